// GEO1 to GEO3: products and projections, barycentric coordinates, lines and homogeneous coordinates,
// against their definitions and against long double.
#include "geometry/support.h"

#include <tessera/transform.h>

namespace tessera {
namespace {

using test::Random;

TEST(Geometry, GEO1_DotNormAndCrossIdentities) {
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a = random.vec3(10), b = random.vec3(10);
        const float scale = length(a) * length(b);
        EXPECT_FLOAT_EQ(dot(a, a), length(a) * length(a));
        EXPECT_EQ(dot(a, b), dot(b, a));
        EXPECT_EQ(cross(a, b), -cross(b, a));
        EXPECT_NEAR(dot(cross(a, b), a), 0, 1e-5f * scale * length(a));
        EXPECT_NEAR(dot(cross(a, b), b), 0, 1e-5f * scale * length(b));
        // Lagrange: |a x b|^2 + (a.b)^2 = |a|^2 |b|^2.
        const float lagrange = dot(cross(a, b), cross(a, b)) + dot(a, b) * dot(a, b);
        EXPECT_NEAR(lagrange, scale * scale, 2e-6f * scale * scale);
        EXPECT_NEAR(length(normalize(a)), 1, 2e-7f);
    }
    EXPECT_EQ(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}), (Vec3{0, 0, 1}));
    EXPECT_EQ(cross(Vec2{1, 0}, Vec2{0, 1}), 1);
    EXPECT_EQ(normalize(Vec3{}), Vec3{});
}

TEST(Geometry, GEO1_ProjectionOnALine) {
    EXPECT_EQ(project({3, 4, 5}, {0, 2, 0}), (Vec3{0, 4, 0}));
    EXPECT_EQ(project({3, 4, 5}, {0, -2, 0}), (Vec3{0, 4, 0}));
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 b = random.vec3(10), u = random.unit() * random.in(0.01f, 100);
        const Vec3 p = project(b, u);
        // Its signed length along u is <b, u> / |u|; the rest is perpendicular; twice is once.
        EXPECT_NEAR(dot(p, normalize(u)), dot(b, u) / length(u), 2e-5f);
        EXPECT_NEAR(length(p), std::fabs(dot(b, u)) / length(u), 2e-5f);
        EXPECT_NEAR(dot(b - p, normalize(u)), 0, 2e-5f);
        test::expect_near(project(p, u), p, 1e-5f);
    }
}

TEST(Geometry, GEO1_TriangleNormal) {
    EXPECT_EQ(triangle_normal({0, 0, 0}, {2, 0, 0}, {0, 3, 0}), (Vec3{0, 0, 1}));
    EXPECT_EQ(triangle_normal({0, 0, 0}, {0, 3, 0}, {2, 0, 0}), (Vec3{0, 0, -1}));
    EXPECT_EQ(triangle_normal({1, 1, 1}, {2, 2, 2}, {3, 3, 3}), Vec3{});
    EXPECT_EQ(triangle_normal({1, 1, 1}, {1, 1, 1}, {3, 0, 3}), Vec3{});
    // Also where products of float would leave their range.
    test::expect_near(triangle_normal({0, 0, 0}, {1e-30f, 0, 0}, {0, 1e-30f, 0}), {0, 0, 1}, 1e-7f);
    test::expect_near(triangle_normal({0, 0, 0}, {0, 1e30f, 0}, {0, 0, 1e30f}), {1, 0, 0}, 1e-7f);
}

TEST(Geometry, GEO2_BarycentricOfKnownPoints) {
    const Vec2 a{1, 1}, b{5, 1}, c{1, 4};
    EXPECT_EQ(barycentric(a, a, b, c), (Vec3{1, 0, 0}));
    EXPECT_EQ(barycentric(b, a, b, c), (Vec3{0, 1, 0}));
    EXPECT_EQ(barycentric(c, a, b, c), (Vec3{0, 0, 1}));
    EXPECT_EQ(barycentric(Vec2{3, 2.5f}, a, b, c), (Vec3{0, 0.5f, 0.5f}));
    // Outside beyond the edge BC, A's coordinate is negative; the winding does not matter.
    const std::optional<Vec3> outside = barycentric(Vec2{5, 4}, a, b, c);
    ASSERT_TRUE(outside);
    EXPECT_EQ(*outside, (Vec3{-1, 1, 1}));
    EXPECT_EQ(barycentric(Vec2{5, 4}, a, c, b), (Vec3{-1, 1, 1}));
    EXPECT_FALSE(barycentric(a, a, b, {3, 1}));
    EXPECT_FALSE(barycentric(Vec3{1, 2, 3}, {0, 0, 0}, {1, 1, 1}, {2, 2, 2}));
}

