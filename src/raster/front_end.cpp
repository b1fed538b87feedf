#include "raster/front_end.h"

#include "core/huge_pages.h"

#include <algorithm>
#include <bit>

namespace tessera {
namespace {

// Everything a set-up kernel calls back for.
struct ChunkBuilder {
    SetupJob job{};
    BinnedChunk& chunk;
    const TileGrid& grid;
    const ProjectionView& projection;

    ChunkBuilder(BinnedChunk& c, const TileGrid& g, const ProjectionView& p) : chunk(c), grid(g), projection(p) {
        job.owner = this;
        job.reserve = [](SetupJob& j) { of(j).reserve(4 * kMaxLanes); };
        job.bin_large = [](SetupJob& j) { of(j).bin_last_large(); };
        job.set_up_slowly = [](SetupJob& j, std::uint32_t triangle) { of(j).set_up_slowly(triangle); };
        point_at_arrays();
    }
    static ChunkBuilder& of(SetupJob& job) { return *static_cast<ChunkBuilder*>(job.owner); }

    void point_at_arrays() {
        ChunkArrays& a = job.arrays;
        a.small = chunk.small;
        a.large = chunk.large.data();
        a.runs = chunk.unsorted.data();
        a.run_tiles = chunk.tiles.data();
        a.small_capacity = chunk.small_capacity;
        a.large_capacity = static_cast<std::uint32_t>(chunk.large.capacity());
        a.run_capacity = static_cast<std::uint32_t>(std::min(chunk.unsorted.capacity(), chunk.tiles.capacity()));
    }

    // Room for a batch of triangles of each kind, and `runs` more runs.
    void reserve(std::uint32_t runs) {
        ChunkArrays& a = job.arrays;
        if (a.room() >= kMaxLanes && a.run_count + runs <= a.run_capacity) return;
        chunk.large.reserve(a.large_count + kMaxLanes, a.large_count);
        chunk.unsorted.reserve(a.run_count + runs, a.run_count);
        chunk.tiles.reserve(a.run_count + runs, a.run_count);
        point_at_arrays();
    }

    void bin_last_large();
    void set_up_slowly(std::uint32_t triangle);
    void sort_runs();
};

struct TileRange {
    int x_begin, y_begin, x_end, y_end;  // end is one past

    int count() const { return std::max(x_end - x_begin, 0) * std::max(y_end - y_begin, 0); }
};

TileRange tiles_of(const LargeTriangle& t, const TileGrid& grid) {
    const auto tile = [&](std::int32_t v) { return v >> (8 + grid.shift); };
    const auto [low_x, high_x] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
    const auto [low_y, high_y] = std::minmax({t.v[0].y, t.v[1].y, t.v[2].y});
    return {std::max(tile(low_x), 0), std::max(tile(low_y), 0), std::min(tile(high_x) + 1, grid.columns),
            std::min(tile(high_y) + 1, grid.rows)};
}

// The edges of a triangle at the corners of tiles where they are largest.
struct CornerEdges {
    std::int64_t start[3], a[3], b[3];  // of tile (0, 0); per tile

