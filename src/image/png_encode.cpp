// Writing PNG. The picture is cut into strips whose height depends on the picture alone, so that the
// bytes are the same for every number of threads. At the fast levels each strip is filtered and
// deflated by a task of its own (zlib, whose flush ends a strip at a byte border without the final
// mark, so that the strips join to one stream) and becomes one IDAT chunk. The higher levels filter in
// parallel and deflate the whole stream at once with libdeflate, for size.
#include "core/parallel.h"
#include "image/codecs.h"
#include "image/png_filter.h"

#include <tessera/error.h>

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>

namespace tessera {
namespace {

using Bytes = std::vector<std::uint8_t>;

// About as many filtered bytes per strip: enough for a good Huffman code, few enough to share out.
constexpr std::size_t kStripBytes = std::size_t{192} << 10;
// Up to this level strips are deflated in parallel; above, libdeflate takes the whole.
constexpr int kLastFastLevel = 1;

struct Layout {
    int width, height, channels, sample_bytes;
    std::size_t pixel_bytes, row_bytes;  // as written, without the filter's number
    std::size_t strip_rows, strips;
};

[[noreturn]] void throw_memory() { throw Error(ErrorCode::kLimit, "not enough memory to write a PNG"); }

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

Layout make_layout(const Image& image, const PngOptions& options) {
    Layout l{};
    l.width = image.width();
    l.height = image.height();
    l.sample_bytes = image.format() == PixelFormat::kRgba16 ? 2 : 1;
    l.channels = options.drop_opaque_alpha && is_opaque(image) ? 3 : 4;
    l.pixel_bytes = static_cast<std::size_t>(l.channels * l.sample_bytes);
    l.row_bytes = l.pixel_bytes * static_cast<std::size_t>(l.width);
    l.strip_rows = std::max<std::size_t>(1, kStripBytes / (l.row_bytes + 1));
    l.strips = (static_cast<std::size_t>(l.height) + l.strip_rows - 1) / l.strip_rows;
    return l;
}

// One row as PNG stores it: RGB or RGBA, 16-bit samples with the high byte first.
void pack_row(const Image& image, const Layout& l, std::size_t y, std::uint8_t* out) {
    const auto* in = image.data<std::uint8_t>() + y * image.row_bytes();
    const auto width = static_cast<std::size_t>(l.width);
    if (l.sample_bytes == 1) {
        if (l.channels == 4)
            std::memcpy(out, in, 4 * width);
        else
            for (std::size_t x = 0; x < width; ++x)
                for (std::size_t c = 0; c < 3; ++c) out[3 * x + c] = in[4 * x + c];
        return;
    }
    const auto* samples = image.data<std::uint16_t>() + 4 * y * width;
    const auto channels = static_cast<std::size_t>(l.channels);
    for (std::size_t x = 0; x < width; ++x)
        for (std::size_t c = 0; c < channels; ++c) {
            const std::uint16_t v = samples[4 * x + c];
            out[2 * (channels * x + c)] = static_cast<std::uint8_t>(v >> 8);
            out[2 * (channels * x + c) + 1] = static_cast<std::uint8_t>(v & 0xff);
        }
}

// Filters the rows of a strip into `out`. The row above the strip is read too: filters reach over
// strip borders, only deflate does not.
void filter_strip(const Image& image, const Layout& l, std::size_t strip, std::uint8_t* out) {
    PngFilter filter(l.row_bytes, l.pixel_bytes);
    Bytes above(l.row_bytes), row(l.row_bytes);
    const std::size_t first = strip * l.strip_rows;
    const std::size_t end = std::min(first + l.strip_rows, static_cast<std::size_t>(l.height));
    if (first > 0) pack_row(image, l, first - 1, above.data());
    for (std::size_t y = first; y < end; ++y, out += l.row_bytes + 1) {
        pack_row(image, l, y, row.data());
        filter.apply(row.data(), y > 0 ? above.data() : nullptr, out);
        row.swap(above);
    }
}

std::size_t filtered_bytes(const Layout& l, std::size_t strip) {
    const std::size_t first = strip * l.strip_rows;
    return (std::min(first + l.strip_rows, static_cast<std::size_t>(l.height)) - first) * (l.row_bytes + 1);
}

void put_big_endian(std::uint8_t* to, std::uint32_t v) {
    for (int i = 0; i < 4; ++i) to[i] = static_cast<std::uint8_t>(v >> (24 - 8 * i));
}

// Length, type, data, checksum of type and data.
Bytes make_chunk(const char* type, std::span<const std::uint8_t> data) {
    Bytes chunk(data.size() + 12);
    put_big_endian(&chunk[0], static_cast<std::uint32_t>(data.size()));
    std::memcpy(&chunk[4], type, 4);
    std::copy(data.begin(), data.end(), chunk.begin() + 8);
    put_big_endian(&chunk[8 + data.size()], libdeflate_crc32(0, &chunk[4], data.size() + 4));
    return chunk;
}

// Appends one strip as deflate blocks that end at a byte border. Run lengths and Huffman codes only
// (Z_RLE): on filtered rows nearly as small as level 1's matches, and several times as fast.
void deflate_strip(const Bytes& in, int level, Bytes& out) {
    z_stream stream{};
    if (deflateInit2(&stream, level, Z_DEFLATED, -15, 9, Z_RLE) != Z_OK) throw_memory();
    const std::size_t before = out.size();
    out.resize(before + deflateBound(&stream, static_cast<uLong>(in.size())) + 16);
    stream.next_in = const_cast<Bytef*>(in.data());
    stream.avail_in = static_cast<uInt>(in.size());
    stream.next_out = out.data() + before;
    stream.avail_out = static_cast<uInt>(out.size() - before);
    const int status = deflate(&stream, Z_SYNC_FLUSH);
    const bool complete = status == Z_OK && stream.avail_in == 0 && stream.avail_out > 0;
    out.resize(out.size() - stream.avail_out);
    deflateEnd(&stream);
    if (!complete) throw Error(ErrorCode::kInternal, "deflate failed");
}

// The zlib wrapper (RFC 1950): two bytes before the stream, the Adler-32 of the plain bytes after it.
constexpr std::array<std::uint8_t, 2> kZlibHeader{0x78, 0x01};

std::vector<Bytes> fast_data(const Image& image, const Layout& l, int level, Arena& arena) {
    std::vector<Bytes> chunks(l.strips + 1);
    std::vector<std::uint32_t> sums(l.strips);
    arena.for_each(l.strips, [&](std::size_t strip) {
        Bytes filtered(filtered_bytes(l, strip));
        filter_strip(image, l, strip, filtered.data());
        sums[strip] = libdeflate_adler32(1, filtered.data(), filtered.size());
        Bytes data;
        if (strip == 0) data.assign(kZlibHeader.begin(), kZlibHeader.end());
        deflate_strip(filtered, level, data);
        chunks[strip] = make_chunk("IDAT", data);
    });
    uLong sum = 1;
    for (std::size_t strip = 0; strip < l.strips; ++strip)
        sum = adler32_combine(sum, sums[strip], static_cast<z_off_t>(filtered_bytes(l, strip)));
    Bytes tail{0x03, 0x00, 0, 0, 0, 0};  // an empty final block, then the checksum
    put_big_endian(&tail[2], static_cast<std::uint32_t>(sum));
    chunks.back() = make_chunk("IDAT", tail);
    return chunks;
}

std::vector<Bytes> small_data(const Image& image, const Layout& l, int level, Arena& arena) {
    Bytes filtered((l.row_bytes + 1) * static_cast<std::size_t>(l.height));
    arena.for_each(l.strips, [&](std::size_t strip) {
        filter_strip(image, l, strip, filtered.data() + strip * l.strip_rows * (l.row_bytes + 1));
    });
    const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
        libdeflate_alloc_compressor(level), libdeflate_free_compressor);
    if (!compressor) throw_memory();
    Bytes stream(libdeflate_zlib_compress_bound(compressor.get(), filtered.size()));
    stream.resize(
        libdeflate_zlib_compress(compressor.get(), filtered.data(), filtered.size(), stream.data(), stream.size()));
    if (stream.empty()) throw Error(ErrorCode::kInternal, "deflate failed");
    // A chunk's length has 31 bits.
    constexpr std::size_t kLargest = std::size_t{1} << 30;
    std::vector<Bytes> chunks;
    for (std::size_t at = 0; at < stream.size(); at += kLargest)
        chunks.push_back(make_chunk("IDAT", std::span(stream).subspan(at, std::min(kLargest, stream.size() - at))));
    return chunks;
}

}  // namespace

