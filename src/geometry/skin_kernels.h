// The skinning kernels by instruction set, all of the same bits: skin_kernels(isa).
#pragma once

#include "geometry/skinning.h"
#include "simd/isa.h"

namespace tessera {

TESSERA_KERNELS(SkinKernels, skin_kernels);

}  // namespace tessera
