// A rendered picture as the bytes of a file.
#pragma once

#include "cli/render_arguments.h"

#include <cstddef>
#include <vector>

namespace tessera::cli {

// Reduces the colour plane as the job says, and notes its hash.
void finish_color(const RenderJob& job, RenderResult& result);
std::vector<std::byte> encode_color(const RenderJob& job, const RenderResult& result);

}  // namespace tessera::cli
