// TEX1: wrap modes, filters, mip levels and colour decoding of texture lookups, against tables written
// by hand, exact sums and the sRGB curve in long double. Texels around the texture are guards: no
// coordinate of whatever value reads them.
#include "shading/texture.h"

#include "shading/film.h"
#include "shading/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

using test::Real;
using test::TestTexture;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Vec4T<float> sample(TestTexture& t, float u, float v, Footprint<float> d = {0, 0, 0, 0}) {
    return sample_texture(t.view(), u, v, d);
}
// Red of a nearest lookup as 0 .. 255.
int red(TestTexture& t, float u, float v) { return static_cast<int>(std::lround(sample(t, u, v).x * 255)); }

void make_nearest(TestTexture& t) {
    t.view().mag_linear = t.view().min_linear = false;
    t.view().mip = MipFilter::kNone;
}

// --- wrapping -------------------------------------------------------------------------------

// Which texel of a row of 4 a coordinate means, by the definitions of OpenGL 4.6, section 8.14.2.
TEST(TEX1_Wrap, NearestTexelByTheTable) {
    struct Row {
        float u;
        int repeat, mirror, clamp;
    };
    constexpr Row kTable[] = {
        {0.0f, 0, 0, 0},    {0.125f, 0, 0, 0},   {0.25f, 1, 1, 1}, {0.49f, 1, 1, 1},  {0.5f, 2, 2, 2},
        {0.75f, 3, 3, 3},   {0.99f, 3, 3, 3},    {1.0f, 0, 3, 3},  {1.01f, 0, 3, 3},  {1.3f, 1, 2, 3},
        {1.6f, 2, 1, 3},    {1.99f, 3, 0, 3},    {2.0f, 0, 0, 3},  {2.3f, 1, 1, 3},   {3.1f, 0, 3, 3},
        {-0.01f, 3, 0, 0},  {-0.3f, 2, 1, 0},    {-0.6f, 1, 2, 0}, {-0.99f, 0, 3, 0}, {-1.0f, 0, 3, 0},
        {-1.1f, 3, 3, 0},   {-1.6f, 1, 1, 0},    {-2.0f, 0, 0, 0}, {-2.3f, 2, 1, 0},  {1000.3f, 1, 1, 3},
        {1001.3f, 1, 2, 3}, {-1000.3f, 2, 1, 0}, {1e8f, 0, 0, 3},
    };
    TestTexture t(4, 4, 1, 1);
    make_nearest(t);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) t.texel(0, x, y) = static_cast<std::uint32_t>(16 * y + x);
    for (const Row& row : kTable) {
        const std::pair<Wrap, int> modes[] = {
            {Wrap::kRepeat, row.repeat}, {Wrap::kMirror, row.mirror}, {Wrap::kClamp, row.clamp}};
        for (const auto& [mode, want] : modes) {
            t.view().wrap_s = mode;
            t.view().wrap_t = Wrap::kClamp;
            EXPECT_EQ(red(t, row.u, 0.6f), 32 + want) << "u " << row.u << ", mode " << static_cast<int>(mode);
            t.view().wrap_t = mode;
            t.view().wrap_s = Wrap::kClamp;
            EXPECT_EQ(red(t, 0.3f, row.u), 16 * want + 1) << "v " << row.u << ", mode " << static_cast<int>(mode);
        }
    }
}

