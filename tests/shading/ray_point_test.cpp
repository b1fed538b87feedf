// Where rays meet triangles, and the part of them that a ray's cone covers, against long double.
#include "shading/transport.h"

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

struct Case {
    Vec3T<float> v[3];
    Vec3T<float> ng;
    ConeRay<float> ray;
};

// A triangle and a ray to its point of these barycentrics, not along the plane.
Case make_case(Random& random, Real b1, Real b2) {
    for (;;) {
        Case c;
        for (Vec3T<float>& v : c.v) v = random.box(1);
        const Real3 n = outer(Real3(c.v[1]) - Real3(c.v[0]), Real3(c.v[2]) - Real3(c.v[0]));
        if (norm(n) < 0.05L) continue;
        c.ng = to_vec(unit(n));
        const Real3 at = Real3(c.v[0]) * (1 - b1 - b2) + Real3(c.v[1]) * b1 + Real3(c.v[2]) * b2;
        const Real3 from(random.box(3)), d = unit(at - from);
        if (std::fabs(inner(d, unit(n))) < 0.1L) continue;
        c.ray = {to_vec(from), to_vec(d), random.in(0, 0.1f)};
        return c;
    }
}

// Where a ray meets the plane: b1, b2 and the distance, by Cramer's rule.
std::array<Real, 3> meet(const Case& c, Real3 from, Real3 d) {
    const Real3 e1 = Real3(c.v[1]) - Real3(c.v[0]), e2 = Real3(c.v[2]) - Real3(c.v[0]), n = outer(e1, e2);
    const Real t = inner(n, Real3(c.v[0]) - from) / inner(n, d);
    const Real3 at = from + d * t - Real3(c.v[0]);
    return {inner(outer(at, e2), n) / inner(n, n), inner(outer(e1, at), n) / inner(n, n), t};
}

TEST(RayPoint, BarycentricsAndDistance) {
    Random random(1);
    for (int i = 0; i < 5000; ++i) {
        Real b1 = static_cast<Real>(random.in(0, 1)), b2 = static_cast<Real>(random.in(0, 1));
        if (b1 + b2 > 1) b1 = 1 - b1, b2 = 1 - b2;
        const Case c = make_case(random, b1, b2);
        const RayPoint<float> p = ray_point(c.ray, c.v, c.ng, 0.01f);
        const std::array<Real, 3> want = meet(c, Real3(c.ray.origin), Real3(c.ray.direction));
        EXPECT_TRUE(close(p.barycentrics.b[1], want[0], 1e-4));
        EXPECT_TRUE(close(p.barycentrics.b[2], want[1], 1e-4));
        EXPECT_TRUE(close(p.distance, want[2], 1e-4));
        const float* b = p.barycentrics.b;
        EXPECT_TRUE(close(b[0] + b[1] + b[2], 1, 2e-7));
        EXPECT_TRUE(close(p.width, c.ray.width + 0.01f * p.distance, 1e-6f));
    }
}

TEST(RayPoint, StaysWithinTheTriangleWhateverTheRay) {
    Random random(2);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (int i = 0; i < 20000; ++i) {
        Case c = make_case(random, static_cast<Real>(random.in(-1, 2)), static_cast<Real>(random.in(-1, 2)));
        if (i % 4 == 1) c.v[2] = c.v[1];                                                // no area
        if (i % 4 == 2) c.ray.direction = to_vec(unit(Real3(c.v[1]) - Real3(c.v[0])));  // along the plane
        if (i % 4 == 3) c.ray.direction = -c.ray.direction;                             // behind
        const RayPoint<float> p = ray_point(c.ray, c.v, c.ng, 0.01f);
        for (int k = 0; k < 3; ++k) {
            EXPECT_TRUE(p.barycentrics.b[k] >= -1.2e-7f && p.barycentrics.b[k] <= 1) << p.barycentrics.b[k];
            EXPECT_TRUE(std::fabs(p.barycentrics.ddx[k]) < kInfinity && std::fabs(p.barycentrics.ddy[k]) < kInfinity);
        }
        EXPECT_TRUE(p.distance >= 0 && p.distance < kInfinity);
    }
}

