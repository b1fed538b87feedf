#include "core/parallel.h"
#include "image/codecs.h"
#include "image/pictures.h"

#include <tessera/error.h>

#include <gtest/gtest.h>
#include <png.h>

#include <cstring>

namespace tessera {
namespace {

using test::flat_picture;
using test::noise_picture;
using test::same_pixels;
using test::sphere_picture;

// libpng's simplified reader: a way to the pixels that shares no code with decode_image().
std::vector<std::uint8_t> read_with_libpng(const std::vector<std::byte>& file, std::uint32_t* stored_format = nullptr) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&png, file.data(), file.size()) == 0) {
        ADD_FAILURE() << png.message;
        return {};
    }
    if (stored_format != nullptr) *stored_format = png.format;
    png.format = PNG_FORMAT_RGBA;
    std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(png));
    if (png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr) == 0) ADD_FAILURE() << png.message;
    EXPECT_EQ(png.warning_or_error, 0u) << png.message;
    return pixels;
}

void expect_round_trip(const Image& image, const PngOptions& options) {
    const std::vector<std::byte> file = encode_png(image, options);
    EXPECT_TRUE(same_pixels(decode_image(file, 1u << 28, true), image)) << "level " << options.level;
    if (image.format() == PixelFormat::kRgba8) {
        const std::vector<std::uint8_t> pixels = read_with_libpng(file);
        ASSERT_EQ(pixels.size(), image.bytes().size());
        EXPECT_EQ(std::memcmp(pixels.data(), image.data<std::uint8_t>(), pixels.size()), 0)
            << "level " << options.level;
    }
}

TEST(PngEncode, Fb1TrueColourRoundTripsAtEveryLevel) {
    for (int level = 0; level <= 12; ++level) {
        expect_round_trip(noise_picture(61, 47), {.level = level});
        expect_round_trip(sphere_picture(160, 90), {.level = level});
        expect_round_trip(sphere_picture(160, 90, true), {.level = level});
    }
}

TEST(PngEncode, Fb1TrueColourRoundTripsForOddSizes) {
    for (const int width : {1, 2, 3, 15, 16, 17, 255})
        for (const int height : {1, 2, 31})
            for (const PixelFormat format : {PixelFormat::kRgba8, PixelFormat::kRgba16})
                expect_round_trip(noise_picture(width, height, format), {});
    expect_round_trip(noise_picture(16384, 1), {});
    expect_round_trip(noise_picture(1, 16384), {});
    expect_round_trip(noise_picture(16384, 3, PixelFormat::kRgba16), {.level = 3});
}

TEST(PngEncode, DropsAlphaOnlyWhenOpaque) {
    Image image = sphere_picture(64, 64);
    std::uint32_t format = 0;
    read_with_libpng(encode_png(image), &format);
    EXPECT_EQ(format & PNG_FORMAT_FLAG_ALPHA, 0u);
    read_with_libpng(encode_png(image, {.drop_opaque_alpha = false}), &format);
    EXPECT_NE(format & PNG_FORMAT_FLAG_ALPHA, 0u);
    image.data<std::uint8_t>()[4 * 64 * 64 - 1] = 254;
    read_with_libpng(encode_png(image), &format);
    EXPECT_NE(format & PNG_FORMAT_FLAG_ALPHA, 0u);
    expect_round_trip(image, {});
}

TEST(PngEncode, BytesDoNotDependOnThreads) {
    const Image image = sphere_picture(640, 480);
    for (const int level : {0, 1, 2, 6}) {
        Arena one(1);
        const std::vector<std::byte> expected = encode_png(image, {.level = level}, one);
        for (const int threads : {2, 3, 8}) {
            Arena arena(threads);
            EXPECT_EQ(encode_png(image, {.level = level}, arena), expected) << threads << " threads, level " << level;
        }
    }
}

TEST(PngEncode, IsSmall) {
    const Image image = sphere_picture(960, 540);
    // The reference: libpng with its own defaults (level 6, adaptive filters), RGB.
    std::vector<std::uint8_t> rgb;
    for (std::size_t i = 0; i < image.bytes().size(); i += 4)
        rgb.insert(rgb.end(), image.data<std::uint8_t>() + i, image.data<std::uint8_t>() + i + 3);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = 960;
    png.height = 540;
    png.format = PNG_FORMAT_RGB;
    png_alloc_size_t reference = 0;
    ASSERT_NE(png_image_write_get_memory_size(png, reference, 0, rgb.data(), 0, nullptr), 0);
    EXPECT_LT(encode_png(image).size(), reference * 3 / 2);
    EXPECT_LT(encode_png(image, {.level = 9}).size(), reference);
    // One colour: a run costs a few bits per 258 bytes.
    EXPECT_LT(encode_png(flat_picture(1920, 1080, 30, 60, 90)).size(), 20000u);
    // Noise does not grow by more than stored blocks and chunks cost.
    EXPECT_LT(encode_png(noise_picture(512, 512)).size(), 512u * 512 * 4 * 1005 / 1000);
}

TEST(PngEncode, RefusesWhatPngCannotHold) {
    const auto code_of = [](auto&& call) {
        try {
            call();
        } catch (const Error& e) {
            return e.code();
        }
        return ErrorCode::kInternal;
    };
    EXPECT_EQ(code_of([] { encode_png(Image(2, 2, PixelFormat::kF32)); }), ErrorCode::kUsage);
    EXPECT_EQ(code_of([] { encode_png(Image(2, 2, PixelFormat::kU32)); }), ErrorCode::kUsage);
    EXPECT_EQ(code_of([] { encode_png(Image(2, 2, PixelFormat::kRgba32f)); }), ErrorCode::kUsage);
    EXPECT_EQ(code_of([] { encode_png(Image()); }), ErrorCode::kUsage);
    EXPECT_EQ(code_of([] { encode_png(Image(2, 2, PixelFormat::kRgba8), {.level = 13}); }), ErrorCode::kUsage);
    EXPECT_EQ(code_of([] { encode_png(Image(2, 2, PixelFormat::kRgba8), {.level = -1}); }), ErrorCode::kUsage);
}

}  // namespace
}  // namespace tessera
