// Speed of every kernel of the rasterizer on every instruction set of this processor, and of its two stages on
// one and on all threads. Kernels: processor time; stages: wall time. Before it is timed, a kernel's output is
// compared with the scalar kernel's; a difference is an error. For example
//     tessera_raster_kernel_bench --benchmark_filter='^visibility/.*/(avx2|avx512)/'
#include "raster_kernel_cases.h"

namespace {

using namespace tessera;
using namespace tessera::bench;

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
    register_kernels(front_end_cases());
    register_kernels(visibility_cases());
    register_kernels(surface_cases());
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
