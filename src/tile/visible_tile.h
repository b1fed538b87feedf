// What is visible in a tile at one sample position, and the interface of those who find out: the rasterizer by bins,
// the ray tracer by packets of rays.
#pragma once

#include "tile/buffer.h"
#include "tile/tile_data.h"

#include <vector>

namespace tessera {

// Tiles over the picture, row after row.
struct TileGrid {
    int side, shift, columns, rows;  // side: 32, 64 or 128 pixels, 1 << shift

    TileGrid(int width, int height, int tile_side);
    int count() const { return columns * rows; }
};

// One of them.
struct TileArea {
    int index, side;
    int x0, y0;         // first pixel
    int width, height;  // within the picture

    TileArea() = default;
    TileArea(const TileGrid& grid, int tile, const ProjectionView& picture);
};

// Where a pixel of a tile is, whose pixels lie as blocks.
struct TilePixel {
    int x, y;
    TilePixel(std::uint32_t pixel, int side) {
        const int blocks = side / kBlockSide, block = static_cast<int>(pixel) / kBlockPixels,
                  at = static_cast<int>(pixel) % kBlockPixels;
        x = block % blocks * kBlockSide + at % kBlockSide;
        y = block / blocks * kBlockSide + at / kBlockSide;
    }
};

// One transparent surface at a pixel.
struct TileFragment {
    std::uint32_t pixel, ordinal;
    float depth;
};

// Ordinals count the tile's triangles from 1; 0 is nothing. Those of one instance follow each other.
struct VisibleTile {
    PixelArray<float> depth;                // canonical, of the nearest opaque surface
    PixelArray<std::uint32_t> ordinal;      // of that
    Buffer<TileTriangle> triangles;         // by ordinal - 1
    std::uint32_t triangle_count = 0;       // those that may be named
    std::vector<TileFragment> fragments{};  // in front of it, by pixel, far to near

    void resize(int side);
    // Sorts the fragments, at equal depth the lower triangle on top, without what the opaque surface hides.
    // `instances` give triangles their numbers.
    void sort_fragments(const InstanceView* instances);
    // Adds one; throws kLimit when there are too many.
    void add_fragment(const TileFragment& fragment, std::size_t most) {
        if (fragments.size() >= most) refuse_fragments();
        fragments.push_back(fragment);
    }

  private:
    [[noreturn]] static void refuse_fragments();
};

// Finds what is visible, with scratch memory for one tile at a time.
class TileVisibility {
  public:
    virtual ~TileVisibility() = default;
    // Turns to a tile. False where it shows nothing, wherever the samples are.
    virtual bool enter(const TileArea& area) = 0;
    // At a sample position of every pixel. `counted`: it goes into the statistics.
    virtual void find(SamplePosition offset, bool counted, VisibleTile& tile) = 0;
    // After a sample was shaded, of which `seen` triangles had records; and after all of them.
    virtual void sample_shaded(const VisibleTile&, std::uint32_t /*seen*/) {}
    virtual void picture_drawn() {}
};

}  // namespace tessera
