// What is visible in a tile, found by the rasterizer: the tile's bins drawn in the order of submission into depth and
// ordinals. Scratch memory of one tile at a time.
#pragma once

#include "raster/front_end.h"
#include "tile/visible_tile.h"

#include <vector>

namespace tessera {

// The stages of a picture with colours, drawn: planes of one number per pixel, null where not wanted.
struct RasterInspection {
    std::uint32_t* bins = nullptr;      // triangles of the pixel's tile
    std::uint32_t* overdraw = nullptr;  // samples tested for depth
    float* floor = nullptr;             // hierarchical Z of the pixel's block, after the last sample
    std::uint32_t* cost = nullptr;      // estimated cycles of the pixel's tile (inspection.cpp)
};

// What all tiles of a frame share.
struct RasterSource {
    const FrontEnd* front;
    const SurfaceSource* surfaces;
    const RasterKernels* kernels;
    bool hierarchical_z, count;
    std::size_t max_fragments;
    RasterInspection inspection;
};

class RasterVisibility final : public TileVisibility {
  public:
    // Before a frame.
    void begin(const RasterSource& source) { source_ = &source, counters = {}; }

    bool enter(const TileArea& area) override;
    void find(SamplePosition offset, bool counted, VisibleTile& tile) override;
    void sample_shaded(const VisibleTile& tile, std::uint32_t seen) override;
    void picture_drawn() override;

    TileCounters counters{};

  private:
    void clear_depth(VisibleTile& tile);
    static void add_fragment(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth);

    const RasterSource* source_ = nullptr;
    TileArea area_{};
    VisibleTile* tile_ = nullptr;  // that is being filled
    std::uint32_t triangle_count_ = 0;
    std::uint64_t cost_ = 0;  // of this tile so far
    TileCounters costed_{};   // counters at the last estimate
    std::vector<TileBin> bins_;
    PixelArray<float> floor_;
    PixelArray<std::uint32_t> overdraw_;
};

}  // namespace tessera
