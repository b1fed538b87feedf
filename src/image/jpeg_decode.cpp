// Reading JPEG through libjpeg-turbo, with the exact integer transform so that the pixels do not
// depend on the processor.
#include "image/codecs.h"
#include "image/jpeg_error.h"

#include <tessera/error.h>

#include <jerror.h>

#include <algorithm>

namespace tessera {
namespace {

// Progressive files refine a picture in scans, each of which visits all blocks: a small file may claim
// very many. Real files have about ten.
constexpr int kMaxScans = 100;
constexpr std::uint64_t kMaxBlockVisits = std::uint64_t{1} << 28;
// libjpeg keeps the coefficients of a progressive picture in memory.
constexpr long kMaxLibraryMemory = 512L << 20;

struct Reader {
    jpeg_decompress_struct jpeg{};
    jpeg_progress_mgr progress{};
    JpegErrors errors{};

    Reader() = default;
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() { jpeg_destroy_decompress(&jpeg); }
};

void on_progress(j_common_ptr info) {
    const auto* jpeg = reinterpret_cast<j_decompress_ptr>(info);
    const std::uint64_t blocks = std::uint64_t{jpeg->image_width} * jpeg->image_height / 64 *
                                 static_cast<unsigned>(std::max(jpeg->num_components, 1));
    const auto scans = static_cast<std::uint64_t>(std::max(jpeg->input_scan_number, 0));
    if (scans > kMaxScans || (scans > 10 && scans * blocks > kMaxBlockVisits)) jpeg_failure(info, "too many scans");
}

[[noreturn]] void throw_damaged(const Reader& reader) {
    const int code = reader.errors.manager.msg_code;
    if (code == JERR_OUT_OF_MEMORY || code == JERR_NO_BACKING_STORE)
        throw Error(ErrorCode::kLimit, "not enough memory to read the JPEG");
    throw Error(ErrorCode::kInput, std::string("damaged JPEG: ") + reader.errors.failure);
}

void open(Reader& reader, std::span<const std::byte> file) {
    jpeg_decompress_struct& jpeg = reader.jpeg;
    jpeg.err = install_jpeg_errors(reader.errors);
    const bool opened = guarded_jpeg(reader.errors, [&] {
        jpeg_create_decompress(&jpeg);
        jpeg.mem->max_memory_to_use = kMaxLibraryMemory;
        jpeg.progress = &reader.progress;
        reader.progress.progress_monitor = on_progress;
        jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(file.data()),
                     static_cast<unsigned long>(file.size()));
        jpeg_read_header(&jpeg, TRUE);
    });
    if (!opened) throw_damaged(reader);
}

// In place, from CMYK to RGBA. Photoshop and those after it store the inks inverted (255: no ink) and
// say so with an Adobe marker. The plain conversion without profiles: R = (1 - C) (1 - K).
void convert_cmyk(std::uint8_t* row, std::size_t width, bool inverted) {
    const unsigned flip = inverted ? 0 : 255;
    for (std::size_t x = 0; x < width; ++x, row += 4) {
        const unsigned white = row[3] ^ flip;
        for (int c = 0; c < 3; ++c) row[c] = static_cast<std::uint8_t>(((row[c] ^ flip) * white + 127) / 255);
        row[3] = 255;
    }
}

}  // namespace

bool is_jpeg(std::span<const std::byte> file) {
    return file.size() >= 3 && file[0] == std::byte{0xff} && file[1] == std::byte{0xd8} && file[2] == std::byte{0xff};
}

ImageInfo read_jpeg_info(std::span<const std::byte> file) {
    Reader reader;
    open(reader, file);
    ImageInfo info;
    info.codec = "jpeg";
    info.width = static_cast<int>(reader.jpeg.image_width);
    info.height = static_cast<int>(reader.jpeg.image_height);
    info.channels = reader.jpeg.num_components;
    info.bits = reader.jpeg.data_precision;
    return info;
}

Image decode_jpeg(std::span<const std::byte> file, std::uint64_t max_pixels) {
    Reader reader;
    open(reader, file);
    jpeg_decompress_struct& jpeg = reader.jpeg;
    check_image_size(jpeg.image_width, jpeg.image_height, max_pixels);
    // Huffman-coded data has at least a bit for each block, and a group of blocks covers at most
    // 32 x 32 pixels. A file too short for its claim is refused before the pixels are allocated.
    if (!jpeg.arith_code && std::uint64_t{jpeg.image_width} * jpeg.image_height / (8 * 32 * 32) > file.size())
        throw Error(ErrorCode::kInput, "damaged JPEG: too short for its size in pixels");

    const bool cmyk = jpeg.jpeg_color_space == JCS_CMYK || jpeg.jpeg_color_space == JCS_YCCK;
    jpeg.out_color_space = cmyk ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg.dct_method = JDCT_ISLOW;
    jpeg.do_fancy_upsampling = TRUE;
    jpeg.do_block_smoothing = FALSE;
    if (!guarded_jpeg(reader.errors, [&] { jpeg_start_decompress(&jpeg); })) throw_damaged(reader);

    Image image(static_cast<int>(jpeg.output_width), static_cast<int>(jpeg.output_height), PixelFormat::kRgba8);
    const std::size_t row_bytes = image.row_bytes();
    auto* pixels = image.data<std::uint8_t>();
    const bool decoded = guarded_jpeg(reader.errors, [&] {
        while (jpeg.output_scanline < jpeg.output_height) {
            JSAMPROW row = pixels + jpeg.output_scanline * row_bytes;
            jpeg_read_scanlines(&jpeg, &row, 1);
        }
        jpeg_finish_decompress(&jpeg);
    });
    if (!decoded) throw_damaged(reader);
    if (cmyk)
        for (int y = 0; y < image.height(); ++y)
            convert_cmyk(pixels + static_cast<std::size_t>(y) * row_bytes, static_cast<std::size_t>(image.width()),
                         jpeg.saw_Adobe_marker != 0);
    return image;
}

}  // namespace tessera
