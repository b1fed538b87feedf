#include "image/mipmap.h"

#include "image/color.h"
#include "image/pictures.h"
#include "image/srgb.h"

#include <tessera/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera {
namespace {

// In double, so that the sum itself adds no error worth counting.
std::array<double, 4> mean(const std::vector<float>& pixels) {
    std::array<double, 4> sum{};
    for (std::size_t i = 0; i < pixels.size(); ++i) sum[i % 4] += static_cast<double>(pixels[i]);
    for (double& s : sum) s /= static_cast<double>(pixels.size() / 4);
    return sum;
}

std::vector<float> random_floats(std::size_t count) {
    std::mt19937 random(7);
    std::vector<float> v(count);
    for (float& f : v) f = static_cast<float>(random() % 100000) / 100000;
    return v;
}

TEST(Mipmap, Tex1MeanInLinearLightIsKeptForEverySize) {
    for (const int width : {1, 2, 3, 5, 7, 8, 13, 64, 101})
        for (const int height : {1, 2, 3, 6, 9, 17, 33}) {
            const std::vector<float> in = random_floats(4 * static_cast<std::size_t>(width * height));
            const std::vector<float> out = halve(in, width, height);
            ASSERT_EQ(out.size(), 4 * static_cast<std::size_t>(std::max(1, width / 2) * std::max(1, height / 2)));
            for (std::size_t c = 0; c < 4; ++c)
                EXPECT_NEAR(mean(in)[c], mean(out)[c], 2e-7) << width << " x " << height;
        }
}

// The definition: output pixels are the integrals of the input over equal parts of its area.
TEST(Mipmap, Tex1OddSizesAreExactAreaAverages) {
    const int width = 7, height = 5;
    const std::vector<float> in = random_floats(4 * width * height);
    const std::vector<float> out = halve(in, width, height);
    const auto overlap = [](double a0, double a1, double b0, double b1) {
        return std::max(0.0, std::min(a1, b1) - std::max(a0, b0));
    };
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
            for (int c = 0; c < 4; ++c) {
                double sum = 0;
                for (int v = 0; v < height; ++v)
                    for (int u = 0; u < width; ++u)
                        sum += overlap(x * 7.0 / 3, (x + 1) * 7.0 / 3, u, u + 1) *
                               overlap(y * 5.0 / 2, (y + 1) * 5.0 / 2, v, v + 1) *
                               static_cast<double>(in[static_cast<std::size_t>(4 * (v * width + u) + c)]);
                EXPECT_NEAR(out[static_cast<std::size_t>(4 * (y * 3 + x) + c)], sum / (7.0 / 3 * 5.0 / 2), 1e-6);
            }
}

const Texel& texel(const MipChain& chain, std::size_t level, int x, int y) {
    return chain.texels[chain.levels[level].index(x, y)];
}

TEST(Mipmap, Tex1LevelsHalveDownToOneTexelAndDoNotOverlap) {
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 9}, {16, 1}, {37, 20}, {256, 256}}) {
        const MipChain chain = make_mip_chain(test::noise_picture(w, h), true);
        std::size_t end = 0;
        int width = w, height = h;
        for (const MipLevel& level : chain.levels) {
            EXPECT_EQ(level.width, width);
            EXPECT_EQ(level.height, height);
            EXPECT_EQ(level.index(-1, -1), end);
            for (int y = -1; y <= height; ++y)
                for (int x = -1; x <= width; ++x) ASSERT_EQ(level.index(x, y), end++);
            width = std::max(1, width / 2);
            height = std::max(1, height / 2);
        }
        EXPECT_EQ(chain.levels.back().width * chain.levels.back().height, 1);
        EXPECT_EQ(chain.texels.size(), end);
    }
}

TEST(Mipmap, Tex1TheBorderIsTheOppositeEdge) {
    for (const auto& [w, h] : {std::pair{1, 1}, {5, 1}, {2, 7}, {12, 10}}) {
        const MipChain chain = make_mip_chain(test::noise_picture(w, h), false);
        for (std::size_t i = 0; i < chain.levels.size(); ++i) {
            const int width = chain.levels[i].width, height = chain.levels[i].height;
            for (int y = -1; y <= height; ++y)
                for (int x = -1; x <= width; ++x)
                    ASSERT_EQ(texel(chain, i, x, y), texel(chain, i, (x + width) % width, (y + height) % height));
        }
    }
}

// --- the format -----------------------------------------------------------------------------

