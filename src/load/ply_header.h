// The header of a PLY file: which elements follow, and which properties they have.
#pragma once

#include "load/context.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };
enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t size_of(PlyType type);
inline bool is_integer(PlyType type) { return type < PlyType::kFloat32; }

struct PlyProperty {
    std::string name;
    PlyType type;  // of a list: of its items
    bool is_list = false;
    PlyType length_type = PlyType::kUint8;  // of a list
};

struct PlyElement {
    std::string name;
    std::uint64_t count;
    std::vector<PlyProperty> properties;

    // The number of the property, or -1.
    int find(std::string_view property) const;
    // Bytes that one of it takes at least.
    std::uint64_t least_bytes(PlyEncoding encoding) const;
};

struct PlyHeader {
    PlyEncoding encoding;
    std::vector<PlyElement> elements;
    std::vector<std::string> texture_files;  // of "comment TextureFile", with forward slashes
    std::size_t size;                        // bytes; the data follow
    std::size_t lines;                       // of the header
};

// Throws kInput for a damaged header, and for elements that the rest of the file cannot hold.
PlyHeader read_ply_header(LoadContext& context, std::string_view file);

}  // namespace tessera
