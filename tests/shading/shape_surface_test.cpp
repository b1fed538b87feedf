// Where rays meet spheres and discs, and what the surface is there, against the definition in long double.
#include "shading/shape_surface.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

using namespace test;

testing::AssertionResult close(Real got, Real want, Real tolerance) {
    if (std::fabs(got - want) <= tolerance) return testing::AssertionSuccess();
    return testing::AssertionFailure() << got << " for " << want << ", " << std::fabs(got - want) << " off, more than "
                                       << tolerance;
}

// u of a sphere's seam is 0 or 1.
testing::AssertionResult close_around(Real got, Real want, Real tolerance) {
    return close(got - std::round(got - want), want, tolerance);
}

constexpr Real kEpsilon = std::numeric_limits<float>::epsilon();

// The line's point nearest to the middle of a sphere, and half the chord.
struct Chord {
    Real nearest, half, miss;  // along the ray, in its units; how far off the middle
    Chord(const Real3& o, const Real3& d, Real r) {
        nearest = -inner(o, d) / inner(d, d);
        const Real3 q = o + d * nearest;
        miss = norm(q);
        half = std::sqrt(std::max(r * r - inner(q, q), 0.0L) / inner(d, d));
    }
    Real t(bool leaving) const { return nearest + (leaving ? half : -half); }
};

Real3 of_uv(Real u, Real v, Real r) {  // docs/scene-format.md
    const Real phi = 2 * kRealPi * (u - 0.5L), theta = kRealPi * v;
    return {r * std::sin(theta) * std::sin(phi), r * std::cos(theta), r * std::sin(theta) * std::cos(phi)};
}

struct ObjectRay {
    Vec3T<float> origin, direction;
    float radius;
};

enum class Kind { kOutside, kInside, kFar, kTiny, kHuge, kGrazing, kPole, kAxis, kStretched };
constexpr Kind kKinds[] = {Kind::kOutside, Kind::kInside, Kind::kFar,  Kind::kTiny,     Kind::kHuge,
                           Kind::kGrazing, Kind::kPole,   Kind::kAxis, Kind::kStretched};

// A ray that meets the sphere, before or behind its origin.
ObjectRay make_ray(Random& random, Kind kind) {
    const float radius = kind == Kind::kTiny ? 1e-4f : kind == Kind::kHuge ? 1e4f : random.in(0.5f, 2);
    const float away = kind == Kind::kInside ? random.in(0, 0.95f) : kind == Kind::kFar ? 1e4f : random.in(1.1f, 5);
    if (kind == Kind::kAxis) {
        const float side = random.below(2) ? 1.0f : -1.0f;
        return {{0, side * away * radius, 0}, {0, -side, 0}, radius};
    }
    const Vec3T<float> origin = random.unit() * (away * radius);
    Vec3T<float> target = random.unit() * (radius * random.in(0, 0.95f));
    if (kind == Kind::kPole) target = {0, random.below(2) ? radius : -radius, 0};
    if (kind == Kind::kGrazing) {  // a point beside the middle, across the way to it
        const Real3 across = unit(outer(Real3(origin), Real3(random.unit())));
        target = to_vec(across * (radius * (1 - static_cast<Real>(random.in(1e-6f, 1e-3f)))));
    }
    Real3 d = unit(Real3(target) - Real3(origin));
    if (kind == Kind::kStretched) d = d * static_cast<Real>(random.in(0.01f, 100));
    return {origin, to_vec(d), radius};
}

