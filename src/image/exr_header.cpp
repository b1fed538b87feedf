#include "image/exr_header.h"

#include "image/byte_cursor.h"
#include "image/codecs.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tessera {
namespace {

constexpr std::string_view kMagic("\x76\x2f\x31\x01", 4);
constexpr std::size_t kMostAttributes = 1024, kMostChannels = 1024, kLongestName = 255;
// Lines per chunk: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
constexpr std::array<std::uint32_t, 10> kLines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
// A chunk may take so much memory even where it is more than the whole picture.
constexpr std::uint64_t kSmallChunk = std::uint64_t{64} << 20;

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::kInput, what); }

struct Reading {
    ExrHeader header;
    bool has_window = false, has_tiles = false;
    std::uint32_t tile_width = 0, tile_height = 0, compression = UINT32_MAX;
};

void read_channels(ByteCursor& in, std::size_t end, ExrHeader& header) {
    while (true) {
        const std::string_view name = in.text(kLongestName);
        if (name.empty()) break;
        constexpr std::array<ChannelType, 3> kTypes{ChannelType::kUint, ChannelType::kHalf, ChannelType::kFloat};
        const std::uint32_t type = in.u32();
        if (type >= kTypes.size()) fail("damaged EXR: unknown type of a channel");
        in.skip(4);
        if (in.u32() != 1 || in.u32() != 1) fail("EXR with subsampled channels is not read");
        if (header.channels.size() == kMostChannels) fail("EXR with more than 1024 channels is not read");
        header.channels.push_back({std::string(name), kTypes[type]});
    }
    if (in.position() != end) fail("damaged EXR: list of channels");
}

void read_window(ByteCursor& in, Reading& reading) {
    const std::int64_t left = in.i32(), top = in.i32(), right = in.i32(), bottom = in.i32();
    if (right < left || bottom < top) fail("damaged EXR: empty data window");
    reading.header.width = static_cast<std::uint32_t>(std::min<std::int64_t>(right - left + 1, UINT32_MAX));
    reading.header.height = static_cast<std::uint32_t>(std::min<std::int64_t>(bottom - top + 1, UINT32_MAX));
    reading.has_window = true;
}

void read_attribute(ByteCursor& in, std::string_view name, std::string_view type, std::uint32_t size,
                    Reading& reading) {
    if (name == "channels" && type == "chlist") {
        if (!reading.header.channels.empty()) fail("damaged EXR: two lists of channels");
        read_channels(in, in.position() + size, reading.header);
    } else if (name == "dataWindow" && type == "box2i" && size == 16) {
        read_window(in, reading);
    } else if (name == "compression" && type == "compression" && size == 1) {
        reading.compression = in.u8();
        if (reading.compression >= kLines.size()) fail("EXR with an unknown compression");
    } else if (name == "tiles" && type == "tiledesc" && size == 9) {
        reading.tile_width = in.u32(), reading.tile_height = in.u32();
        reading.has_tiles = true;
    } else if (name == "type" && type == "string" && size >= 4 && in.begins_with("deep")) {
        fail("deep EXR is not read");
    }
}

// What the decoder takes at a time, and the least bytes that the file needs for its chunks: the place of
// each in a table, and a head of 8.
void check_chunks(const Reading& reading, bool tiled, std::size_t file_bytes) {
    const ExrHeader& header = reading.header;
    std::uint64_t pixel_bytes = 0;
    for (const ExrHeader::Channel& channel : header.channels) pixel_bytes += bytes_of(channel.type);
    const std::uint64_t lines = kLines[reading.compression];
    const std::uint64_t width = tiled ? reading.tile_width : header.width;
    const std::uint64_t height = tiled ? reading.tile_height : lines;
    if (width == 0 || height == 0) fail("damaged EXR: empty tiles");
    const std::uint64_t picture = std::uint64_t{header.width} * header.height * pixel_bytes;
    if (width > kMaxImageSide || height > kMaxImageSide ||
        width * height * pixel_bytes > std::max(kSmallChunk, picture))
        fail("EXR with tiles or strips that are too large is not read");
    const std::uint64_t chunks = ((header.width + width - 1) / width) * ((header.height + height - 1) / height);
    if (chunks * 16 > file_bytes) fail("damaged EXR: too short for its size in pixels");
}

}  // namespace

const ExrHeader::Channel* ExrHeader::find(const std::string& name) const {
    const auto found = std::find_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == name; });
    return found == channels.end() ? nullptr : &*found;
}

bool is_exr(std::span<const std::byte> file) { return begins_with(file, kMagic); }

ExrHeader read_exr_header(std::span<const std::byte> file) {
    ByteCursor in(file, "EXR");
    in.skip(kMagic.size());
    const std::uint32_t version = in.u32();
    if ((version & 0xff) != 2) fail("EXR of version " + std::to_string(version & 0xff) + "; version 2 is read");
    if ((version & 0x800) != 0) fail("deep EXR is not read");
    if ((version & 0x1000) != 0) fail("EXR of several parts is not read");
    Reading reading;
    for (std::size_t count = 0;; ++count) {
        const std::string_view name = in.text(kLongestName);
        if (name.empty()) break;
        if (count == kMostAttributes) fail("EXR with more than 1024 attributes is not read");
        const std::string_view type = in.text(kLongestName);
        const std::uint32_t size = in.u32();
        ByteCursor value = in;
        in.skip(size);
        read_attribute(value, name, type, size, reading);
    }
    const bool tiled = (version & 0x200) != 0;
    if (!reading.has_window || reading.header.channels.empty() || reading.compression == UINT32_MAX ||
        (tiled && !reading.has_tiles))
        fail("damaged EXR: incomplete header");
    // Sides that no picture has are refused by the caller, with the limit's own words.
    if (reading.header.width <= kMaxImageSide && reading.header.height <= kMaxImageSide)
        check_chunks(reading, tiled, file.size());
    return std::move(reading.header);
}

ImageInfo read_exr_info(std::span<const std::byte> file) {
    const ExrHeader header = read_exr_header(file);
    ImageInfo info;
    info.codec = "exr";
    info.width = static_cast<int>(std::min<std::uint32_t>(header.width, INT32_MAX));
    info.height = static_cast<int>(std::min<std::uint32_t>(header.height, INT32_MAX));
    info.channels = static_cast<int>(header.channels.size());
    info.bits = 16;
    for (const ExrHeader::Channel& channel : header.channels)
        if (channel.type != ChannelType::kHalf) info.bits = 32;
    info.floating = true;
    info.premultiplied = header.find("A") != nullptr;
    return info;
}

}  // namespace tessera
