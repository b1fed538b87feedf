// The rasterizer's kernels, compiled once per instruction set.
#include "raster/film_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

const RasterKernels& raster_kernels() {
    static constexpr RasterKernels kKernels{&index_range,   &transform,  &setup,        &visibility,   &find_visible,
                                            &make_surfaces, &shade_tile, &shade_points, &develop_tile, &label_tile};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
