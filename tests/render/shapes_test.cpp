// Spheres, discs and planes in pictures, beside their formulas: outlines, shading and shadows, planes without end,
// labels and motion.
#include <gtest/gtest.h>

#include "render/pinhole.h"
#include "render/traced_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace tessera {
namespace {

using namespace test;

constexpr int kWidth = 120, kHeight = 90;
constexpr std::array kExact{Engine::kTrace, Engine::kReferenceTrace};
constexpr std::array kEngines{Engine::kRaster, Engine::kReferenceRaster, Engine::kTrace, Engine::kHybrid,
                              Engine::kReferenceTrace};

Primitive sphere_shape(float radius, int material = kNone, int segments = 96) {
    return shape_primitive({Shape::Type::kSphere, radius, {0, 0}, segments}, material);
}
Primitive disc_shape(float radius, int material = kNone) {
    return shape_primitive({Shape::Type::kDisc, radius, {0, 0}, 96}, material);
}
Primitive plane_shape(Vec2 size, int material = kNone) {
    return shape_primitive({Shape::Type::kPlane, 1, size, 96}, material);
}

RenderOptions labels_only(Engine engine, int width = kWidth, int height = kHeight) {
    RenderOptions o;
    o.width = width, o.height = height, o.samples = 1;
    o.engine = engine;
    o.want_color = false;
    return o;
}

Point to_point(Vec3 v) { return {v.x, v.y, v.z}; }

// --- outlines -----------------------------------------------------------------------------------

// An ellipsoid along the axes.
struct Ball {
    Point centre, half;

