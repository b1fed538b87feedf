// The tile in the middle of a workload's picture, and what the scalar kernels make of it.
#pragma once

#include "raster_kernel_cases.h"

#include <algorithm>

namespace tessera::bench {

class MiddleTile {
  public:
    explicit MiddleTile(const std::string& workload)
        : frame(BenchFrame::of(workload)),
          settings(frame.settings(Isa::kScalar)),
          task(frame.task(settings, targets, frame.front)),
          side(frame.grid.side) {
        const int column = frame.grid.columns / 2, row = frame.grid.rows / 2;
        x0 = side * column;
        y0 = side * row;
        triangle_count = frame.front.bins_of(row * frame.grid.columns + column, bins);
        const auto pixels = static_cast<std::size_t>(side * side);
        depth.resize(pixels);
        ordinal.resize(pixels);
        floor.resize(pixels / kBlockPixels + kMaxLanes);
        triangles.resize(triangle_count);
    }
    MiddleTile(const MiddleTile&) = delete;
    MiddleTile& operator=(const MiddleTile&) = delete;

    void clear() {
        std::fill(depth.begin(), depth.end(), 0.0f);
        std::fill(floor.begin(), floor.end(), 0.0f);
        std::fill(ordinal.begin(), ordinal.end(), 0u);
        std::fill(triangles.begin(), triangles.end(), TileTriangle{~0u, ~0u});
    }
    VisibilityJob visibility(bool hierarchical_z, bool count) {
        VisibilityJob job{};
        job.x0 = x0;
        job.y0 = y0;
        job.side = side;
        job.offset = {128, 128};
        job.bins = bins.data();
        job.bin_count = static_cast<std::uint32_t>(bins.size());
        job.source = &task.source;
        job.hierarchical_z = hierarchical_z;
        job.count = count;
        job.depth = depth.data();
        job.ordinal = ordinal.data();
        job.floor = floor.data();
        job.triangles = triangles.data();
        job.add_fragment = [](void*, std::uint32_t, std::uint32_t, float) {};  // the workloads are opaque
        return job;
    }
    // Visibility by the scalar kernel; returns how many samples were tested.
    std::uint64_t see() {
        clear();
        VisibilityJob job = visibility(false, true);
        raster_kernels(Isa::kScalar).visibility(job);
        return job.counters.samples_covered;
    }
    // The ordinals that are seen, in order.
    std::vector<std::uint32_t> seen() const {
        std::vector<std::uint32_t> list(ordinal);
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        if (!list.empty() && list.front() == 0) list.erase(list.begin());
        return list;
    }
    std::uint64_t covered() const {
        return ordinal.size() - static_cast<std::size_t>(std::count(ordinal.begin(), ordinal.end(), 0u));
    }

    BenchFrame& frame;
    const RasterSettings settings;
    const PictureTargets targets;
    const TileTask task;
    const int side;
    int x0, y0;
    std::uint32_t triangle_count;
    std::vector<TileBin> bins;
    std::vector<float> depth, floor;
    std::vector<std::uint32_t> ordinal;
    std::vector<TileTriangle> triangles;
};

// A tile as its own picture.
inline TileWindow whole_tile(int side) { return {side, side, side, 4 * static_cast<std::size_t>(side), false}; }

}  // namespace tessera::bench
