#include "image/codecs.h"
#include "image/pictures.h"

#include <tessera/error.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>

#include <jpeglib.h>

namespace tessera {
namespace {

using test::same_pixels;
using test::sphere_picture;

// A JPEG file as libjpeg writes it from samples of `space`.
struct Options {
    J_COLOR_SPACE stored = JCS_YCbCr;
    int quality = 95;
    bool progressive = false, adobe = true;
};

std::vector<std::byte> write_with_libjpeg(const std::vector<std::uint8_t>& samples, int width, int height,
                                          J_COLOR_SPACE space, const Options& options) {
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = static_cast<JDIMENSION>(width);
    jpeg.image_height = static_cast<JDIMENSION>(height);
    jpeg.in_color_space = space;
    jpeg.input_components = space == JCS_GRAYSCALE ? 1 : space == JCS_RGB ? 3 : 4;
    jpeg_set_defaults(&jpeg);
    jpeg_set_colorspace(&jpeg, options.stored);
    jpeg.write_Adobe_marker = options.adobe ? TRUE : FALSE;
    for (int c = 0; c < jpeg.num_components; ++c) jpeg.comp_info[c].h_samp_factor = jpeg.comp_info[c].v_samp_factor = 1;
    jpeg_set_quality(&jpeg, options.quality, TRUE);
    if (options.progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    const std::size_t stride = static_cast<std::size_t>(width * jpeg.input_components);
    while (jpeg.next_scanline < jpeg.image_height) {
        auto* row = const_cast<JSAMPROW>(samples.data() + jpeg.next_scanline * stride);
        jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    const auto* first = reinterpret_cast<const std::byte*>(bytes);
    std::vector<std::byte> file(first, first + size);
    std::free(bytes);
    return file;
}

// A smooth picture of `channels` samples a pixel, which JPEG keeps within a few levels.
std::vector<std::uint8_t> smooth(int width, int height, int channels) {
    std::vector<std::uint8_t> v;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c)
                v.push_back(static_cast<std::uint8_t>(40 + (x * (c + 1) * 40) / width + (y * (4 - c) * 30) / height));
    return v;
}

void expect_near(const Image& image, int channels, const std::function<int(std::size_t pixel, std::size_t c)>& expected,
                 int tolerance) {
    const auto* p = image.data<std::uint8_t>();
    for (std::size_t i = 0; i < image.bytes().size() / 4; ++i) {
        for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(p[4 * i + c], expected(i, c), tolerance) << channels;
        ASSERT_EQ(p[4 * i + 3], 255);
    }
}

TEST(Jpeg, DecodesGreyAndColour) {
    for (const bool progressive : {false, true})
        for (const auto& [w, h] : {std::pair{64, 48}, {37, 29}, {1, 1}}) {
            const std::vector<std::uint8_t> grey = smooth(w, h, 1), rgb = smooth(w, h, 3);
            std::vector<std::byte> file =
                write_with_libjpeg(grey, w, h, JCS_GRAYSCALE, {.stored = JCS_GRAYSCALE, .progressive = progressive});
            EXPECT_EQ(read_image_info(file).channels, 1);
            expect_near(
                decode_image(file), 1, [&](std::size_t i, std::size_t) { return grey[i]; }, 4);

            file = write_with_libjpeg(rgb, w, h, JCS_RGB, {.progressive = progressive});
            const ImageInfo info = read_image_info(file);
            EXPECT_EQ(info.codec, "jpeg");
            EXPECT_EQ(info.width, w);
            EXPECT_EQ(info.height, h);
            EXPECT_EQ(info.channels, 3);
            EXPECT_EQ(info.bits, 8);
            expect_near(
                decode_image(file), 3, [&](std::size_t i, std::size_t c) { return rgb[3 * i + c]; }, 8);
            file = write_with_libjpeg(rgb, w, h, JCS_RGB, {.stored = JCS_RGB, .progressive = progressive});
            expect_near(
                decode_image(file), 3, [&](std::size_t i, std::size_t c) { return rgb[3 * i + c]; }, 4);
        }
}

TEST(Jpeg, DecodesInks) {
    const int w = 40, h = 30;
    const std::vector<std::uint8_t> cmyk = smooth(w, h, 4);
    for (const J_COLOR_SPACE stored : {JCS_CMYK, JCS_YCCK})
        for (const bool adobe : {true, false}) {
            if (stored == JCS_YCCK && !adobe) continue;  // only the marker tells YCCK from CMYK
            const Image image =
                decode_image(write_with_libjpeg(cmyk, w, h, JCS_CMYK, {.stored = stored, .adobe = adobe}));
            const auto expected = [&](std::size_t i, std::size_t c) {
                // With Adobe's marker 255 means no ink, without it 255 is full ink.
                const int ink = cmyk[4 * i + c], black = cmyk[4 * i + 3];
                return adobe ? ink * black / 255 : (255 - ink) * (255 - black) / 255;
            };
            expect_near(image, 4, expected, 8);
        }
}

TEST(Jpeg, RoundTripKeepsThePicture) {
    const Image image = sphere_picture(320, 180);
    double last = 0;
    for (const int quality : {50, 75, 92, 100}) {
        const Image decoded = decode_image(encode_jpeg(image, quality));
        const double psnr = compare_images(image, decoded).psnr;
        EXPECT_GT(psnr, last) << quality;
        last = psnr;
    }
    EXPECT_GT(last, 45);
    EXPECT_THROW(encode_jpeg(image, 0), Error);
    EXPECT_THROW(encode_jpeg(image, 101), Error);
    EXPECT_THROW(encode_jpeg(Image(4, 4, PixelFormat::kF32)), Error);
    EXPECT_THROW(encode_jpeg(Image()), Error);
}

ErrorCode decode_code(std::span<const std::byte> file, std::uint64_t max_pixels = 1u << 28) {
    try {
        decode_image(file, max_pixels);
    } catch (const Error& e) {
        EXPECT_FALSE(e.message().empty());
        return e.code();
    }
    ADD_FAILURE() << "decoded without an error";
    return ErrorCode::kInternal;
}

TEST(Jpeg, EveryTruncationIsAnError) {
    const std::vector<std::uint8_t> rgb = smooth(48, 40, 3);
    for (const bool progressive : {false, true}) {
        const std::vector<std::byte> file = write_with_libjpeg(rgb, 48, 40, JCS_RGB, {.progressive = progressive});
        // Without its last two bytes, the end marker, all pixels may be there; before that some are not.
        for (std::size_t n = 0; n + 2 < file.size(); ++n)
            ASSERT_EQ(decode_code(std::span(file).first(n)), ErrorCode::kInput) << n << " of " << file.size();
    }
}

TEST(Jpeg, TrailingBytesAreFine) {
    std::vector<std::byte> file = encode_jpeg(sphere_picture(48, 40));
    const Image image = decode_image(file);
    file.resize(file.size() + 1000, std::byte{0x5a});
    EXPECT_TRUE(same_pixels(decode_image(file), image));
}

std::size_t find_frame(const std::vector<std::byte>& file) {
    for (std::size_t i = 0; i + 1 < file.size(); ++i)
        if (file[i] == std::byte{0xff} && (file[i + 1] == std::byte{0xc0} || file[i + 1] == std::byte{0xc2})) return i;
    return 0;
}

TEST(Jpeg, LimitsComeBeforeMemory) {
    std::vector<std::byte> file = encode_jpeg(sphere_picture(48, 40));
    EXPECT_EQ(decode_code(file, 48 * 40 - 1), ErrorCode::kLimit);
    EXPECT_NO_THROW(decode_image(file, 48 * 40));
    // Height and width follow the frame marker, its length and the precision.
    const std::size_t frame = find_frame(file);
    file[frame + 5] = file[frame + 7] = std::byte{0xff};
    file[frame + 6] = file[frame + 8] = std::byte{0x00};
    EXPECT_EQ(decode_code(file), ErrorCode::kLimit);  // 65280 x 65280
    file[frame + 5] = file[frame + 7] = std::byte{0x40};
    EXPECT_EQ(decode_code(file), ErrorCode::kInput);  // 16384 x 16384 does not fit into so few bytes
}

TEST(Jpeg, EndlessScansAreRefused) {
    std::vector<std::byte> file =
        write_with_libjpeg(smooth(48, 40, 1), 48, 40, JCS_GRAYSCALE, {.stored = JCS_GRAYSCALE, .progressive = true});
    // The last scan (start marker to end marker), again and again.
    std::size_t scan = file.size() - 2;
    while (!(file[scan] == std::byte{0xff} && file[scan + 1] == std::byte{0xda})) --scan;
    const std::vector<std::byte> repeated(file.begin() + static_cast<std::ptrdiff_t>(scan), file.end() - 2);
    file.resize(file.size() - 2);
    for (int i = 0; i < 3000; ++i) file.insert(file.end(), repeated.begin(), repeated.end());
    file.push_back(std::byte{0xff});
    file.push_back(std::byte{0xd9});
    EXPECT_EQ(decode_code(file), ErrorCode::kInput);
}

}  // namespace
}  // namespace tessera
