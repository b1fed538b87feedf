// Detection of instruction sets for <tessera/isa.h>, and the tables by which a stage of the renderer
// calls its kernels. There is no process-wide switch: two renderers may use two instruction sets.
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
// The same questions as those of <tessera/isa.h>, for a given processor.
bool isa_supported(Isa isa, const CpuFeatures& cpu);
// Throws kUsage unless it is supported, naming it and what the processor has.
void require_isa(Isa isa, const CpuFeatures& cpu);

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
// and the renderer calls blend_kernels(isa).blend(...) with a resolved, supported `isa`.
#if defined(__x86_64__)
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
        switch (isa) {                                                     \
            case Isa::kSse4:                                               \
                return sse4::function();                                   \
            case Isa::kAvx2:                                               \
                return avx2::function();                                   \
            case Isa::kAvx512:                                             \
                return avx512::function();                                 \
            default:                                                       \
                return scalar::function();                                 \
        }                                                                  \
    }                                                                      \
    static_assert(true)
#else
#define TESSERA_KERNELS(Table, function)                                                            \
    namespace scalar {                                                                              \
    const Table& function();                                                                        \
    }                                                                                               \
    inline __attribute__((always_inline)) const Table& function(Isa) { return scalar::function(); } \
    static_assert(true)
#endif
