// The front end: chunks of triangles are set up in parallel and binned to tiles, each chunk into a
// store of its own, without locks. Tiles read the chunks in their order, which is that of submission.
#pragma once

#include "core/parallel.h"
#include "geometry/frame.h"
#include "raster/kernels.h"

#include <functional>
#include <vector>

namespace tessera {

// A tile grid over the picture.
struct TileGrid {
    int columns, rows;
    TileGrid(int width, int height)
        : columns((width + kTileSide - 1) / kTileSide), rows((height + kTileSide - 1) / kTileSide) {}
    int count() const { return columns * rows; }
};

// What one chunk gave: records in the order of submission, and for every tile the numbers of those
// that may touch it, in the same order.
struct BinnedChunk {
    std::vector<TriangleRecord> records;
    std::vector<std::uint32_t> entries;  // tile after tile
    std::vector<std::uint32_t> begin;    // of each tile in entries; one more than tiles

    bool empty() const { return records.empty(); }
};

struct FrontEndResult {
    std::vector<BinnedChunk> chunks;
    FrontCounters counters;
    std::uint64_t triangles = 0;
};

// `samples` are the sample positions per pixel. `checkpoint` is called by the tasks and may throw.
FrontEndResult run_front_end(const Frame& frame, const ShadingContext& shading, const RasterKernels& kernels,
                             const TileGrid& grid, const std::vector<SamplePosition>& samples, Arena& arena,
                             const std::function<void()>& checkpoint);

}  // namespace tessera
