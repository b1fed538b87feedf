// The functions of simd/records.h, compiled once per instruction set, for records_test.cpp.
#pragma once

#include "simd/isa.h"

namespace tessera {

struct RecordTable {
    int lanes;
    // Between one record of four floats per lane and four planes of `lanes` floats.
    void (*load_records)(const float* const* records, float* planes);
    void (*store_records)(float* const* records, const float* planes);
    // From consecutive records of three floats to three planes.
    void (*load_triples)(const float* records, float* planes);
    float (*least_lane)(const float* lanes);
    // The lanes of the bits, moved to the front, and the bits of their mask.
    std::uint32_t (*compress)(std::uint32_t bits, const float* lanes, float* front);
};
TESSERA_KERNELS(RecordTable, record_table);

inline constexpr int kMostLanes = 16;

}  // namespace tessera