    // How far a ray passes beside it, as a part of its size: below 1 it is met.
    double miss(const Point& o, const Point& d) const {
        const Point q = (o - centre) / half, e = d / half;
        return glm::length(q - e * (glm::dot(q, e) / glm::dot(e, e)));
    }
};

// Compares what is covered with the formula, but for pixels within 1/1000 of the outline. `miss(x, y)`: of the ray
// through a picture position.
template <class Miss>
void expect_outline(const RenderResult& r, const Miss& miss) {
    int inside = 0, outside = 0, near = 0;
    for (int y = 0; y < r.node.height(); ++y)
        for (int x = 0; x < r.node.width(); ++x) {
            const double px = x + 0.5, py = y + 0.5, h = 1e-4, m = miss(px, py) - 1;
            const double slope = std::hypot(miss(px + h, py) - miss(px - h, py), miss(px, py + h) - miss(px, py - h));
            if (std::fabs(m) <= 1e-3 * slope / (2 * h)) {
                ++near;
                continue;
            }
            ++(m < 0 ? inside : outside);
            ASSERT_EQ(r.node.data<std::uint32_t>()[y * r.node.width() + x] != 0, m < 0) << x << ", " << y;
        }
    EXPECT_GT(inside, 500);
    EXPECT_GT(outside, 500);
    EXPECT_LT(near, 5);
}

TEST(ShapePictures, OutlinesAreThoseOfTheFormula) {
    const Eye eye{{0.4f, 0.7f, 4}, {0.1f, 0, 0}};
    for (const Vec3 half : {Vec3{1, 1, 1}, {0.7f, 1.1f, 0.5f}, {-0.9f, 0.4f, 1}}) {
        Scene scene;
        place(scene, sphere_shape(0.5f, kNone, 8), {0.2f, -0.1f, 0}, {}, half * 2.0f);
        add_orthographic(scene);
        const Ball ball{{static_cast<double>(0.2f), static_cast<double>(-0.1f), 0}, glm::abs(to_point(half))};
        for (const Engine engine : kExact) {
            SCOPED_TRACE(name(engine));
            RenderOptions o = labels_only(engine);
            o.want_node = true;
            o.view = eye.view();
            expect_outline(render(scene, o),
                           [&](double x, double y) { return ball.miss(eye.at(), eye.direction(x, y)); });
            RenderOptions flat = labels_only(engine, 64, 64);
            flat.want_node = true;
            flat.view.camera = 0;
            expect_outline(render(scene, flat), [&](double x, double y) {
                return ball.miss({x / 32 - 1, 1 - y / 32, 10}, {0, 0, -1});
            });
        }
    }
}

// From within a sphere its inside fills the picture, where its back is drawn.
TEST(ShapePictures, FromWithinASphereIsEverywhere) {
    for (const bool double_sided : {false, true}) {
        Scene scene;
        Material m = lambert({1, 1, 1});
        m.double_sided = double_sided;
        place(scene, sphere_shape(2, add_material(scene, m)), {});
        const Eye eye{{0.3f, 0.2f, 0.5f}, {0, 0, -1}};
        for (const Engine engine : kExact) {
            RenderOptions o = labels_only(engine);
            o.want_node = o.want_position = o.want_normal = true;
            o.view = eye.view();
            const RenderResult r = render(scene, o);
            for (int i = 0; i < kWidth * kHeight; ++i) {
                ASSERT_EQ(r.node.data<std::uint32_t>()[i], double_sided ? 1u : 0u) << name(engine);
                if (!double_sided) continue;
                const float *p = r.position.data<float>() + 3 * i, *n = r.normal.data<float>() + 3 * i;
                const Vec3 at{p[0], p[1], p[2]};
                ASSERT_NEAR(length(at), 2, 1e-5f);
                ASSERT_NEAR(dot(at, {n[0], n[1], n[2]}), -2, 1e-5f) << "towards the viewer";
            }
        }
    }
}

// --- light --------------------------------------------------------------------------------------

// A Lambert ball on a Lambert floor in the sun: n.l everywhere but where the ball is in the way; it does not
// shadow its own lit side.
TEST(ShapePictures, ShadingAndShadowsAreThoseOfTheFormula) {
    const Eye eye{{0.5f, 2, 5}, {0, 0.6f, 0}};
    const Vec3 to_sun = normalize(Vec3{0.5f, 1, 0.4f});
    const Point sun = to_point(to_sun);
    for (const float unit : {1.0f, 1e-3f, 1e3f}) {
        Scene scene;
        const int white = add_material(scene, lambert({1, 1, 1}));
        place(scene, sphere_shape(unit, white), {0, unit, 0});
        place(scene, disc_shape(4 * unit, white), {});
        add_sun(scene, to_sun, 1);
        Eye at = eye;
        at.eye = at.eye * unit, at.target = at.target * unit;
        const Ball ball{{0, unit, 0}, Point(unit, unit, unit)};
        for (const Engine engine : kExact) {
            SCOPED_TRACE(name(engine));
            RenderOptions o = traced(engine, kWidth, kHeight);
            o.view = at.view();
            o.view.intrinsics = kPinhole;
            o.want_position = o.want_node = true;
            const RenderResult r = render(scene, o);
            int lit = 0, shadowed = 0, away = 0;
            for (int i = 0; i < kWidth * kHeight; ++i) {
                const std::uint32_t node = r.node.data<std::uint32_t>()[i];
                if (node == 0) continue;
                const float* p = r.position.data<float>() + 3 * i;
                const Point q(p[0], p[1], p[2]), n = node == 1 ? (q - ball.centre) / ball.half.x : Point(0, 1, 0);
                double want = std::max(glm::dot(n, sun), 0.0) / 3.14159265358979;
                if (node == 2) {
                    const double miss = ball.miss(q, sun);
                    if (std::fabs(miss - 1) < 1e-3) continue;
                    if (miss < 1) want = 0;
                }
                ++(want > 0 ? lit : node == 1 ? away : shadowed);
                ASSERT_NEAR(linear_at(r, i % kWidth, i / kWidth).y, want, 3e-5) << i % kWidth << ", " << i / kWidth;
            }
            EXPECT_GT(lit, 3000);
            EXPECT_GT(shadowed, 200);
            EXPECT_GT(away, 100);
        }
    }
}

// --- planes without end -------------------------------------------------------------------------

TEST(ShapePictures, PlanesWithoutEndReachTheHorizonAndLieWhereTheyShould) {
    const double reach = 0x1p24;
    double farthest = 0;
    for (const Eye& eye : {Eye{{0.3f, 1.7f, 0.2f}, {0.5f, 1.6f, -1}}, Eye{{30, 400, 5}, {0, 200, -300}},
                           Eye{{-3, 0.01f, 2}, {0, 0.005f, -1}}, Eye{{2, 1e5f, 1}, {3, 1e5f, -1}}}) {
        Scene scene;
        place(scene, plane_shape({0, 0}, add_material(scene, lambert({1, 1, 1}))), {});
        for (const Engine engine : kEngines) {
            SCOPED_TRACE(name(engine));
            RenderOptions o = labels_only(engine);
            o.want_depth = o.want_primitive = o.want_normal = o.want_uv = true;
            o.view = eye.view();
            const RenderResult r = render(scene, o);
            int seen = 0, sky = 0;
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x) {
                    const Point d = eye.direction(x + 0.5, y + 0.5);
                    const double t = -eye.at().y / d.y;  // along the axis
                    const Point at = eye.at() + d * t;
                    const double away = std::max(std::fabs(at.x), std::fabs(at.z));
                    if (t > 0 && std::fabs(away - reach) < 0.02 * reach) continue;
                    const bool hit = t > 0 && away < reach;
                    const int i = y * kWidth + x;
                    ASSERT_EQ(r.primitive.data<std::uint32_t>()[i], hit ? 1u : 0u) << x << ", " << y;
                    ++(hit ? seen : sky);
                    const float depth = r.depth.data<float>()[i];
                    if (!hit) {
                        ASSERT_EQ(depth, std::numeric_limits<float>::infinity());
                        continue;
                    }
                    farthest = std::max(farthest, t);
                    // A level ray's depth turns with its direction, which is a float.
                    const double slack = 1e-5 * t * (1 + glm::length(d) * 0.02 / std::fabs(d.y));
                    ASSERT_NEAR(static_cast<double>(depth), t, slack) << x << ", " << y;
                    ASSERT_NEAR(r.normal.data<float>()[3 * i + 1], 1, 1e-6f);
                    const float* uv = r.uv.data<float>() + 2 * i;
                    // Corners snap to 1/256 pixel, by which what is far moves a long way.
                    const Point aside = eye.direction(x + 0.5, y + 0.5 + 1.0 / 256);
                    const double coarse =
                        1e-5 * (1 + away) + glm::distance(at, eye.at() - aside * (eye.at().y / aside.y));
                    ASSERT_NEAR(static_cast<double>(uv[0]), at.x, coarse);
                    ASSERT_NEAR(static_cast<double>(uv[1]), at.z, coarse);
                }
            EXPECT_GT(seen, 2000);
            if (eye.eye.y != 400) {
                EXPECT_GT(sky, 1000);
            }
        }
    }
    EXPECT_GT(farthest, 1e7);
}

