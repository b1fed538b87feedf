// Surface points of a wave and their shading.
#include "trace_kernel_cases.h"
#include "trace_kernel_wave.h"

#include <algorithm>

namespace tessera::bench {
namespace {

// What the surface kernels write, of so many points.
Bytes point_bytes(const WaveArrays& points, const SurfaceLayout& layout, std::uint32_t count) {
    Bytes bytes;
    const auto add = [&](int first, int last) {
        for (int number = first; number <= last; ++number) append(bytes, points[number], count);
    };
    add(kPositionX, kRounding);
    if (layout.color >= 0) add(kColorR, kColorA);
    for (int set = 0; set < kMaxUvSets; ++set)
        if (layout.uv[set] >= 0) add(kUv + 6 * set, kUv + 6 * set + 5);
    return bytes;
}

// A kernel on the job of a wave, in which `clear` writes over what the kernel writes, and `output` finds it.
template <class Job, class Clear, class Output>
TraceWork point_work(const Place& place, Job (BenchWave::*make)(), void (*TraceKernels::*kernel)(const Job&),
                     const Clear& clear, const Output& output) {
    const auto state = std::make_shared<WaveJob<Job>>(place, make);
    TraceWork work{};
    work.items = std::uint64_t{kRuns} * state->job.count;
    work.clear = [=] { clear(*state); };
    work.run = [=](const TracingKernels& kernels) { return seconds_of_runs([&] { (kernels.*kernel)(state->job); }); };
    work.output = [=] { return output(state->job); };
    return work;
}

TraceWork flat_planes_work(const Place& place) {
    const auto clear = [](WaveJob<FlatPlanesJob>& w) { std::fill_n(w.job.planes, 4 * w.job.count, -1.0f); };
    const auto output = [](const FlatPlanesJob& job) {
        Bytes bytes;
        append(bytes, job.planes, 4 * std::size_t{job.count});
        return bytes;
    };
    return point_work(place, &BenchWave::flat_planes, &TraceKernels::flat_planes, clear, output);
}

TraceWork primary_surfaces_work(const Place& place) {
    const auto clear = [](WaveJob<PrimarySurfacesJob>& w) { w.wave.reset_points(); };
    const auto output = [](const PrimarySurfacesJob& job) { return point_bytes(job.points, job.layout, job.count); };
    return point_work(place, &BenchWave::primary_surfaces, &TraceKernels::primary_surfaces, clear, output);
}

// Points of rays anywhere.
template <class Job>
TraceWork hit_work(const Place& place, Job (BenchWave::*make)(), void (*TraceKernels::*kernel)(const Job&)) {
    const auto clear = [](WaveJob<Job>& w) {
        std::fill_n(w.job.points[0], static_cast<std::size_t>(kPointNumbers) * w.job.points.stride, -1.0f);
        std::fill_n(w.job.distance, w.job.count, -1.0f);
    };
    const auto output = [](const Job& job) {
        Bytes bytes = point_bytes(job.points, job.layout, job.count);
        append(bytes, job.points[kTimes], job.count);
        append(bytes, job.distance, job.count);
        return bytes;
    };
    return point_work(place, make, kernel, clear, output);
}
TraceWork ray_surfaces_work(const Place& place) {
    return hit_work(place, &BenchWave::ray_surfaces, &TraceKernels::ray_surfaces);
}
TraceWork shape_surfaces_work(const Place& place) {
    return hit_work(place, &BenchWave::shape_surfaces, &TraceKernels::shape_surfaces);
}

TraceWork shade_work(const Place& place) {
    const auto clear = [](WaveJob<TracedShadeJob>& w) {
        std::fill_n(w.job.shades[0], static_cast<std::size_t>(kShadeNumbers) * w.job.shades.stride, -1.0f);
    };
    const auto output = [](const TracedShadeJob& job) {
        Bytes bytes;
        for (int number = 0; number < kShadeNumbers; ++number) append(bytes, job.shades[number], job.count);
        return bytes;
    };
    return point_work(place, &BenchWave::shade, &TraceKernels::shade, clear, output);
}

}  // namespace

std::vector<TraceCase> point_cases() {
    std::vector<TraceCase> cases;
    const auto add = [&](const char* kernel, const Place& place, TraceWork (*make)(const Place&)) {
        cases.push_back({std::string(kernel) + "/" + place.workload, [=] { return make(place); }});
    };
    for (const Place& place : {kSphere, kTerrain, kStudio, kSoup}) {
        add("flat_planes", place, flat_planes_work);
        add("primary_surfaces", place, primary_surfaces_work);
        add("shade", place, shade_work);
    }
    for (const Place& place : {kSphere, kTerrain}) add("ray_surfaces", place, ray_surfaces_work);
    add("shape_surfaces", kSphere, shape_surfaces_work);
    return cases;
}

}  // namespace tessera::bench