TEST(Geometry, GEO2_BarycentricAgainstLongDouble) {
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        const Vec2 p = random.vec2(2), a = random.vec2(1), b = random.vec2(1), c = random.vec2(1);
        const auto area = [](Vec2 i0, Vec2 j, Vec2 k) {
            const long double x = i0.x, y = i0.y;
            return (j.x - x) * (k.y - y) - (j.y - y) * (k.x - x);
        };
        const long double whole = area(a, b, c);
        if (std::fabs(whole) < 1e-3L) continue;
        const std::optional<Vec3> w = barycentric(p, a, b, c);
        ASSERT_TRUE(w);
        const long double wa = area(p, b, c) / whole, wb = area(p, c, a) / whole, wc = area(p, a, b) / whole;
        // Correct to the rounding of the result.
        EXPECT_NEAR(w->x, static_cast<double>(wa), 6.1e-8 * std::fabs(static_cast<double>(wa)) + 1e-12);
        EXPECT_NEAR(w->y, static_cast<double>(wb), 6.1e-8 * std::fabs(static_cast<double>(wb)) + 1e-12);
        EXPECT_NEAR(w->z, static_cast<double>(wc), 6.1e-8 * std::fabs(static_cast<double>(wc)) + 1e-12);
        const Vec2 back = a * w->x + b * w->y + c * w->z;
        const float size = std::fabs(w->x) + std::fabs(w->y) + std::fabs(w->z);
        EXPECT_NEAR(back.x, p.x, 5e-7f * size);
        EXPECT_NEAR(back.y, p.y, 5e-7f * size);
        EXPECT_NEAR(w->x + w->y + w->z, 1, 5e-7f * size);
    }
}

TEST(Geometry, GEO2_BarycentricInSpaceProjectsOntoThePlane) {
    Random random(4);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a = random.vec3(1), b = random.vec3(1), c = random.vec3(1);
        if (length(cross(b - a, c - a)) < 0.05f) continue;
        const Vec3 weights{random.in(-1, 2), random.in(-1, 2), 0};
        const float last = 1 - weights.x - weights.y;
        const Vec3 in_plane = a * weights.x + b * weights.y + c * last;
        const Vec3 p = in_plane + triangle_normal(a, b, c) * random.in(-2, 2);
        const std::optional<Vec3> w = barycentric(p, a, b, c);
        ASSERT_TRUE(w);
        test::expect_near(*w, {weights.x, weights.y, last}, 2e-4f);
    }
}

TEST(Geometry, GEO3_LinesRaysAndSegments) {
    const Ray ray{{1, 2, 3}, {4, -2, 0}};
    EXPECT_EQ(ray.at(0), ray.origin);
    EXPECT_EQ(ray.at(1), (Vec3{5, 0, 3}));
    EXPECT_EQ(ray.at(0.5f), (Vec3{3, 1, 3}));
    EXPECT_EQ(ray.at(-1), (Vec3{-3, 4, 3}));
}

TEST(Geometry, GEO3_PointsTranslateAndDirectionsDoNot) {
    const Mat4 move = translation({10, 20, 30});
    const Vec3 v{1, 2, 3};
    EXPECT_EQ(move * point(v), (Vec4{11, 22, 33, 1}));
    EXPECT_EQ(move * direction(v), (Vec4{1, 2, 3, 0}));
    // The difference of two points is a direction, a point and a direction make a point.
    EXPECT_EQ(point({5, 5, 5}) - point(v), direction({4, 3, 2}));
    EXPECT_EQ(point(v) + direction({1, 1, 1}), point({2, 3, 4}));
    // Multiples of a homogeneous point are the same point.
    EXPECT_EQ(cartesian(point(v) * 4), v);
    EXPECT_EQ(cartesian({2, 4, 6, 2}), v);
}

}  // namespace
}  // namespace tessera
