// Adaptive palettes by their definitions: the boxes of the median cut, the fixed point of k-means, nearest
// entries by looking at all of them, the light of dithered areas; index planes as PNG read by libpng.
#include "image/palette.h"
#include "core/parallel.h"
#include "image/pictures.h"

#include <tessera/error.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

namespace tessera {
namespace {

using test::flat_picture;
using test::noise_picture;
using test::same_pixels;
using test::sphere_picture;

Image picture_of(int width, const std::vector<Rgba8>& pixels) {
    Image image(width, static_cast<int>(pixels.size()) / width, PixelFormat::kRgba8);
    std::memcpy(image.bytes().data(), pixels.data(), 4 * pixels.size());
    return image;
}

Rgba8 grey(int v) {
    const auto code = static_cast<std::uint8_t>(v);
    return {code, code, code};
}

std::vector<Rgba8> pixels_of(const Image& image) {
    std::vector<Rgba8> pixels(image.bytes().size() / 4);
    std::memcpy(pixels.data(), image.bytes().data(), image.bytes().size());
    return pixels;
}

// Between premultiplied colours, alpha as the fourth coordinate; 0 .. 255 each. Exact: multiples of 2^-16 would
// do, and doubles have more.
double apart(Rgba8 a, Rgba8 b) {
    const auto square = [](double d) { return d * d; };
    return square(a.r * a.a - b.r * b.a) + square(a.g * a.a - b.g * b.a) + square(a.b * a.a - b.b * b.a) +
           square(255.0 * (a.a - b.a));
}

void expect_nearest_entries(const Image& image, const IndexedImage& indexed) {
    const std::vector<Rgba8> pixels = pixels_of(image);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        std::size_t best = 0;
        for (std::size_t e = 1; e < indexed.colormap.size(); ++e)
            if (apart(pixels[i], indexed.colormap[e]) < apart(pixels[i], indexed.colormap[best])) best = e;
        ASSERT_EQ(indexed.indices[i], best) << i;
    }
}

double total_error(const Image& image, const IndexedImage& indexed) {
    const std::vector<Rgba8> pixels = pixels_of(image);
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) sum += apart(pixels[i], indexed.colormap[indexed.indices[i]]);
    return sum;
}

TEST(Palette, Fb2EveryPixelTakesItsNearestEntry) {
    const Image soft = [] {  // alpha from 0 to 255
        Image image = noise_picture(64, 64);
        for (int i = 0; i < 64 * 64; ++i) image.data<std::uint8_t>()[4 * i + 3] = static_cast<std::uint8_t>(i / 16);
        return image;
    }();
    for (const Image& image : {sphere_picture(160, 90), sphere_picture(160, 90, true), noise_picture(60, 60), soft})
        for (const int colors : {2, 3, 16, 100, 256}) {
            const IndexedImage indexed = make_palette(image, {.colors = colors});
            EXPECT_LE(indexed.colormap.size(), static_cast<std::size_t>(colors));
            EXPECT_GE(indexed.colormap.size(), static_cast<std::size_t>(colors == 2 ? 2 : colors * 9 / 10));
            expect_nearest_entries(image, indexed);
        }
}

TEST(Palette, Fb2FewColoursComeOutExact) {
    std::vector<Rgba8> pixels;
    for (int i = 0; i < 600; ++i) {
        const int c = i * 7 % 200;
        pixels.push_back(
            {static_cast<std::uint8_t>(c), static_cast<std::uint8_t>(255 - c), 3, static_cast<std::uint8_t>(c + 1)});
    }
    const Image image = picture_of(30, pixels);
    for (const bool dithered : {false, true}) {
        const IndexedImage exact = make_palette(image, {.colors = 200, .dither = dithered});
        EXPECT_EQ(exact.colormap.size(), 200u);
        EXPECT_EQ(exact.bits, 8);
        EXPECT_TRUE(same_pixels(to_rgba8(exact), image));
    }
    EXPECT_FALSE(same_pixels(to_rgba8(make_palette(image, {.colors = 199})), image));
    EXPECT_EQ(make_palette(flat_picture(3, 3, 9, 8, 7)).colormap, (std::vector<Rgba8>{{9, 8, 7}}));
}

