// Writing JPEG through libjpeg-turbo, with the exact integer transform.
#include "image/codecs.h"
#include "image/jpeg_error.h"

#include <tessera/error.h>

#include <cstdlib>

namespace tessera {
namespace {

struct Writer {
    jpeg_compress_struct jpeg{};
    JpegErrors errors{};
    unsigned char* bytes = nullptr;  // allocated by libjpeg with malloc
    unsigned long size = 0;

    Writer() = default;
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer() {
        jpeg_destroy_compress(&jpeg);
        std::free(bytes);
    }
};

}  // namespace

std::vector<std::byte> encode_jpeg(const Image& image, int quality) {
    if (image.empty()) throw Error(ErrorCode::kUsage, "an empty image cannot be written");
    if (image.format() != PixelFormat::kRgba8) throw Error(ErrorCode::kUsage, "JPEG takes 8-bit RGBA images");
    if (quality < 1 || quality > 100) throw Error(ErrorCode::kUsage, "the JPEG quality must be 1 to 100");

    Writer writer;
    jpeg_compress_struct& jpeg = writer.jpeg;
    jpeg.err = install_jpeg_errors(writer.errors);
    const auto* pixels = image.data<std::uint8_t>();
    const std::size_t row_bytes = image.row_bytes();
    const bool written = guarded_jpeg(writer.errors, [&] {
        jpeg_create_compress(&jpeg);
        jpeg_mem_dest(&jpeg, &writer.bytes, &writer.size);
        jpeg.image_width = static_cast<JDIMENSION>(image.width());
        jpeg.image_height = static_cast<JDIMENSION>(image.height());
        jpeg.input_components = 4;
        jpeg.in_color_space = JCS_EXT_RGBX;
        jpeg_set_defaults(&jpeg);
        jpeg_set_quality(&jpeg, quality, TRUE);
        jpeg.dct_method = JDCT_ISLOW;
        if (quality >= 90) jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = 1;
        jpeg_start_compress(&jpeg, TRUE);
        while (jpeg.next_scanline < jpeg.image_height) {
            auto* row = const_cast<JSAMPROW>(pixels + jpeg.next_scanline * row_bytes);
            jpeg_write_scanlines(&jpeg, &row, 1);
        }
        jpeg_finish_compress(&jpeg);
    });
    if (!written) throw Error(ErrorCode::kInternal, std::string("writing a JPEG failed: ") + writer.errors.failure);
    const auto* first = reinterpret_cast<const std::byte*>(writer.bytes);
    return {first, first + writer.size};
}

}  // namespace tessera