TEST(ShapeSurface, RaysMeetSpheresWhereTheDefinitionSays) {
    for (const Kind kind : kKinds) {
        Random random(static_cast<std::uint32_t>(kind) + 1);
        SCOPED_TRACE(static_cast<int>(kind));
        int met = 0;
        for (int i = 0; i < 4000; ++i) {
            const ObjectRay ray = make_ray(random, kind);
            const Real3 o(ray.origin), d(ray.direction);
            const Real r = ray.radius;
            const Chord chord(o, d, r);
            if (chord.half == 0) continue;
            ++met;
            // What rounding moves the ray aside, and that along the surface.
            const Real aside = 4 * kEpsilon * (norm(o) + r), half = chord.half * norm(d);
            const Real along = std::min(aside * (1 + r / half), aside + 2 * std::sqrt(r * aside));
            for (const bool leaving : {false, true}) {
                const ShapeHit<float> hit = hit_sphere<float>(ray.origin, ray.direction, ray.radius, leaving);
                const Real t = chord.t(leaving);
                ASSERT_LE(distance(hit.position, o + d * t), along) << i;
                ASSERT_TRUE(close(hit.t * norm(d), std::max(t, 0.0L) * norm(d), along)) << i;
                ASSERT_TRUE(close(norm(Real3(hit.position)), r, 3 * kEpsilon * r));
                ASSERT_TRUE(close(norm(Real3(hit.normal)), 1, 3 * kEpsilon));
                ASSERT_LE(distance(hit.normal, Real3(hit.position) * (1 / r)), 3 * kEpsilon);
                ASSERT_LE(distance(hit.position, of_uv(hit.uv.x, hit.uv.y, r)), 1.5e-6L * r) << hit.uv.x;
                ASSERT_TRUE(hit.uv.x >= 0 && hit.uv.x <= 1 && hit.uv.y >= 0 && hit.uv.y <= 1);
                ASSERT_GE((leaving ? 1 : -1) * inner(Real3(hit.normal), unit(d)), -3 * along / r);
            }
        }
        EXPECT_GT(met, 3900);
    }
}

TEST(ShapeSurface, RaysThatMissTouchTheNearestPoint) {
    Random random(20);
    for (int i = 0; i < 4000; ++i) {
        const float radius = random.in(0.1f, 3);
        const Vec3T<float> o = random.unit() * (radius * random.in(1.5f, 5)), aim = random.unit() * (1.4f * radius);
        const Vec3T<float> d = to_vec(unit(Real3(aim) - Real3(o)));
        const Chord chord(Real3(o), Real3(d), radius);
        if (chord.miss <= static_cast<Real>(radius) * 1.001L) continue;
        const Real3 nearest = unit(Real3(o) + Real3(d) * chord.nearest) * static_cast<Real>(radius);
        for (const bool leaving : {false, true}) {
            const ShapeHit<float> hit = hit_sphere<float>(o, d, radius, leaving);
            ASSERT_LE(distance(hit.position, nearest), 1e-5L * static_cast<Real>(radius));
            ASSERT_TRUE(close(hit.t, std::max(chord.nearest, 0.0L), 1e-5L * static_cast<Real>(radius)));
        }
    }
}

// Entering, leaving and missing by next to nothing are next to each other.
TEST(ShapeSurface, NormalsAreContinuousAcrossTheOutline) {
    for (const float away : {2.0f, 100.0f})
        for (int i = -200; i < 200; ++i) {
            const auto at = [&](int step, bool leaving) {
                const float x = 1 + 1e-6f * static_cast<float>(step);
                return hit_sphere<float>({x, 0, away}, {0, 0, -1}, 1, leaving).normal;
            };
            // The angle at the outline goes by the square root.
            const Real step = 3e-3L + std::sqrt(2e-6L * std::max(-i, 0)) - std::sqrt(2e-6L * std::max(-i - 1, 0));
            for (const bool leaving : {false, true})
                ASSERT_LE(distance(at(i, leaving), Real3(at(i + 1, leaving))), step) << i;
            ASSERT_LE(distance(at(i, false), Real3(at(i, true))), 2 * std::sqrt(2e-6L * std::max(-i, 0)) + 3e-3L) << i;
        }
}

TEST(ShapeSurface, TheSeamAndThePolesAreWhereTheyShouldBe) {
    const auto uv = [](Vec3T<float> toward) { return hit_sphere<float>(toward * 3.0f, -toward, 1, false).uv; };
    EXPECT_EQ(uv({0, 0, 1}).x, 0.5f);
    EXPECT_TRUE(close(uv({1, 0, 0}).x, 0.75, 1e-7));
    EXPECT_TRUE(close(uv({-1, 0, 0}).x, 0.25, 1e-7));
    EXPECT_TRUE(close_around(uv({0, 0, -1}).x, 0, 1e-7));
    EXPECT_EQ(uv({0, 1, 0}).y, 0.0f);
    EXPECT_EQ(uv({0, -1, 0}).y, 1.0f);
    for (const Vec3T<float> toward : {Vec3T<float>{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}})
        EXPECT_TRUE(close(uv(toward).y, 0.5, 1e-7));
}