// Between the last texel and the first one bilinear filtering mixes what the mode says lies there.
TEST(TEX1_Wrap, BilinearAcrossTheBorder) {
    TestTexture t(4, 1, 1, 1);
    for (int x = 0; x < 4; ++x) t.texel(0, x, 0) = static_cast<std::uint32_t>(x == 0 ? 40 : x == 3 ? 200 : 100);
    const auto at = [&](Wrap mode, float u) {
        t.view().wrap_s = mode;
        return sample(t, u, 0.5f).x * 255;
    };
    EXPECT_NEAR(at(Wrap::kRepeat, 0.0f), 120, 1e-4);  // half of texel 3, half of texel 0
    EXPECT_NEAR(at(Wrap::kRepeat, 1.0f), 120, 1e-4);
    EXPECT_NEAR(at(Wrap::kRepeat, 1.0625f), 80, 1e-4);  // a quarter of texel 3
    EXPECT_NEAR(at(Wrap::kRepeat, -0.0625f), 160, 1e-4);
    EXPECT_NEAR(at(Wrap::kMirror, 0.0f), 40, 1e-4);
    EXPECT_NEAR(at(Wrap::kMirror, 1.0f), 200, 1e-4);
    EXPECT_NEAR(at(Wrap::kMirror, 1.25f), 150, 1e-4);  // between texels 3 and 2
    EXPECT_NEAR(at(Wrap::kClamp, -0.5f), 40, 1e-4);
    EXPECT_NEAR(at(Wrap::kClamp, 0.0625f), 40, 1e-4);
    EXPECT_NEAR(at(Wrap::kClamp, 7.0f), 200, 1e-4);
}

// Every channel of the guards is above that of every texel: a lookup that touches one shows.
TEST(TEX1_Wrap, NoCoordinateReadsOutsideTheTexture) {
    const float coordinates[] = {0.0f,  -0.0f,   1.0f,        -1.0f,    0.99999994f, 1.0000001f,  -1e-9f,
                                 1e-9f, -1e-45f, 0.5f,        -0.5f,    2.0f,        1e6f,        -1e6f,
                                 1e9f,  -1e9f,   1e30f,       -3.4e38f, 3.4e38f,     kInfinity,   -kInfinity,
                                 kNan,  16384,   0.33333334f, 8388609,  -8388607.5f, 999999936.0f};
    const float steps[] = {0, 1e-30f, 0.01f, 1, 1e30f, kInfinity, kNan};
    for (const auto& [w, h, levels] : {std::array{1, 1, 1}, {4, 4, 3}, {7, 3, 3}, {5, 1, 3}, {1, 9, 4}}) {
        TestTexture t(w, h, levels, 3);
        for (int level = 0; level < levels; ++level)
            for (int y = 0; y < t.view().height[level]; ++y)
                for (int x = 0; x < t.view().width[level]; ++x) t.texel(level, x, y) &= 0x7f7f7f7fu;
        for (const Wrap s : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp})
            for (const MipFilter mip : {MipFilter::kNone, MipFilter::kNearest, MipFilter::kLinear})
                for (const bool linear : {false, true}) {
                    t.view().wrap_s = t.view().wrap_t = s;
                    t.view().mip = mip;
                    t.view().mag_linear = t.view().min_linear = linear;
                    for (const float u : coordinates)
                        for (const float v : coordinates)
                            for (const float step : steps) {
                                const Vec4T<float> c = sample(t, u, v, {step, 0, 0, step});
                                // The guard is de ad be ef: all channels above 0x7f.
                                ASSERT_TRUE(c.x <= 0.4981f && c.y <= 0.4981f && c.z <= 0.4981f && c.w <= 0.4981f)
                                    << u << " " << v << " " << step << " in " << w << " x " << h;
                                ASSERT_TRUE(c.x >= 0 && c.w >= 0);
                            }
                }
    }
}

// --- filters --------------------------------------------------------------------------------

TEST(TEX1_Filter, NearestIsTheTexelThatHoldsThePoint) {
    for (const auto& [w, h] : {std::pair{8, 4}, {7, 5}, {13, 1}}) {
        TestTexture t(w, h, 1, 5);
        make_nearest(t);
        test::Random random(5);
        for (int i = 0; i < 5000; ++i) {
            const int x = static_cast<int>(random.below(static_cast<std::uint32_t>(w))),
                      y = static_cast<int>(random.below(static_cast<std::uint32_t>(h)));
            const Vec4T<float> c =
                sample(t, (static_cast<float>(x) + random.in(0.001f, 0.999f)) / static_cast<float>(w),
                       (static_cast<float>(y) + random.in(0.001f, 0.999f)) / static_cast<float>(h));
            const float channels[4] = {c.x, c.y, c.z, c.w};
            for (int k = 0; k < 4; ++k)
                ASSERT_FLOAT_EQ(channels[k], static_cast<float>(t.channel(0, x, y, k)) / 255.0f);
        }
    }
}

