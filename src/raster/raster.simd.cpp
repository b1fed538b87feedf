// The rasterizer's kernels but for shading and labels, compiled once per instruction set, and the table of all.
#include "raster/film_kernel.h"
#include "raster/setup_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// shade.simd.cpp
void shade_tile(const ShadeJob& job);
void shade_points(const ShadeJob& job);
// label.simd.cpp
void label(const LabelJob& job);
void label_surfaces(const LabelSurfaceJob& job);

const RasterKernels& raster_kernels() {
    static constexpr RasterKernels kKernels{&transform,  &setup,        &visibility,   &find_visible, &make_surfaces,
                                            &shade_tile, &shade_points, &develop_tile, &label,        &label_surfaces};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