// The cone's edge rays, parallel to the ray, a width aside: in the surface's own direction, and across that.
TEST(RayPoint, DerivativesAreWhatTheConeCovers) {
    Random random(3);
    for (int i = 0; i < 5000; ++i) {
        const Case c = make_case(random, 0.3L, 0.3L);
        const RayPoint<float> p = ray_point(c.ray, c.v, c.ng, 0.01f);
        const Real3 d = unit(Real3(c.ray.direction)), sideways = unit(outer(Real3(c.ng), d)), up = outer(sideways, d);
        const auto moved = [&](Real3 aside) {
            const std::array<Real, 3> a = meet(c, Real3(c.ray.origin), d);
            const std::array<Real, 3> b = meet(c, Real3(c.ray.origin) + aside * p.width, d);
            return std::array<Real, 2>{b[0] - a[0], b[1] - a[1]};
        };
        // The ellipse has no sense of rotation.
        const auto expect = [&](const float(&got)[3], std::array<Real, 2> want) {
            const Real size = std::max({std::fabs(want[0]), std::fabs(want[1]), 1e-3L});
            const Real sign = got[1] * want[0] + got[2] * want[1] < 0 ? -1 : 1;
            EXPECT_TRUE(close(got[1], sign * want[0], 2e-4L * size));
            EXPECT_TRUE(close(got[2], sign * want[1], 2e-4L * size));
            EXPECT_TRUE(close(got[0] + got[1] + got[2], 0, 1e-6L * size));
        };
        expect(p.barycentrics.ddx, moved(sideways));
        expect(p.barycentrics.ddy, moved(up));
    }
}

TEST(RaySurface, IsThePointThatTheRayMeetsSeenFromThere) {
    Random random(4);
    for (int i = 0; i < 2000; ++i) {
        const Case c = make_case(random, 0.2L, 0.5L);
        // Moved by the instance: positions are those of camera space less the way.
        InstanceView instance{};
        const Vec3T<float> way = random.box(2);
        const float rows[12] = {1, 0, 0, way.x, 0, 1, 0, way.y, 0, 0, 1, way.z}, turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        std::copy_n(rows, 12, instance.object_to_camera);
        std::copy_n(turn, 9, instance.normal_to_camera);
        instance.handedness = 1;
        const float present[1] = {0};
        instance.mesh.uvs[1] = present;
        Corner<float> corners[3]{};
        for (int k = 0; k < 3; ++k) {
            corners[k].position = c.v[k] - way;
            corners[k].normal = c.ng;
            corners[k].uv[1] = {static_cast<float>(k == 1), static_cast<float>(k == 2)};
        }
        const RaySurface<float> hit = ray_surface(instance, corners, c.ray, 0.0f, 0.5f);
        const SurfacePoint<float>& s = hit.point;
        const Real3 at = Real3(c.ray.origin) + Real3(c.ray.direction) * hit.distance;
        EXPECT_LT(distance(s.position, at), 2e-4L);
        EXPECT_EQ(s.side, dot(c.ng, c.ray.direction) < 0 ? 1 : -1);
        EXPECT_GT(dot(s.view, s.geometric_normal), 0);
        EXPECT_GT(dot(s.view, s.normal), 0);
        EXPECT_LT(distance(s.view, Real3(c.ray.direction) * -1), 1e-6L);
        EXPECT_TRUE(close(s.uv[1].x, 0.2, 2e-4));
        EXPECT_TRUE(close(s.uv[1].y, 0.5, 2e-4));
        // Of the set whose coordinates are the barycentrics, shrunk to a sample.
        const RayPoint<float> p = ray_point(c.ray, c.v, c.ng, 0.0f);
        EXPECT_TRUE(close(s.footprint[1].ux, 0.5f * p.barycentrics.ddx[1], 1e-4f));
        EXPECT_TRUE(close(s.footprint[1].vy, 0.5f * p.barycentrics.ddy[2], 1e-4f));
    }
}

}  // namespace
}  // namespace tessera
