// The header of an OpenEXR file ("OpenEXR File Layout", openexr.com), read by us before the library sees
// the file: what it claims is checked against the bytes that are there and against the limits.
#pragma once

#include <tessera/image_files.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

struct ExrHeader {
    struct Channel {
        std::string name;
        ChannelType type = ChannelType::kHalf;
    };
    std::uint32_t width = 0, height = 0;  // of the data window
    std::vector<Channel> channels;        // ordered by name

    const Channel* find(const std::string& name) const;
};

inline std::size_t bytes_of(ChannelType type) { return type == ChannelType::kHalf ? 2 : 4; }

// Throws kInput for what is damaged or not read: several parts, deep data, subsampled channels, tiles and
// strips whose memory is out of proportion.
ExrHeader read_exr_header(std::span<const std::byte> file);

}  // namespace tessera