// No point of it is in its own shadow, however near or far.
TEST(ShapePictures, PlanesWithoutEndDoNotShadowThemselves) {
    for (const Eye& eye : {Eye{{0.3f, 1.7f, 0.2f}, {0.5f, 1.6f, -1}}, Eye{{7, 0.1f, 2}, {7, 0, 1.9f}},
                           Eye{{30, 400, 5}, {0, 200, -300}}, Eye{{1e3f, 3, -1e3f}, {1.001e3f, 2.5f, -1e3f}}})
        for (const Vec3 to_sun : {Vec3{0, 1, 0}, Vec3{0.3f, 0.5f, 0.2f}, Vec3{1, 0.05f, 0.3f}}) {
            Scene scene;
            place(scene, plane_shape({0, 0}, add_material(scene, lambert({1, 1, 1}))), {});
            add_sun(scene, normalize(to_sun), 1);
            for (const Engine engine : kTracers) {
                RenderOptions o = traced(engine, kWidth, kHeight);
                o.view = eye.view();
                o.want_primitive = true;
                const RenderResult r = render(scene, o);
                const double want = static_cast<double>(normalize(to_sun).y) / 3.14159265358979;
                int seen = 0;
                for (int i = 0; i < kWidth * kHeight; ++i) {
                    if (r.primitive.data<std::uint32_t>()[i] == 0) continue;
                    ++seen;
                    ASSERT_NEAR(linear_at(r, i % kWidth, i / kWidth).y, want, 2e-5)
                        << name(engine) << " " << i % kWidth << ", " << i / kWidth;
                }
                EXPECT_GT(seen, 1000) << name(engine);
            }
        }
}

// --- labels -------------------------------------------------------------------------------------

TEST(ShapePictures, LabelsCountAShapeAsOnePrimitiveInEveryEngine) {
    Scene scene;
    Material both = lambert({1, 1, 1});
    place(scene, rectangle(0.2f, 0.2f, 0, kNone), {-0.8f, 0.7f, 0});
    place(scene, sphere_shape(0.3f), {0, 0.2f, 0});
    place(scene, disc_shape(0.3f), {0.7f, 0.2f, 0}, quaternion({1, 0, 0}, 1.2f));
    place(scene, plane_shape({0.4f, 0.4f}), {-0.7f, 0.1f, 0}, quaternion({1, 0, 0}, 1.2f));
    place(scene, plane_shape({0, 0}, add_material(scene, both)), {0, -0.5f, 0});
    place(scene, rectangle(0.2f, 0.2f, 0, kNone), {0.8f, 0.7f, 0});
    const std::vector<std::set<std::uint32_t>> numbers = {{1, 2}, {3}, {4}, {5}, {6}, {7, 8}};
    const Eye eye{{0, 0.3f, 2.5f}, {0, 0.2f, 0}};
    for (const Engine engine : kEngines) {
        SCOPED_TRACE(name(engine));
        RenderOptions o = labels_only(engine);
        o.want_node = o.want_primitive = true;
        o.view = eye.view();
        const RenderResult r = render(scene, o);
        std::vector<std::set<std::uint32_t>> found(7);
        for (int i = 0; i < kWidth * kHeight; ++i)
            found.at(r.node.data<std::uint32_t>()[i]).insert(r.primitive.data<std::uint32_t>()[i]);
        EXPECT_EQ(found[0], (std::set<std::uint32_t>{0}));
        for (std::size_t n = 0; n < numbers.size(); ++n) EXPECT_EQ(found[n + 1], numbers[n]) << n;
    }
}

// --- exposure -----------------------------------------------------------------------------------

TEST(ShapePictures, TheExposureDependsOnNoEngine) {
    Scene scene;
    place(scene, sphere_shape(1, add_material(scene, lambert({1, 1, 1}))), {});
    add_sun(scene, {1, -0.2f, 0.5f}, 3);  // not on the poles, where its first triangles are
    const Eye eye{{0.5f, 0.7f, 4}, {0, 0, 0}};
    double exposure = 0;
    for (const Engine engine : kEngines) {
        RenderOptions o;
        o.width = kWidth, o.height = kHeight, o.samples = 1;
        o.engine = engine;
        o.view = eye.view();
        const double own = render(scene, o).stats.exposure;
        if (exposure == 0) exposure = own;
        EXPECT_EQ(own, exposure) << name(engine);
        EXPECT_NE(own, 1) << "metered";
    }
}

}  // namespace
}  // namespace tessera
