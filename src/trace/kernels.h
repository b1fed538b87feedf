// The kernels of the ray tracer by instruction set: trace_kernels(isa).
#pragma once

#include "simd/isa.h"
#include "trace/wave_data.h"

namespace tessera {

TESSERA_KERNELS(TraceKernels, trace_kernels);

}  // namespace tessera
