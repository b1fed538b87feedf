#include "simd/isa.h"

#include <tessera/error.h>

#include <cstdlib>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace tessera {
namespace {

constexpr Isa kIsas[] = {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512};

constexpr std::uint32_t bit(int n) { return std::uint32_t{1} << n; }

// What the flags of cmake/TesseraKernels.cmake let the compiler emit, by cpuid register.
// Leaf 1, ecx: SSE3, PCLMULQDQ, SSSE3, SSE4.1, SSE4.2, POPCNT, AES.
constexpr std::uint32_t kSse4Leaf1 = bit(0) | bit(1) | bit(9) | bit(19) | bit(20) | bit(23) | bit(25);
// FMA, OSXSAVE, AVX, F16C; leaf 7, ebx: BMI1, AVX2, BMI2; leaf 0x80000001, ecx: LZCNT.
constexpr std::uint32_t kAvx2Leaf1 = kSse4Leaf1 | bit(12) | bit(27) | bit(28) | bit(29);
constexpr std::uint32_t kAvx2Leaf7 = bit(3) | bit(5) | bit(8);
constexpr std::uint32_t kAvx2Extended1 = bit(5);
constexpr std::uint64_t kAvx2States = 0x06;  // XMM, YMM
// MOVBE; AVX-512 F, DQ, ADX, CD, BW, VL; PREFETCHW. (Skylake has more, such as PKU and CLWB, that only
// intrinsics reach and that virtual machines often hide.)
constexpr std::uint32_t kAvx512Leaf1 = kAvx2Leaf1 | bit(22);
constexpr std::uint32_t kAvx512Leaf7 = kAvx2Leaf7 | bit(16) | bit(17) | bit(19) | bit(28) | bit(30) | bit(31);
constexpr std::uint32_t kAvx512Extended1 = kAvx2Extended1 | bit(8);
constexpr std::uint64_t kAvx512States = 0xe6;  // and opmask, upper halves of ZMM, ZMM 16 to 31

bool has(const CpuFeatures& cpu, const CpuFeatures& needed) {
    return (cpu.leaf1_ecx & needed.leaf1_ecx) == needed.leaf1_ecx &&
           (cpu.leaf7_ebx & needed.leaf7_ebx) == needed.leaf7_ebx &&
           (cpu.extended1_ecx & needed.extended1_ecx) == needed.extended1_ecx &&
           (cpu.xcr0 & needed.xcr0) == needed.xcr0;
}

const CpuFeatures& this_cpu() {
    static const CpuFeatures cpu = read_cpu_features();
    return cpu;
}

Isa find_isa(const std::string& text, const std::string& origin) {
    if (text == name(Isa::kAuto)) return Isa::kAuto;
    for (const Isa isa : kIsas)
        if (text == name(isa)) return isa;
    throw Error(ErrorCode::kUsage,
                origin + "\"" + text + "\" is no instruction set; expected auto, scalar, sse4, avx2 or avx512");
}

}  // namespace

const char* name(Isa isa) {
    switch (isa) {
        case Isa::kAuto:
            return "auto";
        case Isa::kScalar:
            return "scalar";
        case Isa::kSse4:
            return "sse4";
        case Isa::kAvx2:
            return "avx2";
        case Isa::kAvx512:
            return "avx512";
    }
    return "unknown";
}

CpuFeatures read_cpu_features() {
    CpuFeatures cpu;
#if defined(__x86_64__)
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (__get_cpuid(1, &a, &b, &c, &d)) cpu.leaf1_ecx = c;
    if (__get_cpuid_count(7, 0, &a, &b, &c, &d)) cpu.leaf7_ebx = b;
    if (__get_cpuid(0x80000001, &a, &b, &c, &d)) cpu.extended1_ecx = c;
    if ((cpu.leaf1_ecx & bit(27)) != 0) {
        unsigned low = 0, high = 0;
        __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
        cpu.xcr0 = std::uint64_t{high} << 32 | low;
    }
#endif
    return cpu;
}

bool isa_supported(Isa isa, const CpuFeatures& cpu) {
    switch (isa) {
        case Isa::kAuto:
        case Isa::kScalar:
            return true;
        case Isa::kSse4:
            return has(cpu, {kSse4Leaf1, 0, 0, 0});
        case Isa::kAvx2:
            return has(cpu, {kAvx2Leaf1, kAvx2Leaf7, kAvx2Extended1, kAvx2States});
        case Isa::kAvx512:
            return has(cpu, {kAvx512Leaf1, kAvx512Leaf7, kAvx512Extended1, kAvx512States});
    }
    return false;
}

void require_isa(Isa isa, const CpuFeatures& cpu, IsaBits built) {
    const auto is_built = [built](Isa i) { return i == Isa::kAuto || (built & isa_bits(i)) != 0; };
    if (is_built(isa) && isa_supported(isa, cpu)) return;
    std::string usable;
    for (const Isa other : kIsas)
        if (is_built(other) && isa_supported(other, cpu))
            usable += (usable.empty() ? "" : ", ") + std::string(name(other));
    const char* lacking = is_built(isa) ? "processor lacks" : "build has no kernels for";
    throw Error(ErrorCode::kUsage,
                std::string("this ") + lacking + " the instruction set " + name(isa) + "; it has " + usable);
}

bool isa_supported(Isa isa) { return isa_built(isa) && isa_supported(isa, this_cpu()); }

Isa best_isa() {
    Isa best = Isa::kScalar;
    for (const Isa isa : kIsas)
        if (isa_supported(isa)) best = isa;
    return best;
}

Isa parse_isa(const std::string& text) {
    const Isa isa = find_isa(text, "");
    require_isa(isa, this_cpu());
    return isa;
}

Isa resolve_isa(Isa isa) {
    if (isa == Isa::kAuto) {
        const char* forced = std::getenv("TESSERA_ISA");
        if (forced != nullptr && *forced != '\0') isa = find_isa(forced, "TESSERA_ISA: ");
        if (isa == Isa::kAuto) isa = best_isa();
    }
    require_isa(isa, this_cpu());
    return isa;
}

}  // namespace tessera
