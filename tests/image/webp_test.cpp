// WebP: lossless round trips, lossy ones within what the eye allows, and hostile files.
#include "image/files.h"
#include "image/pictures.h"

#include <tessera/image_files.h>

#include <gtest/gtest.h>

namespace tessera {
namespace {

using test::error_of;
using test::same_pixels;

TEST(Webp, LosslessIsExactEvenUnderTransparency) {
    for (const Image& image : {test::noise_picture(33, 21), test::sphere_picture(40, 30),
                               test::sphere_picture(40, 30, true), test::flat_picture(1, 1, 1, 2, 3, 0)}) {
        const std::vector<std::byte> file = encode_webp(image);
        EXPECT_TRUE(same_pixels(decode_image(file), image));
        EXPECT_EQ(file, encode_webp(image));
        const ImageInfo info = read_image_info(file);
        EXPECT_EQ(info.codec, "webp");
        EXPECT_EQ(info.width, image.width());
        EXPECT_EQ(info.height, image.height());
        EXPECT_FALSE(info.floating);
    }
}

TEST(Webp, LossyIsNearAndSmaller) {
    const Image image = test::sphere_picture(160, 120), transparent = test::sphere_picture(160, 120, true);
    std::size_t last = 0;
    for (const int quality : {30, 90, 100}) {
        const std::vector<std::byte> file = encode_webp(image, {.lossless = false, .quality = quality});
        EXPECT_GT(compare_images(decode_image(file), image).psnr, quality < 50 ? 28 : 33) << quality;
        EXPECT_GT(file.size(), last);
        last = file.size();
    }
    const Image back = decode_image(encode_webp(transparent, {.lossless = false}));
    for (std::size_t i = 3; i < back.bytes().size(); i += 4)
        ASSERT_EQ(back.data<std::uint8_t>()[i], transparent.data<std::uint8_t>()[i]) << "alpha is kept exactly";
    EXPECT_EQ(read_image_info(encode_webp(transparent, {.lossless = false})).channels, 4);
    EXPECT_EQ(read_image_info(encode_webp(image, {.lossless = false})).channels, 3);
}

TEST(Webp, RefusesByName) {
    EXPECT_EQ(error_of([] { encode_webp(Image(2, 2, PixelFormat::kRgba16)); }).code(), ErrorCode::kUsage);
    EXPECT_EQ(error_of([] { encode_webp(Image(16384, 1, PixelFormat::kRgba8)); }).code(), ErrorCode::kUsage);
    EXPECT_EQ(error_of([] { encode_webp(Image(2, 2, PixelFormat::kRgba8), {false, 0}); }).code(), ErrorCode::kUsage);
    std::vector<std::byte> file = encode_webp(test::sphere_picture(64, 48, true), {.lossless = false});
    EXPECT_EQ(error_of([&] { decode_image(file, 64 * 48 - 1); }).code(), ErrorCode::kLimit);
    file[20] |= std::byte{0x02};  // the flag of animations in the VP8X chunk
    EXPECT_NE(error_of([&] { decode_image(file); }).message().find("animated"), std::string::npos);
}

// A header of a large picture with nothing behind it is refused before there is memory for the picture.
TEST(Webp, SizesOfChunksAreThoseOfTheFile) {
    const auto message = [](std::vector<std::byte> file) {
        return error_of([&] { (void)read_image_info(file); }).message();
    };
    const std::vector<std::byte> whole = encode_webp(test::sphere_picture(24, 16, true), {.lossless = false});
    EXPECT_EQ(message({whole.begin(), whole.end() - 2}), "damaged WebP: truncated");
    std::vector<std::byte> file = whole;
    const std::size_t picture = test::find_text(file, "VP8 ");
    ASSERT_NE(picture, std::string_view::npos);
    test::put_little_endian(file, picture + 4, file.size() - picture - 8 + 2, 4);
    EXPECT_EQ(message(file), "damaged WebP: truncated");
    file.resize(picture);
    test::put_little_endian(file, 4, file.size() - 8, 4);
    EXPECT_EQ(message(file), "damaged WebP: no picture in it");
    std::vector<std::byte> longer = whole;  // what stands behind the picture is nobody's business
    longer.resize(longer.size() + 10);
    EXPECT_TRUE(same_pixels(decode_image(longer), decode_image(whole)));
}

TEST(Webp, DamageIsSurvived) {
    test::expect_damage_is_survived(encode_webp(test::sphere_picture(24, 16, true)));
    test::expect_damage_is_survived(encode_webp(test::sphere_picture(24, 16, true), {.lossless = false}));
    test::expect_damage_is_survived(encode_webp(test::sphere_picture(24, 16), {.lossless = false}));
}

}  // namespace
}  // namespace tessera
