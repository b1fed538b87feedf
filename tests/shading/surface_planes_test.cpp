// RAS5, GEO2: the surface planes against perspective-correct interpolation through the snapped vertices in
// long double, with the bound of float roundings carried along; footprints against differences; closed
// forms; what sees no surface stays finite.
#include "shading/plane_cases.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tessera {
namespace {

using test::Bounded;
using test::PlaneCase;
using test::Real;
using test::Real3;

// A plane through the snapped vertices at (x, y), its value by weights of area, its bound by the roundings
// of the formula: differences to the first vertex, times the inverse of the area.
struct Weights {
    Real l[3];

    Weights(const SnappedVertex* v, Real x, Real y) {
        const auto area = [](Real ax, Real ay, Real bx, Real by) { return ax * by - bx * ay; };
        const Real whole = area(v[1].x - v[0].x, v[1].y - v[0].y, v[2].x - v[0].x, v[2].y - v[0].y);
        for (int i = 0; i < 3; ++i) {
            const SnappedVertex &j = v[(i + 1) % 3], &k = v[(i + 2) % 3];
            l[i] = area(j.x - x, j.y - y, k.x - x, k.y - y) / whole;
        }
    }
    Real of(const Real (&g)[3]) const { return l[0] * g[0] + l[1] * g[1] + l[2] * g[2]; }
};

Bounded plane_value(const PlaneCase& c, int k, Real x, Real y) {
    const SnappedVertex* v = c.setup.polygon;
    Bounded g[3];
    Real exact[3];
    for (int i = 0; i < 3; ++i) {
        const Bounded inverse = Bounded{1} / Bounded{c.setup.vertices[i].w};
        g[i] = k == 0 ? inverse : Bounded{c.number(k, i)} * inverse;
        exact[i] = static_cast<Real>(c.number(k, i)) / c.setup.vertices[i].w;
    }
    const Bounded dx1{static_cast<Real>(v[1].x) - v[0].x}, dy1{static_cast<Real>(v[1].y) - v[0].y},
        dx2{static_cast<Real>(v[2].x) - v[0].x}, dy2{static_cast<Real>(v[2].y) - v[0].y};
    const Bounded inverse_area = Bounded{1} / (dx1 * dy2 - dx2 * dy1);
    const Bounded d1 = g[1] - g[0], d2 = g[2] - g[0];
    const Bounded ddx = (d1 * dy2 - d2 * dy1) * inverse_area, ddy = (d2 * dx1 - d1 * dx2) * inverse_area;
    const Bounded value = (g[0] + ddy * Bounded{y - v[0].y}) + ddx * Bounded{x - v[0].x};
    return {Weights(v, x, y).of(exact), value.error};
}

struct Size {
    const char* name;
    float size;
};

class PlanesTest : public testing::TestWithParam<Size> {};

TEST_P(PlanesTest, RAS5_WithinTheRoundingsOfTheInterpolation) {
    test::Random random(43);
    PlaneCase c;
    int cases = 0, sharp = 0;
    for (int i = 0; i < 20000; ++i) {
        c.randomise(random, std::exp2(random.in(-2, 10)), GetParam().size, false);
        if (c.setup.kind != TriangleSetup::Kind::kPlain) continue;
        c.make_record();
        const SamplePosition at = c.inside(random);
        const auto x = static_cast<float>(at.x), y = static_cast<float>(at.y);
        const SurfacePoint<float> s = c.point(x, y);
        const float got[] = {s.color.x, s.color.y, s.color.z, s.color.w, s.uv[0].x, s.uv[0].y, s.uv[1].x, s.uv[1].y};
        const Bounded inverse_w = plane_value(c, 0, at.x, at.y);
        for (int k = 0; k < c.layout.count; ++k) {
            const Bounded want = plane_value(c, k, at.x, at.y);
            const float value = c.plane(k).at(x - c.record[0], y - c.record[1]);
            ASSERT_LE(std::fabs(value - want.value), want.error) << "plane " << k << " of case " << i;
            if (k < 7) continue;
            // Times w: the reciprocal is rounded, the product is rounded.
            const Bounded number = want * (Bounded{1} / inverse_w);
            ASSERT_LE(std::fabs(got[k - 7] - number.value), number.error) << "number " << k << " of case " << i;
            sharp += number.error < 1e-4L;
        }
        ++cases;
    }
    EXPECT_GT(cases, 5000);
    EXPECT_GT(sharp, 4 * cases) << "the bound must say something";
}

// The position lies on the ray at the distance that the plane of 1 / w says; normal and tangent are the
// interpolated ones, the tangent across the normal.
TEST_P(PlanesTest, RAS5_PositionNormalAndFrame) {
    test::Random random(44);
    PlaneCase c;
    int cases = 0;
    for (int i = 0; i < 10000; ++i) {
        c.randomise(random, std::exp2(random.in(-2, 10)), GetParam().size, false);
        if (c.setup.kind != TriangleSetup::Kind::kPlain) continue;
        c.make_record();
        const SamplePosition at = c.inside(random);
        const SurfacePoint<float> s = c.point(static_cast<float>(at.x), static_cast<float>(at.y));
        Bounded v[7];
        for (int k = 0; k < 7; ++k) v[k] = plane_value(c, k, at.x, at.y);
        const Bounded w = Bounded{1} / v[0];
        if (!(w.error < 1e-4L * w.value)) continue;
        ASSERT_LE(std::fabs(-s.position.z - w.value), w.error) << i;
        const Real rx = (at.x / (128.0L * PlaneCase::kWidth) - 1) / 0.5625L,
                   ry = 1 - at.y / (128.0L * PlaneCase::kHeight);
        ASSERT_NEAR(s.position.x, static_cast<double>(rx * w.value),
                    static_cast<double>(2 * w.error + 4e-7L * w.value));
        ASSERT_NEAR(s.position.y, static_cast<double>(ry * w.value),
                    static_cast<double>(2 * w.error + 4e-7L * w.value));

        const Real3 normal{v[1].value, v[2].value, v[3].value}, tangent{v[4].value, v[5].value, v[6].value};
        const Real shortest = std::fmin(norm(normal), norm(outer(normal, tangent)) / norm(normal));
        Real worst = 0;
        for (int k = 1; k < 7; ++k) worst = std::fmax(worst, v[k].error);
        if (worst > 1e-5L * shortest) continue;
        const Real tolerance = 4 * worst / shortest + 1e-6L;
        const Real3 n = unit(normal);
        ASSERT_LT(distance(s.normal, n), tolerance);
        // The record's normal looks to the viewer; the frame stands on the front.
        const Real side = s.side;
        const Real3 t = unit(tangent - n * inner(n, tangent));
        ASSERT_LT(distance(s.tangent, t), 4 * tolerance);
        ASSERT_LT(distance(s.bitangent, outer(n, t) * -side), 8 * tolerance);
        ++cases;
    }
    EXPECT_GT(cases, 1000);
}

// The change of the coordinates per pixel against central differences of the exact ones.
TEST_P(PlanesTest, RAS5_FootprintsAreDerivatives) {
    test::Random random(45);
    PlaneCase c;
    int cases = 0;
    for (int i = 0; i < 10000; ++i) {
        c.randomise(random, std::exp2(random.in(-2, 10)), GetParam().size, false);
        if (c.setup.kind != TriangleSetup::Kind::kPlain) continue;
        c.make_record();
        const SamplePosition at = c.inside(random);
        const SurfacePoint<float> s = c.point(static_cast<float>(at.x), static_cast<float>(at.y));
        const auto exact = [&](int k, Real x, Real y) {
            Real g[3], q[3];
            for (int j = 0; j < 3; ++j) {
                q[j] = 1.0L / c.setup.vertices[j].w;
                g[j] = c.number(k, j) * q[j];
            }
            const Weights weights(c.setup.polygon, x, y);
            return weights.of(g) / weights.of(q);
        };
        // What is known of the coordinates themselves, over the triangle's height in pixels.
        const SnappedVertex &v0 = c.setup.polygon[0], &v1 = c.setup.polygon[1], &v2 = c.setup.polygon[2];
        const Real longest = std::max({std::hypot(v1.x - v0.x, v1.y - v0.y), std::hypot(v2.x - v0.x, v2.y - v0.y),
                                       std::hypot(v2.x - v1.x, v2.y - v1.y)});
        const Real height = std::fabs(static_cast<Real>(twice_area(v0, v1, v2))) / longest / 256;
        Real worst = 0;
        for (int k = 11; k < 15; ++k)
            worst =
                std::fmax(worst, (plane_value(c, k, at.x, at.y) * (Bounded{1} / plane_value(c, 0, at.x, at.y))).error);
        if (worst > 1e-3L) continue;
        for (int set = 0; set < 2; ++set) {
            const Footprint<float>& f = s.footprint[set];
            const float got[] = {f.ux, f.vx, f.uy, f.vy};
            Real want[4], size = 0;
            for (int k = 0; k < 4; ++k) {
                const Real h = 1e-4L, dx = k < 2 ? h : 0, dy = k < 2 ? 0 : h;
                const int number = 11 + 2 * set + k % 2;
                want[k] = 256 * (exact(number, at.x + dx, at.y + dy) - exact(number, at.x - dx, at.y - dy)) / (2 * h);
                size = std::fmax(size, std::fabs(want[k]));
            }
            for (int k = 0; k < 4; ++k)
                ASSERT_LT(std::fabs(got[k] - want[k]), size * 1e-5L + 8 * worst / height + 1e-6L) << i << " " << k;
        }
        ++cases;
    }
    EXPECT_GT(cases, 2000);
}

INSTANTIATE_TEST_SUITE_P(Surface, PlanesTest,
                         testing::Values(Size{"Large", 0.8f}, Size{"Small", 0.02f}, Size{"Tiny", 0.002f}),
                         [](const auto& instance) { return std::string(instance.param.name); });

// The midpoint of the picture of an edge is not the midpoint of the edge: what screen-space
// interpolation would get wrong, in closed form: weight of the far end = near / (near + far).
TEST(RAS5_Perspective, EdgeMidpointIsWeightedByDepth) {
    PlaneCase c;
    test::Random random(46);
    c.randomise(random, 1, 0.1f, false);
    const float positions[9] = {-1.0f / 0.5625f, -0.5f, -1, 9.0f / 0.5625f, -4.5f, -9, 0, 1.5f, -3};
    std::memcpy(c.positions, positions, sizeof positions);
    setup_triangle(c.instance, 0, c.projection, c.setup);
    ASSERT_EQ(c.setup.kind, TriangleSetup::Kind::kPlain);
    c.make_record();
    const SurfacePoint<float> s = c.point(128 * PlaneCase::kWidth, 192 * PlaneCase::kHeight);
    for (int k = 0; k < 2; ++k) {
        const float* uv = c.uvs[k];
        EXPECT_NEAR(s.uv[k].x, 0.9f * uv[0] + 0.1f * uv[2], 2e-6);
        EXPECT_NEAR(s.uv[k].y, 0.9f * uv[1] + 0.1f * uv[3], 2e-6);
    }
    EXPECT_NEAR(s.position.z, -1.8, 2e-6);
}

// Where no area is left, and beside slivers where 1 / w is lost, every number is finite.
TEST(RAS5_Planes, StayFiniteOnWorthlessTriangles) {
    PlaneCase c;
    test::Random random(47);
    for (int i = 0; i < 3000; ++i) {
        c.randomise(random, std::exp2(random.in(-3, 12)), i % 3 == 0 ? 1e-5f : 0.5f, false);
        PictureVertex<float> p[3];
        Corner<float> corners[3];
        for (int k = 0; k < 3; ++k) {
            if (i % 3 == 1) c.setup.vertices[k] = c.setup.vertices[0];  // a point
            p[k] = to_picture(c.setup.vertices[k], PlaneCase::kWidth, PlaneCase::kHeight);
            corners[k] = fetch_corner(c.instance.mesh, static_cast<std::uint32_t>(k));
        }
        if (i % 3 == 2) p[2] = p[1];  // a line
        make_planes(c.instance, c.layout, corners, c.setup.vertices, p, 1.0f, [&](int k, float v) { c.record[k] = v; });
        for (int k = 0; k < 20; ++k) {
            const SurfacePoint<float> s =
                c.point(static_cast<float>(random.below(1920 * 256)), static_cast<float>(random.below(1080 * 256)));
            const Vec3T<float> sum = s.position + s.normal + s.tangent + s.bitangent + s.color.xyz();
            ASSERT_TRUE(std::isfinite(sum.x + sum.y + sum.z + s.color.w)) << i;
            for (int set = 0; set < 2; ++set) {
                const Footprint<float>& f = s.footprint[set];
                ASSERT_TRUE(std::isfinite(s.uv[set].x + s.uv[set].y)) << i;
                ASSERT_FALSE(std::isnan(f.ux + f.vx) || std::isnan(f.uy) || std::isnan(f.vy)) << i;
            }
        }
    }
}

}  // namespace
}  // namespace tessera
