// OBJ geometry: references, objects, polygons, normals by smoothing groups, lines and points.
#include "mesh_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace tessera {
namespace {

const Primitive& only_primitive(const Scene& scene) {
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes.at(0).primitives.size(), 1u);
    return scene.meshes.at(0).primitives.at(0);
}

TEST(Obj, PositionsTextureCoordinatesAndNormals) {
    const Scene scene = load_text(
        "# a comment\nv 0 0 0\nv 1 0 0 # behind\nv 0 1 0\nvt 0.25 0.75\nvt 1 0 0\nvt 0.5\nvn 0 0 3\n"
        "f 1/1/1 2/2/1 3/3/1\n",
        "a.obj");
    const Primitive& p = only_primitive(scene);
    EXPECT_EQ(p.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(p.texcoords[0], (std::vector<Vec2>{{0.25f, 0.25f}, {1, 1}, {0.5f, 1}}));  // from the top
    EXPECT_EQ(p.normals, (std::vector<Vec3>(3, Vec3{0, 0, 1})));
    EXPECT_EQ(p.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_TRUE(scene.materials[static_cast<std::size_t>(p.material)].double_sided);
}

TEST(Obj, NegativeReferencesCountBackFromTheirLine) {
    const Scene scene =
        load_text("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4// 3// -1//\n", "a.obj");
    const Primitive& p = only_primitive(scene);
    ASSERT_EQ(p.indices.size(), 6u);
    const auto at = [&](std::size_t i) { return p.positions[p.indices[i]]; };
    EXPECT_EQ(at(0), (Vec3{0, 0, 0}));
    EXPECT_EQ(at(2), (Vec3{0, 1, 0}));
    EXPECT_EQ(at(3), (Vec3{0, 0, 0}));
    EXPECT_EQ(at(5), (Vec3{5, 5, 5}));
}

// Vertices are shared where all of position, texture coordinate and normal are the same, and only there.
TEST(Obj, VerticesAreShared) {
    const Scene scene = load_text(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1//1 3//1 4//2\nf 1//2 3//1 "
        "4//2\n",
        "a.obj");
    const Primitive& p = only_primitive(scene);
    EXPECT_EQ(p.positions.size(), 5u);
    EXPECT_EQ(p.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 4, 2, 3}));
}

TEST(Obj, ObjectsGroupsAndMaterialsPartTheMesh) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const Scene objects = load_text(
        vertices + "o first\ng ignored\nf 1 2 3\nusemtl red\nf 1 2 3\nf 1 2 3\no second\ng also\nf 1 2 3\n", "a.obj");
    ASSERT_EQ(objects.meshes.size(), 2u);
    EXPECT_EQ(objects.nodes[0].name, "first");
    EXPECT_EQ(objects.nodes[1].name, "second");
    ASSERT_EQ(objects.meshes[0].primitives.size(), 2u);
    EXPECT_EQ(objects.meshes[0].primitives[1].indices.size(), 6u);
    const Scene groups = load_text(vertices + "g a\nf 1 2 3\ng b c\nf 1 2 3\ng a\nf 1 2 3", "a.obj");
    ASSERT_EQ(groups.meshes.size(), 3u);
    EXPECT_EQ(groups.meshes[1].name, "b c");
}

TEST(Obj, ConcavePolygonsAreSplitInside) {
    const Scene dart = load_text("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\n", "a.obj");
    const Primitive& p = only_primitive(dart);
    ASSERT_EQ(p.indices.size(), 6u);
    for (std::size_t i = 0; i < 6; i += 3) {  // both triangles have the reflex corner
        std::set<float> x;
        for (std::size_t k = 0; k < 3; ++k) x.insert(p.positions[p.indices[i + k]].x);
        EXPECT_TRUE(x.count(1));
    }
}

