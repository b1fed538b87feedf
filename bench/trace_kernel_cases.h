// The cases of tessera_trace_kernel_bench.
#pragma once

#include "kernel_work.h"

#include "trace/kernels.h"

#include <vector>

namespace tessera::bench {

struct TracingKernels : TraceKernels {
    explicit TracingKernels(Isa isa) : TraceKernels(trace_kernels(isa)) {}
};
using TraceWork = WorkOf<TracingKernels>;
using TraceCase = CaseOf<TracingKernels>;

// A wave is so small that a single run takes hardly longer than to look at the clock.
inline constexpr int kRuns = 16;
template <class Run>
double seconds_of_runs(const Run& run) {
    return seconds_of([&] {
        for (int i = 0; i < kRuns; ++i) run();
    });
}

std::vector<TraceCase> ray_cases();
std::vector<TraceCase> point_cases();
// EmbreeScene's calls beside bare Embree's, with the instructions of best_isa().
void register_traces();

}  // namespace tessera::bench
