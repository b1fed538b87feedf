// Benchmarks of kernels: one job after another on every instruction set of this processor, with processor time. Before
// it is timed, a kernel's output is compared with the scalar kernel's; a difference is an error. `Kernels` is a table
// of kernels that can be made from an Isa.
#pragma once

#include "core/fp_environment.h"

#include <tessera/isa.h>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

namespace tessera::bench {

using Bytes = std::vector<std::byte>;

template <class T>
void append(Bytes& bytes, const T* data, std::size_t count) {
    const auto* first = reinterpret_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

inline bool same(const Bytes& a, const Bytes& b) {
    return a.size() == b.size() && !a.empty() && std::memcmp(a.data(), b.data(), a.size()) == 0;
}

// One kernel's job in the making.
template <class Kernels>
struct WorkOf {
    std::uint64_t items;                        // pixels, triangles, vertices, indices or rays
    std::function<void()> clear;                // what it writes; not timed
    std::function<double(const Kernels&)> run;  // seconds of processor time in the kernel
    std::function<Bytes()> output;              // all that the last run wrote
};

template <class Kernels>
struct CaseOf {
    std::string name;  // kernel/case
    std::function<WorkOf<Kernels>()> make;
};

// Of this thread, in seconds.
inline double processor_time() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Run>
double seconds_of(Run&& run) {
    const double start = processor_time();
    run();
    return processor_time() - start;
}

inline void count_items(benchmark::State& state, std::uint64_t items) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
    state.counters["per_item"] = benchmark::Counter(
        static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class Kernels>
void run_kernel(benchmark::State& state, const CaseOf<Kernels>& c, Isa isa) {
    const FpEnvironment exact;
    const WorkOf<Kernels> work = c.make();
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

template <class Visit>
void for_each_isa(Visit&& visit) {
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
        if (isa_supported(isa)) visit(isa);
}

template <class Kernels>
void register_kernels(const std::vector<CaseOf<Kernels>>& cases) {
    for (const CaseOf<Kernels>& c : cases)
        for_each_isa([&](Isa isa) {
            benchmark::RegisterBenchmark((c.name + "/" + name(isa)).c_str(),
                                         [=](benchmark::State& state) { run_kernel(state, c, isa); })
                ->UseManualTime()
                ->Unit(benchmark::kMicrosecond);
        });
}

}  // namespace tessera::bench
