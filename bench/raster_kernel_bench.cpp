// Speed of every kernel of the rasterizer on every instruction set of this processor, and of its two stages on
// one and on all threads. Kernels: processor time; stages: wall time. Before it is timed, a kernel's output is
// compared with the scalar kernel's; a difference is an error. For example
//     tessera_raster_kernel_bench --benchmark_filter='^visibility/.*/(avx2|avx512)/'
#include "raster_kernel_cases.h"

#include "core/fp_environment.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstring>

namespace {

using namespace tessera;
using namespace tessera::bench;

bool same(const Bytes& a, const Bytes& b) {
    return a.size() == b.size() && !a.empty() && std::memcmp(a.data(), b.data(), a.size()) == 0;
}

void count_items(benchmark::State& state, std::uint64_t items) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
    state.counters["per_item"] = benchmark::Counter(
        static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void run_kernel(benchmark::State& state, const KernelCase& c, Isa isa) {
    const FpEnvironment exact;
    const KernelWork work = c.make();
    const auto once = [&](Isa by) {
        work.clear();
        work.run(Kernels(by));
        return work.output();
    };
    if (!same(once(Isa::kScalar), once(isa))) {
        state.SkipWithError("the output is not the scalar kernel's");
        return;
    }
    const Kernels kernels(isa);
    for (auto _ : state) {
        work.clear();
        state.SetIterationTime(work.run(kernels));
    }
    count_items(state, work.items);
}

void run_stage(benchmark::State& state, const StageCase& c, Isa isa, int threads) {
    const FpEnvironment exact;
    const auto once = [](const StageWork& work) {
        work.run();
        return work.output();
    };
    const StageWork work = c.make(isa, threads);
    if (!same(once(c.make(Isa::kScalar, threads)), once(work))) {
        state.SkipWithError("the output is not the scalar stage's");
        return;
    }
    for (auto _ : state) work.run();
    count_items(state, work.items);
}

}  // namespace

int main(int argc, char** argv) {
    const auto for_each_isa = [](auto&& visit) {
        for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
            if (isa_supported(isa)) visit(isa);
    };
    for (const auto& cases : {front_end_cases(), visibility_cases(), surface_cases()})
        for (const KernelCase& c : cases)
            for_each_isa([&](Isa isa) {
                benchmark::RegisterBenchmark((c.name + "/" + name(isa)).c_str(),
                                             [=](benchmark::State& state) { run_kernel(state, c, isa); })
                    ->UseManualTime()
                    ->Unit(benchmark::kMicrosecond);
            });
    std::vector<int> threads{1};
    if (available_threads() > 1) threads.push_back(available_threads());
    for (const StageCase& c : stage_cases())
        for (const int count : threads)
            for_each_isa([&](Isa isa) {
                const std::string title = c.name + "/" + std::to_string(count) + "_threads/" + name(isa);
                benchmark::RegisterBenchmark(title.c_str(),
                                             [=](benchmark::State& state) { run_stage(state, c, isa, count); })
                    ->UseRealTime()
                    ->MeasureProcessCPUTime()
                    ->Unit(benchmark::kMillisecond);
            });
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