    CornerEdges(const LargeTriangle& t, const TileGrid& grid) {
        const std::int64_t side = std::int64_t{256} * grid.side;
        for (int k = 0; k < 3; ++k) {
            const SnappedVertex from = t.v[k], to = t.v[(k + 1) % 3];
            const std::int64_t dx = static_cast<std::int64_t>(to.x) - from.x,
                               dy = static_cast<std::int64_t>(to.y) - from.y;
            start[k] = dx * ((dx > 0 ? side : 0) - from.y) - dy * ((dy < 0 ? side : 0) - from.x);
            a[k] = -dy * side;
            b[k] = dx * side;
        }
    }
    // Whether a tile lies wholly outside one edge.
    bool miss(int x, int y) const {
        for (int k = 0; k < 3; ++k)
            if (start[k] + a[k] * x + b[k] * y < 0) return true;
        return false;
    }
};

void ChunkBuilder::bin_last_large() {
    const std::uint32_t index = job.arrays.large_count - 1;
    const TileRange range = tiles_of(job.arrays.large[index], grid);
    reserve(static_cast<std::uint32_t>(range.count()) + 4 * kMaxLanes);
    ChunkArrays& arrays = job.arrays;
    const bool many = range.x_end - range.x_begin > 1 && range.y_end - range.y_begin > 1;
    const CornerEdges edges(arrays.large[index], grid);
    for (int y = range.y_begin; y < range.y_end; ++y)
        for (int x = range.x_begin; x < range.x_end; ++x) {
            if (many && edges.miss(x, y)) continue;
            arrays.run_tiles[arrays.run_count] = static_cast<std::uint32_t>(y * grid.columns + x);
            arrays.runs[arrays.run_count++] = {index, 1 | BinRun::kLarge};
        }
}

// The scalar path: clipped triangles, and those too large for the kernel's 32-bit areas.
void ChunkBuilder::set_up_slowly(std::uint32_t triangle) {
    TriangleSetup t;
    setup_triangle(*job.instance, triangle, projection, t);
    switch (t.kind) {
        case TriangleSetup::Kind::kOutside:
            ++job.counters.frustum;
            return;
        case TriangleSetup::Kind::kDegenerate:
            ++job.counters.degenerate;
            return;
        case TriangleSetup::Kind::kClipped:
            ++job.counters.clipped;
            break;
        case TriangleSetup::Kind::kPlain:
            break;
    }
    if (!t.front(*job.instance) && !job.double_sided) {
        ++job.counters.backface;
        return;
    }
    for (int i = 1; i + 1 < t.vertex_count; ++i) {
        const std::int64_t area = twice_area(t.polygon[0], t.polygon[i], t.polygon[i + 1]);
        if (area == 0 || (area < 0) != (t.orientation > 0)) continue;
        reserve(4 * kMaxLanes);
        LargeTriangle& piece = job.arrays.large[job.arrays.large_count++];
        piece = {{t.polygon[0], t.polygon[i], t.polygon[i + 1]}, t.depth, triangle, job.instance_index};
        if (area < 0) std::swap(piece.v[1], piece.v[2]);
        ++job.counters.large;
        bin_last_large();
    }
}

// Counting sort of the runs by tile; those of a tile keep their order.
void ChunkBuilder::sort_runs() {
    const ChunkArrays& a = job.arrays;
    const auto tiles = static_cast<std::size_t>(grid.count());
    std::uint32_t* begin = chunk.begin.reserve(tiles + 2);
    std::fill_n(begin, tiles + 2, 0u);
    for (std::uint32_t i = 0; i < a.run_count; ++i) ++begin[a.run_tiles[i] + 2];
    for (std::size_t t = 2; t < tiles + 2; ++t) begin[t] += begin[t - 1];
    BinRun* sorted = chunk.runs.reserve(a.run_count);
    // begin[t + 1] walks from the start of tile t to its end, which is the start of the next.
    for (std::uint32_t i = 0; i < a.run_count; ++i) sorted[begin[a.run_tiles[i] + 1]++] = a.runs[i];
    chunk.small_count = a.small_count;
    chunk.large_count = a.large_count;
    chunk.run_count = a.run_count;
}

void add(FrontCounters& sum, const FrontCounters& c) {
    sum.frustum += c.frustum;
    sum.backface += c.backface;
    sum.degenerate += c.degenerate;
    sum.clipped += c.clipped;
    sum.no_sample += c.no_sample;
    sum.small += c.small;
    sum.large += c.large;
}

}  // namespace

void FrontEnd::make_chunks(const FrontEndInput& input, int threads) {
    const Frame& frame = input.frame;
    const std::uint32_t size =
        std::clamp(frame.triangle_count / (8u * static_cast<std::uint32_t>(threads)), 2048u, 16384u);
    counters = {};
    triangles = 0;
    ranges_.clear();
    in_view_.clear();
    chunk_begin_.assign(1, 0);
    std::uint32_t filled = 0;
    for (std::uint32_t i = 0; i < frame.instances.size(); ++i) {
        const std::uint32_t count = frame.instances[i].mesh.triangle_count;
        triangles += count;
        if (outside_view(frame.instances[i], frame.prepared[i]->bounds)) {
            counters.frustum += count;
            continue;
        }
        if (count > 0) in_view_.push_back(i);
        for (std::uint32_t first = 0; first < count;) {
            const std::uint32_t part = std::min(size - filled, count - first);
            ranges_.push_back({i, first, part});
            first += part;
            filled += part;
            if (filled < size) continue;
            chunk_begin_.push_back(ranges_.size());
            filled = 0;
        }
    }
    if (filled > 0) chunk_begin_.push_back(ranges_.size());
    if (chunks_.size() < chunk_begin_.size() - 1) chunks_.resize(chunk_begin_.size() - 1);
    place_small_triangles(input.samples.size() == 1);
}

// One array for all chunks; `masks`: whether there can be any. What a chunk does not need is never touched, and takes
// memory only where pages are huge: so they are not asked for beyond some 64 MiB.
void FrontEnd::place_small_triangles(bool masks) {
    constexpr std::uint32_t kSpare = 2 * kMaxLanes;  // whole vectors are written
    std::size_t total = 0;
    for (const Range& range : ranges_) total += range.count;
    if (!masks) total = 0;
    total += kSpare * (chunk_begin_.size() - 1);
    if (small_.capacity() < total) {
        small_.reserve(total);
        const std::size_t bytes = total * sizeof(SmallTriangle);
        if (bytes <= std::size_t{64} << 20) prefer_huge_pages(small_.data(), bytes);
    }
    SmallTriangle* next = small_.data();
    for (std::size_t c = 0; c + 1 < chunk_begin_.size(); ++c) {
        std::uint32_t room = kSpare;
        for (std::size_t r = chunk_begin_[c]; masks && r < chunk_begin_[c + 1]; ++r) room += ranges_[r].count;
        chunks_[c].small = next;
        chunks_[c].small_capacity = room;
        next += room;
    }
}

void FrontEnd::set_up(const FrontEndInput& input, const Range& range, BinnedChunk& chunk, FrontCounters& sum) const {
    const InstanceView& instance = input.frame.instances[range.instance];
    const ProjectionView& picture = input.frame.projection;
    ChunkBuilder builder(chunk, input.grid, picture);
    const MaterialView& material = input.shading.materials[instance.material];
    SetupJob& job = builder.job;
    job.arrays.small_count = chunk.small_count;
    job.arrays.large_count = chunk.large_count;
    job.arrays.run_count = chunk.run_count;
    job.instance = &instance;
    job.width = picture.width;
    job.height = picture.height;
    job.instance_index = range.instance;
    job.first = range.first;
    job.count = range.count;
    job.double_sided = material.double_sided;
    job.one_sample = input.samples.size() == 1;
    job.masks = job.one_sample && material.alpha_mode == AlphaMode::kOpaque;
    job.sample = input.samples[0];
    job.tile_shift = input.grid.shift;
    job.tile_columns = input.grid.columns;
    job.vertices = vertices_.by_instance()[range.instance];
    input.kernels.setup(job);
    chunk.small_count = job.arrays.small_count;
    chunk.large_count = job.arrays.large_count;
    chunk.run_count = job.arrays.run_count;
    add(sum, job.counters);
}

void FrontEnd::build_chunk(const FrontEndInput& input, std::size_t index) {
    BinnedChunk& chunk = chunks_[index];
    chunk.small_count = chunk.large_count = chunk.run_count = 0;
    FrontCounters sum;
    for (std::size_t r = chunk_begin_[index]; r < chunk_begin_[index + 1]; ++r) set_up(input, ranges_[r], chunk, sum);
    ChunkBuilder builder(chunk, input.grid, input.frame.projection);
    builder.job.arrays.small_count = chunk.small_count;
    builder.job.arrays.large_count = chunk.large_count;
    builder.job.arrays.run_count = chunk.run_count;
    builder.sort_runs();
    const std::lock_guard lock(mutex_);
    add(counters, sum);
}

void FrontEnd::run(const FrontEndInput& input, Arena& arena) {
    make_chunks(input, arena.threads());
    vertices_.transform(input.frame, in_view_, input.kernels, arena, input.checkpoint);
    arena.for_each(chunk_begin_.size() - 1, [&](std::size_t chunk) {
        input.checkpoint();
        build_chunk(input, chunk);
    });
}

std::uint32_t FrontEnd::bins_of(int tile, std::vector<TileBin>& bins) const {
    bins.clear();
    std::uint32_t count = 0;
    const auto t = static_cast<std::size_t>(tile);
    for (std::size_t c = 0; c + 1 < chunk_begin_.size(); ++c) {
        const BinnedChunk& chunk = chunks_[c];
        const std::uint32_t first = chunk.begin[t], end = chunk.begin[t + 1];
        if (first == end) continue;
        bins.push_back({chunk.small, chunk.large.data(), chunk.runs.data() + first, end - first});
        for (std::uint32_t r = first; r < end; ++r) count += chunk.runs[r].size();
    }
    return count;
}

}  // namespace tessera
