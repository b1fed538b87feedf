#include "raster/engine.h"

#include "raster/tile.h"

#include <tessera/error.h>

#include <atomic>

namespace tessera {

struct RasterEngine::State {
    FrontEnd front;
    std::mutex mutex;
    std::vector<std::unique_ptr<Tile>> idle;

    std::unique_ptr<Tile> take() {
        const std::lock_guard lock(mutex);
        if (idle.empty()) return std::make_unique<Tile>();
        std::unique_ptr<Tile> tile = std::move(idle.back());
        idle.pop_back();
        return tile;
    }
    void give(std::unique_ptr<Tile> tile) {
        const std::lock_guard lock(mutex);
        idle.push_back(std::move(tile));
    }
};

namespace {

// Larger tiles bin less and shade a little better; more of them keep more threads busy. In large
// pictures edges over 128 pixels would not fit 32 bits.
int choose_tile_side(const RasterSettings& settings, const ProjectionView& picture, int threads) {
    const bool large = picture.width > 8192 || picture.height > 8192;
    if (settings.tile_side != 0) {
        if (settings.tile_side == 128 && large) return 64;
        return settings.tile_side;
    }
    return threads <= 4 && !large && picture.width * picture.height > 640 * 480 ? 128 : 64;
}

void add(TileCounters& sum, const TileCounters& c) {
    sum.samples_covered += c.samples_covered;
    sum.fragments_passed += c.fragments_passed;
    sum.blocks_drawn += c.blocks_drawn;
    sum.blocks_hidden += c.blocks_hidden;
}

}  // namespace

RasterEngine::RasterEngine() : state_(std::make_unique<State>()) {}
RasterEngine::~RasterEngine() = default;
RasterEngine::RasterEngine(RasterEngine&&) noexcept = default;
RasterEngine& RasterEngine::operator=(RasterEngine&&) noexcept = default;

RasterCounters RasterEngine::draw(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
                                  const RasterTargets& targets, Arena& arena) {
    const TileGrid grid(static_cast<int>(frame.projection.width), static_cast<int>(frame.projection.height),
                        choose_tile_side(settings, frame.projection, arena.threads()));
    std::vector<SamplePosition> positions;
    if (targets.colors()) positions = settings.samples;
    const bool centre_is_sample = positions.size() == 1 && positions[0].x == 128 && positions[0].y == 128;
    if ((targets.labels.any() && !centre_is_sample) || positions.empty()) positions.push_back({128, 128});
    const std::function<void()> pause = [&] { settings.checkpoint(0.0); };
    const FrontEndInput input{frame, shading, raster_kernels(settings.isa), grid, positions, pause};
    state_->front.run(input, arena);

    const TileTask task(frame, shading, settings, targets, grid, state_->front);
    for (const std::unique_ptr<Tile>& tile : state_->idle) tile->reset_counters();
    std::atomic<int> done{0};
    arena.for_each(static_cast<std::size_t>(grid.count()), [&](std::size_t index) {
        settings.checkpoint(static_cast<double>(done.load()) / grid.count());
        std::unique_ptr<Tile> tile = state_->take();
        tile->draw(task, static_cast<int>(index));
        state_->give(std::move(tile));
        ++done;
    });
    settings.checkpoint(1.0);
    RasterCounters counters;
    counters.front = state_->front.counters;
    counters.triangles = state_->front.triangles;
    counters.tile_side = grid.side;
    for (const std::unique_ptr<Tile>& tile : state_->idle) {
        add(counters.tiles, tile->counters);
        counters.pixels_covered += tile->pixels_covered;
    }
    // Cut-outs and transparent triangles are counted in any case: a part of the sums would mislead.
    if (!settings.count) counters.tiles.samples_covered = counters.tiles.fragments_passed = 0;
    return counters;
}

}  // namespace tessera
