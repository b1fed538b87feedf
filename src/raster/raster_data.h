// What the stages of the rasterizer hand to each other and to their kernels: plain data. Picture
// coordinates in 24.8 fixed point (1/256 pixel, y down), depth reversed.
#pragma once

#include "shading/film.h"
#include "shading/shade.h"
#include "shading/triangle_setup.h"

#include <cstdint>

namespace tessera {

// Pixels on a side of a tile: its depth and ordinals (32 KiB) stay in the first two caches.
inline constexpr int kTileSide = 64;
inline constexpr int kTilePixels = kTileSide * kTileSide;
// The widest vectors; arrays that kernels read are padded to a multiple of it.
inline constexpr int kMaxLanes = 16;

// A triangle, or a piece of a clipped one, ready to fill.
struct TriangleRecord {
    SnappedVertex v[3];  // clockwise on the screen
    DepthPlane<float> depth;
    std::uint32_t triangle;  // within its instance
    std::uint32_t instance;
    float orientation;  // of the whole triangle: +1 counter-clockwise as a viewer sees it
};

struct FrontCounters {
    std::uint64_t frustum = 0, backface = 0, degenerate = 0, clipped = 0;
};

// Set-up of consecutive triangles of one instance. `records` and `slow` hold `count` entries.
struct SetupJob {
    const InstanceView* instance;
    ProjectionView projection;
    std::uint32_t instance_index, first, count;
    bool double_sided;
    // With one sample per pixel, its position: triangles that reach no sample are dropped.
    bool one_sample;
    SamplePosition sample;
    TriangleRecord* records;
    std::uint32_t record_count;
    // Triangles that need the scalar path: clipped, or too large for 32-bit areas.
    std::uint32_t* slow;
    std::uint32_t slow_count;
    FrontCounters counters;
};

// Coverage and depth of a tile at one sample position per pixel. Ordinals count the tile's records from
// 1; 0 is nothing.
struct VisibilityJob {
    int x0, y0, width, height;  // first pixel, and how many of the tile lie in the picture
    SamplePosition offset;
    const TriangleRecord* const* records;
    std::uint32_t record_count;
    const InstanceView* instances;
    const ShadingContext* shading;
    ProjectionView projection;
    float* depth;            // kTilePixels, row by row
    std::uint32_t* ordinal;  // kTilePixels
    std::uint64_t fragments_passed;
    // Receives one transparent fragment.
    void (*add_fragment)(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth);
    void* owner;
};

// Surface points of one instance to shade, one per entry, padded to kMaxLanes.
struct ShadeJob {
    const InstanceView* instance;
    const ShadingContext* shading;
    ProjectionView projection;
    std::uint32_t count;
    const std::int32_t *x, *y;     // picture position
    const std::int32_t* triangle;  // within the instance
    const float* orientation;
    float *r, *g, *b, *alpha, *distance;  // radiance, alpha, distance along the view axis
};

// A row of pixels to develop: sums over the samples in, display values out. Padded to kMaxLanes.
struct DevelopJob {
    FilmView film;
    float weight;  // one over the number of samples
    std::uint32_t count;
    const float *r, *g, *b, *alpha;
    std::uint8_t* rgba;  // straight from the kernel, `count` pixels
};

struct RasterKernels {
    void (*setup)(SetupJob& job);
    void (*visibility)(VisibilityJob& job);
    void (*shade)(const ShadeJob& job);
    void (*develop)(const DevelopJob& job);
};

}  // namespace tessera
