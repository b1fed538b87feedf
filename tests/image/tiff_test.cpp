// TIFF: round trips of every depth, files made by hand of the kinds that we do not write, and hostile ones.
#include "image/files.h"
#include "image/pictures.h"

#include <tessera/image_files.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace tessera {
namespace {

using test::error_of;
using test::find_text;
using test::keep_all;
using test::same_pixels;

class Tiff : public testing::Test {
  protected:
    void SetUp() override {
        if (!has_image_module()) GTEST_SKIP() << "built without the OpenImageIO module";
    }
};

struct Tag {
    std::uint16_t number, type;  // 3: 16 bits, 4: 32 bits
    std::uint32_t value;
    std::uint32_t count = 1;
};

// A file of one strip without compression: header, pixels, tags.
std::vector<std::byte> tiff_by_hand(bool big_endian, const std::vector<std::uint8_t>& pixels, std::vector<Tag> tags) {
    std::vector<std::byte> file;
    const auto put = [&](std::uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i)
            file.push_back(static_cast<std::byte>(value >> 8 * (big_endian ? bytes - 1 - i : i) & 0xff));
    };
    put(big_endian ? 0x4d4d : 0x4949, 2);
    put(42, 2);
    const auto padded = static_cast<std::uint32_t>((pixels.size() + 1) & ~std::size_t{1});
    put(8 + padded, 4);
    for (const std::uint8_t byte : pixels) file.push_back(static_cast<std::byte>(byte));
    file.resize(8 + padded);
    tags.push_back({273, 4, 8});
    tags.push_back({279, 4, static_cast<std::uint32_t>(pixels.size())});
    std::sort(tags.begin(), tags.end(), [](const Tag& a, const Tag& b) { return a.number < b.number; });
    put(static_cast<std::uint32_t>(tags.size()), 2);
    for (const Tag& tag : tags) {
        put(tag.number, 2), put(tag.type, 2), put(tag.count, 4);
        // Short values lie at the front of their four bytes; several of them are equal here.
        if (tag.type == 3)
            put(tag.value, 2), put(tag.count > 1 ? tag.value : 0, 2);
        else
            put(tag.value, 4);
    }
    put(0, 4);
    return file;
}

std::vector<Tag> tags_of(std::uint32_t width, std::uint32_t height, std::uint32_t samples, std::uint32_t bits,
                         std::uint32_t photometric) {
    return {{256, 4, width},       {257, 4, height},  {258, 3, bits},  {259, 3, 1},
            {262, 3, photometric}, {277, 3, samples}, {278, 4, height}};
}

Image opaque(Image image) {
    for (std::size_t i = 3; i < image.bytes().size() / 2; i += 4)
        if (image.format() == PixelFormat::kRgba16) image.data<std::uint16_t>()[i] = 0xffff;
    return image;
}

TEST_F(Tiff, EveryDepthReturns) {
    const Image eight = test::noise_picture(33, 21), sixteen = test::noise_picture(33, 21, PixelFormat::kRgba16);
    Image floats(33, 21, PixelFormat::kRgba32f);
    for (std::size_t i = 0; i < floats.bytes().size() / 4; ++i) floats.data<float>()[i] = static_cast<float>(i) / 7;
    const Image cases[] = {eight, sixteen, floats, test::sphere_picture(40, 30), opaque(sixteen)};
    for (const Image& image : cases) {
        const std::vector<std::byte> file = encode_tiff(image);
        EXPECT_TRUE(same_pixels(decode_image(file, keep_all()), image));
        EXPECT_EQ(file, encode_tiff(image));
        EXPECT_EQ(find_text(file, "20"), std::string_view::npos) << "a year";
        const ImageInfo info = read_image_info(file);
        EXPECT_EQ(info.codec, "tiff");
        EXPECT_EQ(info.width, image.width());
        EXPECT_EQ(info.height, image.height());
        EXPECT_EQ(info.bits, static_cast<int>(2 * bytes_per_pixel(image.format())));
        EXPECT_EQ(info.floating, image.format() == PixelFormat::kRgba32f);
        EXPECT_EQ(info.premultiplied, image.format() == PixelFormat::kRgba32f);
    }
    EXPECT_EQ(read_image_info(encode_tiff(cases[3])).channels, 3);
    // 16 bits to 8: rounded.
    const Image narrow = decode_image(encode_tiff(sixteen));
    for (std::size_t i = 0; i < narrow.bytes().size(); ++i)
        EXPECT_EQ(narrow.data<std::uint8_t>()[i], (sixteen.data<std::uint16_t>()[i] + 128) / 257);
    EXPECT_NE(error_of([&] { decode_image(encode_tiff(floats)); }).message().find("floating-point"), std::string::npos);
    EXPECT_EQ(error_of([] { encode_tiff(Image(2, 2, PixelFormat::kF32)); }).code(), ErrorCode::kUsage);
}

