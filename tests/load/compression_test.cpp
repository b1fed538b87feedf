// Draco and meshoptimizer: what their own encoders pack comes back within the quantisation step, packed twins
// of models are their twins, and damaged data are an error or a valid scene.
#include "gltf_text.h"
#include "test_files.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <tessera/render.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace tessera {
namespace {

constexpr std::uint32_t kSide = 12;  // of a bumpy grid

struct Grid {
    std::vector<Vec3> positions;
    std::vector<std::uint32_t> indices;

    Grid() {
        for (std::uint32_t y = 0; y <= kSide; ++y)
            for (std::uint32_t x = 0; x <= kSide; ++x)
                positions.push_back(
                    {static_cast<float>(x), static_cast<float>(y), 0.3f * std::sin(static_cast<float>(x * y))});
        for (std::uint32_t y = 0; y < kSide; ++y)
            for (std::uint32_t x = 0; x < kSide; ++x) {
                const std::uint32_t a = y * (kSide + 1) + x, b = a + kSide + 1;
                indices.insert(indices.end(), {a, a + 1, b + 1, a, b + 1, b});
            }
    }
};

// The corners of all triangles, in an order of their own.
std::vector<std::array<Vec3, 3>> triangles_of(const std::vector<Vec3>& positions,
                                              const std::vector<std::uint32_t>& indices) {
    std::vector<std::array<Vec3, 3>> triangles;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        std::array<Vec3, 3> t{positions[indices[i]], positions[indices[i + 1]], positions[indices[i + 2]]};
        // Quantisation must not change the order, so whole steps decide; the winding stays.
        const auto key = [](const Vec3& p) { return std::lround(p.y) * 1000 + std::lround(p.x); };
        std::rotate(t.begin(),
                    std::min_element(t.begin(), t.end(), [&](const Vec3& a, const Vec3& b) { return key(a) < key(b); }),
                    t.end());
        triangles.push_back(t);
    }
    std::sort(triangles.begin(), triangles.end(), [](const auto& a, const auto& b) {
        const auto key = [](const std::array<Vec3, 3>& t) {
            std::array<long, 6> k{};
            for (std::size_t i = 0; i < 3; ++i) k[2 * i] = std::lround(t[i].y), k[2 * i + 1] = std::lround(t[i].x);
            return k;
        };
        return key(a) < key(b);
    });
    return triangles;
}

void expect_twins(const std::vector<std::array<Vec3, 3>>& a, const std::vector<std::array<Vec3, 3>>& b, float step) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t t = 0; t < a.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_NEAR(a[t][k].x, b[t][k].x, step);
            ASSERT_NEAR(a[t][k].y, b[t][k].y, step);
            ASSERT_NEAR(a[t][k].z, b[t][k].z, step);
        }
}

std::vector<std::uint8_t> draco_packed(const Grid& grid, int method, int bits) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(static_cast<int>(grid.indices.size() / 3));
    const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (std::uint32_t f = 0; f < grid.indices.size() / 3; ++f)
        builder.SetAttributeValuesForFace(id, draco::FaceIndex(f), &grid.positions[grid.indices[3 * f]],
                                          &grid.positions[grid.indices[3 * f + 1]],
                                          &grid.positions[grid.indices[3 * f + 2]]);
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
    encoder.SetEncodingMethod(method);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.data() + buffer.size()};
}

std::string draco_gltf(const std::vector<std::uint8_t>& packed, std::size_t vertices, std::size_t indices) {
    return gltf_text(
        "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],"
        "\"accessors\":[{\"componentType\":5126,\"count\":" +
            std::to_string(vertices) +
            ",\"type\":\"VEC3\"},{\"componentType\":5125,\"count\":" + std::to_string(indices) +
            ",\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":" + std::to_string(packed.size()) +
            "}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"extensions\":{"
            "\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}]}],"
            "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]",
        packed);
}

TEST(Draco, ComesBackWithinTheQuantisationStep) {
    const Grid grid;
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING})
        for (const int bits : {8, 11, 16}) {
            const std::vector<std::uint8_t> packed = draco_packed(grid, method, bits);
            const Scene scene = load_text(draco_gltf(packed, grid.positions.size(), grid.indices.size()));
            const Primitive& p = scene.meshes[0].primitives[0];
            const float step = static_cast<float>(kSide) / static_cast<float>((1 << bits) - 1);
            expect_twins(triangles_of(grid.positions, grid.indices), triangles_of(p.positions, p.indices),
                         0.51f * step + 1e-5f);
        }
}

