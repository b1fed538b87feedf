// Radiance pictures: the pixel against its definition, the run lengths against files written by hand, and
// hostile files.
#include "image/files.h"
#include "image/pictures.h"
#include "image/rgbe.h"

#include <tessera/image_files.h>

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace tessera {
namespace {

using test::bytes_of;
using test::error_of;
using test::keep_all;
using test::same_pixels;

using Rgbe = std::array<std::uint8_t, 4>;
using Rgb = std::array<float, 3>;

Rgbe encoded(const Rgb& rgb) {
    Rgbe rgbe{};
    float_to_rgbe(rgb.data(), rgbe.data());
    return rgbe;
}

// The definition in rgbe.h, searched for instead of computed: the least exponent that fits.
Rgbe defined(const Rgb& rgb) {
    const long double most = std::ldexp(255.0L, 119);
    std::array<long double, 3> c{};
    for (std::size_t i = 0; i < 3; ++i)
        c[i] = std::isnan(rgb[i]) || rgb[i] <= 0 ? 0 : std::fmin(static_cast<long double>(rgb[i]), most);
    const long double largest = std::fmax(c[0], std::fmax(c[1], c[2]));
    if (largest < std::ldexp(1.0L, -128)) return {};
    for (int e = 1; e < 256; ++e) {
        if (std::floor(std::ldexp(largest, 136 - e) + 0.5L) > 255) continue;
        Rgbe rgbe{};
        for (std::size_t i = 0; i < 3; ++i)
            rgbe[i] = static_cast<std::uint8_t>(std::floor(std::ldexp(c[i], 136 - e) + 0.5L));
        rgbe[3] = static_cast<std::uint8_t>(e);
        return rgbe;
    }
    ADD_FAILURE() << "no exponent for " << largest;
    return {};
}

TEST(Rgbe, EveryMantissaAndExponentIsAsDefined) {
    for (int e = 0; e < 256; ++e)
        for (int m = 0; m < 256; ++m) {
            const Rgbe rgbe{static_cast<std::uint8_t>(m), 128, 0, static_cast<std::uint8_t>(e)};
            float rgba[4];
            rgbe_to_float(rgbe.data(), rgba);
            EXPECT_EQ(rgba[0], e == 0 ? 0.0 : std::ldexp(m, e - 136)) << m << " " << e;
            EXPECT_EQ(rgba[2], 0);
            EXPECT_EQ(rgba[3], 1);
            // What is normalised returns.
            const Rgbe again = encoded({rgba[0], rgba[1], rgba[2]});
            EXPECT_EQ(again, e == 0 ? Rgbe{} : rgbe);
        }
}

TEST(Rgbe, EncodesAsDefined) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
    for (const Rgb& rgb :
         {Rgb{0, 0, 0}, Rgb{1, 1, 1}, Rgb{-1, -0.0f, 2}, Rgb{kNan, 0.5f, kInfinity}, Rgb{kNan, -1, kNan},
          Rgb{255.49999f, 1, 0}, Rgb{255.5f, 1, 0}, Rgb{0.99609375f, 0.998046875f, 0.99804687f}, Rgb{0x1p-128f, 0, 0},
          Rgb{0x1.fffffcp-129f, 0, 0}, Rgb{0x1.fep+126f, 0x1.fefp+126f, 0},
          Rgb{std::numeric_limits<float>::max(), 1, 0}, Rgb{0x1p-149f, 0, 0}})
        EXPECT_EQ(encoded(rgb), defined(rgb)) << rgb[0] << " " << rgb[1] << " " << rgb[2];
    std::mt19937 random(7);
    for (int i = 0; i < 200000; ++i) {
        Rgb rgb{};
        // Any bits at all, and channels near to one another.
        const auto bits = [&] { return static_cast<std::uint32_t>(random()); };
        const std::uint32_t first = bits() & 0x7fffffff;
        for (std::size_t c = 0; c < 3; ++c) rgb[c] = std::bit_cast<float>(i % 2 == 0 ? bits() : first + (bits() >> 6));
        ASSERT_EQ(encoded(rgb), defined(rgb)) << rgb[0] << " " << rgb[1] << " " << rgb[2];
    }
}

// Every channel within half a step of the largest one's power of two.
TEST(Hdr, RoundTripIsWithinHalfAStep) {
    Image image(61, 17, PixelFormat::kRgba32f);
    std::mt19937 random(3);
    for (std::size_t i = 0; i < image.bytes().size() / 4; ++i)
        image.data<float>()[i] =
            std::ldexp(static_cast<float>(random() & 0xffff), static_cast<int>(random() % 40) - 30);
    const Image back = decode_image(encode_hdr(image), keep_all());
    ASSERT_EQ(back.format(), PixelFormat::kRgba32f);
    for (std::size_t i = 0; i < image.bytes().size() / 4; i += 4) {
        const float *a = image.data<float>() + i, *b = back.data<float>() + i;
        const float largest = std::fmax(a[0], std::fmax(a[1], a[2]));
        for (int c = 0; c < 3; ++c) EXPECT_LE(std::fabs(a[c] - b[c]), largest / 256);
        EXPECT_EQ(b[3], 1);
    }
    EXPECT_TRUE(same_pixels(decode_image(encode_hdr(back), keep_all()), back)) << "what was read is exact";
}

// Widths on both sides of what the run lengths take, runs of all lengths.
TEST(Hdr, RunsAndWidths) {
    for (const int width : {1, 2, 7, 8, 9, 127, 128, 129, 255, 1000}) {
        Image image(width, 5, PixelFormat::kRgba32f);
        for (int i = 0; i < 5 * width; ++i) {
            // Rows of one value, of steps that grow, of noise.
            const int y = i / width, x = i % width;
            const int value = y == 0 ? 7 : y == 1 ? x / 3 : y == 2 ? x * 37 % 101 : y == 3 ? x / 130 : x & 1;
            for (std::size_t c = 0; c < 4; ++c)
                image.data<float>()[4 * static_cast<std::size_t>(i) + c] = c == 3 ? 1 : static_cast<float>(value % 128);
        }
        EXPECT_TRUE(same_pixels(decode_image(encode_hdr(image), keep_all()), image)) << width;
    }
    const Image flat(1000, 10, PixelFormat::kRgba32f);
    EXPECT_LT(encode_hdr(flat).size(), 1000u) << "black must shrink";
}

std::string hdr_file(const std::string& size, const std::string& data, const std::string& more = "") {
    return "#?RADIANCE\n# by hand\n" + more + "FORMAT=32-bit_rle_rgbe\n\n" + size + "\n" + data;
}

// (16 n, 0, 0, 132) is n.
std::string numbered(const std::string& order) {
    std::string data;
    for (const char n : order) data += std::string{static_cast<char>(16 * (n - '0')), 0, 0, static_cast<char>(132)};
    return data;
}

// Pictures of 2 x 3 pixels, numbered from the top left.
TEST(Hdr, AllEightOrientations) {
    const std::pair<const char*, const char*> cases[] = {
        {"-Y 3 +X 2", "123456"}, {"-Y 3 -X 2", "214365"}, {"+Y 3 +X 2", "563412"}, {"+Y 3 -X 2", "654321"},
        {"+X 2 -Y 3", "135246"}, {"+X 2 +Y 3", "531642"}, {"-X 2 -Y 3", "246135"}, {"-X 2 +Y 3", "642531"},
    };
    for (const auto& [size, order] : cases) {
        const std::string file = hdr_file(size, numbered(order));
        const ImageInfo info = read_image_info(bytes_of(file));
        EXPECT_EQ(info.width, 2);
        EXPECT_EQ(info.height, 3);
        EXPECT_TRUE(info.floating);
        const Image image = decode_image(bytes_of(file), keep_all());
        for (std::size_t i = 0; i < 6; ++i)
            EXPECT_EQ(image.data<float>()[4 * i], static_cast<float>(i + 1)) << size << " pixel " << i;
    }
}

// Radiance's first encoding: (1, 1, 1, n) repeats the pixel before; the second mark in a row counts 256 n.
TEST(Hdr, OldRunLengths) {
    const std::string pixel = numbered("1"), other = numbered("2");
    std::string data = pixel + "\1\1\1\3" + std::string("\1\1\1\1", 4) + other;
    const Image image = decode_image(bytes_of(hdr_file("-Y 1 +X 261", data)), keep_all());
    for (std::size_t i = 0; i < 261; ++i) EXPECT_EQ(image.data<float>()[4 * i], i < 260 ? 1 : 2) << i;
    for (const std::string& bad :
         {"\1\1\1\3" + pixel + pixel + pixel, pixel + "\1\1\1\x7f", pixel + "\1\1\1\1\1\1\1\1"})
        EXPECT_EQ(error_of([&] { decode_image(bytes_of(hdr_file("-Y 1 +X 4", bad)), keep_all()); }).code(),
                  ErrorCode::kInput);
}

TEST(Hdr, RefusesByName) {
    const auto message = [](const std::string& file) {
        return error_of([&] { decode_image(bytes_of(file), keep_all()); }).message();
    };
    EXPECT_NE(message("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd").find("XYZ"), std::string::npos);
    EXPECT_NE(message(hdr_file("-Y 1 -Y 1", "abcd")).find("line of the size"), std::string::npos);
    EXPECT_NE(message(hdr_file("-Y 1 +X 1 +Z 1", "abcd")).find("line of the size"), std::string::npos);
    EXPECT_NE(message(hdr_file("-Y 1 +X", "abcd")).find("line of the size"), std::string::npos);
    EXPECT_NE(message(hdr_file("-Y 99999999999999999999 +X 1", "abcd")).find("exceeds"), std::string::npos);
    EXPECT_NE(message(hdr_file("-Y 0 +X 1", "")).find("0 pixels"), std::string::npos);
    EXPECT_NE(message(hdr_file("-Y 16384 +X 16384", "abcd")).find("too short"), std::string::npos);
    EXPECT_NE(message(hdr_file("-Y 1 +X 5", numbered("123"))).find("truncated"), std::string::npos);
    const std::string head("\2\2\0\x09", 4), other_length = head + std::string(40, '\1');
    EXPECT_NE(message(hdr_file("-Y 1 +X 8", other_length)).find("length of a scan line"), std::string::npos);
    // Callers that take 8 or 16 bits only are told so.
    const std::string fine = hdr_file("-Y 1 +X 1", numbered("1"));
    EXPECT_NE(error_of([&] { decode_image(bytes_of(fine)); }).message().find("floating-point"), std::string::npos);
    EXPECT_EQ(error_of([] { encode_hdr(Image(2, 2, PixelFormat::kRgba8)); }).code(), ErrorCode::kUsage);
}

TEST(Hdr, DamageIsSurvived) {
    Image image(20, 4, PixelFormat::kRgba32f);
    for (std::size_t i = 0; i < image.bytes().size() / 4; ++i) image.data<float>()[i] = static_cast<float>(i / 9 % 5);
    test::expect_damage_is_survived(encode_hdr(image));
    const std::string old = hdr_file("-Y 2 +X 5", numbered("1") + "\1\1\1\3" + numbered("2") + numbered("12345"));
    const auto bytes = bytes_of(old);
    test::expect_damage_is_survived({bytes.begin(), bytes.end()});
}

}  // namespace
}  // namespace tessera
