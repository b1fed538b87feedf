// The rasterizer's kernels, compiled once per instruction set.
#include "raster/setup_kernel.h"
#include "raster/shade_kernel.h"
#include "raster/visibility_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

const RasterKernels& raster_kernels() {
    static constexpr RasterKernels kKernels{&setup, &visibility, &shade_points, &develop_row};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
