// The two stages of a frame: the front end, and the tiles.
#include "raster_kernel_cases.h"

#include <mutex>

namespace tessera::bench {
namespace {

StageWork front_end_work(const std::string& workload, Isa isa, int threads) {
    struct State {
        BenchFrame& frame;
        Arena arena;
        FrontEnd front;
        State(BenchFrame& f, int n) : frame(f), arena(n) {}
    };
    const auto state = std::make_shared<State>(BenchFrame::of(workload), threads);
    StageWork work{};
    work.items = state->frame.frame.triangle_count;
    work.run = [=] { state->front.run(state->frame.input(raster_kernels(isa)), state->arena); };
    // What the tiles read, in their order.
    work.output = [=] {
        Bytes bytes;
        std::vector<TileBin> bins;
        for (int tile = 0; tile < state->frame.grid.count(); ++tile) {
            state->front.bins_of(tile, bins);
            for (const TileBin& bin : bins)
                for (std::uint32_t r = 0; r < bin.run_count; ++r) {
                    const BinRun& run = bin.runs[r];
                    if (run.large())
                        append(bytes, bin.large + run.first, run.size());
                    else
                        append(bytes, bin.small + run.first, run.size());
                }
        }
        return bytes;
    };
    return work;
}

StageWork tiles_work(const std::string& workload, Isa isa, int threads) {
    struct State {
        BenchFrame& frame;
        Arena arena;
        std::vector<std::uint8_t> picture;
        PictureTargets targets;
        RasterSettings settings;
        TileTask task;
        RasterSource source;
        TilePool<RasterVisibility> tiles;

        State(BenchFrame& f, Isa isa, int n)
            : frame(f),
              arena(n),
              picture(4 * static_cast<std::size_t>(f.workload.options.width * f.workload.options.height)),
              targets{picture.data()},
              settings(f.settings(isa)),
              task(f.task(settings, targets, f.front)),
              source{&f.front,
                     &task.source,
                     &raster_kernels(isa),
                     settings.hierarchical_z,
                     settings.count,
                     settings.max_fragments,
                     {}} {}
    };
    const auto state = std::make_shared<State>(BenchFrame::of(workload), isa, threads);
    StageWork work{};
    work.items = state->picture.size() / 4;
    work.run = [=] {
        state->tiles.draw(state->task, state->arena, [&](RasterVisibility& v) { v.begin(state->source); });
    };
    work.output = [=] {
        Bytes bytes;
        append(bytes, state->picture.data(), state->picture.size());
        return bytes;
    };
    return work;
}

}  // namespace

std::vector<StageCase> stage_cases() {
    std::vector<StageCase> cases;
    for (const char* workload : {"sphere1m", "sphere10k", "terrain1m", "soup20k"}) {
        const auto name = [&](const char* stage) { return std::string(stage) + "/" + workload; };
        cases.push_back({name("front_end"), [=](Isa isa, int n) { return front_end_work(workload, isa, n); }});
        cases.push_back({name("tiles"), [=](Isa isa, int n) { return tiles_work(workload, isa, n); }});
    }
    return cases;
}

}  // namespace tessera::bench
