// Memory that is large and read out of order takes pages of 2 MiB where the system offers them: otherwise
// the processor looks a page up for every few cache lines. A hint, without effect on contents.
#pragma once

#include <cstddef>

namespace tessera {

// For fresh memory, before anything is written to it. Does nothing for less than one such page.
void prefer_huge_pages(void* data, std::size_t bytes);

}  // namespace tessera
