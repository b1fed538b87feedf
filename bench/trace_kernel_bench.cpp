// Speed of every kernel of the ray tracer on every instruction set of this processor, over a wave of 1,024 samples of a
// workload's picture: processor time, and an error where the output is not the scalar kernel's. And of EmbreeScene's
// calls beside bare Embree's, by kind of ray, width of packets and coherence: an error where hits or distances are not
// those of single rays. For example
//     tessera_trace_kernel_bench --benchmark_filter='^shade/.*/(scalar|avx512)/|^nearest/.*/16/coherent'
#include "trace_kernel_cases.h"

#include <benchmark/benchmark.h>

int main(int argc, char** argv) {
    using namespace tessera::bench;
    register_kernels(ray_cases());
    register_kernels(point_cases());
    register_traces();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