TEST_F(Tiff, FilesOfBothByteOrders) {
    for (const bool big : {false, true}) {
        const std::vector<std::byte> grey = tiff_by_hand(big, {10, 20, 30, 40, 50, 60}, tags_of(3, 2, 1, 8, 1));
        const Image image = decode_image(grey);
        ASSERT_EQ(image.width(), 3);
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t c = 0; c < 4; ++c)
                EXPECT_EQ(image.data<std::uint8_t>()[4 * i + c], c == 3 ? 255 : 10 * (i + 1));
        const std::vector<std::byte> wide = tiff_by_hand(big, {1, 2, 3, 4}, tags_of(2, 1, 1, 16, 1));
        const Image sixteen = decode_image(wide, keep_all());
        EXPECT_EQ(sixteen.data<std::uint16_t>()[0], big ? 0x0102 : 0x0201);
        EXPECT_EQ(sixteen.data<std::uint16_t>()[4], big ? 0x0304 : 0x0403);
    }
    // White is 0; bits packed into bytes.
    const Image bits = decode_image(tiff_by_hand(true, {0b10100000}, tags_of(3, 1, 1, 1, 0)));
    EXPECT_EQ(bits.data<std::uint8_t>()[0], 0);
    EXPECT_EQ(bits.data<std::uint8_t>()[4], 255);
    EXPECT_EQ(bits.data<std::uint8_t>()[8], 0);
}

// Alpha that the colours are multiplied with (ExtraSamples 1) becomes straight; 2 is straight already.
TEST_F(Tiff, PremultipliedAlphaBecomesStraight) {
    const std::vector<std::uint8_t> pixels{64, 128, 128, 7, 0, 255};  // grey and alpha
    std::vector<Tag> tags = tags_of(3, 1, 2, 8, 1);
    for (Tag& tag : tags)
        if (tag.number == 258) tag.count = 2;
    tags.push_back({338, 3, 1});
    const std::vector<std::byte> file = tiff_by_hand(false, pixels, tags);
    EXPECT_TRUE(read_image_info(file).premultiplied);
    const Image image = decode_image(file);
    const std::uint8_t expected[] = {128, 128, 255, 7, 0, 255};  // 64 of 128 is 127.5; never beyond 255
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(image.data<std::uint8_t>()[4 * i], expected[2 * i]) << i;
        EXPECT_EQ(image.data<std::uint8_t>()[4 * i + 3], expected[2 * i + 1]) << i;
    }
    tags.back().value = 2;
    const Image straight = decode_image(tiff_by_hand(false, pixels, tags));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(straight.data<std::uint8_t>()[4 * i], pixels[2 * i]);
}

TEST_F(Tiff, RefusesByName) {
    const auto message = [](const std::vector<std::byte>& file) {
        return error_of([&] { decode_image(file, keep_all()); }).message();
    };
    const std::vector<std::uint8_t> pixels(12);
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags_of(0x80000000, 0x80000000, 1, 8, 1))).find("exceeds"),
              std::string::npos);
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags_of(16384, 16384, 1, 8, 1))).find("too short"),
              std::string::npos);
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags_of(0, 2, 1, 8, 1))).find("no size"), std::string::npos);
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags_of(2, 2, 65535, 8, 1))).find("samples"), std::string::npos);
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags_of(2, 2, 1, 64, 1))).find("this kind"), std::string::npos);
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags_of(2, 2, 1, 12, 1))).find("this kind"), std::string::npos);
    std::vector<Tag> tags = tags_of(2, 2, 1, 8, 1);
    tags[3].value = 34712;  // JPEG 2000
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags)).find("compression 34712"), std::string::npos);
    tags = tags_of(2, 2, 1, 8, 1);
    tags.push_back({322, 4, 0x7ffffff0});
    tags.push_back({323, 4, 0x7ffffff0});
    EXPECT_NE(message(tiff_by_hand(false, pixels, tags)).find("tiles"), std::string::npos);
    EXPECT_EQ(error_of([&] { decode_image(tiff_by_hand(false, pixels, tags_of(2, 2, 1, 8, 1)), 3); }).code(),
              ErrorCode::kLimit);
}

TEST_F(Tiff, DamageIsSurvived) {
    test::expect_damage_is_survived(encode_tiff(test::sphere_picture(12, 9, true)));
    test::expect_damage_is_survived(encode_tiff(opaque(test::noise_picture(6, 5, PixelFormat::kRgba16))));
    test::expect_damage_is_survived(tiff_by_hand(true, std::vector<std::uint8_t>(27, 9), tags_of(3, 3, 3, 8, 2)));
}

}  // namespace
}  // namespace tessera
