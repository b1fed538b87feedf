// What is seen of a tile, its surface records and its film, compiled once per instruction set, and the table of all of
// a tile's kernels.
#include "tile/film_kernel.h"
#include "tile/surface_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// shade.simd.cpp
void shade_tile(const ShadeJob& job);
void shade_points(const ShadeJob& job);
// label.simd.cpp
void label(const LabelJob& job);
void label_surfaces(const LabelSurfaceJob& job);

const TileKernels& tile_kernels() {
    static constexpr TileKernels kKernels{&find_visible, &make_surfaces, &shade_tile,    &shade_points,
                                          &develop_tile, &label,         &label_surfaces};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
