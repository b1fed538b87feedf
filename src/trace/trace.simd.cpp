// The ray tracer's kernels but for shading, compiled once per instruction set, and the table of all.
#include "trace/shape_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// shade.simd.cpp
void shade_traced_points(const TracedShadeJob& job);

const TraceKernels& trace_kernels() {
    static constexpr TraceKernels kKernels{&primary_rays,        &find_hits,    &pack,           &flat_planes,
                                           &primary_surfaces,    &ray_surfaces, &shape_surfaces, &shadow_rays,
                                           &shade_traced_points, &spawn};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
