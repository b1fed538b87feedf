// The kernels of tiles by instruction set: tile_kernels(isa).
#pragma once

#include "simd/isa.h"
#include "tile/tile_data.h"

namespace tessera {

TESSERA_KERNELS(TileKernels, tile_kernels);

}  // namespace tessera
