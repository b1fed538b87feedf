// STL, binary and ASCII.
#include "mesh_files.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>

namespace tessera {
namespace {

std::string binary_stl(const std::vector<Vec3>& corners, const std::string& header = "made by a test") {
    std::string file = header;
    file.resize(80, ' ');
    const auto count = static_cast<std::uint32_t>(corners.size() / 3);
    file.append(reinterpret_cast<const char*>(&count), 4);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        file.append(12, '\x7f');  // a normal that nobody should read: not a number
        file.append(reinterpret_cast<const char*>(&corners[i]), 3 * sizeof(Vec3));
        file.append(2, '\0');
    }
    return file;
}

const std::vector<Vec3> kTwo{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1.5f}};

constexpr const char* kAscii =
    "solid first part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0\n"
    "  endloop\n endfacet\nendsolid first part\n"
    "solid second\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1 vertex 1 0 1 vertex 0 1 "
    "1.5\nendloop\nendfacet\nendsolid\n";

TEST(Stl, BinaryGivesItsTriangles) {
    for (const char* header : {"made by a test", "solid in name only"}) {
        const Scene scene = load_text(binary_stl(kTwo, header), "part.stl");
        ASSERT_EQ(scene.meshes.size(), 1u);
        ASSERT_EQ(scene.meshes[0].primitives.size(), 1u);
        const Primitive& p = scene.meshes[0].primitives[0];
        EXPECT_EQ(p.positions, kTwo);
        EXPECT_TRUE(p.normals.empty());  // flat
        EXPECT_TRUE(scene.materials[static_cast<std::size_t>(p.material)].double_sided);
        EXPECT_EQ(scene.scenes[0].nodes.size(), 1u);
    }
    EXPECT_EQ(load_text(binary_stl(kTwo), "no-extension").meshes.size(), 1u);
    EXPECT_TRUE(load_text(binary_stl({}), "empty.stl").meshes[0].primitives.empty());
}

TEST(Stl, AsciiGivesTheSameTrianglesBySolid) {
    const Scene scene = load_text(kAscii, "part.stl");
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[0].name, "first part");
    EXPECT_EQ(scene.nodes[1].name, "second");
    std::vector<Vec3> all = scene.meshes[0].primitives[0].positions;
    const std::vector<Vec3>& more = scene.meshes[1].primitives[0].positions;
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(all, kTwo);
    EXPECT_EQ(load_text(kAscii, "<stdin>").meshes.size(), 2u);  // told by content
}

// Headers of binary files may begin with "solid", also where the count and the size disagree.
TEST(Stl, BinaryWithSolidInItsHeaderIsNeverReadAsText) {
    const std::string tail("\0\0", 2);
    const Scene longer = load_text(binary_stl(kTwo, "solid part") + tail, "part.stl");
    EXPECT_EQ(longer.meshes.at(0).primitives.at(0).positions, kTwo);
    ASSERT_EQ(longer.warnings.size(), 1u);
    EXPECT_NE(longer.warnings[0].find("2 bytes behind the 2 triangles"), std::string::npos) << longer.warnings[0];
    std::string cut = binary_stl(kTwo, "solid part");
    cut.resize(cut.size() - 20);
    EXPECT_NE(load_error(cut, "part.stl").find("2 triangles do not fit"), std::string::npos);
    EXPECT_NE(load_error("solid part\nendsolid part\n", "part.stl").find("no facet"), std::string::npos);
}

TEST(Stl, ACountThatWasNeverFilledInComesFromTheSize) {
    for (const char* header : {"made by a test", "solid part"}) {
        std::string file = binary_stl(kTwo, header);
        file.replace(80, 4, 4, '\0');
        const Scene scene = load_text(file, "part.stl");
        EXPECT_EQ(scene.meshes.at(0).primitives.at(0).positions, kTwo);
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_NE(scene.warnings[0].find("the 2 that follow"), std::string::npos) << scene.warnings[0];
    }
}

TEST(Stl, AsciiInEveryDress) {
    const auto expect_two = [](const std::string& text, const char* what) {
        const Scene scene = load_text(text, "part.stl");
        ASSERT_EQ(scene.meshes.size(), 2u) << what;
        EXPECT_EQ(scene.meshes[0].primitives.at(0).positions, std::vector<Vec3>(kTwo.begin(), kTwo.begin() + 3))
            << what;
        EXPECT_EQ(scene.meshes[1].primitives.at(0).positions, std::vector<Vec3>(kTwo.begin() + 3, kTwo.end())) << what;
        EXPECT_EQ(scene.meshes[0].name.size(), std::string_view("first part").size()) << what;
        EXPECT_TRUE(scene.warnings.empty()) << what;
    };
    const std::string text = kAscii;
    std::string upper = text, line = text;
    for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    for (char& c : line) c = c == '\n' ? ' ' : c;
    expect_two(upper, "upper case");
    expect_two(line, "one line");
    expect_two("\xef\xbb\xbf" + text, "byte order mark");
    expect_two("\n \t\r\n" + text, "white space");
    expect_two("; made by hand\n# and\n// so on\n" + text, "comments");
}

TEST(Stl, DamageIsNamed) {
    std::string cut = binary_stl(kTwo);
    cut.resize(cut.size() - 1);
    EXPECT_NE(load_error(cut, "a.stl").find("2 triangles do not fit"), std::string::npos);
    EXPECT_NE(load_error("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "a.stl").find("line 4"),
              std::string::npos);
    EXPECT_NE(load_error("solid x\nouter loop\nvertex 0 0 0\nendloop", "a.stl").find("a triangle of 1"),
              std::string::npos);
    EXPECT_NE(load_error("solid x\nvertex 0 0 0 vertex 1 1 1\nendsolid", "a.stl").find("within a triangle"),
              std::string::npos);
    EXPECT_NE(load_error("solid x\nvertex 0 0 0\nsolid y\n", "a.stl").find("begins within"), std::string::npos);
    EXPECT_NE(load_error("solid x\nbanana", "a.stl").find("banana"), std::string::npos);
    EXPECT_NE(load_error("vertex 1 2 3", "a.stl"), "");
    std::vector<Vec3> infinite = kTwo;
    infinite[4].y = std::numeric_limits<float>::infinity();
    EXPECT_NE(load_error(binary_stl(infinite), "a.stl").find("meshes/0"), std::string::npos);
    LoadOptions one;
    one.max_triangles = 1;
    EXPECT_NE(load_error(binary_stl(kTwo), "a.stl", one).find("limit of 1"), std::string::npos);
    EXPECT_NE(load_error(kAscii, "a.stl", one).find("limit of 1"), std::string::npos);
    LoadOptions small;
    small.max_bytes = 50;
    EXPECT_NE(load_error(binary_stl(kTwo), "a.stl", small).find("limit"), std::string::npos);
}

}  // namespace
}  // namespace tessera
