// Writing PNG. The picture is cut into strips whose height depends on the picture alone, so that the
// bytes are the same for every number of threads. At the fast levels each strip is filtered and
// deflated by a task of its own (zlib, whose flush ends a strip at a byte border without the final
// mark, so that the strips join to one stream) and becomes one IDAT chunk. The higher levels filter in
// parallel and deflate the whole stream at once with libdeflate, for size.
#include "image/png_stream.h"

#include "core/parallel.h"
#include "image/png_filter.h"

#include <tessera/error.h>

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <span>

namespace tessera {
namespace {

using Bytes = std::vector<std::uint8_t>;

// About as many filtered bytes per strip: enough for a good Huffman code, few enough to share out.
constexpr std::size_t kStripBytes = std::size_t{192} << 10;
// Up to this level strips are deflated in parallel; above, libdeflate takes the whole.
constexpr int kLastFastLevel = 1;

struct Layout {
    std::size_t height, pixel_bytes, row_bytes;  // as written, without the filter's number
    std::size_t strip_rows, strips;
};

[[noreturn]] void throw_memory() { throw Error(ErrorCode::kLimit, "not enough memory to write a PNG"); }

Layout make_layout(const PngRows& rows) {
    const int samples = rows.color == PngColor::kRgba ? 4 : rows.color == PngColor::kRgb ? 3 : 1;
    const auto pixel_bits = static_cast<std::size_t>(samples * rows.bits);
    Layout l{};
    l.height = static_cast<std::size_t>(rows.height);
    l.pixel_bytes = (pixel_bits + 7) / 8;
    l.row_bytes = (pixel_bits * static_cast<std::size_t>(rows.width) + 7) / 8;
    l.strip_rows = std::max<std::size_t>(1, kStripBytes / (l.row_bytes + 1));
    l.strips = (l.height + l.strip_rows - 1) / l.strip_rows;
    return l;
}

// Filters the rows of a strip into `out`. The row above the strip is read too: filters reach over
// strip borders, only deflate does not. Indices stay as they are: their differences mean nothing.
void filter_strip(const PngRows& rows, const Layout& l, std::size_t strip, std::uint8_t* out) {
    const std::size_t first = strip * l.strip_rows, end = std::min(first + l.strip_rows, l.height);
    if (rows.color == PngColor::kPalette) {
        for (std::size_t y = first; y < end; ++y, out += l.row_bytes + 1) out[0] = 0, rows.pack(y, out + 1);
        return;
    }
    PngFilter filter(l.row_bytes, l.pixel_bytes);
    Bytes above(l.row_bytes), row(l.row_bytes);
    if (first > 0) rows.pack(first - 1, above.data());
    for (std::size_t y = first; y < end; ++y, out += l.row_bytes + 1) {
        rows.pack(y, row.data());
        filter.apply(row.data(), y > 0 ? above.data() : nullptr, out);
        row.swap(above);
    }
}

std::size_t filtered_bytes(const Layout& l, std::size_t strip) {
    const std::size_t first = strip * l.strip_rows;
    return (std::min(first + l.strip_rows, l.height) - first) * (l.row_bytes + 1);
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

std::vector<Bytes> fast_data(const PngRows& rows, const Layout& l, int level, Arena& arena) {
    std::vector<Bytes> chunks(l.strips + 1);
    std::vector<std::uint32_t> sums(l.strips);
    arena.for_each(l.strips, [&](std::size_t strip) {
        Bytes filtered(filtered_bytes(l, strip));
        filter_strip(rows, l, strip, filtered.data());
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

std::vector<Bytes> small_data(const PngRows& rows, const Layout& l, int level, Arena& arena) {
    Bytes filtered((l.row_bytes + 1) * l.height);
    arena.for_each(l.strips, [&](std::size_t strip) {
        filter_strip(rows, l, strip, filtered.data() + strip * l.strip_rows * (l.row_bytes + 1));
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

std::vector<std::byte> write_png(const PngRows& rows, int level, Arena& arena) {
    if (level < 0 || level > 12) throw Error(ErrorCode::kUsage, "the PNG level must be 0 to 12");
    std::array<std::uint8_t, 13> header{};
    put_big_endian(&header[0], static_cast<std::uint32_t>(rows.width));
    put_big_endian(&header[4], static_cast<std::uint32_t>(rows.height));
    header[8] = static_cast<std::uint8_t>(rows.bits);
    header[9] = static_cast<std::uint8_t>(rows.color);  // the rest: deflate, five filters, no interlace
    constexpr std::array<std::uint8_t, 1> perceptual{0};

    std::vector<Bytes> parts{{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, make_chunk("IHDR", header)};
    if (rows.is_picture) parts.push_back(make_chunk("sRGB", perceptual));
    if (!rows.palette.empty()) parts.push_back(make_chunk("PLTE", rows.palette));
    if (!rows.alpha.empty()) parts.push_back(make_chunk("tRNS", rows.alpha));
    const Layout l = make_layout(rows);
    for (Bytes& chunk : level <= kLastFastLevel ? fast_data(rows, l, level, arena) : small_data(rows, l, level, arena))
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

}  // namespace tessera