TEST(Palette, Fb2MedianCutGivesTheKnownBoxes) {
    const auto cut = [](const std::vector<int>& greys, int colors) {
        std::vector<Rgba8> pixels;
        for (const int v : greys) pixels.push_back(grey(v));
        std::vector<int> found;
        for (const Rgba8 c : make_palette(picture_of(1, pixels), {.colors = colors, .refinements = 0}).colormap)
            found.push_back(c.r);
        std::sort(found.begin(), found.end());
        return found;
    };
    // {0 10 | 200 210}
    EXPECT_EQ(cut({210, 0, 200, 10}, 2), (std::vector<int>{5, 205}));
    // {0 | 40 | 200 210}: the wider of the two halves is cut next.
    EXPECT_EQ(cut({0, 40, 200, 210}, 3), (std::vector<int>{0, 40, 205}));
    // Half of the pixels, not of the colours: {0 10 20 | 30}, the mean rounded half up.
    EXPECT_EQ(cut({0, 10, 20, 30, 30, 30}, 2), (std::vector<int>{10, 30}));
    // {100 | 110 113}: the median pixel is one of the first colour.
    EXPECT_EQ(cut({100, 100, 100, 110, 113}, 2), (std::vector<int>{100, 112}));

    // Along the channel that spreads: red tells two groups, blue one.
    const Image image = picture_of(4, {{0, 0, 7}, {250, 0, 0}, {4, 0, 0}, {254, 0, 3}});
    const IndexedImage halves = make_palette(image, {.colors = 2, .refinements = 0});
    EXPECT_EQ(halves.indices[0], halves.indices[2]);
    EXPECT_EQ(halves.indices[1], halves.indices[3]);
    EXPECT_NE(halves.indices[0], halves.indices[1]);
}

TEST(Palette, Fb2KMeansEndsWhereEveryEntryIsTheMeanOfItsPixels) {
    const Image image = sphere_picture(96, 64);
    const IndexedImage cut = make_palette(image, {.colors = 12, .refinements = 0});
    const IndexedImage refined = make_palette(image, {.colors = 12, .refinements = 64});
    EXPECT_LT(total_error(image, refined), 0.9 * total_error(image, cut));
    const std::vector<Rgba8> pixels = pixels_of(image);
    for (std::size_t e = 0; e < refined.colormap.size(); ++e) {
        double sum[3]{}, count = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (refined.indices[i] != e) continue;
            sum[0] += pixels[i].r, sum[1] += pixels[i].g, sum[2] += pixels[i].b, count += 1;
        }
        const Rgba8 c = refined.colormap[e];
        EXPECT_NEAR(c.r, sum[0] / count, 0.5);
        EXPECT_NEAR(c.g, sum[1] / count, 0.5);
        EXPECT_NEAR(c.b, sum[2] / count, 0.5);
    }
}

TEST(Palette, Fb2TransparentPixelsHaveTheirOwnEntry) {
    Image image = sphere_picture(160, 90, true);
    image.data<std::uint8_t>()[0] = 99;  // a colour that is not seen
    image.data<std::uint8_t>()[3] = 0;
    for (const bool dithered : {false, true}) {
        const IndexedImage indexed = make_palette(image, {.colors = 16, .dither = dithered});
        EXPECT_EQ(indexed.colormap[0], (Rgba8{0, 0, 0, 0}));
        const std::vector<Rgba8> pixels = pixels_of(image);
        for (std::size_t i = 0; i < pixels.size(); ++i) ASSERT_EQ(indexed.indices[i] == 0, pixels[i].a == 0) << i;
        for (std::size_t e = 1; e < indexed.colormap.size(); ++e) EXPECT_EQ(indexed.colormap[e].a, 255);
    }
}