std::vector<std::byte> encode_png(const Image& image, const PngOptions& options, Arena& arena) {
    if (image.empty()) throw Error(ErrorCode::kUsage, "an empty image cannot be written");
    if (image.format() != PixelFormat::kRgba8 && image.format() != PixelFormat::kRgba16)
        throw Error(ErrorCode::kUsage, "PNG takes 8-bit or 16-bit RGBA images");
    if (options.level < 0 || options.level > 12) throw Error(ErrorCode::kUsage, "the PNG level must be 0 to 12");

    const Layout l = make_layout(image, options);
    std::array<std::uint8_t, 13> header{};
    put_big_endian(&header[0], static_cast<std::uint32_t>(l.width));
    put_big_endian(&header[4], static_cast<std::uint32_t>(l.height));
    header[8] = static_cast<std::uint8_t>(8 * l.sample_bytes);
    header[9] = l.channels == 4 ? 6 : 2;  // RGBA or RGB; the rest: deflate, five filters, no interlace
    constexpr std::array<std::uint8_t, 1> perceptual{0};

    std::vector<Bytes> parts{
        {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, make_chunk("IHDR", header), make_chunk("sRGB", perceptual)};
    for (Bytes& chunk : options.level <= kLastFastLevel ? fast_data(image, l, options.level, arena)
                                                        : small_data(image, l, options.level, arena))
        parts.push_back(std::move(chunk));
    parts.push_back(make_chunk("IEND", {}));

    std::size_t size = 0;
    for (const Bytes& part : parts) size += part.size();
    std::vector<std::byte> file(size);
    std::byte* to = file.data();
    for (const Bytes& part : parts) {
        std::memcpy(to, part.data(), part.size());
        to += part.size();
    }
    return file;
}

std::vector<std::byte> encode_png(const Image& image, const PngOptions& options) {
    Arena arena(options.threads);
    return encode_png(image, options, arena);
}

}  // namespace tessera
