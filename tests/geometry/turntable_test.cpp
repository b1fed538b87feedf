// The turntable (View::turn): the camera goes around the scene at one height and distance, all of the scene stays in
// every picture, and no nearer camera would do. Checked by projecting every vertex with the lens' own angle.
#include "geometry/matrix.h"
#include "geometry/prepared_scene.h"
#include "geometry/support.h"

#include <tessera/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tessera {
namespace {

constexpr double kMargin = 1.12;

Scene scattered(std::uint32_t seed, Vec3 size, Vec3 offset) {
    test::Random random(seed);
    Primitive p;
    for (std::uint32_t i = 0; i < 60; ++i) {
        p.positions.push_back(random.vec3(1) * size + offset);
        p.indices.push_back(i);
    }
    Scene scene;
    scene.meshes.push_back({"", {p}, {}, {}});
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    scene.scenes.push_back({"", {0}, ""});
    return scene;
}

// The farthest that a vertex is from the middle of the picture, 1 at the edge.
double reach(const Scene& scene, const PlacedCamera& camera, double aspect) {
    const glm::dmat4 to_camera = rigid_inverse(camera.camera_to_world);
    const double t = std::tan(0.5 * static_cast<double>(camera.lens.yfov));
    double most = 0;
    for (const Vec3& v : scene.meshes[0].primitives[0].positions) {
        const glm::dvec3 p = transform_point(to_camera, to_dvec3(v));
        EXPECT_LT(p.z, -camera.lens.znear);
        most = std::max({most, std::abs(p.x) / (-p.z * t * aspect), std::abs(p.y) / (-p.z * t)});
    }
    return most;
}

View at(double turn, Vec3 up = {0, 1, 0}) {
    View view;
    view.turn = turn, view.up = up;
    return view;
}

TEST(Turntable, ANI11_NothingIsCutOffAndTheFramingIsTight) {
    std::uint32_t seed = 1;
    for (const Vec3 size : {Vec3{1, 1, 1}, Vec3{5, 0.1f, 1}, Vec3{0.1f, 8, 0.2f}, Vec3{1e-3f, 2e-3f, 1e-3f}})
        for (const double aspect : {0.5, 1.0, 16.0 / 9}) {
            const Scene scene = scattered(++seed, size, {30, -4, 7});
            PreparedScene prepared(scene);
            double most = 0;
            constexpr int kViews = 720;
            for (int i = 0; i < kViews; ++i) {
                const double here =
                    reach(scene, prepared.camera(at(2 * std::numbers::pi * i / kViews), aspect), aspect);
                EXPECT_LT(here, 1 / kMargin + 1e-6) << i;
                most = std::max(most, here);
            }
            // In between two of the angles a vertex may come a little closer to the edge.
            EXPECT_GT(most, 0.999 / kMargin) << "size " << size.x << " aspect " << aspect;
        }
}

// What is very small, or small and very far away, is framed as everything else is.
TEST(Framing, TinyAndFarScenesFillThePicture) {
    struct Case {
        float size;
        Vec3 offset;
    };
    for (const Case& c : {Case{1e-10f, {}}, Case{1e-12f, {}}, Case{1e-10f, {1e-4f, 0, 0}}, Case{3, {1e7f, 0, 0}},
                          Case{3, {0, -1e7f, 1e7f}}, Case{1e12f, {}}}) {
        const Scene scene = scattered(5, {c.size, c.size, c.size}, c.offset);
        PreparedScene prepared(scene);
        View still;
        still.frame_bounds = true;
        EXPECT_NEAR(reach(scene, prepared.camera(still, 1.5), 1.5), 1 / kMargin, 1e-5) << c.size << " " << c.offset.x;
        double most = 0;
        for (int i = 0; i < 90; ++i)
            most = std::max(most, reach(scene, prepared.camera(at(2 * std::numbers::pi * i / 90), 1.5), 1.5));
        EXPECT_LT(most, 1 / kMargin + 1e-5) << c.size << " " << c.offset.x;
        EXPECT_GT(most, 0.98 / kMargin) << c.size << " " << c.offset.x;
    }
}

// One point has no extent, wherever it is.
TEST(Framing, APointIsSeenFromAfar) {
    for (const Vec3 where : {Vec3{}, Vec3{1e-10f, 0, 0}, Vec3{5, 6, 7}, Vec3{1e7f, -1e7f, 0}}) {
        const Scene scene = scattered(5, {}, where);
        PreparedScene prepared(scene);
        View still;
        still.frame_bounds = true;
        const PlacedCamera camera = prepared.camera(still, 1.5);
        EXPECT_GT(camera.lens.znear, 0) << where.x;
        EXPECT_LT(reach(scene, camera, 1.5), 1e-6) << where.x;
    }
}

TEST(Turntable, ANI11_TheCameraGoesAroundTheAxis) {
    for (const Vec3 up : {Vec3{0, 1, 0}, Vec3{0, 0, 2}, Vec3{1, 2, -1}}) {
        const Scene scene = scattered(7, {1, 2, 3}, {5, 5, 5});
        PreparedScene prepared(scene);
        const glm::dvec3 axis = to_dvec3(normalize(up));
        const auto dot = [](const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
        const PlacedCamera first = prepared.camera(at(0, up), 1.5);
        const glm::dvec3 pivot = first.pivot;
        const auto arm = [&](const PlacedCamera& camera) {
            const glm::dvec3 d = glm::dvec3(camera.camera_to_world[3]) - pivot;
            return d - axis * dot(d, axis);
        };
        const glm::dvec3 start = arm(first);
        for (const double turn : {0.3, 2.0, -1.0, 9.0}) {
            const PlacedCamera camera = prepared.camera(at(turn, up), 1.5);
            const glm::dvec3 now = arm(camera);
            EXPECT_NEAR(dot(now, now), dot(start, start), 1e-9 * dot(start, start));
            EXPECT_NEAR(dot(now, start) / dot(start, start), std::cos(turn), 1e-9);
            const glm::dvec3 across(start.y * now.z - start.z * now.y, start.z * now.x - start.x * now.z,
                                    start.x * now.y - start.y * now.x);
            EXPECT_NEAR(dot(across, axis) / dot(start, start), std::sin(turn), 1e-6) << "counter-clockwise from above";
            const glm::dvec3 height = glm::dvec3(camera.camera_to_world[3]) - glm::dvec3(first.camera_to_world[3]);
            EXPECT_NEAR(dot(height, axis), 0, 1e-9);
            EXPECT_EQ(camera.lens.znear, first.lens.znear);
            // The elevation of the default view.
            PreparedScene still(scene);
            View framed;
            framed.frame_bounds = true, framed.up = up;
            EXPECT_NEAR(dot(glm::dvec3(camera.camera_to_world[2]), axis),
                        dot(glm::dvec3(still.camera(framed, 1.5).camera_to_world[2]), axis), 1e-6);
        }
    }
}

TEST(Turntable, ANI11_AnEyeTurnsAroundItsTarget) {
    const Scene scene = scattered(3, {1, 1, 1}, {});
    PreparedScene prepared(scene);
    View view = at(std::numbers::pi / 2);
    view.eye = Vec3{3, 2, 1}, view.target = Vec3{1, 1, 1};
    const PlacedCamera camera = prepared.camera(view, 1);
    // A quarter of a turn about y takes (2, 1, 0) to (0, 1, -2).
    EXPECT_NEAR(camera.camera_to_world[3].x, 1, 1e-6);
    EXPECT_NEAR(camera.camera_to_world[3].y, 2, 1e-6);
    EXPECT_NEAR(camera.camera_to_world[3].z, -1, 1e-6);
    view.turn = 0;
    View placed = view;
    placed.turn.reset();
    EXPECT_EQ(prepared.camera(view, 1).camera_to_world[3].x, prepared.camera(placed, 1).camera_to_world[3].x);
}

TEST(Turntable, ANI11_ASceneCameraDoesNotTurn) {
    Scene scene = scattered(3, {1, 1, 1}, {});
    scene.cameras.emplace_back();
    scene.nodes[0].camera = 0;
    PreparedScene prepared(scene);
    View view = at(1);
    EXPECT_NE(prepared.camera(view, 1).camera_to_world[3].x, 0) << "framed, not the scene's camera at the origin";
    view.camera = 0;
    EXPECT_THROW(prepared.camera(view, 1), Error);
    view.camera.reset(), view.turn = std::numeric_limits<double>::infinity();
    EXPECT_THROW(prepared.camera(view, 1), Error);
}

}  // namespace
}  // namespace tessera
