// Reading PNG through libpng. Its default error handlers print and exit; here an error jumps back to
// guarded(), which returns false. No object with a destructor lives in a frame that such a jump
// leaves: the owner of the libpng structures is the function that calls guarded().
#include "image/codecs.h"

#include <tessera/error.h>

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstring>

namespace tessera {
namespace {

constexpr unsigned char kSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
// Signature, length, "IHDR", 13 bytes, checksum.
constexpr std::size_t kHeaderBytes = 33;

struct Header {
    std::uint32_t width = 0, height = 0;
    int depth = 0, color_type = 0;
};

std::uint32_t big_endian(const std::byte* p) {
    return static_cast<std::uint32_t>(p[0]) << 24 | static_cast<std::uint32_t>(p[1]) << 16 |
           static_cast<std::uint32_t>(p[2]) << 8 | static_cast<std::uint32_t>(p[3]);
}

int stored_channels(int color_type) {
    switch (color_type) {
        case PNG_COLOR_TYPE_GRAY_ALPHA:
            return 2;
        case PNG_COLOR_TYPE_RGB:
            return 3;
        case PNG_COLOR_TYPE_RGB_ALPHA:
            return 4;
        default:
            return 1;
    }
}

Header read_header(std::span<const std::byte> file) {
    if (!is_png(file)) throw Error(ErrorCode::kInput, "not a PNG file");
    if (file.size() < kHeaderBytes) throw Error(ErrorCode::kInput, "truncated PNG header");
    if (big_endian(&file[8]) != 13 || std::memcmp(&file[12], "IHDR", 4) != 0 ||
        libdeflate_crc32(0, &file[12], 17) != big_endian(&file[29]))
        throw Error(ErrorCode::kInput, "damaged PNG header");
    Header header;
    header.width = big_endian(&file[16]);
    header.height = big_endian(&file[20]);
    header.depth = static_cast<int>(file[24]);
    header.color_type = static_cast<int>(file[25]);
    return header;
}

// libpng's state with its owner. `failure` is written by the error handler.
struct Reader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::span<const std::byte> rest;
    char failure[160] = "";

    Reader() = default;
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
    auto* reader = static_cast<Reader*>(png_get_error_ptr(png));
    std::snprintf(reader->failure, sizeof reader->failure, "%s", message);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, png_size_t count) {
    auto* reader = static_cast<Reader*>(png_get_io_ptr(png));
    if (count > reader->rest.size()) png_error(png, "truncated file");
    std::memcpy(to, reader->rest.data(), count);
    reader->rest = reader->rest.subspan(count);
}

// Calls step(); false when libpng reported an error in it.
template <class Step>
[[gnu::noinline]] bool guarded(png_structp png, const Step& step) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    step();
    return true;
}

// Everything becomes RGBA with 8 or 16 bits in the machine's byte order.
void set_transforms(png_structp png, bool wide) {
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, wide ? 0xffff : 0xff, PNG_FILLER_AFTER);
    if (wide)
        png_set_swap(png);
    else
        png_set_scale_16(png);
}

[[noreturn]] void throw_damaged(const Reader& reader) {
    throw Error(ErrorCode::kInput, std::string("damaged PNG: ") + reader.failure);
}

}  // namespace

bool is_png(std::span<const std::byte> file) {
    return file.size() >= sizeof kSignature && std::memcmp(file.data(), kSignature, sizeof kSignature) == 0;
}

ImageInfo read_png_info(std::span<const std::byte> file) {
    const Header header = read_header(file);
    ImageInfo info;
    info.codec = "png";
    info.width = static_cast<int>(std::min<std::uint32_t>(header.width, PNG_UINT_31_MAX));
    info.height = static_cast<int>(std::min<std::uint32_t>(header.height, PNG_UINT_31_MAX));
    info.channels = header.color_type == PNG_COLOR_TYPE_PALETTE ? 3 : stored_channels(header.color_type);
    info.bits = header.depth;
    return info;
}

Image decode_png(std::span<const std::byte> file, std::uint64_t max_pixels, bool keep_16_bit) {
    const Header header = read_header(file);
    check_image_size(header.width, header.height, max_pixels);
    // Deflate makes at most 258 bytes of 2 bits. A file too short for its claim is refused before
    // the pixels are allocated.
    const std::uint64_t row_bits =
        std::uint64_t{header.width} * static_cast<unsigned>(header.depth * stored_channels(header.color_type));
    if ((row_bits + 7) / 8 * header.height / 1032 > file.size())
        throw Error(ErrorCode::kInput, "damaged PNG: too short for its size in pixels");

    Reader reader;
    reader.rest = file;
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
    if (reader.png != nullptr) reader.info = png_create_info_struct(reader.png);
    if (reader.info == nullptr) throw Error(ErrorCode::kLimit, "not enough memory to read a PNG");

    const bool wide = header.depth == 16 && keep_16_bit;
    int passes = 1;
    const bool opened = guarded(reader.png, [&] {
        png_set_read_fn(reader.png, &reader, on_read);
        png_set_user_limits(reader.png, kMaxImageSide, kMaxImageSide);
        // Only header, palette, transparency and pixels matter: no text or profile is kept or inflated.
        png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
        static const png_byte ignored[] = "iCCP\0iTXt\0tEXt\0zTXt\0sPLT\0eXIf\0gAMA\0cHRM\0sRGB\0hIST";
        png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, ignored, sizeof ignored / 5);
        png_set_chunk_malloc_max(reader.png, png_alloc_size_t{1} << 20);
        png_set_chunk_cache_max(reader.png, 64);
        png_read_info(reader.png, reader.info);
        set_transforms(reader.png, wide);
        passes = png_set_interlace_handling(reader.png);
        png_read_update_info(reader.png, reader.info);
    });
    if (!opened) throw_damaged(reader);

    Image image(static_cast<int>(header.width), static_cast<int>(header.height),
                wide ? PixelFormat::kRgba16 : PixelFormat::kRgba8);
    const std::size_t row_bytes = image.row_bytes();
    if (png_get_rowbytes(reader.png, reader.info) != row_bytes ||
        png_get_image_height(reader.png, reader.info) != header.height)
        throw Error(ErrorCode::kInput, "damaged PNG: inconsistent header");
    auto* pixels = image.data<png_byte>();
    const bool decoded = guarded(reader.png, [&] {
        for (int pass = 0; pass < passes; ++pass)
            for (std::uint32_t y = 0; y < header.height; ++y) png_read_row(reader.png, pixels + y * row_bytes, nullptr);
        png_read_end(reader.png, nullptr);
    });
    if (!decoded) throw_damaged(reader);
    return image;
}

}  // namespace tessera