TEST(Draco, DamageIsAnErrorOrAValidScene) {
    const Grid grid;
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::vector<std::uint8_t> whole = draco_packed(grid, method, 11);
        const auto attempt = [&](const std::vector<std::uint8_t>& packed) {
            try {
                validate(load_text(draco_gltf(packed, grid.positions.size(), grid.indices.size())));
            } catch (const Error& error) {
                EXPECT_TRUE(error.code() == ErrorCode::kInput || error.code() == ErrorCode::kLimit) << error.what();
            }
        };
        for (std::size_t size = 1; size < whole.size(); size += 1 + size / 8)
            attempt({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        std::mt19937 random(5);
        for (int round = 0; round < 400; ++round) {
            std::vector<std::uint8_t> packed = whole;
            for (int flips = 1 + round % 4; flips > 0; --flips)
                packed[random() % packed.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
            attempt(packed);
        }
        EXPECT_NE(
            load_error(draco_gltf(whole, grid.positions.size(), grid.indices.size() - 3)).find("triangles are packed"),
            std::string::npos);
        EXPECT_NE(
            load_error(draco_gltf(whole, grid.positions.size() + 1, grid.indices.size())).find("vertices are packed"),
            std::string::npos);
    }
    // Counts that would take gigabytes are refused before Draco sees them.
    std::vector<std::uint8_t> huge{'D', 'R',  'A',  'C',  'O',  2,    2,    1,    1,    0,    0,
                                   0,   0xff, 0xff, 0xff, 0xff, 0x0f, 0xff, 0xff, 0xff, 0xff, 0x0f};
    EXPECT_NE(load_error(draco_gltf(huge, 3, 3)).find("the accessors promise 1"), std::string::npos);
    huge[6] = 1;
    EXPECT_NE(load_error(draco_gltf(huge, 3, 3)).find("bitstream 2.1"), std::string::npos);
}

std::string meshopt_gltf(const std::vector<std::uint8_t>& vertices, const std::vector<std::uint8_t>& indices,
                         const Grid& grid) {
    std::vector<std::uint8_t> buffer = vertices;
    while (buffer.size() % 4 != 0) buffer.push_back(0);
    const std::size_t second = buffer.size();
    buffer.insert(buffer.end(), indices.begin(), indices.end());
    const std::string v = std::to_string(grid.positions.size()), i = std::to_string(grid.indices.size());
    const auto packed = [&](std::size_t offset, std::size_t size, const std::string& count, int stride,
                            const char* mode) {
        return "\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":" + std::to_string(offset) +
               ",\"byteLength\":" + std::to_string(size) + ",\"byteStride\":" + std::to_string(stride) +
               ",\"count\":" + count + ",\"mode\":\"" + mode + "\"}}";
    };
    // The plain buffer is a fallback that is not there.
    std::string text = gltf_text("\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":" + v +
                                     ",\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5125,\"count\":" + i +
                                     ",\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":" +
                                     std::to_string(12 * grid.positions.size()) + ",\"byteStride\":12," +
                                     packed(0, vertices.size(), v, 12, "ATTRIBUTES") +
                                     "},{\"buffer\":0,\"byteLength\":" + std::to_string(4 * grid.indices.size()) + "," +
                                     packed(second, indices.size(), i, 4, "TRIANGLES") +
                                     "}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}"
                                     "],\"nodes\":[{\"mesh\":0}],"
                                     "\"scenes\":[{\"nodes\":[0]}]",
                                 buffer);
    return text;
}

TEST(Meshopt, ComesBackExactly) {
    const Grid grid;
    std::vector<std::uint8_t> vertices(meshopt_encodeVertexBufferBound(grid.positions.size(), 12));
    vertices.resize(
        meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), grid.positions.data(), grid.positions.size(), 12));
    std::vector<std::uint8_t> indices(meshopt_encodeIndexBufferBound(grid.indices.size(), grid.positions.size()));
    indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), grid.indices.data(), grid.indices.size()));
    const Scene scene = load_text(meshopt_gltf(vertices, indices, grid));
    const Primitive& p = scene.meshes[0].primitives[0];
    EXPECT_EQ(p.positions, grid.positions);
    expect_twins(triangles_of(grid.positions, grid.indices), triangles_of(p.positions, p.indices), 0);

    const auto attempt = [&](const std::vector<std::uint8_t>& v, const std::vector<std::uint8_t>& i) {
        try {
            validate(load_text(meshopt_gltf(v, i, grid)));
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kInput) << error.what();
        }
    };
    std::mt19937 random(6);
    for (int round = 0; round < 300; ++round) {
        std::vector<std::uint8_t> v = vertices, i = indices;
        v[random() % v.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
        i[random() % i.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
        attempt(v, i);
    }
    vertices.resize(vertices.size() / 2);
    EXPECT_NE(load_error(meshopt_gltf(vertices, indices, grid)).find("damaged"), std::string::npos);
}

TEST(CompressedModels, AreTheirTwins) {
    if (all_gltf_models().empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    const auto corners = [](const Scene& scene) {
        std::vector<std::array<long, 3>> all;
        for (const Mesh& mesh : scene.meshes)
            for (const Primitive& p : mesh.primitives)
                for (const std::uint32_t i : p.indices)
                    all.push_back({std::lround(1000 * p.positions[i].x), std::lround(1000 * p.positions[i].y),
                                   std::lround(1000 * p.positions[i].z)});
        std::sort(all.begin(), all.end());
        return all;
    };
    const auto box = corners(load_scene(gltf_model("Box/glTF-Binary/Box.glb").string()));
    EXPECT_EQ(box.size(), 36u);
    EXPECT_EQ(corners(load_scene(gltf_model("BoxDraco/BoxDraco.gltf").string())), box);
    const Scene meshopt = load_scene(gltf_model("BoxMeshopt.glb").string());
    EXPECT_EQ(visible_bounds(meshopt).max, (Vec3{0.5f, 0.5f, 0.5f}));
}

}  // namespace
}  // namespace tessera
