// BEY2: motion vectors against correspondences found by casting rays in double at scenes evaluated by their definition;
// what is seen of them against rays again, and against a plane that another one slides over.
#include <gtest/gtest.h>

#include "geometry/frame.h"
#include "geometry/scene_definition.h"
#include "geometry/triangles.h"
#include "load/test_files.h"
#include "render/pinhole.h"
#include "render/scenes.h"

#include <array>
#include <cmath>
#include <optional>

namespace tessera {
namespace {

using namespace test;

constexpr int kWidth = 120, kHeight = 90;

struct Hit {
    double t, b1, b2;
};
std::optional<Hit> intersect(const Point& o, const Point& d, const Point (&v)[3]) {
    const Point e1 = v[1] - v[0], e2 = v[2] - v[0], p = glm::cross(d, e2);
    const double det = glm::dot(e1, p);
    if (det == 0) return std::nullopt;
    const Point s = o - v[0], q = glm::cross(s, e1);
    return Hit{glm::dot(e2, q) / det, glm::dot(s, p) / det, glm::dot(d, q) / det};
}

// All triangles of a scene at a moment, by number in the frame, in world space.
std::vector<std::array<Point, 3>> triangles_at(const Scene& scene, const Moment& moment, const Frame& frame) {
    const Evaluation truth(scene, moment.animation, moment.time);
    std::vector<std::array<Point, 3>> all;
    for (std::size_t i = 0; i < frame.instances.size(); ++i) {
        const Primitive& source = *prepared_mesh(*frame.prepared[i]).source;
        const TriangleList list(source);
        for (std::size_t t = 0; t < list.count(); ++t) {
            std::array<Point, 3> v;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto w = truth.vertex(static_cast<int>(frame.instances[i].node), source, list[t][k]);
                v[k] = Point(static_cast<double>(w[0]), static_cast<double>(w[1]), static_cast<double>(w[2]));
            }
            all.push_back(v);
        }
    }
    return all;
}

struct Tally {
    int pixels = 0, seen_alike = 0, seen_otherwise = 0;
    double worst = 0;
};

// Compares the vectors of one direction with rays.
void compare(const RenderResult& r, const std::vector<std::array<Point, 3>>& here,
             const std::vector<std::array<Point, 3>>& there, const Eye& now, const Eye& other, int side, Tally& tally) {
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const auto i = static_cast<std::size_t>(y * kWidth + x);
            const std::uint32_t number = r.primitive.data<std::uint32_t>()[i];
            const float* vector = r.motion.data<float>() + 4 * i + 2 * side;
            const bool seen = (r.motion_seen.data<std::uint32_t>()[i] >> side & 1u) != 0;
            if (number == 0) {
                ASSERT_TRUE(vector[0] == 0 && vector[1] == 0 && !seen);
                continue;
            }
            const auto& a = here[number - 1];
            const Point corners[3] = {a[0], a[1], a[2]};
            const std::optional<Hit> h = intersect(now.at(), now.direction(x + 0.5, y + 0.5), corners);
            // Beyond the triangle by rounding, or on its edge.
            if (!h || h->b1 < 1e-3 || h->b2 < 1e-3 || h->b1 + h->b2 > 1 - 1e-3) continue;
            const auto& b = there[number - 1];
            const Point p = b[0] * (1 - h->b1 - h->b2) + b[1] * h->b1 + b[2] * h->b2;
            const std::array<double, 2> q = other.project(p);
            ++tally.pixels;
            tally.worst = std::max({tally.worst, std::fabs(q[0] - (x + 0.5) - static_cast<double>(vector[0])),
                                    std::fabs(q[1] - (y + 0.5) - static_cast<double>(vector[1]))});
            bool visible = q[0] >= 0 && q[0] < kWidth && q[1] >= 0 && q[1] < kHeight;
            const Point d = p - other.at();
            for (std::size_t t = 0; visible && t < there.size(); ++t) {
                const Point c[3] = {there[t][0], there[t][1], there[t][2]};
                const std::optional<Hit> o = intersect(other.at(), d, c);
                if (o && o->b1 >= 0 && o->b2 >= 0 && o->b1 + o->b2 <= 1 && o->t > 0 && o->t < 1 - 1e-3) visible = false;
            }
            ++(visible == seen ? tally.seen_alike : tally.seen_otherwise);
        }
}

Scene opaque_scene(const std::string& name) {
    LoadOptions options;
    options.load_pictures = false;
    Scene scene = load_scene(gltf_model(name).string(), options);
    for (Material& m : scene.materials) m.double_sided = true, m.alpha_mode = AlphaMode::kOpaque;
    // The default material is drawn from one side only.
    scene.materials.push_back(lambert({1, 1, 1}));
    for (Mesh& mesh : scene.meshes)
        for (Primitive& p : mesh.primitives)
            if (p.material == kNone) p.material = static_cast<int>(scene.materials.size()) - 1;
    return scene;
}