TEST(Obj, LinesAndPointsArePrimitives) {
    const Scene scene = load_text("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nvt 0 0\nl 1 2 3\nl 4/1 1\np 2 3\n", "a.obj");
    ASSERT_EQ(scene.meshes[0].primitives.size(), 2u);
    const Primitive &lines = scene.meshes[0].primitives[0], &points = scene.meshes[0].primitives[1];
    EXPECT_EQ(lines.mode, PrimitiveMode::kLines);
    EXPECT_EQ(lines.indices, (std::vector<std::uint32_t>{0, 1, 1, 2, 3, 0}));
    EXPECT_EQ(points.mode, PrimitiveMode::kPoints);
    EXPECT_EQ(points.indices.size(), 2u);
}

TEST(Obj, ColoursBehindPositionsAreSrgb) {
    const Scene scene = load_text("v 0 0 0 1 0 0.5\nv 1 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n", "a.obj");
    const Primitive& p = only_primitive(scene);
    ASSERT_EQ(p.colors.size(), 1u);
    EXPECT_EQ(p.colors[0][0].x, 1.0f);
    EXPECT_NEAR(p.colors[0][0].z, 0.2140411f, 1e-6f);  // IEC 61966-2-1 of 1/2
    EXPECT_EQ(p.colors[0][1], (Vec4{1, 1, 1, 1}));
    EXPECT_EQ(p.colors[0][2], (Vec4{0, 0, 0, 1}));
}

// A roof of two squares that meet at a right angle.
std::string roof(const std::string& smoothing) {
    return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n" + smoothing + "f 1 2 3 4\nf 1 5 6 2\n";
}

Vec3 normal_at(const Primitive& p, const Vec3& position, std::size_t which = 0) {
    std::set<std::array<float, 3>> found;
    for (std::size_t i = 0; i < p.positions.size(); ++i)
        if (p.positions[i] == position) found.insert({p.normals[i].x, p.normals[i].y, p.normals[i].z});
    if (which >= found.size()) return {0, 0, 0};
    auto it = found.begin();
    std::advance(it, which);
    return {(*it)[0], (*it)[1], (*it)[2]};
}

TEST(Obj, LIT5_SmoothingGroupsDecideMissingNormals) {
    // Faces look to (0, 0, 1) and (0, 1, 0).
    const float half = std::sqrt(0.5f);
    const Scene smooth = load_text(roof("s 1\n"), "a.obj");
    const Vec3 n = normal_at(only_primitive(smooth), {0, 0, 0});
    EXPECT_NEAR(n.y, half, 1e-6f);
    EXPECT_NEAR(n.z, half, 1e-6f);
    EXPECT_EQ(only_primitive(smooth).positions.size(), 6u);
    for (const char* flat : {"s off\n", "s 0\n", "s\n", ""}) {  // nothing said: the edge is sharp
        const Scene scene = load_text(roof(flat), "a.obj");
        EXPECT_EQ(only_primitive(scene).positions.size(), 8u) << flat;
        EXPECT_EQ(normal_at(only_primitive(scene), {0, 0, 0}, 0), (Vec3{0, 0, 1})) << flat;
        EXPECT_EQ(normal_at(only_primitive(scene), {0, 0, 0}, 1), (Vec3{0, 1, 0})) << flat;
    }
    // Off until the file speaks of it.
    const Scene later = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\ns 1\n", "a.obj");
    EXPECT_EQ(only_primitive(later).positions.size(), 6u);
    // A gentle fold stays smooth without a word.
    const Scene gentle =
        load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 -1 0.5\nv 1 -1 0.5\nf 1 2 3 4\nf 1 5 6 2\n", "a.obj");
    EXPECT_EQ(only_primitive(gentle).positions.size(), 6u);
}

// The weight is the angle, so that a square cut into triangles counts once.
TEST(Obj, LIT5_NormalsAreWeightedByAngle) {
    const Scene scene = load_text(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\ns 1\n"
        "f 1 2 3\nf 1 3 4\nf 1 5 6 2\nf 1 4 7 5\n",
        "a.obj");
    const Vec3 n = normal_at(only_primitive(scene), {0, 0, 0});
    const float third = std::sqrt(1.0f / 3);
    EXPECT_NEAR(n.x, third, 1e-6f);
    EXPECT_NEAR(n.y, third, 1e-6f);
    EXPECT_NEAR(n.z, third, 1e-6f);
}

