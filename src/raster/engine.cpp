#include "raster/engine.h"

#include "raster/tile.h"

#include <atomic>
#include <memory>
#include <mutex>

namespace tessera {
namespace {

// Tiles in work, one per thread at a time.
class TilePool {
  public:
    template <class Make>
    explicit TilePool(Make&& make) : make_(std::forward<Make>(make)) {}

    std::unique_ptr<Tile> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!free_.empty()) {
                std::unique_ptr<Tile> tile = std::move(free_.back());
                free_.pop_back();
                return tile;
            }
        }
        return make_();
    }
    void give(std::unique_ptr<Tile> tile) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(tile));
    }
    const std::vector<std::unique_ptr<Tile>>& all() const { return free_; }

  private:
    std::function<std::unique_ptr<Tile>()> make_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Tile>> free_;
};

}  // namespace

RasterCounters draw_raster(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
                           const RasterTargets& targets, Arena& arena) {
    const TileGrid grid(static_cast<int>(frame.projection.width), static_cast<int>(frame.projection.height));
    std::vector<SamplePosition> positions = settings.samples;
    if (targets.distance || targets.triangle) positions.push_back({128, 128});
    const FrontEndResult front = run_front_end(frame, shading, raster_kernels(settings.isa), grid, positions, arena,
                                               [&] { settings.checkpoint(0.0); });

    TilePool pool([&] { return std::make_unique<Tile>(frame, shading, settings, targets, front); });
    std::atomic<int> done{0};
    arena.for_each(static_cast<std::size_t>(grid.count()), [&](std::size_t index) {
        settings.checkpoint(static_cast<double>(done.load()) / grid.count());
        std::unique_ptr<Tile> tile = pool.take();
        tile->draw(grid, static_cast<int>(index));
        pool.give(std::move(tile));
        ++done;
    });
    settings.checkpoint(1.0);
    RasterCounters counters;
    counters.front = front.counters;
    counters.triangles = front.triangles;
    for (const std::unique_ptr<Tile>& tile : pool.all()) {
        counters.fragments_passed += tile->fragments_passed;
        counters.pixels_covered += tile->pixels_covered;
    }
    return counters;
}

}  // namespace tessera