TEST(ShapeSurface, RaysMeetDiscsWhereTheDefinitionSays) {
    Random random(21);
    int inside = 0, beyond = 0;
    for (int i = 0; i < 20000; ++i) {
        const float radius = i % 3 == 0 ? 1e-4f : i % 3 == 1 ? 1e4f : random.in(0.5f, 2);
        const Vec3T<float> o = random.box(2 * radius);
        const Vec3T<float> aim{radius * random.in(-1, 1), 0, radius * random.in(-1, 1)};
        const Real3 d = unit(Real3(aim) - Real3(o));
        if (std::fabs(d.y) < 1e-2L) continue;
        const Vec3T<float> direction = to_vec(d * static_cast<Real>(random.in(0.1f, 10)));
        const Real t = -Real3(o).y / Real3(direction).y;
        const Real3 at = Real3(o) + Real3(direction) * t;
        const Real far = norm(at), r = radius, rounding = 4 * kEpsilon * (norm(Real3(o)) + r) / std::fabs(d.y);
        const ShapeHit<float> hit = hit_disc<float>(o, direction, radius);
        ASSERT_EQ(hit.position.y, 0.0f);
        ASSERT_TRUE(close(hit.t, std::max(t, 0.0L), 4 * kEpsilon * std::fabs(t)));
        if (t < 0) continue;
        ++(far <= r ? inside : beyond);
        // The rim where it is missed.
        ASSERT_LE(distance(hit.position, far <= r ? at : at * (r / far)), rounding);
        ASSERT_LE(norm(Real3(hit.position)), r * (1 + 2 * kEpsilon));
        ASSERT_TRUE(close(hit.uv.x, 0.5L + hit.position.x / (2 * r), 2 * kEpsilon));
        ASSERT_TRUE(close(hit.uv.y, 0.5L + hit.position.z / (2 * r), 2 * kEpsilon));
        ASSERT_TRUE(hit.normal.x == 0 && hit.normal.y == 1 && hit.normal.z == 0);
    }
    EXPECT_GT(inside, 5000);
    EXPECT_GT(beyond, 1000);
}

TEST(ShapeSurface, RaysInTheDiscsPlaneStayWithinIt) {
    Random random(22);
    for (int i = 0; i < 1000; ++i) {
        Vec3T<float> o = random.box(3), d = random.unit();
        d.y = 0;
        if (i % 2) o.y = 0;
        const ShapeHit<float> hit = hit_disc<float>(o, d, 1);
        ASSERT_EQ(hit.t, 0.0f);
        ASSERT_LE(norm(Real3(hit.position)), 1 + 2 * kEpsilon);
    }
}

// --- what u and v gain along the surface --------------------------------------------------------

// By finite differences of the definition.
TEST(ShapeSurface, SlopesAreThoseOfTheCoordinates) {
    Random random(23);
    for (int i = 0; i < 4000; ++i) {
        const float radius = random.in(0.2f, 4);
        const Vec3T<float> n = random.unit();
        if (std::hypot(n.x, n.z) < 0.02f) continue;
        const bool leaving = i % 2;
        const ShapeHit<float> hit =
            hit_sphere<float>(n * (leaving ? -2 * radius : 3 * radius), leaving ? n : -n, radius, leaving);
        const Real r = radius, h = 1e-6L;
        const auto slope = [&](bool u) {
            const Real du = u ? h : 0, dv = u ? 0 : h, x = hit.uv.x, y = hit.uv.y;
            return (of_uv(x + du, y + dv, r) - of_uv(x - du, y - dv, r)) * (1 / (2 * h));
        };
        const Real3 by_u = slope(true), by_v = slope(false);
        ASSERT_TRUE(close(inner(Real3(hit.u_slope), by_u), 1, 2e-5L)) << i;
        ASSERT_TRUE(close(inner(Real3(hit.v_slope), by_v), 1, 2e-5L)) << i;
        ASSERT_TRUE(close(inner(Real3(hit.u_slope), by_v), 0, 1e-4L / std::hypot(n.x, n.z))) << i;
        ASSERT_TRUE(close(inner(Real3(hit.v_slope), by_u), 0, 2e-5L)) << i;
        ASSERT_LE(norm(outer(unit(Real3(hit.along_u)), unit(by_u))), 1e-4L);
        ASSERT_GT(inner(Real3(hit.along_u), by_u), 0);
    }
    // At the poles u has no slope, and nothing is infinite.
    for (const float side : {1.0f, -1.0f}) {
        const ShapeHit<float> pole = hit_sphere<float>({0, 2 * side, 0}, {0, -side, 0}, 1, false);
        for (const Vec3T<float>& v : {pole.along_u, pole.u_slope, pole.v_slope})
            EXPECT_TRUE(v.x - v.x == 0 && v.y - v.y == 0 && v.z - v.z == 0);
    }
}

}  // namespace
}  // namespace tessera