TEST(TEX1_Filter, BilinearIsTheWeightedMeanOfFourTexels) {
    TestTexture t(16, 8, 1, 6);
    t.view().wrap_s = Wrap::kRepeat;
    t.view().wrap_t = Wrap::kClamp;
    test::Random random(6);
    for (int i = 0; i < 20000; ++i) {
        const float u = random.in(-1, 2), v = random.in(-0.2f, 1.2f);
        const Real x = static_cast<Real>(u) * 16 - 0.5L, y = std::clamp(static_cast<Real>(v), 0.0L, 1.0L) * 8 - 0.5L;
        const Real x0 = std::floor(x), y0 = std::floor(y), fx = x - x0, fy = y - y0;
        const auto column = [](Real k) { return (static_cast<int>(k) % 16 + 16) % 16; };
        const auto row = [](Real k) { return std::clamp(static_cast<int>(k), 0, 7); };
        const Vec4T<float> c = sample(t, u, v);
        const float channels[4] = {c.x, c.y, c.z, c.w};
        for (int k = 0; k < 4; ++k) {
            const auto texel = [&](Real a, Real b) { return t.channel(0, column(a), row(b), k) / 255.0L; };
            const Real want = (texel(x0, y0) * (1 - fx) + texel(x0 + 1, y0) * fx) * (1 - fy) +
                              (texel(x0, y0 + 1) * (1 - fx) + texel(x0 + 1, y0 + 1) * fx) * fy;
            ASSERT_NEAR(channels[k], static_cast<double>(want), 4e-6) << u << " " << v;
        }
    }
}

// All texels of level k are 20 k: the sampled value tells the level.
class LevelTexture : public TestTexture {
  public:
    LevelTexture(int width, int height, int levels) : TestTexture(width, height, levels, 1) {
        for (int level = 0; level < levels; ++level)
            for (int y = 0; y < view().height[level]; ++y)
                for (int x = 0; x < view().width[level]; ++x)
                    texel(level, x, y) = 0x01010101u * static_cast<std::uint32_t>(20 * level);
    }
    double level(const Footprint<float>& d) {
        return static_cast<double>(sample_texture(view(), 0.3f, 0.6f, d).x) * 255 / 20;
    }
};

TEST(TEX1_Mip, FootprintOfTwoToTheKTexelsTakesLevelK) {
    LevelTexture t(256, 64, 9);
    for (int k = -3; k <= 12; ++k) {
        const double want = std::clamp(k, 0, 8);
        const float across = std::exp2(static_cast<float>(k)) / 256, down = std::exp2(static_cast<float>(k)) / 64;
        EXPECT_NEAR(t.level({across, 0, 0, 0}), want, 1e-4);
        EXPECT_NEAR(t.level({0, down, 0, 0}), want, 1e-4);
        EXPECT_NEAR(t.level({0, 0, -across, 0}), want, 1e-4);
        // The longer side decides: the other one, shorter, changes nothing.
        EXPECT_NEAR(t.level({across / 8, 0, 0, -down}), want, 1e-4);
        // A diagonal footprint is as long as its hypotenuse.
        EXPECT_NEAR(t.level({0.6f * across, 0.8f * down, 0, 0}), want, 1e-4);
    }
}

TEST(TEX1_Mip, TrilinearMixesNeighbouringLevelsByTheLogarithm) {
    LevelTexture t(256, 256, 9);
    for (int i = 0; i <= 800; ++i) {
        const Real lod = i * 0.01L;
        const float step = static_cast<float>(std::exp2(lod) / 256);
        EXPECT_NEAR(t.level({step, 0, 0, step}), static_cast<double>(lod), 2e-4);
    }
    EXPECT_NEAR(t.level({static_cast<float>(std::sqrt(2.0L) * 4 / 256), 0, 0, 0}), 2.5, 1e-4);  // half and half
}

