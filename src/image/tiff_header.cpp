// The first page's header of a TIFF file (TIFF 6.0; BigTIFF), read by us before the library sees the
// file: what it claims is checked against the bytes that are there and against the limits.
#include "image/byte_cursor.h"
#include "image/codecs.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tessera {
namespace {

using namespace std::string_view_literals;

constexpr std::array<std::string_view, 4> kMagics{"II\x2a\0"sv, "MM\0\x2a"sv, "II\x2b\0"sv, "MM\0\x2b"sv};
constexpr std::uint64_t kMostEntries = 1024, kMostSamples = 64;
// No compression, LZW, JPEG, deflate (two numbers), PackBits.
constexpr std::array<std::uint64_t, 6> kCompressions{1, 5, 7, 8, 32946, 32773};
// The compressions above make at most so many bytes of one; LZW comes nearest.
constexpr std::uint64_t kLargestRatio = 4096;
constexpr std::uint64_t kSmallTile = std::uint64_t{64} << 20;

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::kInput, what); }

struct Tags {
    std::uint64_t width = 0, height = 0, samples = 1, bits = 1, compression = 1, format = 1;
    std::uint64_t tile_width = 0, tile_height = 0, extra = UINT64_MAX, photometric = 0;
    bool same_bits = true;
};

// The first value of an entry; whether all of up to kMostSamples are equal goes to `same`.
std::uint64_t read_values(ByteCursor entry, std::uint32_t type, std::uint64_t count, bool big, bool& same) {
    const std::size_t bytes = type == 1 ? 1 : type == 3 ? 2 : type == 4 ? 4 : type == 16 ? 8 : 0;
    if (bytes == 0 || count == 0) fail("damaged TIFF: a tag of an unknown type");
    const std::uint64_t shown = std::min(count, kMostSamples);
    const std::size_t room = big ? 8 : 4;
    if (count > room / bytes) entry.seek(entry.number(room));
    const std::uint64_t first = entry.number(bytes);
    same = true;
    for (std::uint64_t i = 1; i < shown; ++i) same = entry.number(bytes) == first && same;
    return first;
}

Tags read_tags(ByteCursor& in) {
    const bool little = in.begins_with("II");
    in.set_big_endian(!little);
    in.skip(2);
    const bool big = in.u16() == 43;
    if (big && (in.u16() != 8 || in.u16() != 0)) fail("damaged TIFF header");
    in.seek(in.number(big ? 8 : 4));
    const std::uint64_t count = in.number(big ? 8 : 2);
    if (count > kMostEntries) fail("TIFF with more than 1024 tags is not read");
    Tags tags;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint16_t tag = in.u16(), type = in.u16();
        const std::uint64_t values = in.number(big ? 8 : 4);
        const ByteCursor value = in;
        in.skip(big ? 8 : 4);
        constexpr std::array<std::pair<std::uint16_t, std::uint64_t Tags::*>, 10> kKnown{{
            {256, &Tags::width},
            {257, &Tags::height},
            {258, &Tags::bits},
            {259, &Tags::compression},
            {262, &Tags::photometric},
            {277, &Tags::samples},
            {322, &Tags::tile_width},
            {323, &Tags::tile_height},
            {338, &Tags::extra},
            {339, &Tags::format},
        }};
        for (const auto& [number, member] : kKnown) {
            if (number != tag) continue;
            bool same = true;
            tags.*member = read_values(value, type, values, big, same);
            if (tag == 258 || tag == 339) tags.same_bits = tags.same_bits && same;
        }
    }
    return tags;
}

void check_tags(const Tags& tags, std::size_t file_bytes) {
    if (tags.width == 0 || tags.height == 0 || tags.width > UINT32_MAX || tags.height > UINT32_MAX)
        fail("damaged TIFF: no size in pixels");
    if (std::find(kCompressions.begin(), kCompressions.end(), tags.compression) == kCompressions.end())
        fail("TIFF of compression " + std::to_string(tags.compression) + " is not read");
    if (tags.samples == 0 || tags.samples > kMostSamples) fail("TIFF with more than 64 samples is not read");
    const bool floating = tags.format == 3;
    const bool known = floating ? tags.bits == 16 || tags.bits == 32 : tags.format == 1 || tags.format == 4;
    if (!known || !tags.same_bits || (tags.bits > 16 && !floating) || (tags.bits & (tags.bits - 1)) != 0 ||
        tags.bits == 0)
        fail("TIFF with samples of this kind is not read (8 or 16 bits, or 32-bit float)");
    if (tags.width > kMaxImageSide || tags.height > kMaxImageSide) return;  // refused by the caller
    const std::uint64_t pixel_bits = tags.samples * tags.bits;
    const std::uint64_t picture = tags.width * tags.height * pixel_bits / 8;
    if (picture / kLargestRatio > file_bytes) fail("damaged TIFF: too short for its size in pixels");
    if (tags.tile_width > kMaxImageSide || tags.tile_height > kMaxImageSide ||
        tags.tile_width * tags.tile_height * pixel_bits / 8 > std::max(kSmallTile, picture))
        fail("TIFF with tiles that are too large is not read");
}

}  // namespace

bool is_tiff(std::span<const std::byte> file) {
    return std::any_of(kMagics.begin(), kMagics.end(), [&](std::string_view m) { return begins_with(file, m); });
}

ImageInfo read_tiff_info(std::span<const std::byte> file) {
    ByteCursor in(file, "TIFF");
    const Tags tags = read_tags(in);
    check_tags(tags, file.size());
    ImageInfo info;
    info.codec = "tiff";
    info.width = static_cast<int>(std::min<std::uint64_t>(tags.width, INT32_MAX));
    info.height = static_cast<int>(std::min<std::uint64_t>(tags.height, INT32_MAX));
    constexpr std::uint64_t kPalette = 3;
    info.channels = tags.photometric == kPalette ? 3 : static_cast<int>(tags.samples);
    info.bits = static_cast<int>(tags.bits);
    info.floating = tags.format == 3;
    info.premultiplied = tags.extra == 1;
    return info;
}

}  // namespace tessera
