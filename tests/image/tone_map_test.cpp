#include "image/tone_map.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace tessera {
namespace {

using Rgb = std::array<float, 3>;
using Map = void (*)(float&, float&, float&);

void none(float& r, float& g, float& b) { tone_map_none(r, g, b); }
void neutral(float& r, float& g, float& b) { tone_map_neutral(r, g, b); }
void aces(float& r, float& g, float& b) { tone_map_aces(r, g, b); }

Rgb apply(Map map, Rgb c) {
    map(c[0], c[1], c[2]);
    return c;
}

class ToneMaps : public testing::TestWithParam<Map> {};

TEST_P(ToneMaps, StayInRange) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> exponent(-30, 30);
    for (int i = 0; i < 20000; ++i) {
        const Rgb c =
            apply(GetParam(), {std::exp2(exponent(random)), std::exp2(exponent(random)), std::exp2(exponent(random))});
        for (const float v : c) ASSERT_TRUE(v >= 0 && v <= 1) << v;
    }
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const float special :
         {kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), -1.0f, -0.0f, 1e-42f, 3e38f})
        for (const float other : {0.0f, 0.5f, special})
            for (const float v : apply(GetParam(), {special, other, 0.25f})) EXPECT_TRUE(v >= 0 && v <= 1) << special;
}

TEST_P(ToneMaps, BlackIsBlackAndMoreLightIsNeverDarker) {
    EXPECT_EQ(apply(GetParam(), {0, 0, 0}), (Rgb{0, 0, 0}));
    float last = 0;
    for (float v = 0; v < 100; v += v < 2 ? 0.001f : 0.1f) {
        const float out = apply(GetParam(), {v, v, v})[1];
        ASSERT_GE(out, last) << v;
        last = out;
    }
    EXPECT_GT(last, 0.98f);
}

TEST_P(ToneMaps, GreyStaysGrey) {
    for (float v = 0.01f; v < 50; v *= 1.3f) {
        const Rgb c = apply(GetParam(), {v, v, v});
        EXPECT_NEAR(c[0], c[1], 2e-5);
        EXPECT_NEAR(c[0], c[2], 2e-5);
    }
}

INSTANTIATE_TEST_SUITE_P(All, ToneMaps, testing::Values(none, neutral, aces));

TEST(ToneMapNone, KeepsWhatFits) {
    EXPECT_EQ(apply(none, {0.1f, 0.9f, 1}), (Rgb{0.1f, 0.9f, 1}));
    EXPECT_EQ(apply(none, {2, -1, 0.5f}), (Rgb{1, 0, 0.5f}));
}

TEST(ToneMapNeutral, KeepsColoursBelowTheStart) {
    // Less the 4 % reflected by a dielectric, 0.04 for all channels; a rendered base colour has them more.
    const Rgb in{0.5f, 0.3f, 0.2f}, out = apply(neutral, in);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(out[c], in[c] - 0.04f);
    // Near black the offset fades: x - 6.25 x^2 is subtracted, so 6.25 x^2 is left.
    EXPECT_NEAR(apply(neutral, {0.04f, 0.04f, 0.04f})[0], 6.25f * 0.04f * 0.04f, 1e-7);
}

TEST(ToneMapNeutral, CompressesAsSpecified) {
    // By hand from the specification: peak 2 - 0.04 = 1.96, new peak 1 - 0.24^2 / (1.96 + 0.24 - 0.76) = 0.96,
    // white share 1 - 1 / (0.15 (1.96 - 0.96) + 1) = 0.130435.
    const Rgb out = apply(neutral, {2, 1, 0.5f});
    EXPECT_NEAR(out[0], 0.96, 1e-6);
    EXPECT_NEAR(out[1], 0.96 / 1.96 * 0.96 * 0.869565 + 0.96 * 0.130435, 1e-6);
    EXPECT_NEAR(out[2], 0.46 / 1.96 * 0.96 * 0.869565 + 0.96 * 0.130435, 1e-6);
}

TEST(ToneMapNeutral, IsContinuousAtTheStart) {
    const Rgb below = apply(neutral, {0.7999f, 0.4f, 0.2f}), above = apply(neutral, {0.8001f, 0.4f, 0.2f});
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(below[c], above[c], 3e-4);
}

TEST(ToneMapNeutral, KeepsTheHue) {
    // Compression mixes with white after scaling: the middle channel keeps its place between the others.
    std::mt19937 random(5);
    std::uniform_real_distribution<float> value(0.1f, 20);
    for (int i = 0; i < 5000; ++i) {
        const Rgb in{value(random), value(random), value(random)}, out = apply(neutral, in);
        const auto place = [](const Rgb& c) {
            return std::array{static_cast<double>(c[1]) - static_cast<double>(c[0]),
                              static_cast<double>(c[2]) - static_cast<double>(c[0])};
        };
        const auto a = place(in), b = place(out);
        const double scale = std::hypot(a[0], a[1]) * std::hypot(b[0], b[1]);
        if (scale <= 1e-4) continue;
        ASSERT_NEAR((a[0] * b[1] - a[1] * b[0]) / scale, 0, 1e-4);
    }
}

TEST(ToneMapAces, FollowsThePublishedFit) {
    // Grey: the matrices' rows sum to 1 (within 1e-5), so the curve is applied as it is.
    for (const double v : {0.02, 0.18, 1.0, 5.0}) {
        const double curve = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
        EXPECT_NEAR(apply(aces, {static_cast<float>(v), static_cast<float>(v), static_cast<float>(v)})[1],
                    std::min(1.0, curve), 3e-5);
    }
}

}  // namespace
}  // namespace tessera
