// Colour outside kernels: the continuous sRGB decoding. 8-bit tables and the encoding are in srgb.h.
#pragma once

namespace tessera {

// Linear value of an sRGB-encoded one (both 0 .. 1). Relative error below 1e-15; basic arithmetic only,
// so the bits are the same everywhere.
double linear_from_srgb(double encoded);

}  // namespace tessera
