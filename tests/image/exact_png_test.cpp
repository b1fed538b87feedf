// Numbers that come through PNG unchanged, and those that PNG cannot hold.
#include <tessera/error.h>
#include <tessera/planes.h>

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace tessera {
namespace {

template <class T>
Image plane_of(int width, const std::vector<T>& values) {
    constexpr PixelFormat kFormat = std::is_same_v<T, float> ? PixelFormat::kF32 : PixelFormat::kU32;
    Image plane(width, static_cast<int>(values.size()) / width, kFormat);
    std::copy(values.begin(), values.end(), plane.data<T>());
    return plane;
}

// Bit depth and colour type, as the header of the file says.
std::pair<int, int> kind_of(const std::vector<std::byte>& file) {
    return {static_cast<int>(file.at(24)), static_cast<int>(file.at(25))};
}

bool has_chunk(const std::vector<std::byte>& file, std::string_view type) {
    const auto bytes = std::as_bytes(std::span(type));
    return std::search(file.begin(), file.end(), bytes.begin(), bytes.end()) != file.end();
}

// The grey values that libpng reads.
std::vector<std::uint32_t> grey_values(const std::vector<std::byte>& file) {
    EXPECT_EQ(kind_of(file), std::pair(16, 0));
    EXPECT_FALSE(has_chunk(file, "sRGB")) << "numbers, not display codes";
    const Image image = decode_image(file, 1u << 28, true);
    std::vector<std::uint32_t> values;
    for (std::size_t i = 0; i < image.bytes().size() / 2; i += 4) {
        const auto* p = image.data<std::uint16_t>() + i;
        EXPECT_TRUE(p[0] == p[1] && p[0] == p[2] && p[3] == 65535);
        values.push_back(p[0]);
    }
    return values;
}

template <class Call>
std::string limit_message(const Call& call) {
    try {
        call();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::kLimit);
        return e.message();
    }
    return "accepted";
}

TEST(ExactPng, Fb1GreyHoldsEveryValueOf16Bits) {
    std::vector<std::uint32_t> all(65536);
    for (std::uint32_t i = 0; i < 65536; ++i) all[i] = i;
    for (const int level : {0, 1, 6})
        EXPECT_EQ(grey_values(encode_grey_png(plane_of(512, all), {.level = level})), all);
    const std::vector<std::uint32_t> odd{1, 2, 65535, 0, 258, 7, 9};
    EXPECT_EQ(grey_values(encode_grey_png(plane_of(7, odd))), odd);
    EXPECT_EQ(grey_values(encode_grey_png(plane_of(1, odd))), odd);
    EXPECT_EQ(limit_message([] {
                  encode_grey_png(plane_of<std::uint32_t>(3, {5, 70001, 65536}));
              }),
              "the largest value, 70001, does not fit 16 bits");
    EXPECT_THROW(encode_grey_png(plane_of<float>(1, {1})), Error);
    EXPECT_THROW(encode_grey_png(Image()), Error);
}

TEST(ExactPng, Fb1DepthRoundsHalfToEven) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
    const Image depth =
        plane_of<float>(4, {1.5f, 2.5f, 3.5f, 2.25f, 2.75f, 65535, 65535.25f, kInfinity, kNan, 0.25f, 0.5f, 0});
    const std::vector<std::uint32_t> expected{2, 2, 4, 2, 3, 65535, 65535, 0, 0, 1, 1, 1};
    EXPECT_EQ(grey_values(encode_depth_png(depth, 1)), expected);
    // Millimetres by default: 2.345 m and 65.535 m.
    EXPECT_EQ(grey_values(encode_depth_png(plane_of<float>(2, {2.345f, 65.535f}))),
              (std::vector<std::uint32_t>{2345, 65535}));
    EXPECT_EQ(limit_message([] {
                  encode_depth_png(plane_of<float>(3, {1, 80.5f, 66}));
              }),
              "the largest depth, 80.5 m, does not fit 16 bits at 1000 per metre");
    EXPECT_NE(limit_message([] { encode_depth_png(plane_of<float>(1, {65535.5f}), 1); }), "accepted")
        << "65536 is even";
    EXPECT_EQ(limit_message([] { encode_depth_png(plane_of<float>(2, {1, -0.5f})); }), "a depth of -0.5 m is negative");
    EXPECT_NE(limit_message([] { encode_depth_png(plane_of<float>(1, {3e38f}), 1e300); }), "accepted");
    for (const double scale :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(encode_depth_png(depth, scale), Error) << scale;
    EXPECT_THROW(encode_depth_png(plane_of<std::uint32_t>(1, {1})), Error);
}

TEST(ExactPng, Fb1IdsLieInTheBytesOfTheirColours) {
    const std::vector<std::uint32_t> narrow{0, 1, 0x123456, 0xffffff};
    std::vector<std::byte> file = encode_id_png(plane_of(2, narrow));
    EXPECT_EQ(kind_of(file), std::pair(8, 2));
    EXPECT_FALSE(has_chunk(file, "sRGB"));
    const Image rgb = decode_image(file);
    for (std::size_t i = 0; i < narrow.size(); ++i) {
        const auto* p = rgb.data<std::uint8_t>() + 4 * i;
        EXPECT_EQ(p[0] + 256 * p[1] + 65536 * p[2], static_cast<int>(narrow[i]));
    }
    file = encode_id_png(plane_of<std::uint32_t>(1, {0x01020304, 0}));
    EXPECT_EQ(kind_of(file), std::pair(8, 6));
    const Image rgba = decode_image(file);
    const std::vector<int> bytes(rgba.data<std::uint8_t>(), rgba.data<std::uint8_t>() + 8);
    EXPECT_EQ(bytes, (std::vector<int>{4, 3, 2, 1, 0, 0, 0, 0}));
}

TEST(ExactPng, Fb1IdsRoundTrip) {
    std::mt19937 random(5);
    for (const std::uint32_t mask : {0xffu, 0xffffffu, 0xffffffffu}) {
        std::vector<std::uint32_t> ids(317 * 211);
        for (std::uint32_t& id : ids) id = static_cast<std::uint32_t>(random()) & mask;
        const Image again = decode_id_png(encode_id_png(plane_of(317, ids)));
        EXPECT_EQ(std::vector(again.data<std::uint32_t>(), again.data<std::uint32_t>() + ids.size()), ids);
    }
    EXPECT_THROW(decode_id_png(encode_grey_png(plane_of<std::uint32_t>(1, {1}))), Error);
    EXPECT_THROW(decode_id_png(encode_id_png(plane_of<std::uint32_t>(2, {1, 2})), 1), Error) << "a limit";
    EXPECT_THROW(decode_id_png({}), Error);
}

}  // namespace
}  // namespace tessera
