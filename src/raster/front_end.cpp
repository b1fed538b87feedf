#include "raster/front_end.h"

#include <algorithm>
#include <mutex>

namespace tessera {
namespace {

// Part of one instance's triangles.
struct ChunkRange {
    std::uint32_t instance, first, count;
};

std::vector<ChunkRange> make_chunks(const Frame& frame, int threads, std::uint64_t& triangles,
                                    FrontCounters& counters) {
    const std::uint32_t size =
        std::clamp(frame.triangle_count / (8u * static_cast<std::uint32_t>(threads)), 2048u, 16384u);
    std::vector<ChunkRange> chunks;
    for (std::uint32_t i = 0; i < frame.instances.size(); ++i) {
        const std::uint32_t count = frame.instances[i].mesh.triangle_count;
        triangles += count;
        if (outside_view(frame.instances[i], frame.prepared[i]->bounds)) {
            counters.frustum += count;
            continue;
        }
        for (std::uint32_t first = 0; first < count; first += size)
            chunks.push_back({i, first, std::min(size, count - first)});
    }
    return chunks;
}

// The scalar path: clipped triangles, and those too large for the kernel's 32-bit areas.
void set_up_slowly(const SetupJob& job, std::uint32_t triangle, std::vector<TriangleRecord>& out,
                   FrontCounters& counters) {
    TriangleSetup t;
    setup_triangle(*job.instance, triangle, job.projection, t);
    switch (t.kind) {
        case TriangleSetup::Kind::kOutside:
            ++counters.frustum;
            return;
        case TriangleSetup::Kind::kDegenerate:
            ++counters.degenerate;
            return;
        case TriangleSetup::Kind::kClipped:
            ++counters.clipped;
            break;
        case TriangleSetup::Kind::kPlain:
            break;
    }
    if (!t.front(*job.instance) && !job.double_sided) {
        ++counters.backface;
        return;
    }
    for (int i = 1; i + 1 < t.vertex_count; ++i) {
        const std::int64_t area = twice_area(t.polygon[0], t.polygon[i], t.polygon[i + 1]);
        if (area == 0 || (area < 0) != (t.orientation > 0)) continue;
        TriangleRecord r{
            {t.polygon[0], t.polygon[i], t.polygon[i + 1]}, t.depth, triangle, job.instance_index, t.orientation};
        if (area < 0) std::swap(r.v[1], r.v[2]);
        out.push_back(r);
    }
}

struct TileRange {
    int x_begin, y_begin, x_end, y_end;  // end is one past
};

TileRange tiles_of(const TriangleRecord& r, const TileGrid& grid) {
    const auto tile = [](std::int32_t v) { return (v >> 8) / kTileSide; };
    const auto [low_x, high_x] = std::minmax({r.v[0].x, r.v[1].x, r.v[2].x});
    const auto [low_y, high_y] = std::minmax({r.v[0].y, r.v[1].y, r.v[2].y});
    if (high_x < 0 || high_y < 0) return {0, 0, 0, 0};
    return {tile(std::max(low_x, 0)), tile(std::max(low_y, 0)), std::min(tile(high_x) + 1, grid.columns),
            std::min(tile(high_y) + 1, grid.rows)};
}

// Whether a tile lies wholly outside one edge of the triangle.
bool misses_tile(const TriangleRecord& r, int tile_x, int tile_y) {
    const std::int64_t side = 256 * kTileSide, x = tile_x * side, y = tile_y * side;
    for (int k = 0; k < 3; ++k) {
        const SnappedVertex from = r.v[k], to = r.v[(k + 1) % 3];
        const std::int64_t dx = static_cast<std::int64_t>(to.x) - from.x, dy = static_cast<std::int64_t>(to.y) - from.y;
        // The corner where E = dx (y - from.y) - dy (x - from.x) is largest.
        const std::int64_t cx = dy < 0 ? x + side : x, cy = dx > 0 ? y + side : y;
        if (dx * (cy - from.y) - dy * (cx - from.x) < 0) return true;
    }
    return false;
}

// Counting sort of the records by tile.
void bin(BinnedChunk& chunk, const TileGrid& grid) {
    struct Entry {
        std::uint32_t tile, record;
    };
    std::vector<Entry> unsorted;
    unsorted.reserve(chunk.records.size() + chunk.records.size() / 4);
    chunk.begin.assign(static_cast<std::size_t>(grid.count()) + 1, 0);
    for (std::uint32_t i = 0; i < chunk.records.size(); ++i) {
        const TriangleRecord& r = chunk.records[i];
        const TileRange range = tiles_of(r, grid);
        const bool large = (range.x_end - range.x_begin) > 1 && (range.y_end - range.y_begin) > 1;
        for (int y = range.y_begin; y < range.y_end; ++y)
            for (int x = range.x_begin; x < range.x_end; ++x) {
                if (large && misses_tile(r, x, y)) continue;
                const auto tile = static_cast<std::uint32_t>(y * grid.columns + x);
                unsorted.push_back({tile, i});
                ++chunk.begin[tile + 1];
            }
    }
    for (std::size_t t = 1; t < chunk.begin.size(); ++t) chunk.begin[t] += chunk.begin[t - 1];
    chunk.entries.resize(unsorted.size());
    std::vector<std::uint32_t> next(chunk.begin.begin(), chunk.begin.end() - 1);
    for (const Entry& e : unsorted) chunk.entries[next[e.tile]++] = e.record;
}

void add(FrontCounters& sum, const FrontCounters& c) {
    sum.frustum += c.frustum;
    sum.backface += c.backface;
    sum.degenerate += c.degenerate;
    sum.clipped += c.clipped;
}

}  // namespace

FrontEndResult run_front_end(const Frame& frame, const ShadingContext& shading, const RasterKernels& kernels,
                             const TileGrid& grid, const std::vector<SamplePosition>& samples, Arena& arena,
                             const std::function<void()>& checkpoint) {
    FrontEndResult result;
    const std::vector<ChunkRange> ranges = make_chunks(frame, arena.threads(), result.triangles, result.counters);
    result.chunks.resize(ranges.size());
    std::mutex counters_mutex;
    arena.for_each(ranges.size(), [&](std::size_t c) {
        checkpoint();
        const ChunkRange& range = ranges[c];
        BinnedChunk& chunk = result.chunks[c];
        std::vector<TriangleRecord> fast(range.count), clipped;
        std::vector<std::uint32_t> slow(range.count);
        SetupJob job{};
        job.instance = &frame.instances[range.instance];
        job.projection = frame.projection;
        job.instance_index = range.instance;
        job.first = range.first;
        job.count = range.count;
        job.double_sided = shading.materials[job.instance->material].double_sided;
        job.one_sample = samples.size() == 1;
        job.sample = samples[0];
        job.records = fast.data();
        job.slow = slow.data();
        kernels.setup(job);
        for (std::uint32_t i = 0; i < job.slow_count; ++i) set_up_slowly(job, slow[i], clipped, job.counters);
        fast.resize(job.record_count);
        chunk.records.resize(fast.size() + clipped.size());
        std::merge(fast.begin(), fast.end(), clipped.begin(), clipped.end(), chunk.records.begin(),
                   [](const TriangleRecord& a, const TriangleRecord& b) { return a.triangle < b.triangle; });
        if (!chunk.empty()) bin(chunk, grid);
        const std::lock_guard lock(counters_mutex);
        add(result.counters, job.counters);
    });
    return result;
}

}  // namespace tessera
