// Motion vectors of shapes that are drawn by their formula: where the very points of it go, and whether they are to be
// seen there.
#include <gtest/gtest.h>

#include "render/pinhole.h"
#include "render/traced_scenes.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using namespace test;

constexpr int kWidth = 120, kHeight = 90;
constexpr double kPi = 3.14159265358979;

// Within one second the node goes from one place to another and turns once about the y axis.
constexpr Vec3 kFrom{-0.4f, -0.2f, 0}, kTo{0.6f, 0.4f, -0.5f};

struct Place {
    Point centre;
    double angle;
    explicit Place(double time) : angle(2 * kPi * time) {
        const auto along = [&](float a, float b) { return a + (static_cast<double>(b) - a) * time; };
        centre = {along(kFrom.x, kTo.x), along(kFrom.y, kTo.y), along(kFrom.z, kTo.z)};
    }
    Point to_world(const Point& p) const {
        const double s = std::sin(angle), c = std::cos(angle);
        return centre + Point(c * p.x + s * p.z, p.y, c * p.z - s * p.x);
    }
    Point to_object(const Point& w) const {
        const double s = std::sin(angle), c = std::cos(angle);
        const Point p = w - centre;
        return {c * p.x - s * p.z, p.y, c * p.z + s * p.x};
    }
};

Scene moving(const Shape& shape, Quat stand, bool double_sided) {
    Scene scene;
    Material m = lambert({1, 1, 1});
    m.double_sided = double_sided;
    place(scene, shape_primitive(shape, add_material(scene, m)), {}, stand);
    scene.nodes.push_back({});
    scene.nodes[1].children = {0};
    scene.scenes[0].nodes = {1};
    Animation a;
    a.samplers.push_back({{0, 1}, {kFrom.x, kFrom.y, kFrom.z, kTo.x, kTo.y, kTo.z}, Interpolation::kLinear});
    const float q = std::sqrt(0.5f);
    a.samplers.push_back({{0, 0.25f, 0.5f, 0.75f, 1},
                          {0, 0, 0, 1, 0, q, 0, q, 0, 1, 0, 0, 0, q, 0, -q, 0, 0, 0, -1},
                          Interpolation::kLinear});
    a.channels.push_back({0, 1, AnimationPath::kTranslation});
    a.channels.push_back({1, 1, AnimationPath::kRotation});
    scene.animations.push_back(a);
    return scene;
}

struct Tally {
    int pixels = 0, seen = 0, hidden = 0, otherwise = 0;
    double worst = 0;
};

// `meet`: the point of the object, and its normal, on the ray in object space; false where there is none.
template <class Meet>
Tally compare(const Scene& scene, Engine engine, const Eye& now, const Eye& later, bool one_sided, const Meet& meet) {
    RenderOptions o;
    o.width = kWidth, o.height = kHeight;
    o.engine = engine;
    o.view = now.view();
    o.moment = {0, 0.5};
    o.want_color = false;
    o.want_primitive = o.want_motion = true;
    o.motion_after = Shot{later.view(), {0, 0.86}};
    o.motion_before = Shot{now.view(), {0, 0.3}};
    const RenderResult r = render(scene, o);
    Tally tally;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const int i = y * kWidth + x;
            const float* vector = r.motion.data<float>() + 4 * i;
            const std::uint32_t seen = r.motion_seen.data<std::uint32_t>()[i];
            if (r.primitive.data<std::uint32_t>()[i] == 0) {
                EXPECT_TRUE(std::all_of(vector, vector + 4, [](float v) { return v == 0; }) && seen == 0);
                continue;
            }
            const Place here(0.5);
            Point p, n;
            const Point from = here.to_object(now.at()),
                        way = here.to_object(now.at() + now.direction(x + 0.5, y + 0.5)) - from;
            if (!meet(from, way, p, n)) continue;
            ++tally.pixels;
            for (const int side : {0, 1}) {
                const Place there(side == 0 ? 0.86 : 0.3);
                const Eye& eye = side == 0 ? later : now;
                const std::array<double, 2> q = eye.project(there.to_world(p));
                tally.worst = std::max({tally.worst, std::fabs(q[0] - (x + 0.5) - vector[2 * side]),
                                        std::fabs(q[1] - (y + 0.5) - vector[2 * side + 1])});
                // Towards the eye there or away from it, if not by the outline.
                const Point to_eye = there.to_object(eye.at()) - p;
                const double facing = glm::dot(n, glm::normalize(to_eye));
                if (facing > -0.4 && facing < 0.15) continue;
                const bool inside = q[0] > 1 && q[0] < kWidth - 1 && q[1] > 1 && q[1] < kHeight - 1;
                const bool want = inside && (facing > 0 || !one_sided);
                ++(want ? tally.seen : tally.hidden);
                tally.otherwise += want != ((seen >> side & 1u) != 0);
            }
        }
    return tally;
}

