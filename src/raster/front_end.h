// The front end: vertices are transformed, then chunks of triangles set up and binned to tiles in parallel, each
// chunk into a store of its own, without locks. Tiles read the chunks in their order, which is that of
// submission.
#pragma once

#include "core/parallel.h"
#include "geometry/frame.h"
#include "raster/frame_vertices.h"
#include "tile/visible_tile.h"

#include <functional>
#include <mutex>
#include <vector>

namespace tessera {

// What one chunk gave. The runs of tile t are runs[begin[t]] to runs[begin[t + 1]].
struct BinnedChunk {
    SmallTriangle* small = nullptr;  // a part of FrontEnd's, with room for all of the chunk's triangles
    std::uint32_t small_capacity = 0;
    Buffer<LargeTriangle> large;
    Buffer<BinRun> runs;
    Buffer<std::uint32_t> begin;
    std::uint32_t small_count = 0, large_count = 0, run_count = 0;
    // While it is made: runs in the order of submission, and their tiles.
    Buffer<BinRun> unsorted;
    Buffer<std::uint32_t> tiles;
};

struct FrontEndInput {
    const Frame& frame;
    const ShadingContext& shading;
    const RasterKernels& kernels;
    const TileGrid& grid;
    const std::vector<SamplePosition>& samples;
    const std::function<void()>& checkpoint;  // called by the tasks; may throw
};

// Keeps its memory from frame to frame. One frame at a time.
class FrontEnd {
  public:
    void run(const FrontEndInput& input, Arena& arena);

    // What the chunks have for a tile, in the order of submission; returns how many triangles.
    std::uint32_t bins_of(int tile, std::vector<TileBin>& bins) const;

    // By instance; nothing for those that are not in view.
    const InstanceVertices* vertices() const { return vertices_.by_instance(); }

    FrontCounters counters;
    std::uint64_t triangles = 0;

  private:
    // Part of one instance's triangles.
    struct Range {
        std::uint32_t instance, first, count;
    };

    void place_small_triangles(bool masks);
    void make_chunks(const FrontEndInput& input, int threads);
    void build_chunk(const FrontEndInput& input, std::size_t chunk);
    void set_up(const FrontEndInput& input, const Range& range, BinnedChunk& chunk, FrontCounters& sum) const;

    FrameVertices vertices_;
    std::vector<std::uint32_t> in_view_;  // instances
    std::vector<Range> ranges_;
    std::vector<std::size_t> chunk_begin_;  // first range of every chunk, and the end
    std::vector<BinnedChunk> chunks_;
    Buffer<SmallTriangle> small_;
    std::mutex mutex_;
};

}  // namespace tessera
