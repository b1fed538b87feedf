// PLY in its three encodings.
#include "mesh_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace tessera {
namespace {

const Primitive& only_primitive(const Scene& scene) { return scene.meshes.at(0).primitives.at(0); }

// A square and a triangle over five vertices with everything that a vertex may have.
constexpr const char* kElements =
    "element vertex 5\nproperty float x\nproperty float y\nproperty double z\nproperty float nx\nproperty float ny\n"
    "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\n"
    "property float t\nproperty list uchar short extra\n"
    "element other 2\nproperty int a\nproperty list uint double b\n"
    "element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n";

struct Vertex {
    float x, y;
    double z;
    float n[3];
    std::uint8_t color[3];
    float st[2];
};
const Vertex kVertices[5] = {{0, 0, 0, {0, 0, 2}, {255, 0, 0}, {0, 0}},
                             {1, 0, 0, {0, 0, 2}, {0, 255, 0}, {1, 0}},
                             {1, 1, 0, {0, 0, 2}, {0, 0, 255}, {1, 1}},
                             {0, 1, 0.25, {0, 0, 2}, {128, 128, 128}, {0, 0.75f}},
                             {2, 0, 0, {0, 0, 0}, {0, 0, 0}, {2, 0}}};

std::string ascii_file() {
    std::string file = std::string("ply\nformat ascii 1.0\ncomment made by a test\n") + kElements;
    for (const Vertex& v : kVertices) {
        const auto add = [&](double number) { file += std::to_string(number) + " "; };
        add(v.x), add(v.y), add(v.z), add(v.n[0]), add(v.n[1]), add(v.n[2]);
        for (const int c : v.color) file += std::to_string(c) + " ";
        add(v.st[0]), add(v.st[1]);
        file += "2 -7 8\n";
    }
    return file + "1 0\n2 3 1.5 2.5 3.5\n" + "9 4 0 1 2 3\n9 3 1 4 2\n";
}

std::string binary_file(bool big) {
    std::string file =
        std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") + " 1.0\n" + kElements;
    const auto add = [&](auto number) {
        char bytes[sizeof number];
        std::memcpy(bytes, &number, sizeof number);
        if (big) std::reverse(bytes, bytes + sizeof number);
        file.append(bytes, sizeof number);
    };
    for (const Vertex& v : kVertices) {
        add(v.x), add(v.y), add(v.z), add(v.n[0]), add(v.n[1]), add(v.n[2]);
        add(v.color[0]), add(v.color[1]), add(v.color[2]), add(v.st[0]), add(v.st[1]);
        add(std::uint8_t{2}), add(std::int16_t{-7}), add(std::int16_t{8});
    }
    add(1), add(0u);
    add(2), add(3u), add(1.5), add(2.5), add(3.5);
    add(std::uint8_t{9}), add(std::uint8_t{4});
    for (const int i : {0, 1, 2, 3}) add(i);
    add(std::uint8_t{9}), add(std::uint8_t{3});
    for (const int i : {1, 4, 2}) add(i);
    return file;
}

TEST(Ply, ThreeEncodingsGiveTheSameScene) {
    for (const std::string& file : {ascii_file(), binary_file(false), binary_file(true)}) {
        const Scene scene = load_text(file, "thing.ply");
        const Primitive& p = only_primitive(scene);
        EXPECT_EQ(p.mode, PrimitiveMode::kTriangles);
        EXPECT_EQ(p.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 1, 4, 2}));
        ASSERT_EQ(p.positions.size(), 5u);
        EXPECT_EQ(p.positions[3], (Vec3{0, 1, 0.25f}));
        EXPECT_EQ(p.normals[0], (Vec3{0, 0, 1}));
        EXPECT_EQ(p.normals[4], (Vec3{0, 0, 1}));  // none: something that shades
        ASSERT_EQ(p.colors.size(), 1u);
        EXPECT_EQ(p.colors[0][1], (Vec4{0, 1, 0, 1}));
        EXPECT_NEAR(p.colors[0][3].x, 0.2158605f, 1e-6f);  // IEC 61966-2-1 of 128/255
        ASSERT_EQ(p.texcoords.size(), 1u);
        EXPECT_EQ(p.texcoords[0][3], (Vec2{0, 0.25f}));  // counted from the top
        EXPECT_TRUE(scene.materials[static_cast<std::size_t>(p.material)].double_sided);
    }
}

