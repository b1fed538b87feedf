// The GLB container (glTF 2.0, chapter 4): a 12-byte header, a JSON chunk, at most one BIN chunk, and
// chunks of other types, which are skipped. Little-endian.
#pragma once

#include "load/context.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace tessera {

struct GlbChunks {
    std::string_view json;
    std::optional<std::span<const std::byte>> binary;
};

bool is_glb(std::span<const std::byte> file);
// Views into `file`. Throws kInput unless all lengths fit.
GlbChunks split_glb(LoadContext& context, std::span<const std::byte> file);

}  // namespace tessera
