// The choice of instruction set: names, detection from processor registers, the override by
// TESSERA_ISA, and errors that name what is missing and what there is.
#include "simd/isa.h"

#include "simd/operations.h"

#include <tessera/error.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <optional>
#include <string>

namespace tessera {
namespace {

constexpr Isa kIsas[] = {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512};
constexpr IsaBits kAllIsas = isa_bits(Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512);

// Sets TESSERA_ISA (or removes it) for a scope.
class Environment {
  public:
    explicit Environment(const char* value) {
        if (const char* old = std::getenv("TESSERA_ISA")) old_ = old;
        set(value);
    }
    ~Environment() { set(old_ ? old_->c_str() : nullptr); }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

  private:
    static void set(const char* value) {
        if (value != nullptr)
            ::setenv("TESSERA_ISA", value, 1);
        else
            ::unsetenv("TESSERA_ISA");
    }
    std::optional<std::string> old_;
};

std::string usage_error(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kUsage);
        return error.message();
    }
    ADD_FAILURE() << "no error";
    return "";
}

// What cpuid and xgetbv say on a first-generation Skylake server, a Haswell and a Westmere.
constexpr CpuFeatures kSkylakeServer{0x7ffefbff, 0xd39ffffb, 0x121, 0xe7};
constexpr CpuFeatures kHaswell{0x7ffafbff, 0x27ab, 0x21, 0x07};
constexpr CpuFeatures kWestmere{0x029ee3ff, 0, 0x1, 0};

TEST(Isa, EveryNameIsParsed) {
    EXPECT_EQ(parse_isa("auto"), Isa::kAuto);
    for (const Isa isa : kIsas) {
        if (isa_supported(isa)) {
            EXPECT_EQ(parse_isa(name(isa)), isa);
        }
    }
}

TEST(Isa, UnknownNamesAreRefusedByName) {
    for (const char* text : {"", "AVX2", "avx", "neon", "sse4 "}) {
        const std::string message = usage_error([&] { parse_isa(text); });
        EXPECT_NE(message.find('"' + std::string(text) + '"'), std::string::npos) << message;
        EXPECT_NE(message.find("scalar, sse4, avx2"), std::string::npos) << message;
    }
}

TEST(Isa, DetectionAsksForEveryFeatureOfTheFlags) {
    EXPECT_TRUE(isa_supported(Isa::kAvx512, kSkylakeServer));
    EXPECT_TRUE(isa_supported(Isa::kAvx2, kHaswell) && !isa_supported(Isa::kAvx512, kHaswell));
    EXPECT_TRUE(isa_supported(Isa::kSse4, kWestmere) && !isa_supported(Isa::kAvx2, kWestmere));
    EXPECT_TRUE(isa_supported(Isa::kScalar, {}) && !isa_supported(Isa::kSse4, {}));

    // Each feature taken away by itself: bit 20 of leaf 1 is SSE4.2 and so on.
    const auto without = [](CpuFeatures cpu, int leaf1, int leaf7, int extended) {
        if (leaf1 >= 0) cpu.leaf1_ecx &= ~(1u << leaf1);
        if (leaf7 >= 0) cpu.leaf7_ebx &= ~(1u << leaf7);
        if (extended >= 0) cpu.extended1_ecx &= ~(1u << extended);
        return cpu;
    };
    for (const int bit : {0, 1, 9, 19, 20, 23, 25})
        EXPECT_FALSE(isa_supported(Isa::kSse4, without(kSkylakeServer, bit, -1, -1))) << bit;
    for (const int bit : {12, 20, 25, 27, 28, 29})
        EXPECT_FALSE(isa_supported(Isa::kAvx2, without(kSkylakeServer, bit, -1, -1))) << bit;
    for (const int bit : {3, 5, 8})
        EXPECT_FALSE(isa_supported(Isa::kAvx2, without(kSkylakeServer, -1, bit, -1))) << bit;
    EXPECT_FALSE(isa_supported(Isa::kAvx2, without(kSkylakeServer, -1, -1, 5)));
    for (const int bit : {5, 16, 17, 19, 28, 30, 31}) {
        const CpuFeatures cpu = without(kSkylakeServer, -1, bit, -1);
        EXPECT_FALSE(isa_supported(Isa::kAvx512, cpu)) << bit;
        EXPECT_EQ(isa_supported(Isa::kAvx2, cpu), bit != 5) << bit;
    }
}

