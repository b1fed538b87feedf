#include "load/glb.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "the reader copies little-endian data");

constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a, kBinary = 0x004e4942;
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

std::uint32_t read_u32(std::span<const std::byte> file, std::size_t offset) {
    std::uint32_t value;
    std::memcpy(&value, file.data() + offset, sizeof value);
    return value;
}

}  // namespace

bool is_glb(std::span<const std::byte> file) { return file.size() >= 4 && read_u32(file, 0) == kMagic; }

GlbChunks split_glb(LoadContext& context, std::span<const std::byte> file) {
    if (file.size() < kHeaderBytes) context.fail("truncated GLB header");
    const std::uint32_t version = read_u32(file, 4), length = read_u32(file, 8);
    if (version != 2) context.fail("GLB version " + std::to_string(version) + "; version 2 is read", "byte 4");
    if (length > file.size())
        context.fail("truncated GLB: " + std::to_string(file.size()) + " of " + std::to_string(length) + " bytes",
                     "byte 8");
    if (length < kHeaderBytes) context.fail("the GLB length is smaller than its header", "byte 8");
    if (length < file.size()) context.warn("data after the end of the GLB is ignored");

    GlbChunks chunks;
    std::size_t offset = kHeaderBytes;
    for (std::size_t number = 0; offset < length; ++number) {
        const std::string place = "byte " + std::to_string(offset);
        if (length - offset < kChunkHeaderBytes) context.fail("truncated GLB chunk header", place);
        const std::size_t size = read_u32(file, offset);
        const std::uint32_t type = read_u32(file, offset + 4);
        offset += kChunkHeaderBytes;
        if (size > length - offset)
            context.fail("GLB chunk of " + std::to_string(size) + " bytes where " + std::to_string(length - offset) +
                             " are left",
                         place);
        const std::span<const std::byte> data = file.subspan(offset, size);
        if (number == 0) {
            if (type != kJson) context.fail("the first GLB chunk is not JSON", place);
            chunks.json = {reinterpret_cast<const char*>(data.data()), data.size()};
        } else if (type == kBinary && !chunks.binary) {
            chunks.binary = data;
        } else if (type == kJson || type == kBinary) {
            context.fail("a second GLB chunk of the same type", place);
        }
        offset += size;
    }
    if (chunks.json.data() == nullptr) context.fail("GLB without a JSON chunk");
    return chunks;
}

}  // namespace tessera
