// Reading WebP (RFC 9649) through libwebp, which gives the same pixels on every processor. The header is
// read by us before the library sees the file.
#include "image/byte_cursor.h"
#include "image/codecs.h"

#include <webp/decode.h>

#include <algorithm>

namespace tessera {
namespace {

[[noreturn]] void fail(VP8StatusCode status) {
    if (status == VP8_STATUS_OUT_OF_MEMORY) throw Error(ErrorCode::kLimit, "not enough memory to read a WebP");
    throw Error(ErrorCode::kInput, status == VP8_STATUS_UNSUPPORTED_FEATURE ? "WebP with a feature that is not read"
                                   : status == VP8_STATUS_NOT_ENOUGH_DATA   ? "damaged WebP: truncated"
                                                                            : "damaged WebP");
}

// That the file has all of the picture's chunk, which its header promises: a few bytes must not ask for the memory of a
// large picture. `in` stands behind "WEBP". Chunks are padded to even sizes.
void check_chunks(ByteCursor in, std::uint64_t riff_bytes) {
    const auto truncated = [] { return Error(ErrorCode::kInput, "damaged WebP: truncated"); };
    if (riff_bytes < 4 || riff_bytes - 4 > in.rest()) throw truncated();
    std::uint64_t rest = riff_bytes - 4;
    while (rest >= 8) {
        const bool is_picture = in.begins_with("VP8 ") || in.begins_with("VP8L");
        in.skip(4);
        const std::uint64_t bytes = in.u32();
        rest -= 8;
        if (bytes > rest) throw truncated();
        if (is_picture) return;
        const std::uint64_t padded = std::min(bytes + bytes % 2, rest);
        in.skip(padded);
        rest -= padded;
    }
    throw Error(ErrorCode::kInput, "damaged WebP: no picture in it");
}

}  // namespace

bool is_webp(std::span<const std::byte> file) {
    return begins_with(file, "RIFF") && file.size() >= 12 && begins_with(file.subspan(8), "WEBP");
}

ImageInfo read_webp_info(std::span<const std::byte> file) {
    ByteCursor in(file, "WebP");
    in.skip(4);
    const std::uint32_t riff_bytes = in.u32();
    in.skip(4);
    const ByteCursor chunks = in;
    ImageInfo info;
    info.codec = "webp";
    info.channels = 3;
    if (in.begins_with("VP8X")) {
        in.skip(8);
        const std::uint32_t flags = in.u32();
        if ((flags & 0x02) != 0) throw Error(ErrorCode::kInput, "animated WebP is not read");
        if ((flags & 0x10) != 0) info.channels = 4;
        info.width = static_cast<int>(in.number(3)) + 1;
        info.height = static_cast<int>(in.number(3)) + 1;
    } else if (in.begins_with("VP8L")) {
        in.skip(8);
        if (in.u8() != 0x2f) throw Error(ErrorCode::kInput, "damaged WebP header");
        const std::uint32_t bits = in.u32();
        info.width = static_cast<int>(bits & 0x3fff) + 1;
        info.height = static_cast<int>(bits >> 14 & 0x3fff) + 1;
        if ((bits >> 28 & 1) != 0) info.channels = 4;
    } else if (in.begins_with("VP8 ")) {
        in.skip(8 + 3);
        if (!in.begins_with("\x9d\x01\x2a")) throw Error(ErrorCode::kInput, "damaged WebP header");
        in.skip(3);
        info.width = in.u16() & 0x3fff;
        info.height = in.u16() & 0x3fff;
    } else {
        throw Error(ErrorCode::kInput, "damaged WebP header");
    }
    check_chunks(chunks, riff_bytes);
    return info;
}

Image decode_webp(std::span<const std::byte> file, std::uint64_t max_pixels) {
    const ImageInfo info = read_webp_info(file);
    check_image_size(static_cast<std::uint64_t>(info.width), static_cast<std::uint64_t>(info.height), max_pixels);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(file.data());
    WebPDecoderConfig config;
    if (WebPInitDecoderConfig(&config) == 0) throw Error(ErrorCode::kInternal, "libwebp has another version");
    const VP8StatusCode known = WebPGetFeatures(bytes, file.size(), &config.input);
    if (known != VP8_STATUS_OK) fail(known);
    if (config.input.width != info.width || config.input.height != info.height || config.input.has_animation != 0)
        throw Error(ErrorCode::kInput, "damaged WebP: the picture has another shape than its header says");

    Image image(info.width, info.height, PixelFormat::kRgba8);
    config.output.colorspace = MODE_RGBA;
    config.output.is_external_memory = 1;
    config.output.u.RGBA = {image.data<std::uint8_t>(), static_cast<int>(image.row_bytes()), image.bytes().size()};
    const VP8StatusCode decoded = WebPDecode(bytes, file.size(), &config);
    WebPFreeDecBuffer(&config.output);
    if (decoded != VP8_STATUS_OK) fail(decoded);
    return image;
}

}  // namespace tessera
