// The tile rasterizer: front end, then one task per tile that finds what is visible, shades it and
// develops it. Bit for bit the reference rasterizer's pictures.
#pragma once

#include "raster/raster_visibility.h"
#include "tile/picture.h"

#include <memory>

namespace tessera {

struct RasterSettings : PictureSettings {
    bool hierarchical_z = true;
    bool count = true;  // fragments: samples_covered, fragments_passed
    RasterInspection inspection;
};

struct RasterCounters {
    FrontCounters front;
    TileCounters tiles;
    std::uint64_t triangles = 0, pixels_covered = 0;
    int tile_side = 0;
};

// Keeps its memory from frame to frame. One frame at a time.
class RasterEngine {
  public:
    RasterEngine();
    ~RasterEngine();
    RasterEngine(RasterEngine&&) noexcept;
    RasterEngine& operator=(RasterEngine&&) noexcept;

    RasterCounters draw(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
                        const PictureTargets& targets, Arena& arena);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tessera
