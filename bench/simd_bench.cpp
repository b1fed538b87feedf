// Speed of every operation of the number layer on every instruction set of this processor, from the table
// that the tests use; nanoseconds per element, loads and stores (in L1) included. For example
//     tessera_simd_bench --benchmark_filter='^(sin|pow)/'
#include "simd/operations.h"

#include <benchmark/benchmark.h>

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace {

using namespace tessera;

constexpr int kElements = 1024;

// Floats in 1/16 .. 8, whose bits also are unremarkable integers.
std::vector<std::uint32_t> operands(std::uint32_t seed) {
    std::vector<std::uint32_t> all(kElements);
    for (std::uint32_t& bits : all) {
        seed = seed * 1664525u + 1013904223u;
        bits = std::bit_cast<std::uint32_t>(0.0625f + static_cast<float>(seed >> 8) * 0x1p-21f);
    }
    return all;
}

void run(benchmark::State& state, const Operation* operation) {
    const std::vector<std::uint32_t> a = operands(1), b = operands(2), c = operands(3);
    std::vector<std::uint32_t> out(kElements);
    for (auto _ : state) {
        operation->run(a.data(), b.data(), c.data(), out.data(), kElements);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.counters["per_element"] =
        benchmark::Counter(kElements, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace

int main(int argc, char** argv) {
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
        if (!isa_supported(isa)) continue;
        for (const Operation& operation : operation_table(isa).operations)
            benchmark::RegisterBenchmark((std::string(operation.name) + "/" + name(isa)).c_str(), run, &operation);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
