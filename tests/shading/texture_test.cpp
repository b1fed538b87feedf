// TEX1: wrap modes, filters, mip levels and colour decoding of texture lookups, against tables written
// by hand, the definition in long double and the sRGB curve. Texels around the texture are guards: no
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
// Red of a lookup in 1/32767.
double red(TestTexture& t, float u, float v) { return static_cast<double>(sample(t, u, v).x) * 32767; }

Texel grey15(int c) {
    const auto channel = static_cast<std::int16_t>(c);
    return {{channel, channel, channel, channel}};
}

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
        for (int x = 0; x < 4; ++x) t.set(0, x, y, grey15(16 * y + x));
    for (const Row& row : kTable) {
        const std::pair<Wrap, int> modes[] = {
            {Wrap::kRepeat, row.repeat}, {Wrap::kMirror, row.mirror}, {Wrap::kClamp, row.clamp}};
        for (const auto& [mode, want] : modes) {
            t.view().wrap_s = mode;
            t.view().wrap_t = Wrap::kClamp;
            EXPECT_EQ(std::lround(red(t, row.u, 0.6f)), 32 + want)
                << "u " << row.u << ", mode " << static_cast<int>(mode);
            t.view().wrap_t = mode;
            t.view().wrap_s = Wrap::kClamp;
            EXPECT_EQ(std::lround(red(t, 0.3f, row.u)), 16 * want + 1)
                << "v " << row.u << ", mode " << static_cast<int>(mode);
        }
    }
}

// Between the last texel and the first one bilinear filtering mixes what the mode says lies there.
TEST(TEX1_Wrap, BilinearAcrossTheBorder) {
    TestTexture t(4, 1, 1, 1);
    for (int x = 0; x < 4; ++x) t.set(0, x, 0, grey15(x == 0 ? 4000 : x == 3 ? 20000 : 10000));
    const auto at = [&](Wrap mode, float u) {
        t.view().wrap_s = mode;
        return red(t, u, 0.5f);
    };
    EXPECT_NEAR(at(Wrap::kRepeat, 0.0f), 12000, 0.01);  // half of texel 3, half of texel 0
    EXPECT_NEAR(at(Wrap::kRepeat, 1.0f), 12000, 0.01);
    EXPECT_NEAR(at(Wrap::kRepeat, 1.0625f), 8000, 0.01);  // a quarter of texel 3
    EXPECT_NEAR(at(Wrap::kRepeat, -0.0625f), 16000, 0.01);
    EXPECT_NEAR(at(Wrap::kMirror, 0.0f), 4000, 0.01);
    EXPECT_NEAR(at(Wrap::kMirror, 1.0f), 20000, 0.01);
    EXPECT_NEAR(at(Wrap::kMirror, 1.25f), 15000, 0.01);  // between texels 3 and 2
    EXPECT_NEAR(at(Wrap::kClamp, -0.5f), 4000, 0.01);
    EXPECT_NEAR(at(Wrap::kClamp, 0.0625f), 4000, 0.01);
    EXPECT_NEAR(at(Wrap::kClamp, 7.0f), 20000, 0.01);
    EXPECT_NEAR(at(Wrap::kClamp, kInfinity), 20000, 0.01);
    EXPECT_NEAR(at(Wrap::kClamp, -kInfinity), 4000, 0.01);
}