TEST(Obj, ContinuedLinesAndForeignStatements) {
    const Scene scene = load_text(
        "v 0 0 \\\n 0\r\nv 1 0 0\r\nv 0 1 0\r\nmg 0\nlod 3\ncstype bezier\ncurv 0 1\nend\nwhatever 1 2\nf 1 \\\n2 3",
        "a.obj");
    EXPECT_EQ(only_primitive(scene).indices.size(), 3u);
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_NE(scene.warnings[0].find("free-form"), std::string::npos);
    EXPECT_NE(scene.warnings[1].find("\"whatever\""), std::string::npos);
}

// Files that once took minutes: corners that all stand at one place, in faces of their own and in one face.
TEST(Obj, WorkStaysInProportion) {
    std::string flat = "v 0 0 0\ns off\n", around = "v 0 0 0\n", one = "v 0 0 0\nf", textured = "v 0 0 0\n";
    for (int i = 0; i < 100000; ++i) flat += "f 1 1 1\n";
    for (int i = 0; i < 300000; ++i) one += " 1";
    for (int i = 0; i < 50000; ++i) textured += "vt 0.5 0." + std::to_string(i) + "\nf 1/-1 1/-1 1/-1\n";
    EXPECT_EQ(only_primitive(load_text(flat, "a.obj")).positions.size(), 100000u);
    EXPECT_EQ(only_primitive(load_text(one, "a.obj")).indices.size(), 3u * 299998);
    EXPECT_EQ(only_primitive(load_text(textured, "a.obj")).positions.size(), 50000u);
    LoadOptions few;
    few.max_nodes = 2;
    EXPECT_NE(load_error("v 0 0 0\no a\np 1\no b\np 1\no c\np 1\n", "a.obj", few).find("limit of 2"),
              std::string::npos);
}

TEST(Obj, CommentsJoinNothing) {
    const Scene scene = load_text("v 0 0 0\n# from D:\\models\\\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj");
    EXPECT_EQ(only_primitive(scene).positions.size(), 3u);
}

TEST(Obj, EmptyFilesDrawNothing) {
    EXPECT_TRUE(load_text("", "a.obj").meshes.empty());
    EXPECT_TRUE(load_text("# nothing\n", "a.obj").meshes.empty());
    EXPECT_TRUE(load_text("v 1 2 3\nf 1 1\n", "a.obj").meshes.empty());
}

TEST(Obj, DamageIsNamed) {
    const auto expect = [](const std::string& file, const char* reason) {
        EXPECT_NE(load_error(file, "x.obj").find(reason), std::string::npos) << load_error(file, "x.obj");
    };
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    expect(three + "f 1 2 4\n", "line 4: vertex \"4\" of 3");
    expect(three + "f 1 2 0\n", "vertex \"0\"");
    expect(three + "f 1 2 -4\n", "vertex \"-4\" of 3");
    expect(three + "f 1 2 3x\n", "\"3x\"");
    expect(three + "f 1/1 2 3\n", "texture coordinate \"1\" of 0");
    expect(three + "f 1//1 2 3\n", "normal \"1\" of 0");
    expect(three + "f /1 2 3\n", "names no vertex");
    expect("v 0 0\n", "a number is missing");
    expect("v 0 0 zero\n", "\"zero\" is no number");
    expect("v 0 0 1e99\n", "not finite");
    expect("v 0 0 nan\n", "not finite");
    expect("s x\n", "smoothing group");
    expect(std::string("v\0x 1", 5), "no statement of OBJ");
    LoadOptions one;
    one.max_triangles = 1;
    EXPECT_NE(load_error(three + "f 1 2 3 1\n", "x.obj", one).find("line 4"), std::string::npos);
    EXPECT_NE(load_error(three + "l 1 2 3\n", "x.obj", one).find("line 4"), std::string::npos);
    LoadOptions small;
    small.max_bytes = 5000;
    std::string many;
    for (int i = 0; i < 1000; ++i) many += "v 0 0 0\n";
    EXPECT_NE(load_error(many, "x.obj", small).find("limit of 5000 bytes"), std::string::npos);
}

}  // namespace
}  // namespace tessera