TEST(Isa, RegistersThatTheSystemDoesNotSaveAreNotUsed) {
    CpuFeatures cpu = kSkylakeServer;
    cpu.xcr0 = 0x07;  // no AVX-512 state
    EXPECT_TRUE(isa_supported(Isa::kAvx2, cpu) && !isa_supported(Isa::kAvx512, cpu));
    cpu.xcr0 = 0x03;  // no AVX state
    EXPECT_TRUE(isa_supported(Isa::kSse4, cpu) && !isa_supported(Isa::kAvx2, cpu));
}

TEST(Isa, AMissingOneIsRefusedByName) {
    EXPECT_NO_THROW(require_isa(Isa::kAvx2, kHaswell, kAllIsas));
    EXPECT_EQ(usage_error([] { require_isa(Isa::kAvx512, kHaswell, kAllIsas); }),
              "this processor lacks the instruction set avx512; it has scalar, sse4, avx2");
    EXPECT_EQ(usage_error([] { require_isa(Isa::kSse4, {}, kAllIsas); }),
              "this processor lacks the instruction set sse4; it has scalar");
    for (const Isa isa : kIsas) {
        if (isa_supported(isa)) continue;
        EXPECT_NE(usage_error([&] { parse_isa(name(isa)); }).find(name(isa)), std::string::npos);
        EXPECT_NE(usage_error([&] { resolve_isa(isa); }).find(name(isa)), std::string::npos);
    }
}

TEST(Isa, OneThatIsNotBuiltIsRefusedByName) {
    constexpr IsaBits kTwo = isa_bits(Isa::kScalar, Isa::kSse4);
    EXPECT_NO_THROW(require_isa(Isa::kSse4, kSkylakeServer, kTwo));
    EXPECT_EQ(usage_error([] { require_isa(Isa::kAvx2, kSkylakeServer, kTwo); }),
              "this build has no kernels for the instruction set avx2; it has scalar, sse4");
    EXPECT_EQ(usage_error([] { require_isa(Isa::kAvx512, {}, kTwo); }),
              "this build has no kernels for the instruction set avx512; it has scalar");
    EXPECT_TRUE(isa_built(Isa::kAuto) && isa_built(Isa::kScalar));
    for (const Isa isa : kIsas)
        EXPECT_EQ(isa_supported(isa), isa_built(isa) && isa_supported(isa, read_cpu_features()));
}

TEST(Isa, AutomaticIsTheBestOne) {
    for (const char* value : {static_cast<const char*>(nullptr), "", "auto"}) {
        const Environment environment(value);
        EXPECT_EQ(resolve_isa(Isa::kAuto), best_isa());
    }
    EXPECT_TRUE(isa_supported(best_isa()));
    for (const Isa isa : kIsas) EXPECT_TRUE(isa <= best_isa() || !isa_supported(isa)) << name(isa);
}

TEST(Isa, TheEnvironmentForcesAutomaticOnly) {
    for (const Isa forced : kIsas) {
        if (!isa_supported(forced)) continue;
        const Environment environment(name(forced));
        EXPECT_EQ(resolve_isa(Isa::kAuto), forced);
        EXPECT_EQ(resolve_isa(Isa::kScalar), Isa::kScalar);
        // The kernels that are then called really are those.
        const int lanes = operation_table(resolve_isa(Isa::kAuto)).lanes;
        EXPECT_EQ(lanes, forced == Isa::kScalar ? 1 : forced == Isa::kSse4 ? 4 : forced == Isa::kAvx2 ? 8 : 16);
    }
}

TEST(Isa, TheEnvironmentsErrorsNameTheVariable) {
    const Environment environment("mmx");
    EXPECT_NE(usage_error([] { resolve_isa(Isa::kAuto); }).find("TESSERA_ISA: \"mmx\""), std::string::npos);
    EXPECT_EQ(resolve_isa(Isa::kScalar), Isa::kScalar);
}

}  // namespace
}  // namespace tessera
