// Whole frames of the workloads of `tessera bench` with a warm renderer, per engine, instruction set and number of
// threads. A frame whose covered pixels are not the known ones is an error. For example
//     tessera_raster_bench --benchmark_filter='sphere100k/raster/avx2/'
// Kernels have their own program.
#include "cli/workloads.h"

#include <tessera/renderer.h>

#include "simd/isa.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace tessera;

// Benchmarks run in the order of their registration, so one scene at a time is enough.
cli::Workload& workload(const std::string& name) {
    static std::unique_ptr<cli::Workload> kept;
    if (!kept || kept->name != name) {
        kept.reset();
        kept = std::make_unique<cli::Workload>(cli::make_workload(name, 1920, 1080));
    }
    return *kept;
}

struct Way {
    Engine engine;
    Isa isa;
    int threads;
};

void run(benchmark::State& state, const std::string& name, Way way) {
    cli::Workload& w = workload(name);
    w.options.engine = way.engine;
    w.options.isa = way.isa;
    w.options.threads = way.threads;
    Renderer renderer(w.scene, w.options);
    RenderResult result;
    renderer.draw(result);
    for (auto _ : state) renderer.draw(result);
    if (const std::string fault = cli::pixel_fault(w, result.stats.pixels_covered); !fault.empty())
        state.SkipWithError(fault.c_str());
    state.counters["pixels_covered"] = static_cast<double>(result.stats.pixels_covered);
    state.counters["triangles_per_s"] =
        benchmark::Counter(static_cast<double>(result.stats.triangles), benchmark::Counter::kIsIterationInvariantRate);
}

std::vector<Way> ways(const std::string& name) {
    const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<Way> list;
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
        for (const int threads : {1, all})
            if (isa_supported(isa) && (threads == 1 || all > 1)) list.push_back({Engine::kRaster, isa, threads});
    // Seconds a frame on the large ones.
    if (name.find("1m") == std::string::npos) list.push_back({Engine::kReferenceRaster, Isa::kScalar, 1});
    return list;
}

}  // namespace

int main(int argc, char** argv) {
    for (const std::string& name : cli::workload_names())
        for (const Way& way : ways(name)) {
            const std::string title = name + "/" + tessera::name(way.engine) + "/" + tessera::name(way.isa) + "/" +
                                      std::to_string(way.threads) + "_threads";
            benchmark::RegisterBenchmark(title.c_str(), [=](benchmark::State& state) { run(state, name, way); })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime()
                ->MeasureProcessCPUTime();
        }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
