#include "raster/engine.h"

#include "tile/tile.h"

namespace tessera {

struct RasterEngine::State {
    FrontEnd front;
    TilePool<RasterVisibility> tiles;
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
                                  const PictureTargets& targets, Arena& arena) {
    const TileGrid grid(static_cast<int>(frame.projection.width), static_cast<int>(frame.projection.height),
                        choose_tile_side(settings, frame.projection, arena.threads()));
    std::vector<SamplePosition> positions;
    if (targets.colors()) positions = settings.samples;
    const bool centre_is_sample = positions.size() == 1 && positions[0].x == 128 && positions[0].y == 128;
    if ((targets.labels.any() && !centre_is_sample) || positions.empty()) positions.push_back({128, 128});
    const std::function<void()> pause = [&] { settings.checkpoint(0.0); };
    const RasterKernels& kernels = raster_kernels(settings.isa);
    const FrontEndInput input{frame, shading, kernels, grid, positions, pause};
    state_->front.run(input, arena);

    const TileTask task(frame, shading, settings, targets, grid, state_->front.vertices());
    const RasterSource source{&state_->front, &task.source,           &kernels,           settings.hierarchical_z,
                              settings.count, settings.max_fragments, settings.inspection};
    state_->tiles.draw(task, arena, [&](RasterVisibility& visibility) { visibility.begin(source); });
    RasterCounters counters;
    counters.front = state_->front.counters;
    counters.triangles = state_->front.triangles;
    counters.tile_side = grid.side;
    state_->tiles.visit([&](const auto& worker) {
        add(counters.tiles, worker.visibility.counters);
        counters.pixels_covered += worker.tile.pixels_covered;
    });
    // Cut-outs and transparent triangles are counted in any case: a part of the sums would mislead.
    if (!settings.count) counters.tiles.samples_covered = counters.tiles.fragments_passed = 0;
    return counters;
}

}  // namespace tessera