void expect(const Tally& tally, const char* what) {
    EXPECT_GT(tally.pixels, 400) << what;
    EXPECT_LT(tally.worst, 5e-3) << what << ", pixels";
    EXPECT_GT(tally.seen, 300) << what;
    EXPECT_EQ(tally.otherwise, 0) << what << ", of " << tally.seen << " and " << tally.hidden;
}

TEST(ShapeMotion, PointsOfASphereMoveWithIt) {
    const Eye now{{0.3f, 0.5f, 4}, {0, 0, 0}}, later{{0.5f, 0.4f, 4}, {0.1f, 0, 0}};
    constexpr double kRadius = 0.75;
    for (const bool double_sided : {false, true}) {
        const Scene scene = moving({Shape::Type::kSphere, 0.75f, {0, 0}, 48}, {}, double_sided);
        for (const Engine engine : {Engine::kTrace, Engine::kReferenceTrace}) {
            const Tally tally =
                compare(scene, engine, now, later, true, [&](const Point& o, const Point& d, Point& p, Point& n) {
                    const double a = glm::dot(d, d), nearest = -glm::dot(o, d) / a;
                    const Point q = o + d * nearest;
                    const double rest = kRadius * kRadius - glm::dot(q, q);
                    if (rest < 0.05 * kRadius * kRadius) return false;  // by the outline
                    p = o + d * (nearest - std::sqrt(rest / a));
                    n = p / kRadius;
                    return true;
                });
            expect(tally, name(engine));
            EXPECT_GT(tally.hidden, 100) << "turned away";
        }
    }
}

TEST(ShapeMotion, PointsOfADiscMoveWithIt) {
    const Eye now{{0.3f, 0.5f, 4}, {0, 0, 0}}, later{{0.5f, 0.4f, 4}, {0.1f, 0, 0}};
    // Its axis, +Y, is turned to -Z, which looks at the camera in the middle of the time, and away from it later.
    const Quat stand = quaternion({1, 0, 0}, -static_cast<float>(kPi) / 2);
    for (const bool double_sided : {false, true}) {
        const Scene scene = moving({Shape::Type::kDisc, 0.9f, {0, 0}, 48}, stand, double_sided);
        for (const Engine engine : {Engine::kTrace, Engine::kReferenceTrace}) {
            const Tally tally = compare(scene, engine, now, later, !double_sided,
                                        [](const Point& o, const Point& d, Point& p, Point& n) {
                                            p = o + d * (-o.z / d.z);
                                            n = {0, 0, o.z > 0 ? 1 : -1};
                                            return glm::length(p) < 0.85;
                                        });
            expect(tally, name(engine));
            EXPECT_EQ(tally.hidden > 100, !double_sided) << "turned away";
        }
    }
}

// What stands still has no motion, to the bit, and is seen where it was.
TEST(ShapeMotion, WhatStandsHasNone) {
    Scene scene;
    place(scene, shape_primitive({Shape::Type::kSphere, 0.75f, {0, 0}, 16}), {});
    place(scene, shape_primitive({Shape::Type::kDisc, 0.4f, {0, 0}, 16}), {0.9f, 0.3f, 0}, quaternion({1, 0, 0}, 1.2f));
    const Eye eye{{0.3f, 0.5f, 3}, {0, 0, 0}};
    for (const Engine engine : {Engine::kTrace, Engine::kReferenceTrace}) {
        RenderOptions o;
        o.width = kWidth, o.height = kHeight;
        o.engine = engine;
        o.view = eye.view();
        o.want_color = false;
        o.want_node = o.want_motion = true;
        o.motion_after = o.motion_before = Shot{o.view, {}};
        const RenderResult r = render(scene, o);
        int covered = 0;
        for (int i = 0; i < kWidth * kHeight; ++i) {
            const bool hit = r.node.data<std::uint32_t>()[i] != 0;
            covered += hit;
            for (int c = 0; c < 4; ++c) ASSERT_EQ(r.motion.data<float>()[4 * i + c], 0);
            ASSERT_EQ(r.motion_seen.data<std::uint32_t>()[i], hit ? 3u : 0u) << i % kWidth << ", " << i / kWidth;
        }
        EXPECT_GT(covered, 1000);
    }
}

}  // namespace
}  // namespace tessera
