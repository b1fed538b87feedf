// RAS2, RAS5: the planes of clipped triangles, from their homogeneous vertices: against the planes of the
// plain path where no clipping is needed, and against the point that the ray meets where a vertex is
// behind the eye.
#include "shading/plane_cases.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using test::PlaneCase;
using test::Real;
using test::Real3;

// The plain path interpolates through the snapped vertices, the other through the vertices where they are:
// inside the triangle that moves a plane by no more than its change over half a grid step each way.
TEST(RAS2_ClippedPlanes, AreThePlainOnesWhereNothingIsClipped) {
    test::Random random(61);
    PlaneCase c;
    int cases = 0;
    for (int i = 0; i < 20000; ++i) {
        c.randomise(random, std::exp2(random.in(-2, 8)), i % 2 ? 0.8f : 0.05f, false);
        if (c.setup.kind != TriangleSetup::Kind::kPlain) continue;
        c.make_record();
        float plain[kMaxSurfaceFloats];
        std::memcpy(plain, c.record, sizeof plain);
        c.setup.kind = TriangleSetup::Kind::kClipped;
        c.make_record();
        for (int k = 0; k < kSurfaceHeader; ++k) ASSERT_EQ(c.record[k], plain[k]) << "header " << k << ", case " << i;
        const SamplePosition at = c.inside(random);
        const Real dx = at.x - c.setup.polygon[0].x, dy = at.y - c.setup.polygon[0].y;
        const Real area = static_cast<Real>(twice_area(c.setup.polygon[0], c.setup.polygon[1], c.setup.polygon[2]));
        if (std::fabs(area) < 256 * 256 * 64) continue;  // a sliver's planes are known too badly
        for (int k = 0; k < c.layout.count; ++k) {
            const float* p = plain + kSurfaceHeader + 3 * k;
            const Plane<float> q = c.plane(k);
            const Real before = p[0] + p[1] * dx + p[2] * dy, after = q.at_anchor + q.ddx * dx + q.ddy * dy;
            const Real step = 0.6L * (std::fabs(static_cast<Real>(q.ddx)) + std::fabs(static_cast<Real>(q.ddy)));
            Real largest = 0;
            for (int j = 0; j < 3; ++j)
                largest = std::fmax(largest, std::fabs(static_cast<Real>(c.number(k, j))) / c.setup.vertices[j].w);
            // The roundings of the plain formula: of the differences, over the part of the box that has area.
            const Real box = (std::fabs(static_cast<Real>(c.setup.polygon[1].x) - c.setup.polygon[0].x) +
                              std::fabs(static_cast<Real>(c.setup.polygon[1].y) - c.setup.polygon[0].y)) *
                             (std::fabs(static_cast<Real>(c.setup.polygon[2].x) - c.setup.polygon[0].x) +
                              std::fabs(static_cast<Real>(c.setup.polygon[2].y) - c.setup.polygon[0].y));
            ASSERT_LE(std::fabs(after - before), step + largest * (1 + box / std::fabs(area)) * 24 * 0x1p-24L)
                << "plane " << k << " of case " << i;
        }
        ++cases;
    }
    EXPECT_GT(cases, 4000);
}

// Where the ray through (x, y) meets the plane of the triangle, and the barycentrics there (GEO2: triple
// products in long double). `rounding`: how far, relative to the distance, the hit moves where x of the
// clip vertices, which alone is rounded before this lens, is off by its rounding.
struct Hit {
    Real distance, b[3], rounding;

    Hit(const PlaneCase& c, SamplePosition at) {
        const Real3 ray{(at.x / (128.0L * PlaneCase::kWidth) - 1) / 0.5625L, 1 - at.y / (128.0L * PlaneCase::kHeight),
                        -1};
        Real3 p[3];
        for (int i = 0; i < 3; ++i) p[i] = {c.positions[3 * i], c.positions[3 * i + 1], c.positions[3 * i + 2]};
        Real sum = 0;
        for (int i = 0; i < 3; ++i) sum += b[i] = inner(ray, outer(p[(i + 1) % 3], p[(i + 2) % 3]));
        for (Real& v : b) v /= sum;
        distance = inner(p[0], outer(p[1], p[2])) / sum;
        const Real3 n = outer(p[1] - p[0], p[2] - p[0]);
        const Real widest = std::fmax(std::fabs(p[0].x), std::fmax(std::fabs(p[1].x), std::fabs(p[2].x)));
        rounding = 0x1p-24L * widest * std::fabs(n.x) / (std::fabs(inner(n, ray)) * distance);
    }
};

TEST(RAS2_ClippedPlanes, AreThoseOfTheRayWhereAVertexIsBehindTheEye) {
    test::Random random(62);
    PlaneCase c;
    int cases = 0;
    for (int i = 0; i < 40000; ++i) {
        c.randomise(random, std::exp2(random.in(-1, 7)), 0.8f, true);
        if (c.setup.kind != TriangleSetup::Kind::kClipped) continue;
        c.make_record();
        const SamplePosition at = c.inside(random);
        const Hit hit(c, at);
        if (!(hit.b[0] > 0 && hit.b[1] > 0 && hit.b[2] > 0) || !(hit.distance > 0.1L)) continue;
        const SurfacePoint<float> s = c.point(static_cast<float>(at.x), static_cast<float>(at.y));
        // The float planes are exact to roundings of their three numbers at the far end of the polygon.
        const Plane<float> inverse_w = c.plane(0);
        const Real dx = std::fabs(static_cast<Real>(at.x) - c.record[0]),
                   dy = std::fabs(static_cast<Real>(at.y) - c.record[1]);
        const auto slack = [&](const Plane<float>& p) {
            return 6 * 0x1p-24L *
                   (std::fabs(static_cast<Real>(p.at_anchor)) + std::fabs(static_cast<Real>(p.ddx)) * dx +
                    std::fabs(static_cast<Real>(p.ddy)) * dy);
        };
        const Real relative = slack(inverse_w) * hit.distance + 2 * hit.rounding;
        if (relative > 1e-3L) continue;
        ASSERT_NEAR(static_cast<double>(-s.position.z / hit.distance), 1, static_cast<double>(relative + 2e-7L)) << i;
        const float got[] = {s.color.x, s.color.y, s.color.z, s.color.w, s.uv[0].x, s.uv[0].y, s.uv[1].x, s.uv[1].y};
        for (int k = 7; k < c.layout.count; ++k) {
            Real want = 0;
            for (int j = 0; j < 3; ++j) want += hit.b[j] * c.number(k, j);
            ASSERT_NEAR(got[k - 7], static_cast<double>(want),
                        static_cast<double>(slack(c.plane(k)) * hit.distance + std::fabs(want) * relative + 6e-6L))
                << "number " << k << " of case " << i;
        }
        ++cases;
    }
    EXPECT_GT(cases, 3000);
}

}  // namespace
}  // namespace tessera
