// Visibility of a tile, which triangles are seen there, and labels.
#include "raster_kernel_tile.h"

namespace tessera::bench {
namespace {

// What visibility/ counts: the tile's triangles, or all samples in them.
enum class Items { kTriangles, kSamples };

KernelWork visibility_work(const std::string& workload, bool hierarchical_z, Items items) {
    const auto tile = std::make_shared<MiddleTile>(workload);
    KernelWork work{};
    const std::uint64_t samples = tile->see();
    work.items = items == Items::kTriangles ? tile->triangle_count : samples;
    work.clear = [=] { tile->clear(); };
    work.run = [=](const Kernels& kernels) {
        VisibilityJob job = tile->visibility(hierarchical_z, false);
        return seconds_of([&] { kernels.visibility(job); });
    };
    // The floors are bounds, which instruction sets may tighten at different times.
    work.output = [=] {
        Bytes bytes;
        append(bytes, tile->depth.data(), tile->depth.size());
        append(bytes, tile->ordinal.data(), tile->ordinal.size());
        append(bytes, tile->triangles.data(), tile->triangles.size());
        return bytes;
    };
    return work;
}

KernelWork find_visible_work(const std::string& workload) {
    struct State {
        MiddleTile tile;
        std::vector<std::uint8_t> seen;
        std::vector<std::uint32_t> list;
        std::uint32_t count;
    };
    const std::shared_ptr<State> state(new State{MiddleTile(workload), {}, {}, 0});
    state->tile.see();
    state->seen.resize(state->tile.triangle_count + 1);
    state->list.resize(state->tile.triangle_count + 1);
    KernelWork work{};
    work.items = state->tile.ordinal.size();
    work.clear = [=] {
        std::fill(state->seen.begin(), state->seen.end(), std::uint8_t{0xff});
        std::fill(state->list.begin(), state->list.end(), ~0u);
    };
    work.run = [=](const Kernels& kernels) {
        VisibleJob job{state->tile.ordinal.data(), static_cast<int>(state->tile.ordinal.size()),
                       state->tile.triangle_count, state->seen.data(),
                       state->list.data(),         0};
        const double seconds = seconds_of([&] { kernels.find_visible(job); });
        state->count = job.count;
        return seconds;
    };
    work.output = [=] {
        Bytes bytes;
        append(bytes, &state->count, 1);
        append(bytes, state->list.data(), state->count);
        return bytes;
    };
    return work;
}

KernelWork label_work(const std::string& workload) {
    struct State {
        MiddleTile tile;
        std::vector<float> distance;
        std::vector<std::uint32_t> triangle;
    };
    const std::shared_ptr<State> state(new State{MiddleTile(workload), {}, {}});
    state->tile.see();
    const std::size_t pixels = state->tile.ordinal.size();
    state->distance.resize(pixels);
    state->triangle.resize(pixels);
    KernelWork work{};
    work.items = pixels;
    work.clear = [=] {
        std::fill(state->distance.begin(), state->distance.end(), -1.0f);
        std::fill(state->triangle.begin(), state->triangle.end(), ~0u);
    };
    work.run = [=](const Kernels& kernels) {
        const MiddleTile& t = state->tile;
        LabelJob job{};
        job.projection = t.frame.frame.projection;
        job.window = whole_tile(t.side);
        job.depth = t.depth.data();
        job.ordinal = t.ordinal.data();
        job.triangles = t.triangles.data();
        job.instances = t.frame.frame.instances.data();
        job.planes.distance = state->distance.data();
        job.planes.triangle = state->triangle.data();
        return seconds_of([&] { kernels.label(job); });
    };
    work.output = [=] {
        Bytes bytes;
        append(bytes, state->distance.data(), state->distance.size());
        append(bytes, state->triangle.data(), state->triangle.size());
        return bytes;
    };
    return work;
}

}  // namespace

std::vector<KernelCase> visibility_cases() {
    std::vector<KernelCase> cases;
    const auto add = [&](const std::string& name, const std::string& workload, bool hierarchical_z, Items items) {
        cases.push_back({"visibility/" + name, [=] { return visibility_work(workload, hierarchical_z, items); }});
    };
    add("small_triangles", "sphere1m", true, Items::kTriangles);
    add("terrain_triangles", "terrain1m", true, Items::kTriangles);
    add("medium_triangles", "sphere100k", true, Items::kTriangles);
    add("large_samples", "soup20k", true, Items::kSamples);
    for (const bool hierarchical_z : {true, false}) {
        const std::string way = hierarchical_z ? "hi_z" : "no_hi_z";
        add("layers_front_to_back_" + way, "quads_f2b", hierarchical_z, Items::kSamples);
        add("layers_back_to_front_" + way, "quads_b2f", hierarchical_z, Items::kSamples);
    }
    for (const char* workload : {"quads_f2b", "sphere10k", "sphere1m", "soup20k"}) {
        cases.push_back({std::string("find_visible/") + workload, [=] { return find_visible_work(workload); }});
        cases.push_back({std::string("label/") + workload, [=] { return label_work(workload); }});
    }
    return cases;
}

}  // namespace tessera::bench
