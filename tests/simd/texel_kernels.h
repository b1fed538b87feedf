// The functions of simd/texels.h, compiled once per instruction set, for texels_test.cpp.
#pragma once

#include "simd/isa.h"
#include "simd/texels.h"

namespace tessera {

// Arrays have a number for each lane; channels are planes of `lanes` floats.
struct TexelTable {
    int lanes;
    // Bilinear in each of two levels at the same addresses, then between them.
    void (*filter)(const Texel* lower, const Texel* upper, const std::int32_t* first, const std::int32_t* stride,
                   const std::int32_t* across, const std::int32_t* down, const std::int32_t* between, float* planes);
    void (*load)(const Texel* texels, const std::int32_t* first, const std::int32_t* stride, const std::int32_t* across,
                 const std::int32_t* down, float* planes);
    void (*lookup_floats)(const float* table, const std::int32_t* index, float* out);
    void (*lookup_integers)(const std::int32_t* table, const std::int32_t* index, std::int32_t* out);
};
TESSERA_KERNELS(TexelTable, texel_table);

}  // namespace tessera
