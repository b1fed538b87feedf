// The rasterizer's kernels, compiled once per instruction set, and their table.
#include "raster/setup_kernel.h"
#include "raster/visibility_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

const RasterKernels& raster_kernels() {
    static constexpr RasterKernels kKernels{&transform, &setup, &visibility};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
