// Pictures as PNG: RGB and RGBA of 8 and 16 bits, and index planes with their palette.
#include "core/parallel.h"
#include "image/codecs.h"
#include "image/indexed.h"
#include "image/png_stream.h"

#include <tessera/error.h>
#include <tessera/planes.h>

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

bool is_opaque(const Image& image) {
    if (image.format() == PixelFormat::kRgba8) {
        const auto* p = image.data<std::uint8_t>();
        std::uint8_t all = 0xff;
        for (std::size_t i = 3, n = image.bytes().size(); i < n; i += 4) all &= p[i];
        return all == 0xff;
    }
    const auto* p = image.data<std::uint16_t>();
    std::uint16_t all = 0xffff;
    for (std::size_t i = 3, n = image.bytes().size() / 2; i < n; i += 4) all &= p[i];
    return all == 0xffff;
}

void pack_rgba8(const Image& image, std::size_t channels, std::size_t y, std::uint8_t* out) {
    const auto* in = image.data<std::uint8_t>() + y * image.row_bytes();
    const auto width = static_cast<std::size_t>(image.width());
    if (channels == 4)
        std::memcpy(out, in, 4 * width);
    else
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < 3; ++c) out[3 * x + c] = in[4 * x + c];
}

// The high byte first.
void pack_rgba16(const Image& image, std::size_t channels, std::size_t y, std::uint8_t* out) {
    const auto width = static_cast<std::size_t>(image.width());
    const auto* samples = image.data<std::uint16_t>() + 4 * y * width;
    for (std::size_t x = 0; x < width; ++x)
        for (std::size_t c = 0; c < channels; ++c) {
            const std::uint16_t v = samples[4 * x + c];
            out[2 * (channels * x + c)] = static_cast<std::uint8_t>(v >> 8);
            out[2 * (channels * x + c) + 1] = static_cast<std::uint8_t>(v & 0xff);
        }
}

}  // namespace

std::vector<std::byte> encode_png(const Image& image, const PngOptions& options, Arena& arena) {
    if (image.empty()) throw Error(ErrorCode::kUsage, "an empty image cannot be written");
    const bool wide = image.format() == PixelFormat::kRgba16;
    if (!wide && image.format() != PixelFormat::kRgba8)
        throw Error(ErrorCode::kUsage, "PNG takes 8-bit or 16-bit RGBA images");

    PngRows rows;
    rows.width = image.width(), rows.height = image.height();
    rows.bits = wide ? 16 : 8;
    const std::size_t channels = options.drop_opaque_alpha && is_opaque(image) ? 3 : 4;
    rows.color = channels == 3 ? PngColor::kRgb : PngColor::kRgba;
    rows.pack = [&image, channels, wide](std::size_t y, std::uint8_t* out) {
        wide ? pack_rgba16(image, channels, y, out) : pack_rgba8(image, channels, y, out);
    };
    return write_png(rows, options.level, arena);
}

std::vector<std::byte> encode_png(const Image& image, const PngOptions& options) {
    Arena arena(options.threads);
    return encode_png(image, options, arena);
}

std::vector<std::byte> encode_png(const IndexedImage& image, const PngOptions& options) {
    check_indexed(image);
    PngRows rows;
    rows.width = image.width, rows.height = image.height;
    const std::size_t count = image.colormap.size();
    rows.bits = count <= 2 ? 1 : count <= 4 ? 2 : count <= 16 ? 4 : 8;
    rows.color = PngColor::kPalette;
    std::size_t last_clear = 0;  // entries up to the last that is not opaque
    for (const Rgba8& entry : image.colormap) {
        rows.palette.insert(rows.palette.end(), {entry.r, entry.g, entry.b});
        rows.alpha.push_back(entry.a);
        if (entry.a < 255) last_clear = rows.alpha.size();
    }
    rows.alpha.resize(last_clear);
    rows.pack = [&image, bits = static_cast<unsigned>(rows.bits)](std::size_t y, std::uint8_t* out) {
        const auto width = static_cast<std::size_t>(image.width);
        const std::uint8_t* in = image.indices.data() + y * width;
        const std::size_t per_byte = 8 / bits;
        for (std::size_t x = 0; x < width; x += per_byte) {
            unsigned byte = 0;
            for (std::size_t i = 0; i < per_byte; ++i) byte = byte << bits | (x + i < width ? in[x + i] : 0u);
            *out++ = static_cast<std::uint8_t>(byte);
        }
    };
    Arena arena(options.threads);
    return write_png(rows, options.level, arena);
}

}  // namespace tessera
