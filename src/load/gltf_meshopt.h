// EXT_meshopt_compression: buffer views that meshoptimizer packed.
#pragma once

#include "load/context.h"
#include "load/file.h"
#include "load/json.h"

#include <cstddef>
#include <span>

namespace tessera {

// `json`: the extension object of a buffer view. Throws kInput for what cannot be unpacked; memory is
// charged before it is taken.
Bytes unpack_meshopt(LoadContext& context, const Json& json, std::span<const std::byte> packed);

}  // namespace tessera
