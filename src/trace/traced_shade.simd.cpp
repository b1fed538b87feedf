// Shading of waves, compiled once per instruction set.
#include "trace/shade_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

void shade_traced_points(const TracedShadeJob& job) { shade_wave(job); }

}  // namespace tessera::TESSERA_ISA_NAMESPACE
