// RAS1, RAS5: out-codes and snapping against their definitions.
#include "shading/surface.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace tessera {
namespace {

using test::Real;

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

}  // namespace
}  // namespace tessera