TEST(Ply, ColoursInFloatsAreLinear) {
    const Scene scene = load_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float red\nproperty float green\nproperty float blue\nproperty float alpha\n"
        "element face 1\nproperty list uchar int vertex_index\nend_header\n"
        "0 0 0 0.5 0.25 1 0.75\n1 0 0 0 0 0 1\n0 1 0 0 0 0 1\n3 0 1 2\n",
        "c.ply");
    EXPECT_EQ(only_primitive(scene).colors[0][0], (Vec4{0.5f, 0.25f, 1, 0.75f}));
}

constexpr const char* kCubeHeader =
    "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

// LIT5: normals where the file has none. A cube's edges are sharp: three normals at each corner.
TEST(Ply, LIT5_ACubeHasSixFlatFaces) {
    const Scene scene = load_text(kCubeHeader, "cube.ply");
    const Primitive& p = only_primitive(scene);
    ASSERT_EQ(p.indices.size(), 36u);
    ASSERT_EQ(p.positions.size(), 24u);
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        const Vec3 &a = p.positions[p.indices[i]], &b = p.positions[p.indices[i + 1]],
                   &c = p.positions[p.indices[i + 2]];
        const Vec3 e{b.x - a.x, b.y - a.y, b.z - a.z}, f{c.x - a.x, c.y - a.y, c.z - a.z};
        const Vec3 n{e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(p.normals[p.indices[i + k]], n);
    }
}

TEST(Ply, PointsEdgesAndStrips) {
    const std::string vertices =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string numbers = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    const Scene points = load_text(vertices + "end_header\n" + numbers, "p.ply");
    EXPECT_EQ(only_primitive(points).mode, PrimitiveMode::kPoints);
    EXPECT_EQ(only_primitive(points).positions.size(), 4u);
    const Scene edges = load_text(
        vertices + "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n" + numbers + "0 1\n2 3\n",
        "e.ply");
    EXPECT_EQ(only_primitive(edges).mode, PrimitiveMode::kLines);
    EXPECT_EQ(only_primitive(edges).indices, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    const Scene strip = load_text(vertices + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                                      numbers + "8 0 1 2 3 -1 3 2 1\n",
                                  "s.ply");
    const Primitive& p = only_primitive(strip);
    ASSERT_EQ(p.indices.size(), 9u);
    for (const Vec3& n : p.normals) EXPECT_EQ(std::abs(n.z), 1.0f);
    // The second triangle of a strip is turned over, so both face the same way.
    EXPECT_EQ(p.normals[p.indices[0]], p.normals[p.indices[3]]);
}

const std::string kThreeVertices =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

Scene colored(const std::string& type, const char* first, const char* second) {
    std::string file = kThreeVertices;
    for (const char* channel : {"red", "green", "blue", "alpha"})
        file.append("property ").append(type).append(" ").append(channel).append("\n");
    file.append("element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 ").append(first);
    file.append("\n1 0 0 ").append(second).append("\n0 1 0 ").append(second).append("\n3 0 1 2\n");
    return load_text(file, "c.ply");
}

TEST(Ply, IntegersOfColoursCountTo255But16BitsTo65535) {
    for (const char* type : {"uchar", "int", "uint"}) {
        const Scene scene = colored(type, "255 0 255 255", "0 255 0 255");
        EXPECT_EQ(only_primitive(scene).colors.at(0)[0], (Vec4{1, 0, 1, 1})) << type;
        EXPECT_TRUE(scene.warnings.empty()) << type;
        EXPECT_EQ(scene.materials.at(0).alpha_mode, AlphaMode::kOpaque);
    }
    EXPECT_EQ(only_primitive(colored("ushort", "65535 0 65535 65535", "0 0 0 65535")).colors.at(0)[0],
              (Vec4{1, 0, 1, 1}));
    const Scene far = colored("float", "255 0 255 1", "0 0 0 1");
    ASSERT_EQ(far.warnings.size(), 1u);
    EXPECT_NE(far.warnings[0].find("far above 1"), std::string::npos);
    EXPECT_TRUE(colored("float", "2 0 1 1", "0 0 0 1").warnings.empty());
}

TEST(Ply, AlphaOfVerticesBlends) {
    EXPECT_EQ(colored("uchar", "255 0 255 128", "0 0 0 255").materials.at(0).alpha_mode, AlphaMode::kBlend);
    const Scene zeros = colored("uchar", "255 0 255 0", "0 0 0 0");
    EXPECT_EQ(zeros.materials.at(0).alpha_mode, AlphaMode::kOpaque);
    EXPECT_EQ(only_primitive(zeros).colors.at(0)[0].w, 1);
    EXPECT_EQ(zeros.warnings.size(), 1u);
}

TEST(Ply, EdgesBesideFacesAreNamed) {
    const Scene scene = load_text(kThreeVertices +
                                      "element face 1\nproperty list uchar int vertex_indices\nelement edge 1\n"
                                      "property int vertex1\nproperty int vertex2\nend_header\n"
                                      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n0 1\n",
                                  "e.ply");
    EXPECT_EQ(only_primitive(scene).mode, PrimitiveMode::kTriangles);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("edges beside the faces are not drawn; there are 1"), std::string::npos);
}

