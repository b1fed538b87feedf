// Draco under hostile and unusual files: memory follows the limit whatever the data name, strips are lists.
#include "gltf_text.h"

#include <draco/compression/encode.h>
#include <meshoptimizer.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

namespace tessera {
namespace {

// A level grid of side x side quads with positions and `hidden` generic attributes of 100 integers each.
std::unique_ptr<draco::Mesh> grid_mesh(std::uint32_t side, int hidden) {
    auto made = std::make_unique<draco::Mesh>();
    draco::Mesh& mesh = *made;
    const std::uint32_t across = side + 1, points = across * across;
    mesh.set_num_points(points);
    draco::GeometryAttribute position;
    position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    const int at = mesh.AddAttribute(position, true, points);
    for (std::uint32_t p = 0; p < points; ++p) {
        const std::array<float, 3> xyz{static_cast<float>(p % across), static_cast<float>(p / across), 0};
        mesh.attribute(at)->SetAttributeValue(draco::AttributeValueIndex(p), xyz.data());
    }
    constexpr std::int8_t kComponents = 100;
    const std::vector<std::int32_t> zeros(kComponents);
    for (int i = 0; i < hidden; ++i) {
        draco::GeometryAttribute generic;
        generic.Init(draco::GeometryAttribute::GENERIC, nullptr, kComponents, draco::DT_INT32, false, 4 * kComponents,
                     0);
        const int id = mesh.AddAttribute(generic, true, points);
        for (std::uint32_t p = 0; p < points; ++p)
            mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p), zeros.data());
    }
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = y * across + x, b = a + across;
            using Point = draco::PointIndex;
            mesh.AddFace({Point(a), Point(a + 1), Point(b + 1)});
            mesh.AddFace({Point(a), Point(b + 1), Point(b)});
        }
    return made;
}

std::vector<std::uint8_t> pack(const draco::Mesh& mesh, int method) {
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
    return {buffer.data(), buffer.data() + buffer.size()};
}

std::string gltf(const std::vector<std::uint8_t>& packed, std::size_t vertices, std::size_t indices, int mode) {
    return gltf_text(
        "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"accessors\":[{\"componentType\":5126,\"count\":" +
            std::to_string(vertices) +
            ",\"type\":\"VEC3\"},{\"componentType\":5125,\"count\":" + std::to_string(indices) +
            ",\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":" + std::to_string(packed.size()) +
            "}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":" +
            std::to_string(mode) +
            ",\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}]}]",
        packed);
}

constexpr int kMethods[] = {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING};

