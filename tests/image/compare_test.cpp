#include "image/pictures.h"

#include <tessera/error.h>
#include <tessera/image.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

namespace tessera {
namespace {

using test::flat_picture;

TEST(CompareImages, EqualImagesHaveNoDifference) {
    for (const PixelFormat format : {PixelFormat::kRgba8, PixelFormat::kRgba16, PixelFormat::kU32}) {
        const Image image = test::noise_picture(20, 10, format);
        const ImageDifference d = compare_images(image, image);
        EXPECT_EQ(d.differing_pixels, 0u);
        EXPECT_EQ(d.max_error, 0);
        EXPECT_EQ(d.mean_error, 0);
        EXPECT_EQ(d.psnr, std::numeric_limits<double>::infinity());
    }
}

TEST(CompareImages, CountsAndErrorsAreThoseOfTheDefinition) {
    const Image a = flat_picture(10, 10, 100, 100, 100);
    Image b = a;
    b.data<std::uint8_t>()[0] = 90;           // pixel 0: 10 less
    b.data<std::uint8_t>()[4 * 7 + 1] = 104;  // pixel 7: 4 more
    b.data<std::uint8_t>()[4 * 7 + 2] = 97;   //          3 less
    const ImageDifference d = compare_images(a, b);
    EXPECT_EQ(d.differing_pixels, 2u);
    EXPECT_EQ(d.max_error, 10);
    EXPECT_DOUBLE_EQ(d.mean_error, 17.0 / 400);
    EXPECT_NEAR(d.psnr, 10 * std::log10(255.0 * 255 * 400 / 125), 1e-9);
    EXPECT_EQ(compare_images(a, b, 4).differing_pixels, 1u);
    EXPECT_EQ(compare_images(a, b, 3.9).differing_pixels, 2u);
    EXPECT_EQ(compare_images(a, b, 10).differing_pixels, 0u);
    EXPECT_EQ(compare_images(b, a).max_error, 10);
}

TEST(CompareImages, InfinitiesAndNaNsAreComparedByKind) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    Image a(4, 1, PixelFormat::kF32), b(4, 1, PixelFormat::kF32);
    const float in_a[] = {kInfinity, kNan, 1, 2}, in_b[] = {kInfinity, kNan, 1, 2.5f};
    for (int i = 0; i < 4; ++i) a.data<float>()[i] = in_a[i], b.data<float>()[i] = in_b[i];
    EXPECT_EQ(compare_images(a, b).differing_pixels, 1u);
    EXPECT_EQ(compare_images(a, b).max_error, 0.5);
    b.data<float>()[0] = 0;
    EXPECT_EQ(compare_images(a, b).max_error, static_cast<double>(kInfinity));
    b.data<float>()[1] = 0;
    EXPECT_EQ(compare_images(a, b, 1e9).differing_pixels, 2u);
}

TEST(CompareImages, ShapesMustMatch) {
    const Image a(4, 4, PixelFormat::kRgba8);
    for (const Image& b :
         {Image(4, 5, PixelFormat::kRgba8), Image(5, 4, PixelFormat::kRgba8), Image(4, 4, PixelFormat::kF32)}) {
        EXPECT_THROW(compare_images(a, b), Error);
        EXPECT_THROW(difference_picture(a, b), Error);
    }
    EXPECT_THROW(compare_images(a, a, -1), Error);
    EXPECT_THROW(difference_picture(Image(4, 4, PixelFormat::kF32), Image(4, 4, PixelFormat::kF32)), Error);
}

TEST(DifferencePicture, IsRedExactlyWherePixelsDiffer) {
    const Image a = test::sphere_picture(32, 32);
    Image b = a;
    const std::set<std::size_t> changed{0, 31, 500, 1023};
    for (const std::size_t i : changed) b.data<std::uint8_t>()[4 * i + 3] ^= 0x10;
    const Image picture = difference_picture(a, b);
    for (std::size_t i = 0; i < 1024; ++i) {
        const auto* p = picture.data<std::uint8_t>() + 4 * i;
        EXPECT_EQ(p[3], 255);
        if (changed.count(i) != 0)
            EXPECT_TRUE(p[0] > 127 && p[1] == 0 && p[2] == 0) << i;
        else
            EXPECT_TRUE(p[0] == p[1] && p[1] == p[2]) << i;
    }
}

TEST(HashPixels, IsFnv1a) {
    // Published test vectors of the 64-bit FNV-1a: "foobar" is 85944171f73967e8; four bytes "foob" follow
    // from the definition, so a one-pixel image checks the order of bytes.
    Image image(1, 1, PixelFormat::kU32);
    std::memcpy(image.bytes().data(), "foob", 4);
    EXPECT_EQ(hash_pixels(image), 0xdd120e790c2512afu);
    EXPECT_EQ(hash_pixels(Image()), 0xcbf29ce484222325u);
}

TEST(TrueColour, Fb1KeepsTwoToTheNColours) {
    // All 256 levels of each channel in one picture: every colour cube node that exists is hit.
    Image image(256, 3, PixelFormat::kRgba8);
    auto* p = image.data<std::uint8_t>();
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 256; ++x) {
            p[4 * (256 * y + x) + y] = static_cast<std::uint8_t>(x);
            p[4 * (256 * y + x) + 3] = static_cast<std::uint8_t>(x);
        }
    for (const auto& bits :
         {std::array{3, 3, 2}, std::array{5, 6, 5}, std::array{1, 1, 1}, std::array{8, 8, 8}, std::array{4, 7, 1}}) {
        const Image out = quantize_true_color(image, bits[0], bits[1], bits[2]);
        for (int c = 0; c < 3; ++c) {
            std::set<int> levels;
            const int top = (1 << bits[static_cast<std::size_t>(c)]) - 1;
            for (int x = 0; x < 256; ++x) {
                const int v = out.data<std::uint8_t>()[4 * (256 * c + x) + c];
                levels.insert(v);
                // The nearest level: no more than half a step (and the rounding of the level) away.
                EXPECT_LE(std::abs(v - x), 127.5 / top + 0.5);
                EXPECT_EQ(out.data<std::uint8_t>()[4 * (256 * c + x) + 3], x);
            }
            EXPECT_EQ(levels.size(), static_cast<std::size_t>(top + 1));
            EXPECT_EQ(*levels.begin(), 0);
            EXPECT_EQ(*levels.rbegin(), 255);
        }
        EXPECT_TRUE(test::same_pixels(quantize_true_color(out, bits[0], bits[1], bits[2]), out));
    }
    EXPECT_THROW(quantize_true_color(image, 0, 8, 8), Error);
    EXPECT_THROW(quantize_true_color(image, 8, 9, 8), Error);
    EXPECT_THROW(quantize_true_color(Image(1, 1, PixelFormat::kF32), 8, 8, 8), Error);
}

TEST(ImageType, Fb1SizesAndFormats) {
    for (const auto& [format, bytes] : {std::pair{PixelFormat::kRgba8, 4},
                                        {PixelFormat::kRgba16, 8},
                                        {PixelFormat::kRgba32f, 16},
                                        {PixelFormat::kF32, 4},
                                        {PixelFormat::kU32, 4}}) {
        const Image image(3, 2, format);
        EXPECT_EQ(bytes_per_pixel(format), static_cast<std::size_t>(bytes));
        EXPECT_EQ(image.bytes().size(), static_cast<std::size_t>(6 * bytes));
        EXPECT_EQ(image.row_bytes(), static_cast<std::size_t>(3 * bytes));
        for (const std::byte b : image.bytes()) EXPECT_EQ(b, std::byte{0});
    }
    for (const auto& [w, h] : {std::pair{0, 1}, {1, 0}, {-1, 5}, {kMaxImageSide + 1, 1}, {1, kMaxImageSide + 1}})
        EXPECT_THROW(Image(w, h, PixelFormat::kRgba8), Error);
}

}  // namespace
}  // namespace tessera
