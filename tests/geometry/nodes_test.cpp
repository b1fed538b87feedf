// GEO5 and ANI1: world matrices along a hierarchy, depth-first with the explicit stack and by a
// recursive twin; and the bounds of what hangs on the nodes.
#include "geometry/bounds.h"
#include "geometry/matrix.h"
#include "geometry/node_transforms.h"
#include "geometry/support.h"

#include <tessera/glm.h>
#include <tessera/render.h>
#include <tessera/transform.h>

#include <limits>

namespace tessera {
namespace {

using test::Random;

// A forest of `count` nodes: each hangs below an earlier one or is a root; every seventh root is in
// no scene.
Scene random_forest(std::uint32_t count, std::uint32_t seed) {
    Random random(seed);
    Scene scene;
    scene.nodes.resize(count);
    scene.scenes.resize(1);
    for (std::uint32_t i = 0; i < count; ++i) {
        Node& node = scene.nodes[i];
        if (random.below(4) == 0)
            node.matrix = compose(random.vec3(2), random.rotation(), {1, 2, 0.5f}) * shear(0.1f, 0, 0, 0, 0, 0);
        else
            node.translation = random.vec3(2), node.rotation = random.rotation(), node.scale = {0.9f, 1.1f, 1};
        if (i > 0 && random.below(10) != 0)
            scene.nodes[random.below(i)].children.push_back(static_cast<int>(i));
        else if (i % 7 != 6)
            scene.scenes[0].nodes.push_back(static_cast<int>(i));
    }
    return scene;
}

struct Twin {
    const Scene& scene;
    NodeTransforms result;

    void visit(int node, const glm::dmat4& parent) {
        const auto i = static_cast<std::size_t>(node);
        result.order.push_back(node);
        result.world[i] = parent * local_matrix(scene.nodes[i]);
        result.visited[i] = 1;
        for (const int child : scene.nodes[i].children) visit(child, result.world[i]);
    }
};

TEST(Geometry, ANI1_ExplicitStackEqualsRecursion) {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        const Scene scene = random_forest(300, seed);
        Twin twin{scene, {}};
        twin.result.world.assign(scene.nodes.size(), glm::dmat4(1));
        twin.result.visited.assign(scene.nodes.size(), 0);
        for (const int root : scene.scenes[0].nodes) twin.visit(root, glm::dmat4(1));
        const NodeTransforms stacked = node_transforms(scene);
        EXPECT_EQ(stacked.order, twin.result.order);
        EXPECT_EQ(stacked.visited, twin.result.visited);
        EXPECT_TRUE(stacked.world == twin.result.world);
        EXPECT_LT(stacked.order.size(), scene.nodes.size());  // some are in no scene
    }
}

TEST(Geometry, GEO5_CompositionAlongAHierarchy) {
    // Shoulder, elbow and hand of an arm in the plane, each a unit along x from the one before.
    Scene scene;
    scene.nodes.resize(3);
    scene.nodes[0].children = {1};
    scene.nodes[1].children = {2};
    scene.nodes[1].translation = scene.nodes[2].translation = {1, 0, 0};
    scene.nodes[0].rotation = quaternion({0, 0, 1}, 1.57079633f);
    scene.nodes[1].rotation = quaternion({0, 0, 1}, -1.57079633f);
    scene.scenes.push_back({"arm", {0}, ""});
    const NodeTransforms arm = node_transforms(scene);
    test::expect_near(to_vec3(glm::dvec3(arm.world[1][3])), {0, 1, 0}, 1e-6f);
    test::expect_near(to_vec3(glm::dvec3(arm.world[2][3])), {1, 1, 0}, 1e-6f);
    // M_world = M_parent * M_local at every joint, as the float matrices of the public API do it.
    const Mat4 by_hand = compose({}, scene.nodes[0].rotation, {1, 1, 1}) *
                         compose({1, 0, 0}, scene.nodes[1].rotation, {1, 1, 1}) * translation({1, 0, 0});
    test::expect_near(to_mat4(arm.world[2]), by_hand);
}

TEST(Geometry, GEO5_DeepChains) {
    constexpr int kDepth = 200000;
    Scene scene;
    scene.nodes.resize(kDepth);
    for (int i = 0; i < kDepth; ++i) {
        scene.nodes[static_cast<std::size_t>(i)].translation = {0.25f, 0, 0};
        if (i + 1 < kDepth) scene.nodes[static_cast<std::size_t>(i)].children = {i + 1};
    }
    scene.scenes.push_back({"", {0}, ""});
    const NodeTransforms chain = node_transforms(scene);
    ASSERT_EQ(chain.order.size(), static_cast<std::size_t>(kDepth));
    EXPECT_EQ(chain.order.back(), kDepth - 1);
    EXPECT_EQ(chain.world.back()[3].x, 0.25 * kDepth);
}

TEST(Geometry, GEO5_NoActiveSceneVisitsNothing) {
    Scene scene = random_forest(10, 1);
    scene.active_scene = kNone;
    EXPECT_TRUE(node_transforms(scene).order.empty());
    EXPECT_TRUE(visible_bounds(scene).empty());
    EXPECT_TRUE(node_transforms(Scene{}).order.empty());
}

Scene with_meshes(Scene scene, std::uint32_t seed) {
    Random random(seed);
    for (int m = 0; m < 5; ++m) {
        Primitive p;
        for (int i = 0; i < 12; ++i) p.positions.push_back(random.vec3(1));
        p.positions.push_back({1000, 1000, 1000});                           // nothing uses it
        for (int i = 0; i < 20; ++i) p.indices.push_back(random.below(12));  // 18 of them make triangles
        Primitive lines = p;
        lines.mode = PrimitiveMode::kLines;
        lines.positions[0] = {-2000, 0, 0};
        scene.meshes.push_back({"", {p, lines}, {}, ""});
    }
    for (Node& node : scene.nodes) node.mesh = static_cast<int>(random.below(6)) - 1;
    return scene;
}

TEST(Geometry, GEO5_BoundsAreThoseOfTheDrawnVertices) {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        const Scene scene = with_meshes(random_forest(60, seed), seed);
        const NodeTransforms nodes = node_transforms(scene);
        Bounds3 expected;
        for (const int n : nodes.order) {
            const int mesh = scene.nodes[static_cast<std::size_t>(n)].mesh;
            if (mesh == kNone) continue;
            const glm::dmat4& m = nodes.world[static_cast<std::size_t>(n)];
            for (const Primitive& p : scene.meshes[static_cast<std::size_t>(mesh)].primitives)
                for (std::size_t i = 0; i < (p.mode == PrimitiveMode::kLines ? 20 : 18); ++i)
                    expected.add(to_vec3(transform_point(m, to_dvec3(p.positions[p.indices[i]]))));
        }
        const Bounds3 bounds = visible_bounds(scene);
        EXPECT_EQ(bounds.min, expected.min);
        EXPECT_EQ(bounds.max, expected.max);
    }
}

