// One tile from binned triangles to pixels: for every sample visibility, shading in batches by
// instance, transparency from far to near; then the film. A Tile is scratch memory that one task at a
// time uses, and is used again for other tiles.
#pragma once

#include "raster/engine.h"

#include <vector>

namespace tessera {

class Tile {
  public:
    Tile(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
         const RasterTargets& targets, const FrontEndResult& front);

    // Draws tile `index` of the grid.
    void draw(const TileGrid& grid, int index);

    std::uint64_t fragments_passed = 0, pixels_covered = 0;

  private:
    struct Fragment {
        std::uint32_t pixel, ordinal;
        float depth;
    };
    // Surface points to shade, in the order in which they were asked for, and their colours.
    struct Points {
        std::vector<std::uint32_t> ordinal;
        std::vector<std::int32_t> x, y;
        std::vector<float> r, g, b, alpha, distance;
        void clear() { ordinal.clear(), x.clear(), y.clear(); }
    };

    void gather_records(int tile);
    void find_visible(SamplePosition offset);
    void sort_fragments();
    void shade_visible(SamplePosition offset);
    void shade_points();
    void add_sample();
    void label();
    void develop();
    std::uint32_t number(std::uint32_t ordinal) const;
    static void add_fragment(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth);

    const Frame& frame_;
    const ShadingContext& shading_;
    const RasterSettings& settings_;
    const RasterTargets& targets_;
    const FrontEndResult& front_;
    const RasterKernels& kernels_;

    int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;  // of the tile, in pixels of the picture
    std::vector<const TriangleRecord*> records_;
    std::vector<float> depth_;
    std::vector<std::uint32_t> ordinal_;
    std::vector<Fragment> fragments_;
    Points points_;
    std::vector<std::uint32_t> order_;  // of points, by instance
    std::vector<std::int32_t> batch_x_, batch_y_, batch_triangle_;
    std::vector<float> batch_orientation_, batch_[5];
    std::vector<float> sum_[4];  // of the samples: premultiplied RGB, alpha
    std::vector<char> hit_;
};

}  // namespace tessera
