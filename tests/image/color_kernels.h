// The colour templates of the image module as kernels, to compare instruction sets.
#pragma once

#include "simd/isa.h"

#include <cstdint>

namespace tessera::test {

// `count` colours of three planes in `rgb`, a multiple of 16.
struct ColorKernels {
    void (*encode)(const float* rgb, std::int32_t* codes, int count);
    void (*none)(float* rgb, int count);
    void (*neutral)(float* rgb, int count);
    void (*aces)(float* rgb, int count);
    void (*luminance)(const float* rgb, float* out, int count);
};

}  // namespace tessera::test

namespace tessera {
using test::ColorKernels;
TESSERA_KERNELS(ColorKernels, color_kernels);
}  // namespace tessera
