// Shading kernels, compiled once per instruction set.
#include "tile/shade_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

void shade_tile(const ShadeJob& job) { shade_blocks(job); }
void shade_points(const ShadeJob& job) { shade_list(job); }

}  // namespace tessera::TESSERA_ISA_NAMESPACE
