// Kernels of the front end, timed where the front end calls them: the chunks of a whole frame on one thread.
#include "raster_kernel_cases.h"

namespace tessera::bench {
namespace {

// Stands between the front end and a kernel. One front end at a time.
struct Probe {
    const RasterKernels* kernels;
    double seconds;
    std::uint64_t items;
    Bytes* output;  // null while the time counts
};
Probe probe;

void probed_transform(const VertexJob& job) {
    probe.seconds += seconds_of([&] { probe.kernels->transform(job); });
    probe.items += job.count;
    if (probe.output) append(*probe.output, job.out, job.count);
}

void probed_setup(SetupJob& job) {
    const ChunkArrays before = job.arrays;
    probe.seconds += seconds_of([&] { probe.kernels->setup(job); });
    probe.items += job.count;
    if (!probe.output) return;
    const ChunkArrays& a = job.arrays;
    append(*probe.output, a.small + before.small_count, a.small_count - before.small_count);
    append(*probe.output, a.large + before.large_count, a.large_count - before.large_count);
    append(*probe.output, a.runs + before.run_count, a.run_count - before.run_count);
    append(*probe.output, a.run_tiles + before.run_count, a.run_count - before.run_count);
    append(*probe.output, &job.counters, 1);
}

using SetProbe = void (*)(RasterKernels&);

KernelWork front_end_work(const std::string& workload, SetProbe set_probe) {
    struct State {
        BenchFrame& frame;
        FrontEnd front;
        Bytes output;
        explicit State(BenchFrame& f) : frame(f) {}
    };
    const auto state = std::make_shared<State>(BenchFrame::of(workload));
    const auto draw = [state, set_probe](const RasterKernels& kernels, Bytes* output) {
        RasterKernels table = kernels;
        set_probe(table);
        probe = {&kernels, 0, 0, output};
        state->front.run(state->frame.input(table), state->frame.arena);
        return probe.seconds;
    };
    draw(raster_kernels(Isa::kScalar), nullptr);
    KernelWork work{};
    work.items = probe.items;
    work.clear = [] {};
    work.run = [=](const Kernels& kernels) { return draw(kernels, nullptr); };
    // The frame again, with a copy of all that the kernel writes: copying beside the timed runs would cool its caches.
    work.output = [=] {
        state->output.clear();
        draw(*probe.kernels, &state->output);
        return std::move(state->output);
    };
    return work;
}

}  // namespace

std::vector<KernelCase> front_end_cases() {
    std::vector<KernelCase> cases;
    const auto add = [&](const char* kernel, const char* workload, SetProbe set_probe) {
        cases.push_back({std::string(kernel) + "/" + workload, [=] { return front_end_work(workload, set_probe); }});
    };
    for (const char* workload : {"sphere1m", "sphere1m_shuffled", "soup20k"})
        add("transform", workload, [](RasterKernels& k) { k.transform = &probed_transform; });
    for (const char* workload : {"sphere1m", "sphere10k", "terrain1m", "soup20k"})
        add("setup", workload, [](RasterKernels& k) { k.setup = &probed_setup; });
    return cases;
}

}  // namespace tessera::bench
