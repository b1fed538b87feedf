// How many threads a process may use: what `threads = 0` means in every option of the library. For hosts that share
// them out over several renderers. Any thread may ask.
#pragma once

#include <tessera/export.h>

namespace tessera {

// The affinity mask and the cgroup's CPU quota count; at least 1.
TESSERA_API int available_threads();

}  // namespace tessera
