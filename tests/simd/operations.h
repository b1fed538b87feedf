// One table of operations of the number layer, compiled once per instruction set and used twice: the
// tests compare every instruction set with the one-lane back end, the benchmark times them.
#pragma once

#include "simd/isa.h"

#include <cstdint>
#include <span>

namespace tessera {

// out[i] = operation(a[i], b[i], c[i]) for i < count. Inputs and results are the bits of float, int32_t
// or uint32_t; masks are 0 or 1 (of an input, its lowest bit). Any alignment, any count.
struct Operation {
    const char* name;
    // The result is a float: NaNs are equal whatever their bits.
    bool float_result;
    void (*run)(const std::uint32_t* a, const std::uint32_t* b, const std::uint32_t* c, std::uint32_t* out, int count);
};

// Operations on whole vectors, memory and masks read `a` at indices of their own, below this number.
inline constexpr int kGatherTable = 64;

struct OperationTable {
    std::span<const Operation> operations;
    int lanes;
};
TESSERA_KERNELS(OperationTable, operation_table);

}  // namespace tessera