// From where all of it is seen at rest.
Eye eye_before(const Scene& scene, Vec3 direction) {
    const Bounds3 b = visible_bounds(scene);
    const Vec3 centre = (b.min + b.max) * 0.5f;
    return {centre + normalize(direction) * (1.5f * length(b.max - b.min)), centre};
}

TEST(MotionVectors, BEY2_AreThoseOfRaysOnEveryAnimatedModel) {
    int models = 0;
    Tally all;
    for (const std::string& name : all_gltf_models()) {
        Scene scene;
        try {
            scene = opaque_scene(name);
        } catch (const Error&) {
            continue;
        }
        if (scene.animations.empty()) continue;
        SCOPED_TRACE(name);
        const double end = duration(scene.animations[0]);
        for (const Engine engine : {Engine::kRaster, Engine::kReferenceRaster}) {
            Tally tally;
            for (const double part : {0.21, 0.64}) {
                // The camera moves, too.
                const Eye now = eye_before(scene, {0.5f, 0.4f, 1}), later = eye_before(scene, {0.55f, 0.38f, 1});
                const Moment at{0, part * end}, after{0, (part + 0.05) * end}, before{0, (part - 0.05) * end};
                RenderOptions o;
                o.width = kWidth;
                o.height = kHeight;
                o.engine = engine;
                o.view = now.view();
                o.moment = at;
                o.want_color = false;
                o.want_primitive = o.want_motion = true;
                o.motion_after = Shot{later.view(), after};
                o.motion_before = Shot{now.view(), before};
                const RenderResult r = render(scene, o);
                PreparedScene prepared(scene);
                prepared.move_to(at);
                Frame frame;
                make_frame(prepared, o.view, kWidth, kHeight, {}, frame);
                const auto here = triangles_at(scene, at, frame);
                compare(r, here, triangles_at(scene, after, frame), now, later, 0, tally);
                compare(r, here, triangles_at(scene, before, frame), now, now, 1, tally);
            }
            EXPECT_LT(tally.worst, 0.01) << "pixels";
            all.pixels += tally.pixels, all.seen_alike += tally.seen_alike, all.seen_otherwise += tally.seen_otherwise;
        }
        ++models;
    }
    if (models == 0) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    EXPECT_GT(all.pixels, 10000);
    // Rays decide otherwise along outlines only.
    EXPECT_LT(all.seen_otherwise, all.pixels / 100) << "of " << all.pixels;
}

// A small plate slides to the right before a wall.
TEST(MotionVectors, BEY2_APlateBeforeAWall) {
    Scene scene;
    add_mesh(scene, rectangle(4, 4, 0, add_material(scene, lambert({1, 1, 1}))));
    add_mesh(scene, rectangle(0.5f, 0.5f, 1, add_material(scene, lambert({1, 0, 0}))));
    Animation slide;
    slide.samplers.push_back({{0, 1}, {0, 0, 0, 1, 0, 0}, Interpolation::kLinear});
    slide.channels.push_back({0, 1, AnimationPath::kTranslation});
    scene.animations.push_back(slide);
    for (const Engine engine : {Engine::kRaster, Engine::kReferenceRaster, Engine::kReferenceTrace}) {
        RenderOptions o;
        o.width = 100;
        o.height = 80;
        o.engine = engine;
        o.want_color = false;
        o.want_motion = o.want_node = true;
        o.view.eye = {0, 0, 6};
        o.view.target = {0, 0, 0};
        o.view.intrinsics = {100, 100, 49.5, 39.5};
        o.moment = {0, 0};
        o.motion_after = Shot{o.view, {0, 1}};
        const RenderResult r = render(scene, o);
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 100; ++x) {
                const auto i = static_cast<std::size_t>(y * 100 + x);
                const std::uint32_t node = r.node.data<std::uint32_t>()[i];
                const float* v = r.motion.data<float>() + 4 * i;
                const std::uint32_t seen = r.motion_seen.data<std::uint32_t>()[i];
                // The plate is 5 away: 20 pixels to the metre; it is 20 wide, and moves by its width.
                const double u = x + 0.5 - 50, w = y + 0.5 - 40;
                const bool plate = std::fabs(u) < 10 && std::fabs(w) < 10;
                ASSERT_EQ(node, plate ? 2u : 1u);
                if (plate) {
                    ASSERT_NEAR(v[0], 20, 1e-4);
                    ASSERT_NEAR(v[1], 0, 1e-4);
                } else {
                    ASSERT_EQ(v[0], 0.0f);
                    ASSERT_EQ(v[1], 0.0f);
                }
                ASSERT_EQ(v[2], 0.0f);
                ASSERT_EQ(v[3], 0.0f);
                const bool covered = !plate && std::fabs(u - 20) < 10 && std::fabs(w) < 10;
                ASSERT_EQ(seen, covered ? 2u : 3u) << x << ", " << y;
            }
    }
}

