// OpenEXR: named channels there and back, the file's own bytes, what is refused, and hostile files. The
// halves are proved in half_test.cpp.
#include "image/files.h"
#include "image/half.h"
#include "image/pictures.h"

#include <tessera/image_files.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <random>

namespace tessera {
namespace {

using test::error_of;
using test::find_text;
using test::keep_all;
using test::same_pixels;

class Exr : public testing::Test {
  protected:
    void SetUp() override {
        if (!has_image_module()) GTEST_SKIP() << "built without the OpenImageIO module";
    }
};

// Floats of any bits but NaN, whose payload a file need not keep.
Image float_noise(int width, int height, unsigned seed = 1) {
    Image image = test::noise_picture(width, height, PixelFormat::kRgba32f, seed);
    for (std::size_t i = 0; i < image.bytes().size() / 4; ++i)
        if (float& value = image.data<float>()[i]; value != value) value = -0.0f;
    return image;
}

std::vector<std::byte> small_file() {
    const Image image = float_noise(9, 5);
    const float* pixels = image.data<float>();
    const ImageChannel channels[] = {{"R", ChannelType::kHalf, pixels, 16},
                                     {"G", ChannelType::kHalf, pixels + 1, 16},
                                     {"B", ChannelType::kFloat, pixels + 2, 16}};
    return encode_exr(9, 5, channels);
}

TEST_F(Exr, NamedChannelsOfEveryTypeReturn) {
    constexpr int kWidth = 37, kHeight = 53;
    const Image color = float_noise(kWidth, kHeight);
    Image ids(kWidth, kHeight, PixelFormat::kU32);
    std::mt19937 random(5);
    for (std::size_t i = 0; i < ids.bytes().size() / 4; ++i)
        ids.data<std::uint32_t>()[i] = static_cast<std::uint32_t>(random());
    const float* pixels = color.data<float>();
    // Given in no order; 16 bytes apart, 4 bytes apart, and shared.
    const std::string long_name(200, 'n');
    const ImageChannel channels[] = {
        {"normal.X", ChannelType::kFloat, pixels, 16},
        {"R", ChannelType::kHalf, pixels, 16},
        {"id.object", ChannelType::kUint, ids.data<std::uint32_t>(), 4},
        {"B", ChannelType::kHalf, pixels + 2, 16},
        {"G", ChannelType::kHalf, pixels + 1, 16},
        {"depth.Z", ChannelType::kFloat, pixels + 3, 16},
        {long_name, ChannelType::kFloat, pixels, 4},
        {"A", ChannelType::kFloat, pixels + 3, 16},
    };
    const std::vector<std::byte> file = encode_exr(kWidth, kHeight, channels);
    const std::vector<ImagePlane> planes = decode_exr_channels(file);
    ASSERT_EQ(planes.size(), std::size(channels));
    EXPECT_TRUE(std::is_sorted(planes.begin(), planes.end(), [](auto& a, auto& b) { return a.name < b.name; }));
    for (const ImagePlane& plane : planes) {
        const auto* channel = std::find_if(std::begin(channels), std::end(channels),
                                           [&](const ImageChannel& c) { return c.name == plane.name; });
        ASSERT_NE(channel, std::end(channels)) << plane.name;
        EXPECT_EQ(plane.type, channel->type);
        for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
            std::uint32_t expected, got;
            std::memcpy(&expected, static_cast<const std::byte*>(channel->pixels) + i * channel->pixel_stride, 4);
            std::memcpy(&got, plane.pixels.bytes().data() + 4 * i, 4);
            if (channel->type == ChannelType::kHalf)
                expected = std::bit_cast<std::uint32_t>(half_to_float(float_to_half(std::bit_cast<float>(expected))));
            ASSERT_EQ(got, expected) << plane.name << " pixel " << i;
        }
    }
}

TEST_F(Exr, PicturesReturn) {
    for (const auto& [width, height] : {std::pair{1, 1}, {300, 2}, {2, 300}, {64, 64}}) {
        const Image image = float_noise(width, height);
        const std::vector<std::byte> file = encode_image("exr", image, {.exr_type = ChannelType::kFloat});
        EXPECT_TRUE(same_pixels(decode_image(file, keep_all()), image));
        const ImageInfo info = read_image_info(file);
        EXPECT_EQ(info.codec, "exr");
        EXPECT_EQ(info.width, width);
        EXPECT_EQ(info.height, height);
        EXPECT_EQ(info.channels, 4);
        EXPECT_EQ(info.bits, 32);
        EXPECT_TRUE(info.floating && info.premultiplied);
    }
    const Image image = float_noise(30, 20);
    const Image halves = decode_image(encode_image(".EXR", image), keep_all());
    for (std::size_t i = 0; i < image.bytes().size() / 4; ++i)
        EXPECT_EQ(halves.data<float>()[i], half_to_float(float_to_half(image.data<float>()[i])));
}

// Y is grey; a missing A is full; other channels do not disturb.
TEST_F(Exr, GreyAndSurplusChannels) {
    const Image image = float_noise(8, 8);
    const float* pixels = image.data<float>();
    const ImageChannel grey[] = {{"Y", ChannelType::kFloat, pixels, 16}, {"Z", ChannelType::kFloat, pixels + 1, 16}};
    const Image back = decode_image(encode_exr(8, 8, grey), keep_all());
    for (std::size_t i = 0; i < 64; ++i) {
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(back.data<float>()[4 * i + c], pixels[4 * i]);
        EXPECT_EQ(back.data<float>()[4 * i + 3], 1);
    }
    const ImageChannel neither[] = {{"depth.Z", ChannelType::kFloat, pixels, 16}};
    const std::vector<std::byte> depth = encode_exr(8, 8, neither);
    EXPECT_NE(error_of([&] { decode_image(depth, keep_all()); }).message().find("R, G, B nor Y"), std::string::npos);
    EXPECT_EQ(decode_exr_channels(depth).size(), 1u);
}

// No time of day, no name of a program; the order in which the channels are given does not matter.
TEST_F(Exr, BytesDependOnTheArgumentsAlone) {
    const Image image = float_noise(20, 20);
    const float* pixels = image.data<float>();
    ImageChannel channels[] = {{"R", ChannelType::kHalf, pixels, 16}, {"depth.Z", ChannelType::kFloat, pixels + 1, 16}};
    const std::vector<std::byte> file = encode_exr(20, 20, channels);
    std::swap(channels[0], channels[1]);
    EXPECT_EQ(encode_exr(20, 20, channels), file);
    for (const char* text : {"capDate", "oftware", "OpenImageIO", "owner", "20:", "host"})
        EXPECT_EQ(find_text(file, text), std::string_view::npos) << text;
    const std::size_t compression = find_text(file, std::string_view("compression\0compression\0", 24));
    ASSERT_NE(compression, std::string_view::npos);
    EXPECT_EQ(static_cast<int>(file[compression + 24 + 4]), 3) << "ZIP in blocks of 16 lines";
}

TEST_F(Exr, RefusesArguments) {
    const float pixel = 1;
    const auto code = [&](int width, int height, std::vector<ImageChannel> channels) {
        return error_of([&] { encode_exr(width, height, channels); }).code();
    };
    const ImageChannel fine{"R", ChannelType::kHalf, &pixel, 4};
    EXPECT_EQ(code(0, 1, {fine}), ErrorCode::kUsage);
    EXPECT_EQ(code(1, kMaxImageSide + 1, {fine}), ErrorCode::kUsage);
    EXPECT_EQ(code(1, 1, {}), ErrorCode::kUsage);
    EXPECT_EQ(code(1, 1, {fine, fine}), ErrorCode::kUsage);
    EXPECT_EQ(code(1, 1, {{"", ChannelType::kHalf, &pixel, 4}}), ErrorCode::kUsage);
    EXPECT_EQ(code(1, 1, {{std::string(256, 'x'), ChannelType::kHalf, &pixel, 4}}), ErrorCode::kUsage);
    EXPECT_EQ(code(1, 1, {{std::string("a\0b", 3), ChannelType::kHalf, &pixel, 4}}), ErrorCode::kUsage);
    EXPECT_EQ(code(1, 1, {{"R", ChannelType::kHalf, nullptr, 4}}), ErrorCode::kUsage);
    EXPECT_EQ(error_of([] { encode_image("exr", Image(2, 2, PixelFormat::kRgba8)); }).code(), ErrorCode::kUsage);
}

TEST_F(Exr, HeadersThatClaimTooMuchAreRefusedByName) {
    const std::vector<std::byte> file = small_file();
    const auto message = [](const std::vector<std::byte>& changed) {
        const Error e = error_of([&] { decode_image(changed, keep_all()); });
        EXPECT_TRUE(e.code() == ErrorCode::kInput || e.code() == ErrorCode::kLimit);
        return e.message();
    };
    std::vector<std::byte> changed = file;
    changed[5] |= std::byte{0x08};
    EXPECT_EQ(message(changed), "deep EXR is not read");
    changed = file;
    changed[5] |= std::byte{0x10};
    EXPECT_EQ(message(changed), "EXR of several parts is not read");
    changed = file;
    changed[4] = std::byte{3};
    EXPECT_NE(message(changed).find("version 3"), std::string::npos);

    const std::size_t window = find_text(file, "dataWindow") + 11 + 6 + 4;
    changed = file;
    test::put_little_endian(changed, window + 8, 0x7fffffff, 4);
    EXPECT_NE(message(changed).find("2147483648 x 5"), std::string::npos);
    test::put_little_endian(changed, window, 0x80000000, 4);  // from the least to the largest number
    EXPECT_NE(message(changed).find("4294967295 x 5"), std::string::npos);
    changed = file;
    test::put_little_endian(changed, window + 12, 16383, 4);
    EXPECT_NE(message(changed).find("too short"), std::string::npos);
    changed = file;
    test::put_little_endian(changed, window + 12, 0xffffffff, 4);
    EXPECT_NE(message(changed).find("empty data window"), std::string::npos);
    EXPECT_EQ(error_of([&] { decode_image(file, keep_all(44)); }).code(), ErrorCode::kLimit);
    EXPECT_EQ(error_of([&] { decode_exr_channels(file, 44); }).code(), ErrorCode::kLimit);

    const std::size_t channels = find_text(file, "channels") + 9 + 7;
    changed = file;
    test::put_little_endian(changed, channels, 0x7fffffff, 4);  // the size of the attribute
    EXPECT_NE(message(changed).find("truncated"), std::string::npos);
    changed = file;
    test::put_little_endian(changed, channels + 4 + 2 + 8, 2, 4);  // "B", its type, then: every second pixel
    EXPECT_NE(message(changed).find("subsampled"), std::string::npos);
}

// A thousand channels are the most: a list of more, all of them well formed.
TEST_F(Exr, ManyChannels) {
    std::string file("\x76\x2f\x31\x01\2\0\0\0channels\0chlist\0", 8 + 9 + 7);
    std::string list;
    for (int i = 0; i < 200000; ++i) {
        list.append("c").append(std::to_string(i));
        list.append("\0\2\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0", 17);
    }
    list.push_back('\0');
    for (int i = 0; i < 4; ++i) file.push_back(static_cast<char>(list.size() >> (8 * i) & 0xff));
    file.append(list);
    EXPECT_NE(error_of([&] { read_image_info(test::bytes_of(file)); }).message().find("1024 channels"),
              std::string::npos);
}

TEST_F(Exr, DamageIsSurvived) { test::expect_damage_is_survived(small_file()); }

}  // namespace
}  // namespace tessera