double linear(int code) {
    const double v = code / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

TEST(Palette, Fb2DitheringKeepsTheMeanOfTheLight) {
    constexpr int kSide = 192;
    const std::vector<Rgba8> palette{{0, 0, 0},   {255, 0, 0},   {0, 255, 0},   {255, 255, 0},
                                     {0, 0, 255}, {255, 0, 255}, {0, 255, 255}, {255, 255, 255}};
    for (const Rgba8 c : {Rgba8{128, 128, 128}, Rgba8{188, 60, 220}, Rgba8{20, 250, 130}, Rgba8{255, 0, 90}}) {
        const std::vector<std::uint8_t> indices = dither(flat_picture(kSide, kSide, c.r, c.g, c.b), palette);
        double light[3]{};
        for (const std::uint8_t i : indices)
            light[0] += palette[i].r / 255, light[1] += palette[i].g / 255, light[2] += palette[i].b / 255;
        // What is lost: less than the error of one pixel for each row's end, and for each pixel of the last row.
        const double pixels = kSide * kSide, bound = (kSide + kSide) / pixels;
        EXPECT_NEAR(light[0] / pixels, linear(c.r), bound);
        EXPECT_NEAR(light[1] / pixels, linear(c.g), bound);
        EXPECT_NEAR(light[2] / pixels, linear(c.b), bound);
    }
}

// Light 1/4 is code 137 of 255, more than half, so the first pixel is white and hands -3/4 on.
TEST(Palette, Fb2DitheringIsFloydSteinbergToAndFro) {
    ASSERT_NEAR(linear(137), 0.25, 0.001);
    const std::vector<Rgba8> palette{{0, 0, 0}, {255, 255, 255}};
    // An independent simulation in doubles, with the display code by its formula.
    constexpr int kWidth = 9, kHeight = 6;
    const std::vector<std::uint8_t> indices = dither(flat_picture(kWidth, kHeight, 137, 137, 137), palette);
    double error[kHeight + 1][kWidth + 2]{};
    for (int y = 0; y < kHeight; ++y)
        for (int i = 0; i < kWidth; ++i) {
            const int d = y % 2 == 0 ? 1 : -1, x = d > 0 ? i : kWidth - 1 - i;
            const double wanted = linear(137) + error[y][x + 1];
            const bool white = wanted > linear(127) / 2 + linear(128) / 2;  // brighter than code 127.5
            EXPECT_EQ(indices[static_cast<std::size_t>(y * kWidth + x)], white ? 1 : 0) << x << ' ' << y;
            const double e = wanted - (white ? 1 : 0);
            error[y][x + 1 + d] += e * 7 / 16;
            error[y + 1][x + 1 - d] += e * 3 / 16, error[y + 1][x + 1] += e * 5 / 16, error[y + 1][x + 1 + d] += e / 16;
        }
}

TEST(Palette, Fb2DitheringNeedsFewerColoursForAGradient) {
    // A grey ramp in eight greys: blocks of 16 x 16 pixels keep their light better when dithered.
    Image ramp(256, 64, PixelFormat::kRgba8);
    for (int i = 0; i < 256 * 64; ++i) {
        const Rgba8 c = grey(i % 256);
        std::memcpy(ramp.data<std::uint8_t>() + 4 * i, &c, 4);
    }
    const auto worst = [&](bool dithered) {
        const Image drawn = to_rgba8(make_palette(ramp, {.colors = 8, .dither = dithered}));
        double largest = 0;
        for (int bx = 3; bx < 13; ++bx) {  // away from the ends, where no mixture reaches
            double sum = 0;
            for (int y = 16; y < 32; ++y)
                for (int x = 16 * bx; x < 16 * bx + 16; ++x)
                    sum += linear(drawn.data<std::uint8_t>()[4 * (256 * y + x)]) - linear(x);
            largest = std::max(largest, std::abs(sum) / 256);
        }
        return largest;
    };
    EXPECT_LT(worst(true), worst(false) / 3);
}

TEST(Palette, BytesDoNotDependOnThreads) {
    const Image image = sphere_picture(320, 200, true);
    for (const bool dithered : {false, true}) {
        const IndexedImage one = make_palette(image, {.colors = 64, .dither = dithered, .threads = 1});
        for (const int threads : {2, 5}) {
            const IndexedImage more = make_palette(image, {.colors = 64, .dither = dithered, .threads = threads});
            EXPECT_EQ(one.indices, more.indices);
            EXPECT_EQ(one.colormap, more.colormap);
        }
    }
}

TEST(Palette, RefusesWhatMakesNoSense) {
    const Image image = flat_picture(2, 2, 1, 2, 3);
    for (const PaletteOptions& options :
         {PaletteOptions{.colors = 1}, PaletteOptions{.colors = 257}, PaletteOptions{.refinements = -1},
          PaletteOptions{.refinements = 65}, PaletteOptions{.threads = -1}})
        EXPECT_THROW(make_palette(image, options), Error);
    EXPECT_THROW(make_palette(Image()), Error);
    EXPECT_THROW(make_palette(Image(2, 2, PixelFormat::kU32)), Error);
}

// --- index planes ---------------------------------------------------------------------------

IndexedImage indices_of(int width, int height, int colors, bool transparent) {
    IndexedImage image;
    image.width = width, image.height = height;
    for (int i = 0; i < width * height; ++i)
        image.indices.push_back(static_cast<std::uint8_t>((i * i + i / 3) % colors));
    for (int i = 0; i < colors; ++i)
        image.colormap.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i), 40,
                                  static_cast<std::uint8_t>(transparent && i < 3 ? 100 * i : 255)});
    return image;
}

