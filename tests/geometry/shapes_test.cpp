// Shapes among other meshes: their tangents are those that would be made, planes without end frame nothing, and each is
// one primitive.
#include "geometry/prepared_scene.h"
#include "geometry/support.h"
#include "geometry/tangents.h"

#include <tessera/render.h>

namespace tessera {
namespace {

Shape endless() { return {Shape::Type::kPlane, 1, {0, 0}, 96}; }

TEST(ShapeMeshes, TangentsAreThoseThatWouldBeMade) {
    for (const Shape& shape : {Shape{Shape::Type::kSphere, 2, {0, 0}, 64}, Shape{Shape::Type::kDisc, 2, {0, 0}, 64},
                               Shape{Shape::Type::kPlane, 1, {3, 2}, 96}, endless()}) {
        const Primitive own = shape_primitive(shape);
        const Primitive made = with_tangents(own, 0);
        std::size_t compared = 0;
        for (std::size_t i = 0; i < own.positions.size(); ++i) {
            const float v = own.texcoords[0][i].y;
            if (shape.type == Shape::Type::kSphere && (v < 0.1f || v > 0.9f)) continue;
            const Vec4 &a = own.tangents[i], &b = made.tangents[i];
            EXPECT_EQ(a.w, b.w);
            EXPECT_GT(a.x * b.x + a.y * b.y + a.z * b.z, 0.998f) << i;
            ++compared;
        }
        EXPECT_GT(2 * compared, own.positions.size());
    }
}

// Nodes with one mesh of one primitive each.
void add(Scene& scene, const Primitive& p, Vec3 translation = {0, 0, 0}) {
    if (scene.scenes.empty()) scene.scenes.push_back({});
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()));
    scene.meshes.push_back({"", {p}, {}, {}});
    Node& node = scene.nodes.emplace_back();
    node.mesh = static_cast<int>(scene.meshes.size()) - 1;
    node.translation = translation;
}

TEST(ShapeMeshes, BoundsAreThoseOfWhatEnds) {
    Scene scene;
    add(scene, shape_primitive({Shape::Type::kSphere, 2, {0, 0}, 64}), {10, 0, 0});
    add(scene, shape_primitive({Shape::Type::kDisc, 3, {0, 0}, 64}), {0, -5, 0});
    add(scene, shape_primitive({Shape::Type::kPlane, 1, {2, 30}, 96}), {0, 1, 0});
    test::expect_near(visible_bounds(scene).min, {-3, -5, -15}, 1e-6f);
    test::expect_near(visible_bounds(scene).max, {12, 2, 15}, 1e-6f);
    const Bounds3 before = visible_bounds(scene);
    add(scene, shape_primitive(endless()), {0, -100, 0});
    EXPECT_EQ(visible_bounds(scene).min, before.min);
    EXPECT_EQ(visible_bounds(scene).max, before.max);
    scene.skins.push_back({"", {0}, {}, kNone, ""});  // bounds are taken from the prepared scene
    EXPECT_EQ(visible_bounds(scene).min, before.min);
    EXPECT_EQ(visible_bounds(scene).max, before.max);
}

PlacedCamera camera(const Scene& scene, const View& view) { return PreparedScene(scene).camera(view, 1.5); }

void expect_same(const PlacedCamera& a, const PlacedCamera& b) {
    EXPECT_EQ(a.camera_to_world, b.camera_to_world);
    EXPECT_EQ(a.lens.znear, b.lens.znear);
    EXPECT_EQ(a.lens.yfov, b.lens.yfov);
    EXPECT_EQ(a.pivot, b.pivot);
}

TEST(ShapeMeshes, PlanesWithoutEndFrameNothing) {
    Scene ball, both, ground;
    add(ball, shape_primitive({}), {3, 1, 2});
    add(both, shape_primitive({}), {3, 1, 2});
    add(both, shape_primitive(endless()));
    add(ground, shape_primitive(endless()), {0, 4, 0});
    EXPECT_TRUE(visible_bounds(ground).empty());
    View turning, standing, looking;
    turning.turn = 0.5;
    standing.eye = Vec3{1, 2, 9};
    looking.target = Vec3{1, 1, 1};
    for (const View& view : {View{}, turning, standing, looking}) {
        expect_same(camera(both, view), camera(ball, view));
        expect_same(camera(ground, view), camera(Scene{}, view));
    }
    // One with an end does.
    Scene framed = ball;
    add(framed, shape_primitive({Shape::Type::kPlane, 1, {50, 50}, 96}));
    EXPECT_NE(camera(framed, {}).camera_to_world, camera(ball, {}).camera_to_world);
}

TEST(ShapeMeshes, AShapeIsOnePrimitive) {
    Primitive two;
    two.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    two.indices = {0, 1, 2, 2, 1, 3};
    Scene scene;
    add(scene, shape_primitive({}));
    add(scene, two);
    add(scene, shape_primitive({Shape::Type::kDisc, 1, {0, 0}, 64}));
    add(scene, shape_primitive(endless()));
    add(scene, two, {0, 0, 1});
    const PreparedScene prepared(scene);
    ASSERT_EQ(prepared.placements().size(), 5u);
    const std::uint32_t expected[] = {0, 1, 3, 4, 5};
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(prepared.placements()[i].first_primitive, expected[i]);
    // All of its triangles are drawn.
    EXPECT_EQ(prepared.placements()[0].mesh->triangles.count(), scene.meshes[0].primitives[0].indices.size() / 3);
}

}  // namespace
}  // namespace tessera
