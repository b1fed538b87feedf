// Colormaps against their published numbers and properties, and planes drawn through them.
#include "core/fp_environment.h"
#include "image/pictures.h"

#include <tessera/error.h>
#include <tessera/planes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace tessera {
namespace {

using test::same_pixels;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Image floats(const std::vector<float>& values) {
    Image plane(static_cast<int>(values.size()), 1, PixelFormat::kF32);
    std::copy(values.begin(), values.end(), plane.data<float>());
    return plane;
}

Image integers(const std::vector<std::uint32_t>& values) {
    Image plane(static_cast<int>(values.size()), 1, PixelFormat::kU32);
    std::copy(values.begin(), values.end(), plane.data<std::uint32_t>());
    return plane;
}

std::vector<Rgba8> colors_of(const Image& image) {
    const auto* p = image.data<std::uint8_t>();
    std::vector<Rgba8> colors;
    for (std::size_t i = 0; i < image.bytes().size(); i += 4) colors.push_back({p[i], p[i + 1], p[i + 2], p[i + 3]});
    return colors;
}

void expect_color(Rgba8 c, double r, double g, double b, double tolerance = 0.5) {
    EXPECT_NEAR(c.r, 255 * r, tolerance);
    EXPECT_NEAR(c.g, 255 * g, tolerance);
    EXPECT_NEAR(c.b, 255 * b, tolerance);
    EXPECT_EQ(c.a, 255);
}

// L* of CIE 1976, by the standard's formulas.
double lightness(Rgba8 c) {
    const auto linear = [](int code) {
        const double v = code / 255.0;
        return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    };
    const double y = 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
    return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : 24389.0 / 27 * y;
}

TEST(Colormap, Fb2EndsAndMiddlesAreThePublishedOnes) {
    expect_color(entries(Colormap::kViridis)[0], 0.267004, 0.004874, 0.329415);
    expect_color(entries(Colormap::kViridis)[128], 0.127568, 0.566949, 0.550556);
    expect_color(entries(Colormap::kViridis)[255], 0.993248, 0.906157, 0.143936);
    expect_color(entries(Colormap::kMagma)[0], 0.001462, 0.000466, 0.013866);
    expect_color(entries(Colormap::kMagma)[128], 0.716387, 0.214982, 0.475290);
    expect_color(entries(Colormap::kMagma)[255], 0.987053, 0.991438, 0.749504);
    expect_color(entries(Colormap::kTurbo)[0], 0.18995, 0.07176, 0.23217);
    expect_color(entries(Colormap::kTurbo)[128], 0.64362, 0.98999, 0.23356);
    expect_color(entries(Colormap::kTurbo)[255], 0.47960, 0.01583, 0.01055);
    for (int i = 0; i < 256; ++i)
        expect_color(entries(Colormap::kGrey)[static_cast<std::size_t>(i)], i / 255.0, i / 255.0, i / 255.0);
}

// The polynomials that were published with turbo as an approximation: red, green, blue.
TEST(Colormap, Fb2TurboIsNearItsPolynomials) {
    constexpr double kPolynomials[3][6]{
        {0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396, 59.28637943},
        {0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604},
        {0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973}};
    for (std::size_t i = 13; i < 243; ++i) {
        double rgb[3]{};
        for (int k = 0; k < 3; ++k)
            for (int p = 5; p >= 0; --p) rgb[k] = rgb[k] * static_cast<double>(i) / 255 + kPolynomials[k][p];
        expect_color(entries(Colormap::kTurbo)[i], rgb[0], rgb[1], rgb[2], 22);
    }
}

TEST(Colormap, Fb2LightnessRises) {
    for (const Colormap map : {Colormap::kGrey, Colormap::kViridis, Colormap::kMagma}) {
        const auto& colors = entries(map);
        const double first = lightness(colors[0]), last = lightness(colors[255]);
        EXPECT_GT(last - first, 70) << name(map);
        for (std::size_t i = 1; i < 256; ++i) {
            EXPECT_GT(lightness(colors[i]), lightness(colors[i - 1]) - 0.05) << name(map) << ' ' << i;
            if (i < 4) continue;
            EXPECT_GT(lightness(colors[i]), lightness(colors[i - 4])) << name(map) << ' ' << i;
            // Evenly, near a straight line.
            EXPECT_NEAR(lightness(colors[i]), first + (last - first) * static_cast<double>(i) / 255, 6)
                << name(map) << ' ' << i;
        }
    }
    // Turbo rises to one summit and falls again.
    const auto& turbo = entries(Colormap::kTurbo);
    std::size_t top = 0;
    for (std::size_t i = 1; i < 256; ++i)
        if (lightness(turbo[i]) > lightness(turbo[top])) top = i;
    EXPECT_NEAR(static_cast<double>(top), 128, 32);
    for (std::size_t i = 8; i < 256; i += 8) {
        if (i > top && i - 8 < top) continue;
        EXPECT_EQ(lightness(turbo[i]) > lightness(turbo[i - 8]), i <= top) << i;
    }
}

TEST(Colormap, Names) {
    for (const Colormap map : {Colormap::kGrey, Colormap::kViridis, Colormap::kMagma, Colormap::kTurbo, Colormap::kIds})
        EXPECT_EQ(colormap_named(name(map)), map);
    EXPECT_EQ(colormap_named("jet"), std::nullopt);
    EXPECT_EQ(colormap_named(""), std::nullopt);
}

TEST(Colormap, Fb2RangeIsCutIntoEqualSteps) {
    // Of 0 .. 1023 each entry takes four numbers; the top one is in the last step.
    std::vector<std::uint32_t> numbers(1024);
    for (std::uint32_t i = 0; i < 1024; ++i) numbers[i] = i;
    const Image plane = integers(numbers);
    std::vector<Rgba8> colors = colors_of(apply_colormap(plane, Colormap::kGrey, ValueRange{0, 1024}));
    for (std::uint32_t i = 0; i < 1024; ++i) EXPECT_EQ(colors[i].r, i / 4);
    colors = colors_of(apply_colormap(plane, Colormap::kGrey));
    for (std::uint32_t i = 0; i < 1024; ++i) EXPECT_EQ(colors[i].r, i == 1023 ? 255 : i * 256 / 1023);

    colors = colors_of(apply_colormap(floats({-5, 1, 1.5f, 2, 9}), Colormap::kViridis, ValueRange{1, 2}));
    const auto& viridis = entries(Colormap::kViridis);
    EXPECT_EQ(colors, (std::vector<Rgba8>{viridis[0], viridis[0], viridis[128], viridis[255], viridis[255]}));
    // Integers beyond the precision of float stay apart.
    colors = colors_of(apply_colormap(integers({4294967294u, 4294967295u}), Colormap::kGrey));
    EXPECT_EQ(colors, (std::vector<Rgba8>{{0, 0, 0}, {255, 255, 255}}));
}

TEST(Colormap, WhatIsNotFiniteIsTransparent) {
    constexpr Rgba8 kClear{0, 0, 0, 0};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Image plane = floats({kInfinity, 3, nan, 5, -kInfinity});
    EXPECT_EQ(finite_range(plane), (ValueRange{3, 5}));
    const auto& magma = entries(Colormap::kMagma);
    EXPECT_EQ(colors_of(apply_colormap(plane, Colormap::kMagma)),
              (std::vector<Rgba8>{kClear, magma[0], kClear, magma[255], kClear}));
    EXPECT_EQ(finite_range(floats({nan, kInfinity})), std::nullopt);
    EXPECT_EQ(colors_of(apply_colormap(floats({nan}), Colormap::kMagma)), std::vector<Rgba8>{kClear});
    EXPECT_EQ(colors_of(apply_colormap(floats({7, 7}), Colormap::kMagma)), (std::vector<Rgba8>{magma[0], magma[0]}));
    // From one end of the numbers to the other.
    const float largest = std::numeric_limits<float>::max();
    EXPECT_EQ(colors_of(apply_colormap(floats({-largest, 0, largest}), Colormap::kMagma)),
              (std::vector<Rgba8>{magma[0], magma[128], magma[255]}));
}

// The hue in degrees, by the definition of HSV.
double hue(Rgba8 c) {
    const double high = std::max({c.r, c.g, c.b}), spread = high - std::min({c.r, c.g, c.b});
    const double edge = high == c.r   ? (c.g - c.b) / spread
                        : high == c.g ? 2 + (c.b - c.r) / spread
                                      : 4 + (c.r - c.g) / spread;
    return 60 * (edge < 0 ? edge + 6 : edge);
}

TEST(Colormap, Fb2IdsHaveColoursOfTheirOwn) {
    EXPECT_EQ(id_color(0), (Rgba8{0, 0, 0}));
    std::set<std::tuple<int, int, int>> seen;
    for (const std::uint32_t first : {1u, 1000000u, 4294966295u})
        for (std::uint32_t id = first; id < first + 1000; ++id) {
            const Rgba8 c = id_color(id), next = id_color(id + 1);
            EXPECT_GE(std::max({c.r, c.g, c.b}), 150) << id;
            if (id + 1 == 0) continue;
            const double turn = std::fmod(hue(next) - hue(c) + 360, 360);
            EXPECT_NEAR(turn, 360 * 0.6180339887, 3) << id;  // 8 bits tell a hue of weak colours to about a degree
            if (first == 1) seen.insert({c.r, c.g, c.b});
        }
    EXPECT_EQ(seen.size(), 1000u);

    const Image plane = integers({0, 1, 77, 4294967295u});
    EXPECT_EQ(colors_of(apply_colormap(plane, Colormap::kIds)),
              (std::vector<Rgba8>{{0, 0, 0}, id_color(1), id_color(77), id_color(4294967295u)}));
    EXPECT_EQ(entries(Colormap::kIds)[77], id_color(77));
    EXPECT_THROW(apply_colormap(floats({1}), Colormap::kIds), Error);
}

TEST(Colormap, Fb2IndexPlanesHave2ToTheNEntries) {
    std::vector<float> ramp(1000);
    for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<float>(i);
    const Image plane = floats(ramp);
    for (int bits = 1; bits <= 8; ++bits) {
        const IndexedImage indexed = index_plane(plane, Colormap::kViridis, bits, ValueRange{0, 1000});
        const int count = 1 << bits;
        ASSERT_EQ(indexed.colormap.size(), static_cast<std::size_t>(count));
        EXPECT_EQ(indexed.bits, bits);
        EXPECT_EQ(indexed.colormap.front(), entries(Colormap::kViridis).front());
        EXPECT_EQ(indexed.colormap.back(), entries(Colormap::kViridis).back());
        for (int i = 0; i < 1000; ++i)
            EXPECT_EQ(indexed.indices[static_cast<std::size_t>(i)], i * count / 1000) << bits;
    }
    EXPECT_TRUE(same_pixels(to_rgba8(index_plane(plane, Colormap::kTurbo)), apply_colormap(plane, Colormap::kTurbo)));

    const IndexedImage holes = index_plane(floats({0, kInfinity, 1}), Colormap::kGrey, 2);
    EXPECT_EQ(holes.indices, (std::vector<std::uint8_t>{1, 0, 3}));
    EXPECT_EQ(holes.colormap, (std::vector<Rgba8>{{0, 0, 0, 0}, {0, 0, 0}, {128, 128, 128}, {255, 255, 255}}));
    EXPECT_EQ(index_plane(floats({0, kInfinity, 1}), Colormap::kGrey, 1).indices, (std::vector<std::uint8_t>{1, 0, 1}));

    const IndexedImage ids = index_plane(integers({0, 3, 2}), Colormap::kIds, 2);
    EXPECT_EQ(ids.indices, (std::vector<std::uint8_t>{0, 3, 2}));
    EXPECT_TRUE(same_pixels(to_rgba8(ids), apply_colormap(integers({0, 3, 2}), Colormap::kIds)));
    EXPECT_THROW(index_plane(integers({4}), Colormap::kIds, 2), Error);
}

TEST(Colormap, RefusesWhatMakesNoSense) {
    const Image plane = floats({1, 2});
    const double infinity = std::numeric_limits<double>::infinity();
    for (const ValueRange range : {ValueRange{2, 1}, ValueRange{0, infinity}, ValueRange{-1.7e308, 1.7e308},
                                   ValueRange{std::numeric_limits<double>::quiet_NaN(), 1}})
        EXPECT_THROW(apply_colormap(plane, Colormap::kGrey, range), Error);
    EXPECT_THROW(apply_colormap(Image(), Colormap::kGrey), Error);
    EXPECT_THROW(apply_colormap(Image(2, 2, PixelFormat::kRgba8), Colormap::kGrey), Error);
    EXPECT_THROW(index_plane(plane, Colormap::kGrey, 0), Error);
    EXPECT_THROW(index_plane(plane, Colormap::kGrey, 9), Error);
    EXPECT_THROW(entries(static_cast<Colormap>(9)), Error);
}

}  // namespace
}  // namespace tessera