// Writers that care for normals only: the front is where they point.
TEST(Ply, TrianglesTurnToTheirNormals) {
    const Scene scene = load_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
        "nx\n"
        "property float ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
        "0 0 0 0 0 -1\n1 0 0 0 0 -1\n0 1 0 0 0 -1\n3 0 1 2\n",
        "t.ply");
    EXPECT_EQ(only_primitive(scene).indices, (std::vector<std::uint32_t>{0, 2, 1}));
}

TEST(Ply, DamageIsNamed) {
    const auto expect = [](const std::string& file, const char* reason) {
        EXPECT_NE(load_error(file, "x.ply").find(reason), std::string::npos) << load_error(file, "x.ply");
    };
    const std::string start = "ply\nformat ascii 1.0\n";
    const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
    expect(start + "element vertex 3\n" + xyz, "the header has no end");
    expect("ply\nend_header\n", "names no format");
    expect("ply\nformat ascii 2.0\n", "line 2");
    expect(start + "element vertex 1\nproperty quad x\nend_header\n", "\"quad\" is no type");
    expect(start + "property float x\nend_header\n", "without an element");
    expect(start + "element vertex 1\nproperty float x\nend_header\n1\n", "no x, y and z");
    expect(start + "element vertex 3\n" + xyz + "end_header\n1 2 3 4 5 6 7\n", "do not fit");
    expect(start + "element vertex 2\n" + xyz + "end_header\n1.0 2.0 3.0 4.0 5.0\n", "ends before");
    expect(start + "element vertex 1\n" + xyz + "end_header\n1 2 z\n", "line 8");
    expect(start + "element vertex 1\n" + xyz + "end_header\n1 2 inf\n", "meshes/0");
    const std::string face =
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    expect(start + "element vertex 3\n" + xyz + face + "3 0 1 3\n", "vertex 3 of 3");
    expect(start + "element vertex 3\n" + xyz + face + "3 0 1 -1\n", "vertex -1 of 3");
    expect(start + "element vertex 3\n" + xyz + face + "-3 0 1 2\n", "length of a list");
    expect(start + "element vertex 3\n" + xyz + face + "4000000000 0 1 2\n", "ends before");
    LoadOptions one;
    one.max_triangles = 11;
    EXPECT_NE(load_error(kCubeHeader, "x.ply", one).find("limit of 11"), std::string::npos);
    LoadOptions small;
    small.max_bytes = 200;
    EXPECT_NE(load_error(kCubeHeader, "x.ply", small).find("limit"), std::string::npos);
}

}  // namespace
}  // namespace tessera
