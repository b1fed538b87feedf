// The film: exact backgrounds, straight alpha, tone mapping before the background, odd radiances.
#include "shading/film.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <limits>

namespace tessera {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr ToneMap kMaps[] = {ToneMap::kNone, ToneMap::kNeutral, ToneMap::kAces};

TEST(Film, BackgroundKeepsItsExactCodesWhateverTheToneMap) {
    for (const ToneMap map : kMaps)
        for (const float alpha : {1.0f, 0.75f, 0.1f})
            for (int code = 0; code < 256; ++code) {
                const float linear = kSrgbTables.linear[code];
                const FilmView film{17, map, {linear, linear, 0, alpha}};
                const DisplayPixel<float> p = develop<float>(film, {0, 0, 0}, 0);
                ASSERT_EQ(p.r, code);
                ASSERT_EQ(p.g, code);
                ASSERT_EQ(p.b, 0);
                ASSERT_EQ(p.a, std::lround(alpha * 255));
            }
}

TEST(Film, WithoutBackgroundColourIsStraightAndAlphaTheCoverage) {
    const FilmView film{1, ToneMap::kNone, {0.3f, 0.3f, 0.3f, 0}};
    for (int i = 1; i <= 255; ++i) {
        const float a = static_cast<float>(i) / 255;
        const DisplayPixel<float> p = develop<float>(film, Vec3T<float>{0.5f, 0.2f, 1} * a, a);
        ASSERT_EQ(p.r, 188);  // the code of 0.5
        ASSERT_EQ(p.g, 124);  // of 0.2
        ASSERT_EQ(p.b, 255);
        ASSERT_EQ(p.a, i);
    }
    const DisplayPixel<float> empty = develop<float>(film, {0, 0, 0}, 0);
    EXPECT_EQ(empty.r + empty.g + empty.b + empty.a, 0);
}

// Half of a very bright surface over black: mapped to white first, then half of white.
TEST(Film, TonesAreMappedBeforeTheBackground) {
    for (const ToneMap map : kMaps) {
        const FilmView film{1, map, {0, 0, 0, 1}};
        const DisplayPixel<float> half = develop<float>(film, {5e5f, 5e5f, 5e5f}, 0.5f);
        EXPECT_NEAR(half.r, 188, 1);
        EXPECT_EQ(half.a, 255);
        const DisplayPixel<float> over_white = develop<float>({1, map, {1, 1, 1, 1}}, {5e5f, 5e5f, 5e5f}, 0.5f);
        EXPECT_NEAR(over_white.r, 255, 1);
    }
}

TEST(Film, LinearEncodingIsTheNearestCodeOfEveryValue) {
    const FilmView film{1, ToneMap::kNone, {0, 0, 0, 1}, Encoding::kLinear};
    for (int i = 0; i <= 2550; ++i) {
        const float value = static_cast<float>(i) / 2550;
        ASSERT_EQ(develop<float>(film, Vec3T<float>::splat(value), 1).r, static_cast<int>(value * 255.0f + 0.5f)) << i;
    }
    EXPECT_EQ(develop<float>(film, Vec3T<float>::splat(-3), 1).g, 0);
    EXPECT_EQ(develop<float>(film, Vec3T<float>::splat(kNan), 1).g, 0);
    EXPECT_EQ(develop<float>(film, Vec3T<float>::splat(1e30f), 1).g, 255);
}

TEST(Film, ExposureIsAFactor) {
    for (const float exposure : {0.25f, 1.0f, 8.0f}) {
        const DisplayPixel<float> p =
            develop<float>({exposure, ToneMap::kNone, {0, 0, 0, 1}}, Vec3T<float>::splat(0.5f / exposure), 1);
        EXPECT_EQ(p.r, 188);
    }
}

TEST(Film, OddRadiancesBecomeBlackOrWhite) {
    for (const ToneMap map : kMaps) {
        const FilmView film{1, map, {0, 0, 0, 1}};
        EXPECT_EQ(develop<float>(film, Vec3T<float>::splat(kNan), 1).g, 0);
        EXPECT_EQ(develop<float>(film, Vec3T<float>::splat(-3), 1).g, 0);
        EXPECT_EQ(develop<float>(film, Vec3T<float>::splat(-kInfinity), 1).g, 0);
        EXPECT_GE(develop<float>(film, Vec3T<float>::splat(kInfinity), 1).g, 254);
        for (const float coverage : {0.0f, 1e-45f, 1e-20f, 2.0f, -1.0f, kNan, kInfinity})
            for (const float radiance : {0.0f, 1e-30f, 3e38f, kInfinity, kNan}) {
                const DisplayPixel<float> p = develop(film, Vec3T<float>::splat(radiance), coverage);
                for (const int v : {p.r, p.g, p.b, p.a}) {
                    ASSERT_GE(v, 0);
                    ASSERT_LE(v, 255);
                }
            }
    }
}

}  // namespace
}  // namespace tessera
