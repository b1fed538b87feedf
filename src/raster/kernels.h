// The rasterizer's kernels by instruction set: raster_kernels(isa).
#pragma once

#include "raster/raster_data.h"
#include "simd/isa.h"

namespace tessera {

TESSERA_KERNELS(RasterKernels, raster_kernels);

}  // namespace tessera
