// Shading kernels, compiled once per instruction set.
#include "raster/shade_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// A whole tile through the constant layouts; lists, which are short, as they come.
void shade_tile(const ShadeJob& job) {
    with_kind(job, [&](auto kind) {
        using Kind = decltype(kind);
        job.develop ? shade_and_develop_tile<Kind>(job) : shade_tile_as<Kind>(job);
    });
}

void shade_points(const ShadeJob& job) { shade_points_as<Unknown>(job); }

}  // namespace tessera::TESSERA_ISA_NAMESPACE
