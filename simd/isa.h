// Detection of instruction sets for <tessera/isa.h>, those that this build has kernels for, and the tables by which
// a stage of the renderer calls its kernels. There is no process-wide switch: two renderers may use two instruction
// sets.
#pragma once

#include <tessera/isa.h>

#include <cstdint>

namespace tessera {

// The registers of `cpuid` and `xgetbv` that detection reads; all 0 on other processors.
struct CpuFeatures {
    std::uint32_t leaf1_ecx = 0, leaf7_ebx = 0, extended1_ecx = 0;
    std::uint64_t xcr0 = 0;  // register states that the operating system saves
};
CpuFeatures read_cpu_features();
// Whether a given processor can run it, built or not.
bool isa_supported(Isa isa, const CpuFeatures& cpu);

// A set of instruction sets: bit 1 << Isa.
using IsaBits = std::uint32_t;
template <class... Isas>
constexpr IsaBits isa_bits(Isas... isas) {
    return (... | (IsaBits{1} << static_cast<unsigned>(isas)));
}
// Those that kernels are compiled for: TESSERA_ISAS of cmake/TesseraKernels.cmake.
inline constexpr IsaBits kBuiltIsas = isa_bits(TESSERA_BUILT_ISAS);
constexpr bool isa_built(Isa isa) { return isa == Isa::kAuto || (kBuiltIsas & isa_bits(isa)) != 0; }
// Throws kUsage unless it is built and the processor has it, naming it and what there is.
void require_isa(Isa isa, const CpuFeatures& cpu, IsaBits built = kBuiltIsas);

}  // namespace tessera

// The kernels of a stage. Its header declares a struct of function pointers and then
//     TESSERA_KERNELS(BlendKernels, blend_kernels);
// Its kernel file (*.simd.cpp, see cmake/TesseraKernels.cmake) defines, once per instruction set,
//     namespace tessera::TESSERA_ISA_NAMESPACE {
//     const BlendKernels& blend_kernels() {
//         static constexpr BlendKernels kKernels{&blend, ...};
//         return kKernels;
//     }
//     }
// and the renderer calls blend_kernels(isa).blend(...) with a resolved, supported `isa`. What is not built is
// discarded before it is called, and so need not be linked.
#define TESSERA_KERNELS(Table, function)                                   \
    namespace scalar {                                                     \
    const Table& function();                                               \
    }                                                                      \
    namespace sse4 {                                                       \
    const Table& function();                                               \
    }                                                                      \
    namespace avx2 {                                                       \
    const Table& function();                                               \
    }                                                                      \
    namespace avx512 {                                                     \
    const Table& function();                                               \
    }                                                                      \
    inline __attribute__((always_inline)) const Table& function(Isa isa) { \
        if constexpr (isa_built(Isa::kAvx512))                             \
            if (isa == Isa::kAvx512) return avx512::function();            \
        if constexpr (isa_built(Isa::kAvx2))                               \
            if (isa == Isa::kAvx2) return avx2::function();                \
        if constexpr (isa_built(Isa::kSse4))                               \
            if (isa == Isa::kSse4) return sse4::function();                \
        return scalar::function();                                         \
    }                                                                      \
    static_assert(true)