// The largest resident memory of a process that loads the text, above what it began with, in MiB.
[[maybe_unused]] double memory_of_loading(const std::string& text, const LoadOptions& options, bool expect_limit) {
    const pid_t child = ::fork();
    if (child == 0) {
        struct rusage before {
        }, after{};
        ::getrusage(RUSAGE_SELF, &before);
        bool limited = false;
        try {
            load_scene_from_memory(as_file(text), "", options, "test.gltf");
        } catch (const Error& error) {
            limited = error.code() == ErrorCode::kLimit;
        }
        ::getrusage(RUSAGE_SELF, &after);
        if (limited != expect_limit) ::_exit(255);
        ::_exit(static_cast<int>(std::min(254L, (after.ru_maxrss - before.ru_maxrss) / 1024)));
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_NE(WEXITSTATUS(status), 255) << "limit expected: " << expect_limit;
    return WEXITSTATUS(status);
}

// Twelve attributes that no accessor names, 100 integers each: 9,800 points x 12 x 100 x (4 + 4) bytes are 90 MiB out
// of a file of some kilobytes. What the geometry itself needs is a few MiB.
TEST(Draco, SAFE_AttributesThatNothingNamesCountTowardsTheLimit) {
    constexpr std::uint32_t kSide = 98, kPoints = (kSide + 1) * (kSide + 1), kIndices = 6 * kSide * kSide;
    const std::unique_ptr<draco::Mesh> plain = grid_mesh(kSide, 0), laden = grid_mesh(kSide, 12);
    for (const int method : kMethods) {
        const std::vector<std::uint8_t> packed = pack(*laden, method);
        const std::string text = gltf(packed, kPoints, kIndices, 4);
        LoadOptions options;
        options.max_bytes = std::uint64_t{48} << 20;
        EXPECT_EQ(load_error(gltf(pack(*plain, method), kPoints, kIndices, 4), options), "");
        EXPECT_NE(load_error(text, options, ErrorCode::kLimit).find("KHR_draco_mesh_compression"), std::string::npos);
        EXPECT_EQ(load_error(text), "") << "within the default limit";
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        EXPECT_LT(memory_of_loading(text, options, true), 48);
        // The charge is no less than what is taken.
        EXPECT_GT(memory_of_loading(text, {}, false), 48) << "the file is no test of memory";
#endif
    }
}

// The byte behind the counts says how many tables of corners there are, each as large as the mesh.
TEST(Draco, SAFE_TablesOfSeamsCountTowardsTheLimit) {
    constexpr std::uint32_t kSide = 98, kPoints = (kSide + 1) * (kSide + 1), kIndices = 6 * kSide * kSide;
    std::vector<std::uint8_t> packed = pack(*grid_mesh(kSide, 0), draco::MESH_EDGEBREAKER_ENCODING);
    std::size_t at = 12;
    for (int number = 0; number < 2; ++number)
        while (packed[at++] & 0x80) {
        }
    ASSERT_EQ(packed[at], 0);  // a grid without seams
    packed[at] = 255;
    LoadOptions options;
    options.max_bytes = std::uint64_t{64} << 20;
    EXPECT_NE(load_error(gltf(packed, kPoints, kIndices, 4), options, ErrorCode::kLimit).find("bytes more"),
              std::string::npos);
}

// The extension allows strips; the packed data are a list all the same.
TEST(Draco, StripsAreUnpackedToLists) {
    constexpr std::uint32_t kSide = 9, kPoints = (kSide + 1) * (kSide + 1), kIndices = 6 * kSide * kSide;
    for (const int method : kMethods) {
        const std::vector<std::uint8_t> packed = pack(*grid_mesh(kSide, 0), method);
        const Scene list = load_text(gltf(packed, kPoints, kIndices, 4));
        const Primitive& expected = list.meshes[0].primitives[0];
        // The strip that an exporter would make of them.
        std::vector<std::uint32_t> strip(meshopt_stripifyBound(kIndices));
        strip.resize(meshopt_stripify(strip.data(), expected.indices.data(), kIndices, kPoints, 0));
        ASSERT_LT(strip.size(), kIndices);
        const Scene scene = load_text(gltf(packed, kPoints, strip.size(), 5));
        const Primitive& p = scene.meshes[0].primitives[0];
        EXPECT_EQ(p.mode, PrimitiveMode::kTriangles);
        EXPECT_EQ(p.indices, expected.indices);
        EXPECT_EQ(p.positions, expected.positions);
        // More triangles than the strip can hold, points, lines.
        EXPECT_NE(load_error(gltf(packed, kPoints, kIndices / 3, 5)).find("triangles are packed"), std::string::npos);
        EXPECT_NE(load_error(gltf(packed, kPoints, kIndices, 1)).find("only triangles"), std::string::npos);
    }
}

// 16,777,216 elements are the most of an accessor that is all zeros; packed ones are no zeros.
TEST(Draco, AccessorsOfPackedDataAreNoZeros) {
    const std::vector<std::uint8_t> packed = pack(*grid_mesh(3, 0), draco::MESH_EDGEBREAKER_ENCODING);
    constexpr std::size_t kMany = (std::size_t{1} << 24) + 2;
    LoadOptions options;
    options.max_triangles = kMany;
    // Not the limit of zeros, but that there are other numbers of triangles and vertices.
    EXPECT_NE(load_error(gltf(packed, 16, kMany + 1, 4), options).find("18 triangles are packed"), std::string::npos);
    EXPECT_NE(load_error(gltf(packed, kMany, 54, 4), options).find("16 vertices are packed"), std::string::npos);
}

}  // namespace
}  // namespace tessera