TEST(IndexedPng, Fb2IsReadByLibpngAsItIs) {
    const std::map<int, int> bits{{1, 1}, {2, 1}, {3, 2}, {4, 2}, {5, 4}, {16, 4}, {17, 8}, {255, 8}, {256, 8}};
    for (const auto& [colors, depth] : bits)
        for (const int width : {1, 2, 7, 8, 9, 300})
            for (const bool transparent : {false, true}) {
                const IndexedImage image = indices_of(width, 23, colors, transparent);
                for (const int level : {0, 1, 6}) {
                    const std::vector<std::byte> file = encode_png(image, {.level = level});
                    EXPECT_EQ(static_cast<int>(file.at(24)), depth) << colors;
                    EXPECT_EQ(static_cast<int>(file.at(25)), 3);
                    EXPECT_TRUE(same_pixels(decode_image(file), to_rgba8(image)))
                        << colors << " colours, width " << width;
                }
            }
}

TEST(IndexedPng, Fb2ChunksAreAsShortAsTheyCanBe) {
    const auto chunk_bytes = [](const std::vector<std::byte>& file, const char* type) {
        for (std::size_t at = 8; at + 12 <= file.size();) {
            std::size_t length = 0;
            for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<std::size_t>(file[at + i]);
            if (std::memcmp(&file[at + 4], type, 4) == 0) return static_cast<int>(length);
            at += length + 12;
        }
        return -1;
    };
    const std::vector<std::byte> opaque = encode_png(indices_of(9, 9, 20, false)),
                                 clear = encode_png(indices_of(9, 9, 20, true));
    EXPECT_EQ(chunk_bytes(opaque, "PLTE"), 60);
    EXPECT_EQ(chunk_bytes(opaque, "tRNS"), -1);
    EXPECT_EQ(chunk_bytes(clear, "tRNS"), 3) << "up to the last entry that is not opaque";

    // A picture in 256 colours takes far fewer bytes than in true colour.
    const Image image = sphere_picture(480, 270);
    EXPECT_LT(encode_png(make_palette(image), {.level = 9}).size(), encode_png(image, {.level = 9}).size() * 2 / 3);
}

TEST(IndexedPng, Fb2EntriesOfFewerBits) {
    const IndexedImage image = indices_of(30, 30, 200, true);
    const IndexedImage fewer = quantize_entries(image, 5, 6, 5);
    EXPECT_TRUE(same_pixels(to_rgba8(fewer), quantize_true_color(to_rgba8(image), 5, 6, 5)));
    EXPECT_EQ(fewer.indices, image.indices);
    for (const Rgba8 c : quantize_entries(image, 1, 1, 1).colormap)
        EXPECT_TRUE(c.r % 255 == 0 && c.g % 255 == 0 && c.b % 255 == 0);
    EXPECT_THROW(quantize_entries(image, 0, 6, 5), Error);
}

TEST(IndexedPng, RefusesWhatIsNoIndexPlane) {
    const auto refused = [](auto&& change) {
        IndexedImage image = indices_of(4, 4, 4, false);
        change(image);
        EXPECT_THROW(encode_png(image), Error);
        EXPECT_THROW(to_rgba8(image), Error);
    };
    refused([](IndexedImage& i) { i.indices[5] = 4; });
    refused([](IndexedImage& i) { i.indices.pop_back(); });
    refused([](IndexedImage& i) { i.colormap.clear(); });
    refused([](IndexedImage& i) { i.bits = 1; });
    refused([](IndexedImage& i) { i.bits = 9; });
    refused([](IndexedImage& i) { i.width = 0; });
    refused([](IndexedImage& i) { i.width = -4, i.height = -4; });
    refused([](IndexedImage& i) { i.colormap.resize(257); });
}

}  // namespace
}  // namespace tessera
