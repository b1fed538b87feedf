// RAS1, RAS5, GEO2: out-codes and snapping against their definitions; perspective-correct barycentrics
// against rays in long double, with an error bound carried along; derivatives against differences.
#include "shading/surface.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace tessera {
namespace {

using test::Real;
using test::Real3;

constexpr float kWidth = 1920, kHeight = 1080;

TEST(RAS1_OutCode, EveryBitIsItsPlane) {
    test::Random random(41);
    std::set<std::uint32_t> seen;
    for (int i = 0; i < 300000; ++i) {
        const auto number = [&] { return i % 4 ? random.in(-5, 5) : static_cast<float>(random.below(9)) - 4; };
        const ClipVertex<float> v{number(), number(), number(), number()};
        const Real x = v.x, y = v.y, z = v.z, w = v.w, g = 3.5L * w;
        std::uint32_t want = 0;
        want |= x < -w ? 1 : 0;
        want |= x > w ? 2 : 0;
        want |= y < -w ? 4 : 0;
        want |= y > w ? 8 : 0;
        want |= z > w ? 16 : 0;
        want |= z < 0 ? 32 : 0;
        want |= x < -g || x > g || y < -g || y > g ? 64 : 0;
        if (std::fabs(std::fabs(x) - std::fabs(g)) < 1e-5L || std::fabs(std::fabs(y) - std::fabs(g)) < 1e-5L) continue;
        ASSERT_EQ(out_code(v), want) << v.x << " " << v.y << " " << v.z << " " << v.w;
        seen.insert(want);
    }
    // In front of the eye: 3 * 3 * 3 codes of the six planes, the guard with some; behind it others.
    EXPECT_GE(seen.size(), 45u);
}

TEST(RAS1_OutCode, OnAPlaneIsInside) {
    for (const float s : {-1.0f, 1.0f}) {
        EXPECT_EQ(out_code(ClipVertex<float>{2 * s, 0, 1, 2}), 0u);
        EXPECT_EQ(out_code(ClipVertex<float>{0, 2 * s, 1, 2}), 0u);
    }
    EXPECT_EQ(out_code(ClipVertex<float>{0, 0, 2, 2}), 0u);
    EXPECT_EQ(out_code(ClipVertex<float>{0, 0, 0, 2}), 0u);
    EXPECT_EQ(out_code(ClipVertex<float>{7, 0, 1, 2}), static_cast<std::uint32_t>(kOutRight));  // on the guard
}

// The grid point is the nearest to the float position, halves to even; the float position is right to
// three roundings, at most 3/2 ulp of its largest part.
TEST(RAS5_Snap, NearestOfTheGridHalvesToEven) {
    test::Random random(42);
    for (int i = 0; i < 100000; ++i) {
        const float w = std::exp2(random.in(-10, 10));
        const ClipVertex<float> v{random.in(-3.5f, 3.5f) * w, random.in(-3.5f, 3.5f) * w, 0, w};
        const PictureVertex<float> p = to_picture(v, kWidth, kHeight);
        const Real x = (static_cast<Real>(v.x) / v.w + 1) * 0.5L * kWidth * 256;
        const Real y = (1 - static_cast<Real>(v.y) / v.w) * 0.5L * kHeight * 256;
        ASSERT_NEAR(p.x, static_cast<double>(x), 3 * 0x1p-24 * 3.5 * kWidth * 128);
        ASSERT_NEAR(p.y, static_cast<double>(y), 3 * 0x1p-24 * 3.5 * kHeight * 128);
        const Real down = std::floor(static_cast<Real>(p.x)), part = p.x - down;
        const Real even = std::fmod(std::fabs(down), 2.0L) == 0 ? down : down + 1;
        const Real nearest = part == 0.5L ? even : part < 0.5L ? down : down + 1;
        ASSERT_EQ(p.snapped_x, static_cast<std::int32_t>(nearest));
    }
    // Exactly between two grid points of a 256-pixel picture: x = k + 1/2.
    for (int k = -6; k < 7; ++k) {
        const float ndc = (static_cast<float>(k) + 0.5f) / 32768;
        const PictureVertex<float> p = to_picture(ClipVertex<float>{ndc, 0, 0, 1}, 256, 256);
        ASSERT_EQ(p.snapped_x, 32768 + (k % 2 == 0 ? k : k + 1)) << k;
    }
}

TEST(RAS5_SampleNdc, CentreAndCorners) {
    for (int x = 0; x <= static_cast<int>(kWidth) * 256; x += 97) {
        const Vec2T<float> p = sample_ndc<float>(x, x / 2, kWidth, kHeight);
        ASSERT_NEAR(p.x, static_cast<double>(x / (128.0L * kWidth) - 1), 2e-7);
        ASSERT_NEAR(p.y, static_cast<double>(1 - (x / 2) / (128.0L * kHeight)), 2e-7);
    }
}

// --- barycentrics ---------------------------------------------------------------------------

struct Exact {
    Real b[3], error[3];  // `error`: what float roundings may add, to first order
    bool inside, facing;
};

// The ray through P of an eye at the origin against the triangle, by signed areas seen from the eye
// (P = [PBC]/[ABC] A + ..., GEO2): x' = x / w as a plane of homogeneous points. Beside each edge
// function goes the bound of its float evaluation.
Exact exact_barycentrics(const ClipVertex<float> (&v)[3], Real px, Real py, Real front) {
    constexpr Real u = 0x1p-24L;
    const Real3 eye{px, py, 1};
    Real3 h[3];
    for (int i = 0; i < 3; ++i) h[i] = {v[i].x, v[i].y, v[i].w};
    Exact r{};
    Real e[3], d[3], sum = 0, slack = 0;
    for (int i = 0; i < 3; ++i) {
        const Real3 &j = h[(i + 1) % 3], &k = h[(i + 2) % 3];
        e[i] = inner(eye, outer(j, k)) * front;
        // q = x - P w is rounded twice, a product once, the difference once.
        const auto q = [&](const Real3& a) { return Real3{a.x - px * a.z, a.y - py * a.z, 0}; };
        const auto dq = [&](const Real3& a) {
            const Real3 b = q(a);
            return Real3{u * (std::fabs(px * a.z) + std::fabs(b.x)), u * (std::fabs(py * a.z) + std::fabs(b.y)), 0};
        };
        const Real3 qj = q(j), qk = q(k), dj = dq(j), dk = dq(k);
        const auto term = [&](Real a, Real da, Real b, Real db) {
            return std::fabs(a) * db + da * std::fabs(b) + da * db + 2 * u * std::fabs(a * b);
        };
        d[i] = term(qj.x, dj.x, qk.y, dk.y) + term(qj.y, dj.y, qk.x, dk.x);
        sum += e[i];
        slack += d[i];
    }
    r.inside = e[0] >= 0 && e[1] >= 0 && e[2] >= 0 && sum > 0;
    r.facing = sum > 2 * slack;
    for (int i = 0; i < 3; ++i) {
        r.b[i] = e[i] / sum;
        r.error[i] = (d[i] + r.b[i] * slack) / sum * 1.1L + 6 * u;
    }
    return r;
}

enum class Kind { kOrdinary, kTiny, kSliver, kBehindTheEye };

// A triangle in clip space of a 90 degree lens and an NDC position inside it.
bool make_case(test::Random& random, Kind kind, ClipVertex<float> (&v)[3], Vec2T<float>& p) {
    const float far = std::exp2(random.in(-3, 10));
    const Vec3T<float> middle{random.in(-1, 1) * far, random.in(-1, 1) * far, far};
    const float size = kind == Kind::kTiny ? far * 0.002f : far * 0.8f;
    for (int i = 0; i < 3; ++i) {
        Vec3T<float> c = middle + random.box(size);
        if (kind == Kind::kBehindTheEye && i == 2) c.z = -random.in(0.1f, 3) * far;
        v[i] = {c.x, c.y, 0.1f, c.z};
    }
    if (kind == Kind::kSliver) {
        const float t = random.in(0.2f, 0.8f), thin = 1e-4f * far;
        v[2] = {v[0].x + (v[1].x - v[0].x) * t + random.in(-thin, thin),
                v[0].y + (v[1].y - v[0].y) * t + random.in(-thin, thin), 0.1f, v[0].w + (v[1].w - v[0].w) * t};
    }
    float b[3] = {random.in(0.01f, 1), random.in(0.01f, 1), random.in(0.01f, 1)};
    const float x = b[0] * v[0].x + b[1] * v[1].x + b[2] * v[2].x, y = b[0] * v[0].y + b[1] * v[1].y + b[2] * v[2].y,
                w = b[0] * v[0].w + b[1] * v[1].w + b[2] * v[2].w;
    if (!(w > 0)) return false;
    p = {x / w, y / w};
    return std::fabs(p.x) <= 1 && std::fabs(p.y) <= 1;
}

class BarycentricTest : public testing::TestWithParam<Kind> {};

TEST_P(BarycentricTest, GEO2_RAS5_WithinTheBoundOfTheRay) {
    test::Random random(43);
    int cases = 0;
    for (int i = 0; i < 200000; ++i) {
        ClipVertex<float> v[3];
        Vec2T<float> p;
        if (!make_case(random, GetParam(), v, p)) continue;
        float front = 1;
        Exact want = exact_barycentrics(v, p.x, p.y, 1);
        if (!want.inside) want = exact_barycentrics(v, p.x, p.y, front = -1);
        if (!want.inside || !want.facing) continue;
        const Barycentrics<float> got = barycentrics(v, p, front, kWidth, kHeight);
        for (int k = 0; k < 3; ++k) {
            const Real error = std::fabs(got.b[k] - want.b[k]);
            ASSERT_LE(error, want.error[k]) << k << " of case " << i;
            ASSERT_GE(got.b[k], 0);
            ASSERT_LE(got.b[k], 1.000001f);
        }
        ASSERT_NEAR(got.b[0] + got.b[1] + got.b[2], 1, 4e-7);
        ++cases;
    }
    EXPECT_GT(cases, 5000);
}

// d b / d pixel against central differences of the exact barycentrics.
TEST_P(BarycentricTest, RAS5_DerivativesAreThoseOfTheRay) {
    test::Random random(44);
    int cases = 0;
    for (int i = 0; i < 100000; ++i) {
        ClipVertex<float> v[3];
        Vec2T<float> p;
        if (!make_case(random, GetParam(), v, p)) continue;
        float front = 1;
        Exact want = exact_barycentrics(v, p.x, p.y, 1);
        if (!want.inside) want = exact_barycentrics(v, p.x, p.y, front = -1);
        if (!want.inside || !want.facing) continue;
        const Real worst = std::fmax(std::fmax(want.error[0], want.error[1]), want.error[2]);
        if (worst > 1e-3L) continue;  // ill-conditioned: b itself is only known to this
        const Barycentrics<float> got = barycentrics(v, p, front, kWidth, kHeight);
        const Real hx = 2.0L / kWidth * 1e-6L, hy = -2.0L / kHeight * 1e-6L;
        const Exact right = exact_barycentrics(v, p.x + hx, p.y, front),
                    left = exact_barycentrics(v, p.x - hx, p.y, front);
        const Exact down = exact_barycentrics(v, p.x, p.y + hy, front),
                    up = exact_barycentrics(v, p.x, p.y - hy, front);
        Real size_x = 0, size_y = 0, dx[3], dy[3];
        for (int k = 0; k < 3; ++k) {
            dx[k] = (right.b[k] - left.b[k]) / 2e-6L;
            dy[k] = (down.b[k] - up.b[k]) / 2e-6L;
            size_x = std::fmax(size_x, std::fabs(dx[k]));
            size_y = std::fmax(size_y, std::fabs(dy[k]));
        }
        for (int k = 0; k < 3; ++k) {
            ASSERT_LT(std::fabs(got.ddx[k] - dx[k]), (size_x + size_y) * (1e-4L + 60 * worst) + 1e-8L) << i;
            ASSERT_LT(std::fabs(got.ddy[k] - dy[k]), (size_x + size_y) * (1e-4L + 60 * worst) + 1e-8L) << i;
        }
        ++cases;
    }
    EXPECT_GT(cases, 1000);
}

std::string kind_name(const testing::TestParamInfo<Kind>& info) {
    constexpr const char* kNames[] = {"Ordinary", "Tiny", "Sliver", "BehindTheEye"};
    return kNames[static_cast<int>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(Surface, BarycentricTest,
                         testing::Values(Kind::kOrdinary, Kind::kTiny, Kind::kSliver, Kind::kBehindTheEye), kind_name);

// The midpoint of the picture of an edge is not the midpoint of the edge: what screen-space
// interpolation would get wrong, in closed form: weight of the far end = near / (near + far).
TEST(RAS5_Perspective, EdgeMidpointIsWeightedByDepth) {
    const ClipVertex<float> v[3] = {{-1, -1, 0.1f, 1}, {9, -9, 0.1f, 9}, {0, 3, 0.1f, 3}};
    const Barycentrics<float> b = barycentrics<float>(v, {0, -1}, 1, kWidth, kHeight);
    EXPECT_NEAR(b.b[0], 0.9, 1e-6);
    EXPECT_NEAR(b.b[1], 0.1, 1e-6);
    EXPECT_NEAR(b.b[2], 0, 1e-6);
}

TEST(RAS5_Barycentrics, StayFiniteOnWorthlessTriangles) {
    for (const float s : {1e-30f, 1e-19f, 1e-10f, 1.0f, 1e14f})
        for (const float front : {1.0f, -1.0f}) {
            const ClipVertex<float> good[3] = {{-s, -s, 0, s}, {s, -s, 0, s}, {0, s, 0, s}};
            const ClipVertex<float> line[3] = {{-s, 0, 0, s}, {0, 0, 0, s}, {s, 0, 0, s}};
            const ClipVertex<float> point[3] = {{s, s, 0, s}, {s, s, 0, s}, {s, s, 0, s}};
            for (const auto& v : {good, line, point}) {
                const Barycentrics<float> b =
                    barycentrics<float>({v[0], v[1], v[2]}, {0.1f, -0.2f}, front, kWidth, kHeight);
                float sum = 0;
                for (int k = 0; k < 3; ++k) {
                    ASSERT_TRUE(std::isfinite(b.b[k]) && std::isfinite(b.ddx[k]) && std::isfinite(b.ddy[k])) << s;
                    sum += b.b[k];
                }
                ASSERT_NEAR(sum, 1, 1e-5) << s;
            }
        }
}

}  // namespace
}  // namespace tessera