TEST(MotionVectors, BEY2_WhatLeavesThePictureOrTurnsAwayIsNotSeen) {
    Scene scene;
    Material one_sided = lambert({1, 1, 1});
    one_sided.double_sided = false;
    add_mesh(scene, rectangle(0.3f, 0.3f, 0, add_material(scene, one_sided)));
    RenderOptions o;
    o.width = o.height = 40;
    o.want_color = false;
    o.want_motion = true;
    const auto look = [](Vec3 eye, Vec3 target) {
        View v;
        v.eye = eye;
        v.target = target;
        v.yfov = 0.8f;
        return v;
    };
    o.view = look({0, 0, 2}, {0, 0, 0});
    const auto middle = [&](const View& view) {
        o.motion_after = Shot{view, {}};
        const RenderResult r = render(scene, o);
        const std::size_t i = 20 * 40 + 20;
        return std::pair(r.motion_seen.data<std::uint32_t>()[i], r.motion.data<float>()[4 * i]);
    };
    EXPECT_EQ(middle(look({0.1f, 0, 2}, {0.1f, 0, 0})).first, 3u);
    EXPECT_NEAR(middle(look({0.1f, 0, 2}, {0.1f, 0, 0})).second, -0.05 * 20 / std::tan(0.4), 0.01);
    EXPECT_EQ(middle(look({3, 0, 2}, {3, 0, 0})).first, 2u) << "out of the picture";
    EXPECT_EQ(middle(look({0, 0, -2}, {0, 0, 0})).first, 2u) << "from behind";
    const auto behind = middle(look({0, 0, -1}, {0, 0, -2}));
    EXPECT_EQ(behind.first, 2u) << "behind the eye";
    EXPECT_EQ(behind.second, 0.0f);
}

// Points that do not hide each other are seen, all of each.
TEST(MotionVectors, BEY2_PointsSeeThemselves) {
    Scene scene;
    Primitive grid;
    grid.mode = PrimitiveMode::kPoints;
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x)
            grid.positions.push_back({0.1f * static_cast<float>(x) - 1, 0.1f * static_cast<float>(y) - 1, 0});
    add_mesh(scene, grid);
    for (const Engine engine : {Engine::kRaster, Engine::kReferenceRaster}) {
        RenderOptions o;
        o.width = o.height = 200;
        o.engine = engine;
        o.want_color = false;
        o.want_motion = true;
        o.point_size = 3;
        o.view.eye = {0, 0, 4};
        o.view.target = {0, 0, 0};
        o.view.yfov = 0.9f;
        View other = o.view;
        other.eye = {0.2f, 0.1f, 4};
        other.target = {0.2f, 0.1f, 0};
        o.motion_after = Shot{other, {}};
        const RenderResult r = render(scene, o);
        int pixels = 0;
        for (std::size_t i = 0; i < 200 * 200; ++i) {
            const float* v = r.motion.data<float>() + 4 * i;
            if (v[0] == 0) continue;
            ++pixels;
            EXPECT_EQ(r.motion_seen.data<std::uint32_t>()[i], 3u);
            EXPECT_NEAR(v[0], -0.2 / 4 * 100 / std::tan(0.45), 1e-3);
            EXPECT_NEAR(v[1], 0.1 / 4 * 100 / std::tan(0.45), 1e-3);
        }
        EXPECT_GT(pixels, 400 * 5);
    }
}

// Warm renderers keep nothing of another picture.
TEST(MotionVectors, BEY2_ASequenceIsThePicturesByThemselves) {
    const Scene scene = scene_file("motion.gltf");
    RenderOptions o;
    o.width = 96;
    o.height = 72;
    o.want_motion = o.want_depth = true;
    o.moment.animation = kEveryAnimation;
    Renderer renderer(scene, o);
    const auto shot = [&](double time) { return Shot{o.view, {kEveryAnimation, time}}; };
    RenderResult warm;
    for (const double time : {0.5, 0.0, 1.25}) {
        renderer.draw(shot(time), shot(time - 0.1), shot(time + 0.1), warm);
        RenderOptions cold = o;
        cold.moment = shot(time).moment;
        cold.motion_before = shot(time - 0.1);
        cold.motion_after = shot(time + 0.1);
        cold.threads = 1;
        const RenderResult r = render(scene, cold);
        EXPECT_TRUE(same_bytes(r.motion, warm.motion));
        EXPECT_TRUE(same_bytes(r.motion_seen, warm.motion_seen));
        EXPECT_TRUE(same_bytes(r.depth, warm.depth));
        EXPECT_TRUE(same_bytes(r.color, warm.color));
    }
}

}  // namespace
}  // namespace tessera