// Guards are white, and texels at most half of it: a lookup that touches a guard shows. Where nothing
// is repeated, the border is a guard as well.
TEST(TEX1_Wrap, NoCoordinateReadsOutsideTheTexture) {
    const float coordinates[] = {0.0f,  -0.0f,   1.0f,        -1.0f,    0.99999994f, 1.0000001f,  -1e-9f,
                                 1e-9f, -1e-45f, 0.5f,        -0.5f,    2.0f,        1e6f,        -1e6f,
                                 1e9f,  -1e9f,   1e30f,       -3.4e38f, 3.4e38f,     kInfinity,   -kInfinity,
                                 kNan,  16384,   0.33333334f, 8388609,  -8388607.5f, 999999936.0f};
    const float steps[] = {0, 1e-30f, 0.01f, 1, 1e30f, kInfinity, kNan};
    for (const auto& [w, h, levels] : {std::array{1, 1, 1}, {4, 4, 3}, {7, 3, 3}, {5, 1, 3}, {1, 9, 4}}) {
        TestTexture t(w, h, levels, 3);
        for (int level = 0; level < levels; ++level)
            for (int y = 0; y < t.height(level); ++y)
                for (int x = 0; x < t.width(level); ++x) {
                    Texel texel = t.texel(level, x, y);
                    for (std::int16_t& c : texel.c) c &= 0x3fff;
                    t.set(level, x, y, texel);
                }
        for (const Wrap s : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
            for (int level = 0; level < levels && s != Wrap::kRepeat; ++level) t.spoil_border(level);
            for (const MipFilter mip : {MipFilter::kNone, MipFilter::kNearest, MipFilter::kLinear})
                for (const bool linear : {false, true}) {
                    t.view().wrap_s = t.view().wrap_t = s;
                    t.view().mip = mip;
                    t.view().mag_linear = t.view().min_linear = linear;
                    for (const float u : coordinates)
                        for (const float v : coordinates)
                            for (const float step : steps) {
                                const Vec4T<float> c = sample(t, u, v, {step, 0, 0, step});
                                ASSERT_TRUE(c.x < 0.5001f && c.y < 0.5001f && c.z < 0.5001f && c.w < 0.5001f)
                                    << u << " " << v << " " << step << " in " << w << " x " << h;
                                ASSERT_TRUE(c.x >= 0 && c.w >= 0);
                            }
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
            for (int k = 0; k < 4; ++k) ASSERT_FLOAT_EQ(channels[k], static_cast<float>(t.value(0, x, y, k)));
        }
    }
}

// --- the definition, OpenGL 4.6, section 8.14, in long double ---------------------------------

Real texel_by_index(TestTexture& t, int level, std::int64_t x, std::int64_t y, int c) {
    const auto wrapped = [](std::int64_t i, std::int64_t size, Wrap mode) {
        if (mode == Wrap::kClamp) return std::clamp<std::int64_t>(i, 0, size - 1);
        const std::int64_t period = mode == Wrap::kRepeat ? size : 2 * size, k = (i % period + period) % period;
        return k < size ? k : period - 1 - k;
    };
    return t.value(level, static_cast<int>(wrapped(x, t.width(level), t.view().wrap_s)),
                   static_cast<int>(wrapped(y, t.height(level), t.view().wrap_t)), c);
}

Real by_definition(TestTexture& t, int level, Real u, Real v, bool linear, int c) {
    const Real x = u * t.width(level), y = v * t.height(level);
    const auto texel = [&](Real i, Real j) {
        return texel_by_index(t, level, static_cast<std::int64_t>(i), static_cast<std::int64_t>(j), c);
    };
    if (!linear) return texel(std::floor(x), std::floor(y));
    const Real x0 = std::floor(x - 0.5L), y0 = std::floor(y - 0.5L), fx = x - 0.5L - x0, fy = y - 0.5L - y0;
    return (texel(x0, y0) * (1 - fx) + texel(x0 + 1, y0) * fx) * (1 - fy) +
           (texel(x0, y0 + 1) * (1 - fx) + texel(x0 + 1, y0 + 1) * fx) * fy;
}

// Whether rounding may decide which of two texels holds the point.
bool at_a_border(Real u, int size) { return std::fabs(u * size - std::round(u * size)) < 1e-4L * (1 + std::fabs(u)); }

// The bound, in steps of 1/32767 for texels as far apart as they can be. Along each axis the weight is rounded
// to the nearest 1/32768 (half a step) and so is the mix (half a step); position and size are multiplied
// and half a texel is added in float, an error of at most `size` 2^-23 texels, 2^15 steps each. Between levels:
// the weight, the mix, a quarter of a step for the logarithm; the float footprint adds less than a tenth.
// Converting to float is exact to 2^-24.
double bound(TestTexture& t, bool mips) {
    const double position = (t.width(0) + t.height(0)) * 0x1p-23 * 0x1p15;
    return (2 * (0.5 + 0.5) + position + (mips ? 0.5 + 0.5 + 0.25 + 0.1 : 0) + 0.01) / 32767;
}

TEST(TEX1_Filter, EveryFilterIsItsDefinition) {
    test::Random random(6);
    for (const auto& [w, h, levels] :
         {std::array{1, 1, 1}, {2, 1, 2}, {3, 3, 2}, {16, 8, 5}, {37, 5, 6}, {64, 64, 7}}) {
        TestTexture t(w, h, levels, static_cast<std::uint32_t>(w + h));
        // Neighbours as far apart as they can be, here and there.
        for (int i = 0; i < w * h / 4; ++i)
            t.set(0, static_cast<int>(random.below(static_cast<std::uint32_t>(w))),
                  static_cast<int>(random.below(static_cast<std::uint32_t>(h))), grey15(i % 2 ? 32767 : 0));
        for (int i = 0; i < 40000; ++i) {
            TextureView& view = t.view();
            view.wrap_s = static_cast<Wrap>(random.below(3));
            view.wrap_t = static_cast<Wrap>(random.below(3));
            view.mip = static_cast<MipFilter>(random.below(3));
            view.mag_linear = random.below(4) != 0;
            view.min_linear = random.below(4) != 0;
            const float reach = i % 16 == 0 ? 1000.0f : i % 4 ? 2.0f : 0.1f;
            // A third of the points lie on the grid of quarter texels, where borders and centres are.
            float u = random.in(-reach, 1 + reach), v = random.in(-reach, 1 + reach);
            if (i % 3 == 0) {
                u = std::round(u * static_cast<float>(4 * w)) / static_cast<float>(4 * w);
                v = std::round(v * static_cast<float>(4 * h)) / static_cast<float>(4 * h);
            }
            const float size = std::exp2(random.in(-3, 8)), turn = random.in(0, 6.3f), thin = random.in(0, 1);
            const auto fw = static_cast<float>(w), fh = static_cast<float>(h);
            const Footprint<float> d{size * std::cos(turn) / fw, size * std::sin(turn) / fh,
                                     -size * thin * std::sin(turn) / fw, size * thin * std::cos(turn) / fh};
            const auto length = [&](float x, float y) {
                return std::hypot(static_cast<Real>(x) * t.width(0), static_cast<Real>(y) * t.height(0));
            };
            const Real lod = std::log2(std::fmax(length(d.ux, d.vx), length(d.uy, d.vy)));
            const Real level = std::clamp<Real>(lod, 0, levels - 1);
            if (std::fabs(lod) < 1e-5L) continue;  // either filter
            const bool linear = lod > 0 ? view.min_linear : view.mag_linear;
            int first = 0;
            Real mixed = 0;
            if (view.mip == MipFilter::kLinear) {
                first = static_cast<int>(level);
                mixed = level - first;
            } else if (view.mip == MipFilter::kNearest) {
                if (std::fabs(level - std::floor(level) - 0.5L) < 1e-4L) continue;
                first = static_cast<int>(std::lround(level));
            }
            const int second = std::min(first + 1, levels - 1);
            if (!linear && (at_a_border(u, t.width(first)) || at_a_border(v, t.height(first)) ||
                            at_a_border(u, t.width(second)) || at_a_border(v, t.height(second))))
                continue;
            const Vec4T<float> c = sample(t, u, v, d);
            const float channels[4] = {c.x, c.y, c.z, c.w};
            for (int k = 0; k < 4; ++k) {
                const Real want = by_definition(t, first, u, v, linear, k) * (1 - mixed) +
                                  by_definition(t, second, u, v, linear, k) * mixed;
                ASSERT_NEAR(channels[k], static_cast<double>(want), bound(t, mixed > 0))
                    << u << " " << v << " in " << w << " x " << h << ", level " << level << ", wrap "
                    << static_cast<int>(view.wrap_s) << static_cast<int>(view.wrap_t) << ", linear " << linear;
            }
        }
    }
}

// Nothing between two texels is left out of 0 .. 1, and equal texels give themselves, exactly.
TEST(TEX1_Filter, ConstantTexturesAreExact) {
    TestTexture t(5, 3, 3, 1);
    test::Random random(8);
    for (const int c : {0, 1, 16384, 32766, 32767}) {
        for (int level = 0; level < 3; ++level) t.fill(level, grey15(c));
        for (int i = 0; i < 1000; ++i) {
            const float step = random.in(0, 1);
            ASSERT_EQ(sample(t, random.in(-2, 3), random.in(-2, 3), {step, 0, 0, step}).y,
                      static_cast<float>(c) * (1.0f / 32767));
        }
    }
    EXPECT_EQ(sample(t, 0.1f, 0.1f).y, 1);
}

// Level k is 4000 k: the sampled value tells the level, to 1/8000 and the weight's half step.
class LevelTexture : public TestTexture {
  public:
    LevelTexture(int width, int height, int levels) : TestTexture(width, height, levels, 1) {
        for (int level = 0; level < levels; ++level) fill(level, grey15(4000 * level));
    }
    double level(const Footprint<float>& d) {
        return static_cast<double>(sample_texture(view(), 0.3f, 0.6f, d).x) * 32767 / 4000;
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

// A picture of one row of greys, as a base colour texture.
class ColorRow {
  public:
    explicit ColorRow(const std::vector<int>& codes) {
        Image image(static_cast<int>(codes.size()), 1, PixelFormat::kRgba8);
        for (std::size_t i = 0; i < image.bytes().size(); ++i) image.bytes()[i] = static_cast<std::byte>(codes[i / 4]);
        chain_ = make_mip_chain(image, true);
    }
    Vec4T<float> at(float u) const { return sample_texture(texture_view(chain_, {}), u, 0.5f, {0, 0, 0, 0}); }

  private:
    MipChain chain_;
};

TEST(TEX1_Srgb, AllCodesComeBackFromTextureAndFilm) {
    FilmView film{1, ToneMap::kNone, {0, 0, 0, 1}};
    float last = -1;
    for (int code = 0; code < 256; ++code) {
        const Vec4T<float> c = ColorRow({code}).at(0.5f);
        EXPECT_NEAR(c.w, code / 255.0, 0.5 / 32767 + 1e-7);  // alpha is linear
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
    const Vec4T<float> c = ColorRow({0, 255}).at(0.5f);
    EXPECT_NEAR(c.x, 0.5f, 0.5 / 32767 + 1e-7);
    EXPECT_EQ(develop(FilmView{1, ToneMap::kNone, {0, 0, 0, 1}}, c.xyz(), 1.0f).r, 188);
}

}  // namespace
}  // namespace tessera
