// Loading speed: a GLB of a million triangles against a plain memory copy of its buffers, and a JSON
// file of 20,000 nodes. Writes the files to a temporary folder, reads each a few times with a warm file
// cache and prints the best processor time of this process in milliseconds.
#include <tessera/error.h>
#include <tessera/load.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

namespace {

constexpr int kRepetitions = 15;
constexpr std::uint32_t kSide = 708;  // a grid of kSide^2 vertices: 999,698 triangles

double processor_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

template <class F>
double best_ms(F&& work) {
    double best = 1e30;
    for (int i = 0; i < kRepetitions; ++i) {
        const double begin = processor_ms();
        work();
        best = std::min(best, processor_ms() - begin);
    }
    return best;
}

void append(std::string& out, const void* data, std::size_t bytes) {
    out.append(static_cast<const char*>(data), bytes);
}

void append_chunk(std::string& out, std::uint32_t type, std::string data, char padding) {
    while (data.size() % 4) data += padding;
    const auto size = static_cast<std::uint32_t>(data.size());
    append(out, &size, 4);
    append(out, &type, 4);
    out += data;
}

std::string view(std::size_t offset, std::size_t bytes, std::size_t stride) {
    return "{\"buffer\":0,\"byteOffset\":" + std::to_string(offset) + ",\"byteLength\":" + std::to_string(bytes) +
           (stride ? ",\"byteStride\":" + std::to_string(stride) : std::string()) + "}";
}

std::string accessor(int buffer_view, std::size_t offset, int component, std::size_t count, const char* type) {
    return "{\"bufferView\":" + std::to_string(buffer_view) + ",\"byteOffset\":" + std::to_string(offset) +
           ",\"componentType\":" + std::to_string(component) + ",\"count\":" + std::to_string(count) + ",\"type\":\"" +
           type + "\"}";
}

// A grid with positions, normals and texture coordinates, one after the other or interleaved.
std::string make_glb(bool interleaved) {
    const std::size_t vertices = std::size_t{kSide} * kSide, triangles = std::size_t{kSide - 1} * (kSide - 1) * 2;
    std::vector<float> data(vertices * 8);
    const auto slot = [&](std::size_t v, std::size_t offset, std::size_t n) {
        return interleaved ? v * 8 + offset : vertices * offset + v * n;
    };
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto x = static_cast<float>(v % kSide), y = static_cast<float>(v / kSide);
        const float position[3] = {x, y, 0.01f * x * y}, normal[3] = {0, 0, 1}, uv[2] = {x / kSide, y / kSide};
        std::memcpy(&data[slot(v, 0, 3)], position, 12);
        std::memcpy(&data[slot(v, 3, 3)], normal, 12);
        std::memcpy(&data[slot(v, 6, 2)], uv, 8);
    }
    std::vector<std::uint32_t> indices;
    for (std::uint32_t y = 0; y + 1 < kSide; ++y)
        for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
            const std::uint32_t a = y * kSide + x, b = a + 1, c = a + kSide, d = c + 1;
            for (const std::uint32_t i : {a, b, c, b, d, c}) indices.push_back(i);
        }
    const std::size_t vertex_bytes = data.size() * 4, index_bytes = indices.size() * 4, n = vertices;
    std::string views, accessors;
    if (interleaved) {
        views = view(0, vertex_bytes, 32) + "," + view(vertex_bytes, index_bytes, 0);
        accessors = accessor(0, 0, 5126, n, "VEC3") + "," + accessor(0, 12, 5126, n, "VEC3") + "," +
                    accessor(0, 24, 5126, n, "VEC2") + "," + accessor(1, 0, 5125, triangles * 3, "SCALAR");
    } else {
        views = view(0, n * 12, 0) + "," + view(n * 12, n * 12, 0) + "," + view(n * 24, n * 8, 0) + "," +
                view(vertex_bytes, index_bytes, 0);
        accessors = accessor(0, 0, 5126, n, "VEC3") + "," + accessor(1, 0, 5126, n, "VEC3") + "," +
                    accessor(2, 0, 5126, n, "VEC2") + "," + accessor(3, 0, 5125, triangles * 3, "SCALAR");
    }
    const std::string json =
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2},"
        "\"indices\":3}]}],\"buffers\":[{\"byteLength\":" +
        std::to_string(vertex_bytes + index_bytes) + "}],\"bufferViews\":[" + views + "],\"accessors\":[" + accessors +
        "]}";
    std::string binary;
    append(binary, data.data(), vertex_bytes);
    append(binary, indices.data(), index_bytes);
    std::string chunks;
    append_chunk(chunks, 0x4e4f534a, json, ' ');
    append_chunk(chunks, 0x004e4942, binary, '\0');
    const std::uint32_t header[3] = {0x46546c67, 2, static_cast<std::uint32_t>(chunks.size() + 12)};
    std::string glb;
    append(glb, header, 12);
    return glb + chunks;
}

// 20,000 named nodes with translation, rotation and scale, 100 children each.
std::string make_node_file() {
    constexpr int kNodes = 20000, kChildren = 100;
    std::string json = "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[";
    for (int i = 0; i < kNodes; ++i) {
        const std::string number = std::to_string(i);
        json += std::string(i ? "," : "") + "{\"name\":\"node " + number + "\",\"translation\":[0.25," + number +
                ".5,-1e-3],\"rotation\":[0,0.70710678,0,0.70710678],\"scale\":[1,1,1]";
        const int first = i * kChildren + 1;
        for (int c = first; c < first + kChildren && c < kNodes; ++c)
            json += (c == first ? ",\"children\":[" : ",") + std::to_string(c);
        json += first < kNodes ? "]}" : "}";
    }
    return json + "]}";
}

void report(const char* what, const std::string& path, double copy_ms) {
    const double load_ms = best_ms([&] { (void)tessera::load_scene(path); });
    std::printf("%-22s %8.2f ms", what, load_ms);
    if (copy_ms > 0)
        std::printf("   copy %6.2f ms   ratio %.2f   allowed %.2f ms (1.5 copies + 20)", copy_ms, load_ms / copy_ms,
                    1.5 * copy_ms + 20);
    std::printf("\n");
}

}  // namespace

int main() {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("tessera_load_bench_" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream(folder / name, std::ios::binary) << text;
        return (folder / name).string();
    };
    try {
        const std::string packed = make_glb(false);
        // Fresh memory each time, as a loader must take it.
        const double copy_ms = best_ms([&] {
            const auto copy = std::make_unique_for_overwrite<char[]>(packed.size());
            std::memcpy(copy.get(), packed.data(), packed.size());
            asm volatile("" : : "r"(copy.get()) : "memory");
        });
        report("GLB, packed", write("packed.glb", packed), copy_ms);
        report("GLB, interleaved", write("interleaved.glb", make_glb(true)), copy_ms);
        report("JSON, 20,000 nodes", write("nodes.gltf", make_node_file()), 0);
    } catch (const tessera::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    std::filesystem::remove_all(folder);
}
