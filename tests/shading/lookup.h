// The texture lookup, compiled once per instruction set, for texture_lanes_test.cpp.
#pragma once

#include "shading/texture.h"
#include "simd/isa.h"

namespace tessera {

// Planes of `count` numbers, a multiple of the lanes: u, v and the footprint in, four channels out.
struct LookupJob {
    const TextureView* texture;
    const float* inputs;
    std::uint32_t* results;
    int count;
};
inline constexpr int kLookupInputs = 6, kLookupResults = 4;

struct LookupTable {
    void (*run)(const LookupJob& job);
};
TESSERA_KERNELS(LookupTable, lookup_table);

}  // namespace tessera