// A picture whose pixels are the codes from 0 on, the same in every channel.
template <class T>
Image all_codes(PixelFormat format, int width, int height) {
    Image image(width, height, format);
    for (std::size_t i = 0; i < image.bytes().size() / sizeof(T); ++i) image.data<T>()[i] = static_cast<T>(i / 4);
    return image;
}
// The nearest of 0 .. 32767; no code lies halfway.
int nearest15(double v) { return static_cast<int>(std::lround(v * 32767)); }

TEST(Mipmap, Tex1EveryByteIsTheNearest15BitsAndComesBack) {
    const Image image = all_codes<std::uint8_t>(PixelFormat::kRgba8, 16, 16);
    const MipChain color = make_mip_chain(image, true), data = make_mip_chain(image, false);
    for (int code = 0; code < 256; ++code) {
        const Texel c = texel(color, 0, code % 16, code / 16), d = texel(data, 0, code % 16, code / 16);
        for (int k = 0; k < 4; ++k) {
            const double v = code / 255.0;
            ASSERT_EQ(d.c[k], nearest15(v));
            ASSERT_EQ(c.c[k], nearest15(k == 3 ? v : linear_from_srgb(v)));
        }
        ASSERT_EQ(srgb8_from_linear(static_cast<float>(c.c[0]) / 32767), code);
        ASSERT_EQ(std::lround(d.c[0] * 255 / 32767.0), code);
    }
}

TEST(Mipmap, Tex1EverySixteenBitValueIsTheNearest15Bits) {
    const Image image = all_codes<std::uint16_t>(PixelFormat::kRgba16, 256, 256);
    const MipChain color = make_mip_chain(image, true), data = make_mip_chain(image, false);
    for (int code = 0; code < 65536; ++code) {
        const Texel c = texel(color, 0, code % 256, code / 256), d = texel(data, 0, code % 256, code / 256);
        const double v = code / 65535.0;
        ASSERT_EQ(d.c[1], nearest15(v)) << code;
        ASSERT_EQ(c.c[1], nearest15(linear_from_srgb(v))) << code;
        ASSERT_EQ(c.c[3], d.c[3]);
    }
}

TEST(Mipmap, Tex1ConstantImagesStayConstant) {
    for (int v = 0; v < 256; v += 5)
        for (const bool srgb : {false, true}) {
            const auto byte = static_cast<std::uint8_t>(v);
            const auto other = static_cast<std::uint8_t>(255 - v);
            const MipChain chain = make_mip_chain(test::flat_picture(23, 14, byte, other, 128, byte), srgb);
            for (const Texel& t : chain.texels) ASSERT_EQ(t, chain.texels[0]);
        }
}

TEST(Mipmap, Tex1BlackAndWhiteAverageInLinearLight) {
    Image image = test::flat_picture(2, 2, 0, 0, 0, 0);
    for (std::size_t i = 0; i < 8; ++i) image.data<std::uint8_t>()[i] = 255;
    // Half the light of white, and half of a number, is 16383.5.
    const Texel half{{16384, 16384, 16384, 16384}};
    EXPECT_EQ(texel(make_mip_chain(image, true), 1, 0, 0), half);
    EXPECT_EQ(texel(make_mip_chain(image, false), 1, 0, 0), half);
}

TEST(Mipmap, Tex1RoundingDoesNotAccumulate) {
    // The last level of a power-of-two image is the mean of all texels, rounded once.
    const Image image = test::noise_picture(256, 256);
    const MipChain chain = make_mip_chain(image, true);
    std::array<double, 4> sum{};
    for (std::size_t i = 0; i < image.bytes().size(); ++i) {
        const double v = image.data<std::uint8_t>()[i] / 255.0;
        sum[i % 4] += i % 4 == 3 ? v : linear_from_srgb(v);
    }
    const Texel last = texel(chain, chain.levels.size() - 1, 0, 0);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(last.c[c], nearest15(sum[c] / 65536));
}

TEST(Mipmap, Tex1SixteenBitImagesFilterLikeTheirBytes) {
    const Image image = test::noise_picture(32, 19);
    Image wide(32, 19, PixelFormat::kRgba16);
    for (std::size_t i = 0; i < image.bytes().size(); ++i)
        wide.data<std::uint16_t>()[i] = static_cast<std::uint16_t>(image.data<std::uint8_t>()[i] * 257);
    for (const bool srgb : {false, true})
        EXPECT_EQ(make_mip_chain(wide, srgb).texels, make_mip_chain(image, srgb).texels);
}

TEST(Mipmap, RefusesOtherFormats) {
    EXPECT_THROW(make_mip_chain(Image(4, 4, PixelFormat::kF32), false), Error);
    EXPECT_THROW(make_mip_chain(Image(), false), Error);
}

}  // namespace
}  // namespace tessera