TEST(Geometry, GEO5_BoundsOfPrimitives) {
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 2, 3}, {-1, 0, 0}, {9, 9, 9}};
    const glm::dmat4 m = to_dmat4(translation({10, 0, 0}) * scaling({-1, 1, 1}));
    EXPECT_EQ(transformed_bounds(p, m).min, (Vec3{9, 0, 0}));
    EXPECT_EQ(transformed_bounds(p, m).max, (Vec3{11, 2, 3}));
    p.mode = PrimitiveMode::kPoints;  // all four
    EXPECT_EQ(transformed_bounds(p, m).max, (Vec3{11, 9, 9}));
    p.indices = {0, 1};
    EXPECT_EQ(transformed_bounds(p, m).max, (Vec3{10, 2, 3}));
    p.mode = PrimitiveMode::kTriangles;
    EXPECT_TRUE(transformed_bounds(p, m).empty());
}

TEST(Geometry, GEO5_BoundsStayFinite) {
    Scene scene = with_meshes(random_forest(1, 3), 3);
    scene.nodes.resize(2);
    scene.nodes[0].mesh = scene.nodes[1].mesh = 0;
    scene.nodes[0].matrix = scene.nodes[1].matrix = scaling({1e30f, 1, 1});
    scene.scenes[0].nodes = {0};
    const Bounds3 alone = visible_bounds(scene);
    scene.nodes[0].children = {1};  // 1e60 along x: beyond float, not beyond double
    const Bounds3 wide = visible_bounds(scene);
    EXPECT_EQ(wide.max.x, std::numeric_limits<float>::max());
    EXPECT_EQ(wide.min.x, -std::numeric_limits<float>::max());
    EXPECT_EQ(wide.max.y, alone.max.y);
    (*scene.nodes[1].matrix)(0, 0) = std::numeric_limits<float>::infinity();
    const Bounds3 without = visible_bounds(scene);  // the child has no finite point
    EXPECT_EQ(without.min, alone.min);
    EXPECT_EQ(without.max, alone.max);
}

}  // namespace
}  // namespace tessera
