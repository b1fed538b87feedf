// ANI5: the vertices of animated models at several times against an independent evaluation in long double;
// skins, morphs, and what a moment makes of duplicates and cameras.
#include "geometry/matrix.h"
#include "geometry/prepared_scene.h"
#include "geometry/scene_definition.h"
#include "geometry/support.h"
#include "load/test_files.h"

#include <tessera/error.h>
#include <tessera/load.h>

#include <array>
#include <cmath>

namespace tessera {
namespace {

using test::Evaluation;
using test::Real;

// Vertices of everything that is drawn, matched to those of the scene by way of the triangles.
void expect_vertices(const Scene& scene, PreparedScene& prepared, const Moment& moment, std::uint64_t& compared) {
    prepared.move_to(moment);
    const Evaluation truth(scene, moment.animation, moment.time);
    for (const PreparedNode& node : prepared.nodes())
        for (std::uint32_t i = node.first; i < node.placement_end; ++i) {
            const PreparedMesh& mesh = *prepared.placements()[i].mesh;
            const Primitive& source = *mesh.source;
            const TriangleList original(source);
            ASSERT_EQ(original.count(), mesh.triangles.count());
            for (std::size_t t = 0; t < original.count(); ++t)
                for (std::size_t k = 0; k < 3; ++k) {
                    const Vec3 p = mesh.primitive().positions[mesh.triangles[t][k]];
                    const glm::dvec3 got = transform_point(node.world, to_dvec3(p));
                    const std::array<Real, 3> want = truth.vertex(node.node, source, original[t][k]);
                    const Real size = std::max<Real>({1, std::fabs(want[0]), std::fabs(want[1]), std::fabs(want[2])});
                    ASSERT_NEAR(static_cast<double>(want[0]), got.x, static_cast<double>(1e-5L * size));
                    ASSERT_NEAR(static_cast<double>(want[1]), got.y, static_cast<double>(1e-5L * size));
                    ASSERT_NEAR(static_cast<double>(want[2]), got.z, static_cast<double>(1e-5L * size));
                    ++compared;
                }
        }
}

TEST(ANI5_Models, VerticesAreThoseOfTheDefinition) {
    std::uint64_t compared = 0;
    int animated = 0;
    for (const std::string& name : all_gltf_models()) {
        SCOPED_TRACE(name);
        Scene scene;
        LoadOptions options;
        options.load_pictures = false;
        try {
            scene = load_scene(gltf_model(name).string(), options);
        } catch (const Error&) {
            continue;
        }
        if (scene.active_scene == kNone || (scene.animations.empty() && scene.skins.empty())) continue;
        animated += !scene.animations.empty();
        PreparedScene prepared(scene);
        expect_vertices(scene, prepared, {}, compared);
        for (int a = 0; a < static_cast<int>(scene.animations.size()); ++a) {
            const double end = duration(scene.animations[static_cast<std::size_t>(a)]);
            for (const double part : {0.0, 0.13, 0.5, 0.77, 1.0, 1.5, 0.13})
                expect_vertices(scene, prepared, {a, part * end}, compared);
        }
    }
    if (compared == 0) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    EXPECT_GE(animated, 6);
}

// A strip of two joints, one of which turns; weights that do not sum to 1; an unskinned primitive beside it.
Scene bending_strip() {
    Scene scene;
    Primitive strip;
    for (int i = 0; i <= 8; ++i)
        for (int side = 0; side < 2; ++side) {
            strip.positions.push_back({static_cast<float>(side) - 0.5f, 0.25f * static_cast<float>(i), 0});
            strip.normals.push_back({0, 0, 1});
        }
    strip.joints.resize(1);
    strip.weights.resize(1);
    for (int i = 0; i <= 8; ++i)
        for (int side = 0; side < 2; ++side) {
            strip.joints[0].push_back({0, 1, 0, 0});
            strip.weights[0].push_back({2 - 0.25f * static_cast<float>(i), 0.25f * static_cast<float>(i), 0, 0});
        }
    for (std::uint32_t i = 0; i < 8; ++i) {
        const std::uint32_t a = 2 * i;
        strip.indices.insert(strip.indices.end(), {a, a + 1, a + 3, a, a + 3, a + 2});
    }
    Primitive loose = strip;
    loose.joints.clear();
    loose.weights.clear();
    scene.meshes.push_back({"strip", {strip, loose}, {}, {}});
    scene.nodes.resize(3);
    scene.nodes[0].mesh = 0;
    scene.nodes[0].skin = 0;
    scene.nodes[0].translation = {100, 0, 0};  // does not count for what is skinned
    scene.nodes[1].children = {2};
    scene.nodes[2].translation = {0, 1, 0};
    Skin skin;
    skin.joints = {1, 2};
    skin.inverse_bind.resize(2);
    skin.inverse_bind[1](1, 3) = -1;
    scene.skins.push_back(skin);
    Animation bend;
    const float h = std::sqrt(0.5f);
    bend.samplers.push_back({{0, 1}, {0, 0, 0, 1, h, 0, 0, h}, Interpolation::kLinear});
    bend.channels.push_back({0, 2, AnimationPath::kRotation});
    scene.animations.push_back(bend);
    scene.scenes.push_back({"", {0, 1}, ""});
    return scene;
}

TEST(ANI5_Skins, BendAndIgnoreTheirNode) {
    const Scene scene = bending_strip();
    validate(scene);
    PreparedScene prepared(scene);
    ASSERT_EQ(prepared.placements().size(), 2u);
    std::uint64_t compared = 0;
    for (const double time : {0.0, 0.3, 1.0}) expect_vertices(scene, prepared, {0, time}, compared);
    // At the end the second joint's z looks where its y was... and the tip's normal follows it: (0, 0, 1) turned
    // a quarter about x is (0, -1, 0).
    const Primitive& skinned = prepared.placements()[1].mesh->primitive();
    EXPECT_NEAR(skinned.normals.back().y, -1, 1e-6);
    EXPECT_NEAR(skinned.normals.front().z, 1, 1e-6);
    // Half way along the strip matrices are mixed, and normals still stand on the surface that they make.
    const Vec3 a = skinned.positions[8], b = skinned.positions[9], c = skinned.positions[11];
    const Vec3 e{b.x - a.x, b.y - a.y, b.z - a.z}, f{c.x - a.x, c.y - a.y, c.z - a.z};
    const Vec3 n = normalize(Vec3{e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x});
    EXPECT_GT(dot(n, skinned.normals[8]), 0.95f);
}

TEST(ANI5_Skins, MirroredJointsTurnTheWinding) {
    Scene scene = bending_strip();
    PreparedScene straight(scene);
    EXPECT_FALSE(straight.nodes().back().mirrored);
    scene.nodes[1].scale = {-1, 1, 1};
    PreparedScene mirrored(scene);
    ASSERT_EQ(mirrored.nodes().size(), straight.nodes().size());
    const PreparedNode* skinned = nullptr;
    for (const PreparedNode& node : mirrored.nodes())
        if (node.node == 0 && node.mirrored) skinned = &node;
    ASSERT_TRUE(skinned);
    // Normals stay on the outside, flat ones too.
    EXPECT_NEAR(mirrored.placements()[skinned->first].mesh->primitive().normals.front().z, 1, 1e-6);
    scene.meshes[0].primitives[0].normals.clear();
    const PreparedScene flat(scene);
    for (const PreparedNode& node : flat.nodes())
        if (node.mirrored) {
            EXPECT_NEAR(flat.placements()[node.first].mesh->primitive().normals.front().z, 1, 1e-6);
        }
}

// Without normals in the file, faces are flat wherever the vertices go.
TEST(ANI5_Morphs, FlatNormalsFollowTheShape) {
    Scene scene;
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.targets.resize(1);
    p.targets[0].positions = {{0, 0, 0}, {0, 0, 0}, {0, -1, 1}};
    scene.meshes.push_back({"", {p}, {0}, {}});
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    scene.scenes.push_back({"", {0}, ""});
    Animation a;
    a.samplers.push_back({{0, 1}, {0, 1}, Interpolation::kLinear});
    a.channels.push_back({0, 0, AnimationPath::kWeights});
    scene.animations.push_back(a);
    validate(scene);
    PreparedScene prepared(scene);
    EXPECT_EQ(prepared.placements()[0].mesh->primitive().normals[0], (Vec3{0, 0, 1}));
    prepared.move_to({0, 1});
    EXPECT_EQ(prepared.placements()[0].mesh->primitive().positions[2], (Vec3{0, 0, 1}));
    EXPECT_EQ(prepared.placements()[0].mesh->primitive().normals[0], (Vec3{0, -1, 0}));
    EXPECT_EQ(prepared.placements()[0].mesh->bounds.max, (Vec3{1, 0, 1}));
    // Weights that stand in the file count without any animation, and for the bounds.
    scene.nodes[0].weights = {1};
    EXPECT_EQ(PreparedScene(scene).placements()[0].mesh->primitive().positions[2], (Vec3{0, 0, 1}));
    EXPECT_EQ(visible_bounds(scene).max, (Vec3{1, 0, 1}));
}

// Copies that stand at one place are dropped only as long as they do.
TEST(Moments, DuplicatesPart) {
    Scene scene;
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.meshes.push_back({"", {p}, {}, {}});
    scene.nodes.resize(2);
    scene.nodes[0].mesh = scene.nodes[1].mesh = 0;
    scene.scenes.push_back({"", {0, 1}, ""});
    Animation a;
    a.samplers.push_back({{0, 1}, {0, 0, 0, 5, 0, 0}, Interpolation::kLinear});
    a.channels.push_back({0, 1, AnimationPath::kTranslation});
    scene.animations.push_back(a);
    PreparedScene prepared(scene);
    EXPECT_EQ(prepared.placements().size(), 1u);
    prepared.move_to({0, 1});
    EXPECT_EQ(prepared.placements().size(), 2u);
    // The framing camera sees all of the animation from the beginning, and does not move.
    PreparedScene framed(scene);
    framed.move_to({0, 0});
    const PlacedCamera first = framed.camera({}, 1);
    framed.move_to({0, 0.7});
    const PlacedCamera later = framed.camera({}, 1);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_EQ(first.camera_to_world[c][r], later.camera_to_world[c][r]);
    PreparedScene started_later(scene);
    started_later.move_to({0, 0.03});
    EXPECT_EQ(started_later.camera({}, 1).camera_to_world[3].x, first.camera_to_world[3].x);
    PreparedScene still(scene);
    EXPECT_NE(still.camera({}, 1).camera_to_world[3].x, first.camera_to_world[3].x);
}

}  // namespace
}  // namespace tessera
