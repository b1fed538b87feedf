// What index planes of the public header (tessera/planes.h) have in common inside the library.
#pragma once

#include <tessera/planes.h>

namespace tessera {

// Throws kUsage unless the sides, the number of entries and every index are what IndexedImage promises.
void check_indexed(const IndexedImage& image);

}  // namespace tessera