TEST(TEX1_Mip, NearestLevelSwitchesHalfway) {
    LevelTexture t(256, 256, 9);
    t.view().mip = MipFilter::kNearest;
    for (int k = 0; k < 8; ++k) {
        const auto step = [&](float lod) { return std::exp2(static_cast<float>(k) + lod) / 256; };
        EXPECT_NEAR(t.level({step(0.49f), 0, 0, 0}), k, 1e-4);
        EXPECT_NEAR(t.level({step(0.51f), 0, 0, 0}), k + 1, 1e-4);
    }
}

TEST(TEX1_Mip, WithoutMipsOnlyLevelZero) {
    LevelTexture t(64, 64, 7);
    t.view().mip = MipFilter::kNone;
    for (const float step : {0.0f, 0.1f, 10.0f}) EXPECT_EQ(t.level({step, 0, 0, step}), 0);
}

TEST(TEX1_Mip, MagnificationAndMinificationFiltersSwitchAtOneTexel) {
    TestTexture t(16, 16, 1, 9);
    const float u = 0.4f, v = 0.7f;
    for (const MipFilter mip : {MipFilter::kNone, MipFilter::kNearest, MipFilter::kLinear})
        for (const bool mag : {false, true})
            for (const bool min : {false, true}) {
                t.view().mip = mip;
                t.view().mag_linear = t.view().min_linear = true;
                const float smooth = sample(t, u, v).x;
                t.view().mag_linear = t.view().min_linear = false;
                const float hard = sample(t, u, v).x;
                ASSERT_NE(smooth, hard);
                t.view().mag_linear = mag;
                t.view().min_linear = min;
                EXPECT_EQ(sample(t, u, v, {0.99f / 16, 0, 0, 0}).x, mag ? smooth : hard);
                EXPECT_EQ(sample(t, u, v, {1.01f / 16, 0, 0, 0}).x, min ? smooth : hard);
            }
}

// --- colour ---------------------------------------------------------------------------------

Real srgb_curve(Real c) { return c <= 0.04045L ? c / 12.92L : std::pow((c + 0.055L) / 1.055L, 2.4L); }

TEST(TEX1_Srgb, DecodingPolynomialKeepsItsBound) {
    Real worst = 0;
    for (int i = 0; i <= 200000; ++i) {
        const float c = static_cast<float>(i) / 200000.0f;
        worst = std::fmax(worst, std::fabs(texel_to_linear(c) - srgb_curve(c)));
    }
    EXPECT_LT(worst, 6.1e-6L);
    EXPECT_EQ(texel_to_linear(0.0f), 0);
    EXPECT_EQ(texel_to_linear(1.0f), 1);
}

TEST(TEX1_Srgb, AllCodesComeBackFromTextureAndFilm) {
    FilmView film{1, ToneMap::kNone, {0, 0, 0, 1}};
    float last = -1;
    for (int code = 0; code < 256; ++code) {
        TestTexture t(1, 1, 1, 1);
        t.texel(0, 0, 0) = static_cast<std::uint32_t>(code) * 0x01010101u;
        t.view().srgb = true;
        const Vec4T<float> c = sample(t, 0.5f, 0.5f);
        EXPECT_FLOAT_EQ(c.w, static_cast<float>(code) / 255.0f);  // alpha is linear
        EXPECT_GT(c.x, last);
        last = c.x;
        const DisplayPixel<float> p = develop(film, c.xyz(), 1.0f);
        EXPECT_EQ(p.r, code);
        EXPECT_EQ(p.g, code);
        EXPECT_EQ(p.b, code);
        EXPECT_EQ(p.a, 255);
    }
}

// Linear light is mixed, not codes: between black and white lies 0.5, whose code is 188.
TEST(TEX1_Srgb, FilteringMixesLight) {
    TestTexture t(2, 1, 1, 1);
    t.texel(0, 0, 0) = 0xff000000u;
    t.texel(0, 1, 0) = 0xffffffffu;
    t.view().srgb = true;
    EXPECT_FLOAT_EQ(sample(t, 0.5f, 0.5f).x, 0.5f);
    EXPECT_EQ(develop(FilmView{1, ToneMap::kNone, {0, 0, 0, 1}}, sample(t, 0.5f, 0.5f).xyz(), 1.0f).r, 188);
}

}  // namespace
}  // namespace tessera
