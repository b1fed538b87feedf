// What the stages of the rasterizer hand to each other and to their kernels: plain data. Picture
// coordinates in 24.8 fixed point (1/256 pixel, y down), depth reversed. docs/rasterizer.md explains
// the formats.
#pragma once

#include "tile/tile_data.h"

#include <cstdint>

namespace tessera {

// --- the front end ----------------------------------------------------------------------------

// Transforms `count` vertices: consecutive ones from `first`, or where `indices` is set those.
struct VertexJob {
    const InstanceView* instance;
    float width, height;
    const std::uint32_t* indices;
    std::uint32_t first, count;
    TransformedVertex* out;  // padded to kMaxLanes
};

// A triangle whose samples fit 8x8 pixels: all of its coverage as a mask (bit 8 * row + column, from
// pixel (x, y)), not clipped to the picture's right and bottom. One sample per pixel.
struct SmallTriangle {
    DepthPlane<float> depth;
    std::uint32_t position;  // x | y << 16
    std::uint32_t rows[2];   // rows 0 .. 3 and 4 .. 7
    std::uint32_t triangle;  // within its instance
    std::uint32_t instance;
};
static_assert(sizeof(SmallTriangle) == 48);

// Any other triangle, or a piece of a clipped one.
struct LargeTriangle {
    SnappedVertex v[3];  // clockwise on the screen
    DepthPlane<float> depth;
    std::uint32_t triangle;
    std::uint32_t instance;
};

// Consecutive triangles of a chunk that one tile draws: small ones, or large ones.
struct BinRun {
    static constexpr std::uint32_t kLarge = 0x80000000u;
    std::uint32_t first, count;  // count | kLarge

    TESSERA_INLINE std::uint32_t size() const { return count & ~kLarge; }
    TESSERA_INLINE bool large() const { return (count & kLarge) != 0; }
};

struct FrontCounters {
    std::uint64_t frustum = 0, backface = 0, degenerate = 0, clipped = 0, no_sample = 0, small = 0, large = 0;
};

// Triangles and runs of a chunk as they grow, in the order of submission. The arrays belong to the
// front end, which makes them larger when the kernel asks.
struct ChunkArrays {
    SmallTriangle* small;
    LargeTriangle* large;
    BinRun* runs;
    std::uint32_t* run_tiles;  // the tile of every run
    std::uint32_t small_count, large_count, run_count;
    std::uint32_t small_capacity, large_capacity, run_capacity;

    // How many more triangles fit of either kind, small ones with the four runs that they may need.
    TESSERA_INLINE std::uint32_t room() const {
        const std::uint32_t small_room = small_capacity - small_count, large_room = large_capacity - large_count;
        const std::uint32_t run_room = (run_capacity - run_count) / 4;
        const std::uint32_t least = small_room < large_room ? small_room : large_room;
        return least < run_room ? least : run_room;
    }
};

// Set-up and binning of consecutive triangles of one instance.
struct SetupJob {
    const InstanceView* instance;
    float width, height;
    std::uint32_t instance_index, first, count;
    bool double_sided;
    bool one_sample;  // then `sample` is its position, and triangles that reach none are dropped
    bool masks;       // small triangles may become masks
    SamplePosition sample;
    int tile_shift, tile_columns;
    InstanceVertices vertices;
    ChunkArrays arrays;
    FrontCounters counters;
    // Makes room for kMaxLanes more triangles of each kind and their runs.
    void (*reserve)(SetupJob& job);
    // Bins the last of arrays.large.
    void (*bin_large)(SetupJob& job);
    // Takes a triangle (within the instance) that is clipped, or too large for 32-bit areas.
    void (*set_up_slowly)(SetupJob& job, std::uint32_t triangle);
    void* owner;
};

// --- tiles ------------------------------------------------------------------------------------

// What one chunk has for one tile.
struct TileBin {
    const SmallTriangle* small;
    const LargeTriangle* large;
    const BinRun* runs;
    std::uint32_t run_count;
};

struct TileCounters {
    std::uint64_t samples_covered = 0;   // inside a triangle and tested for depth
    std::uint64_t fragments_passed = 0;  // and in front
    // Of large triangles; a triangle that the whole tile hides counts as one.
    std::uint64_t blocks_drawn = 0, blocks_hidden = 0;
};

// Coverage and depth of a tile at one sample position per pixel. Ordinals count the tile's triangles
// from 1 in the order of submission; 0 is nothing.
struct VisibilityJob {
    int x0, y0;  // first pixel
    int side;    // of the tile
    SamplePosition offset;
    const TileBin* bins;
    std::uint32_t bin_count;
    const SurfaceSource* source;
    bool hierarchical_z, count;
    float* depth;             // by pixel; infinite outside the picture
    std::uint32_t* ordinal;   // by pixel
    float* floor;             // by block: no depth in it is lower
    TileTriangle* triangles;  // out: by ordinal - 1
    TileCounters counters;
    // Receives one transparent fragment.
    void (*add_fragment)(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth);
    void* owner;
    std::uint32_t* overdraw;  // by pixel: samples that were tested; null where not wanted
};

struct RasterKernels {
    void (*transform)(const VertexJob& job);
    void (*setup)(SetupJob& job);
    void (*visibility)(VisibilityJob& job);
};

}  // namespace tessera
