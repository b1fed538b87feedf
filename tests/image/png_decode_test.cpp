#include "image/codecs.h"
#include "image/pictures.h"

#include <tessera/error.h>

#include <gtest/gtest.h>
#include <libdeflate.h>
#include <png.h>

#include <cstring>

namespace tessera {
namespace {

using test::same_pixels;

// A PNG file as libpng writes it. `rows` holds the samples as stored, packed by `depth`.
struct Stored {
    int width = 0, height = 0, depth = 8, color_type = PNG_COLOR_TYPE_RGB;
    bool interlaced = false;
    std::vector<png_color> palette{};
    std::vector<png_byte> palette_alpha{};
    const png_color_16* transparent = nullptr;
    double gamma = 0;
    std::vector<std::vector<png_byte>> rows{};
};

std::vector<std::byte> write_with_libpng(Stored s) {
    std::vector<std::byte> file;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &file,
        [](png_structp p, png_bytep data, png_size_t n) {
            auto* out = static_cast<std::vector<std::byte>*>(png_get_io_ptr(p));
            const auto* first = reinterpret_cast<const std::byte*>(data);
            out->insert(out->end(), first, first + n);
        },
        nullptr);
    png_set_IHDR(png, info, static_cast<png_uint_32>(s.width), static_cast<png_uint_32>(s.height), s.depth,
                 s.color_type, s.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (!s.palette.empty()) png_set_PLTE(png, info, s.palette.data(), static_cast<int>(s.palette.size()));
    if (!s.palette_alpha.empty() || s.transparent != nullptr)
        png_set_tRNS(png, info, s.palette_alpha.empty() ? nullptr : s.palette_alpha.data(),
                     static_cast<int>(s.palette_alpha.size()), s.transparent);
    if (s.gamma > 0) png_set_gAMA(png, info, s.gamma);
    png_write_info(png, info);
    std::vector<png_bytep> rows;
    for (auto& row : s.rows) rows.push_back(row.data());
    png_write_image(png, rows.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    return file;
}

// Packs samples of `depth` bits, most significant first.
std::vector<png_byte> pack(const std::vector<unsigned>& samples, int depth) {
    std::vector<png_byte> bytes;
    unsigned held = 0;
    int bits = 0;
    for (const unsigned s : samples) {
        held = held << depth | s;
        for (bits += depth; bits >= 8; bits -= 8) bytes.push_back(static_cast<png_byte>(held >> (bits - 8)));
    }
    if (bits > 0) bytes.push_back(static_cast<png_byte>(held << (8 - bits)));
    return bytes;
}

// Random samples and what they stand for: `channels` samples a pixel, as rows.
struct Samples {
    Samples(int w, int h, int channels, int depth) : width(w), height(h), per_pixel(channels) {
        std::mt19937 random(static_cast<unsigned>(w * 31 + h * 7 + channels * 3 + depth));
        for (int i = 0; i < w * h * channels; ++i)
            values.push_back(static_cast<unsigned>(random()) & ((1u << depth) - 1));
    }
    unsigned at(int x, int y, int c) const { return values[static_cast<std::size_t>((y * width + x) * per_pixel + c)]; }
    std::vector<std::vector<png_byte>> rows(int depth) const {
        std::vector<std::vector<png_byte>> r;
        const auto stride = width * per_pixel;
        for (int y = 0; y < height; ++y)
            r.push_back(pack({values.begin() + y * stride, values.begin() + (y + 1) * stride}, depth));
        return r;
    }
    int width, height, per_pixel;
    std::vector<unsigned> values;
};

// 16 bits to 8: round(v * 255 / 65535).
unsigned byte_of(unsigned v, int depth) {
    return depth == 16 ? (v * 255 + 32767) / 65535 : v * 255 / ((1u << depth) - 1);
}

class PngColourTypes : public testing::TestWithParam<std::tuple<int, int, bool>> {};

TEST_P(PngColourTypes, DecodeToRgba) {
    const auto [color_type, depth, interlaced] = GetParam();
    const int channels = color_type == PNG_COLOR_TYPE_GRAY         ? 1
                         : color_type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                         : color_type == PNG_COLOR_TYPE_RGB        ? 3
                                                                   : 4;
    for (const auto& [w, h] : {std::pair{1, 1}, {5, 3}, {9, 8}, {33, 17}}) {
        const Samples samples(w, h, channels, depth);
        Stored s{.width = w, .height = h, .depth = depth, .color_type = color_type, .interlaced = interlaced};
        s.rows = samples.rows(depth);
        const std::vector<std::byte> file = write_with_libpng(s);

        const ImageInfo info = read_image_info(file);
        EXPECT_EQ(info.codec, "png");
        EXPECT_EQ(info.width, w);
        EXPECT_EQ(info.height, h);
        EXPECT_EQ(info.bits, depth);
        EXPECT_EQ(info.channels, channels);

        const Image narrow = decode_image(file), wide = decode_image(file, 1u << 28, true);
        ASSERT_EQ(narrow.format(), PixelFormat::kRgba8);
        ASSERT_EQ(wide.format(), depth == 16 ? PixelFormat::kRgba16 : PixelFormat::kRgba8);
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                for (int c = 0; c < 4; ++c) {
                    const bool gray = channels < 3, has_alpha = channels % 2 == 0;
                    unsigned v = (1u << depth) - 1;
                    if (c < 3) v = samples.at(x, y, gray ? 0 : c);
                    if (c == 3 && has_alpha) v = samples.at(x, y, channels - 1);
                    const auto i = static_cast<std::size_t>(4 * (y * w + x) + c);
                    ASSERT_EQ(narrow.data<std::uint8_t>()[i], byte_of(v, depth));
                    if (depth != 16) continue;
                    ASSERT_EQ(wide.data<std::uint16_t>()[i], v);
                }
    }
}

std::vector<std::tuple<int, int, bool>> all_types() {
    std::vector<std::tuple<int, int, bool>> all;
    for (const bool interlaced : {false, true}) {
        for (const int depth : {1, 2, 4}) all.emplace_back(PNG_COLOR_TYPE_GRAY, depth, interlaced);
        for (const int type :
             {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA})
            for (const int depth : {8, 16}) all.emplace_back(type, depth, interlaced);
    }
    return all;
}
INSTANTIATE_TEST_SUITE_P(Fb1, PngColourTypes, testing::ValuesIn(all_types()));

TEST(PngDecode, Fb1PaletteOfEveryDepth) {
    for (const int depth : {1, 2, 4, 8})
        for (const bool interlaced : {false, true}) {
            const Samples samples(19, 11, 1, depth);
            Stored s{.width = 19,
                     .height = 11,
                     .depth = depth,
                     .color_type = PNG_COLOR_TYPE_PALETTE,
                     .interlaced = interlaced};
            for (int i = 0; i < 1 << depth; ++i)
                s.palette.push_back(
                    {static_cast<png_byte>(i * 7), static_cast<png_byte>(255 - i), static_cast<png_byte>(i * 31)});
            // Alpha for the first half only: the others are opaque.
            for (int i = 0; i < (1 << depth) / 2; ++i) s.palette_alpha.push_back(static_cast<png_byte>(i * 3 + 1));
            s.rows = samples.rows(depth);
            const Image image = decode_image(write_with_libpng(s));
            for (int y = 0; y < 11; ++y)
                for (int x = 0; x < 19; ++x) {
                    const unsigned i = samples.at(x, y, 0);
                    const auto* p = image.data<std::uint8_t>() + 4 * (y * 19 + x);
                    ASSERT_EQ(p[0], s.palette[i].red);
                    ASSERT_EQ(p[1], s.palette[i].green);
                    ASSERT_EQ(p[2], s.palette[i].blue);
                    ASSERT_EQ(p[3], i < s.palette_alpha.size() ? s.palette_alpha[i] : 255);
                }
        }
}

TEST(PngDecode, Fb1TransparentColours) {
    const Samples gray(8, 8, 1, 2);
    png_color_16 key{};
    key.gray = 2;
    Stored s{.width = 8, .height = 8, .depth = 2, .color_type = PNG_COLOR_TYPE_GRAY, .transparent = &key};
    s.rows = gray.rows(2);
    Image image = decode_image(write_with_libpng(s));
    for (int i = 0; i < 64; ++i)
        EXPECT_EQ(image.data<std::uint8_t>()[4 * i + 3], gray.values[static_cast<std::size_t>(i)] == 2 ? 0 : 255);

    // 16-bit keys are compared with all their bits.
    Samples rgb(8, 8, 3, 16);
    key = {0, 0x1234, 0x5678, 0x9abc, 0};
    for (std::size_t i = 0; i < rgb.values.size(); i += 12)
        rgb.values[i] = 0x1234, rgb.values[i + 1] = 0x5678, rgb.values[i + 2] = i % 24 == 0 ? 0x9abc : 0x9abd;
    s = {.width = 8, .height = 8, .depth = 16, .color_type = PNG_COLOR_TYPE_RGB, .transparent = &key};
    s.rows = rgb.rows(16);
    image = decode_image(write_with_libpng(s), 1u << 28, true);
    for (std::size_t i = 0; i < 64; ++i)
        EXPECT_EQ(image.data<std::uint16_t>()[4 * i + 3], 3 * i % 24 == 0 ? 0 : 65535) << i;
}

TEST(PngDecode, GammaIsIgnored) {
    const Samples samples(16, 16, 3, 8);
    Stored s{.width = 16, .height = 16};
    s.rows = samples.rows(8);
    const Image plain = decode_image(write_with_libpng(s));
    s.gamma = 1.0;
    EXPECT_TRUE(same_pixels(decode_image(write_with_libpng(s)), plain));
}

ErrorCode decode_code(std::span<const std::byte> file, std::uint64_t max_pixels = 1u << 28) {
    try {
        decode_image(file, max_pixels);
    } catch (const Error& e) {
        EXPECT_FALSE(e.message().empty());
        EXPECT_EQ(e.message().find('\n'), std::string::npos);
        return e.code();
    }
    ADD_FAILURE() << "decoded without an error";
    return ErrorCode::kInternal;
}

TEST(PngDecode, EveryTruncationIsAnError) {
    const std::vector<std::byte> file = encode_png(test::sphere_picture(40, 30));
    for (std::size_t n = 0; n < file.size(); ++n)
        ASSERT_EQ(decode_code(std::span(file).first(n)), ErrorCode::kInput) << n << " bytes";
}

TEST(PngDecode, EveryDamagedByteOfCriticalChunksIsAnError) {
    // Chunks carry checksums, so each changed byte must be found. The sRGB chunk (bytes 33 to 45) is
    // ancillary: damage there costs no pixel and may be overlooked.
    std::vector<std::byte> file = encode_png(test::sphere_picture(24, 20));
    for (std::size_t i = 0; i < file.size(); ++i) {
        if (i >= 33 && i < 46) continue;
        file[i] ^= std::byte{0x41};
        ASSERT_EQ(decode_code(file), ErrorCode::kInput) << "byte " << i;
        file[i] ^= std::byte{0x41};
    }
}

TEST(PngDecode, TrailingBytesAreFine) {
    std::vector<std::byte> file = encode_png(test::sphere_picture(24, 20));
    const Image image = decode_image(file);
    file.resize(file.size() + 1000, std::byte{0x5a});
    EXPECT_TRUE(same_pixels(decode_image(file), image));
}

// Rewrites width and height, with a valid checksum.
std::vector<std::byte> with_size(std::vector<std::byte> file, std::uint32_t width, std::uint32_t height) {
    const auto put = [&](std::size_t at, std::uint32_t v) {
        for (std::size_t i = 0; i < 4; ++i) file[at + i] = static_cast<std::byte>(v >> (24 - 8 * i));
    };
    put(16, width);
    put(20, height);
    put(29, libdeflate_crc32(0, &file[12], 17));
    return file;
}

TEST(PngDecode, LimitsComeBeforeMemory) {
    const std::vector<std::byte> file = encode_png(test::sphere_picture(40, 30));
    EXPECT_EQ(decode_code(file, 40 * 30 - 1), ErrorCode::kLimit);
    EXPECT_NO_THROW(decode_image(file, 40 * 30));
    EXPECT_EQ(decode_code(with_size(file, 0xffffffff, 0xffffffff)), ErrorCode::kLimit);
    EXPECT_EQ(decode_code(with_size(file, 65535, 65535)), ErrorCode::kLimit);
    EXPECT_EQ(decode_code(with_size(file, kMaxImageSide + 1, 1)), ErrorCode::kLimit);
    EXPECT_EQ(decode_code(with_size(file, 0, 5)), ErrorCode::kInput);
    // Within the limits, but these few bytes cannot hold a gigabyte.
    EXPECT_EQ(decode_code(with_size(file, 16384, 16384)), ErrorCode::kInput);
}

}  // namespace
}  // namespace tessera
