// The owner of a set-up kernel's arrays, as the front end is one: it makes room, bins large triangles, and
// takes those that need the scalar path.
#include "raster/kernel_world.h"

#include <algorithm>
#include <utility>

namespace tessera::test {
namespace {

enum Call : std::uint32_t { kBinLarge = 1u << 30, kSlowly = 2u << 30 };

struct Owner {
    SetupJob job{};
    SetupResult& result;
    ProjectionView projection{};
    int tile_rows;

    explicit Owner(SetupResult& r) : result(r) {
        job.owner = this;
        job.reserve = [](SetupJob& j) { of(j).grow(kMaxLanes); };
        job.bin_large = [](SetupJob& j) { of(j).bin_last(); };
        job.set_up_slowly = [](SetupJob& j, std::uint32_t triangle) { of(j).set_up_slowly(triangle); };
    }
    static Owner& of(SetupJob& j) { return *static_cast<Owner*>(j.owner); }

    // Room for `more` triangles of each kind with their runs, and not much beyond.
    void grow(std::uint32_t more) {
        ChunkArrays& a = job.arrays;
        result.small.resize(a.small_count + more);
        result.large.resize(a.large_count + more);
        result.runs.resize(a.run_count + 4 * more);
        result.run_tiles.resize(a.run_count + 4 * more);
        a.small = result.small.data();
        a.large = result.large.data();
        a.runs = result.runs.data();
        a.run_tiles = result.run_tiles.data();
        a.small_capacity = static_cast<std::uint32_t>(result.small.size());
        a.large_capacity = static_cast<std::uint32_t>(result.large.size());
        a.run_capacity = static_cast<std::uint32_t>(result.runs.size());
    }
    // To every tile that its box meets.
    void bin_last() {
        result.calls.push_back(kBinLarge | job.arrays.large_count);
        const std::uint32_t index = job.arrays.large_count - 1;
        const LargeTriangle t = job.arrays.large[index];
        const auto tile = [&](std::int32_t v, int count) {
            return std::clamp(v >> (8 + job.tile_shift), 0, count - 1);
        };
        const auto [left, right] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
        const auto [top, bottom] = std::minmax({t.v[0].y, t.v[1].y, t.v[2].y});
        if (right < 0 || bottom < 0 || left >= static_cast<int>(projection.width) * 256 ||
            top >= static_cast<int>(projection.height) * 256)
            return;
        for (int y = tile(top, tile_rows); y <= tile(bottom, tile_rows); ++y)
            for (int x = tile(left, job.tile_columns); x <= tile(right, job.tile_columns); ++x) {
                grow(2 * kMaxLanes);
                job.arrays.run_tiles[job.arrays.run_count] = static_cast<std::uint32_t>(y * job.tile_columns + x);
                job.arrays.runs[job.arrays.run_count++] = {index, 1 | BinRun::kLarge};
            }
    }
    void set_up_slowly(std::uint32_t triangle) {
        result.calls.push_back(kSlowly | triangle);
        TriangleSetup t;
        setup_triangle(*job.instance, triangle, projection, t);
        if (!t.visible()) return;
        for (int i = 1; i + 1 < t.vertex_count; ++i) {
            const std::int64_t area = twice_area(t.polygon[0], t.polygon[i], t.polygon[i + 1]);
            if (area == 0 || (area < 0) != (t.orientation > 0)) continue;
            grow(2 * kMaxLanes);
            LargeTriangle& piece = job.arrays.large[job.arrays.large_count++];
            piece = {{t.polygon[0], t.polygon[i], t.polygon[i + 1]}, t.depth, triangle, job.instance_index};
            if (area < 0) std::swap(piece.v[1], piece.v[2]);
            bin_last();
        }
    }
};

}  // namespace

void set_up(const RasterKernels& kernels, const KernelMesh& mesh, std::uint32_t instance, const SetupOptions& options,
            SetupResult& result) {
    const InstanceView& view = mesh.instance();
    // The vertices by one lane, so that only the set-up differs; they end where memory ends.
    std::vector<TransformedVertex> padded(view.mesh.vertex_count + kMaxLanes);
    const VertexJob vertices{&view, KernelMesh::kWidth,     KernelMesh::kHeight, nullptr,
                             0,     view.mesh.vertex_count, padded.data()};
    raster_kernels(Isa::kScalar).transform(vertices);
    padded.resize(view.mesh.vertex_count);
    const GuardedArray<TransformedVertex> transformed(padded);

    Owner owner(result);
    SetupJob& job = owner.job;
    job.instance = &view;
    job.width = owner.projection.width = KernelMesh::kWidth;
    job.height = owner.projection.height = KernelMesh::kHeight;
    job.instance_index = instance;
    job.count = view.mesh.triangle_count;
    job.double_sided = options.double_sided;
    job.one_sample = options.one_sample;
    job.masks = options.masks;
    job.sample = options.sample;
    while (1 << job.tile_shift < options.tile_side) ++job.tile_shift;
    job.tile_columns = (KernelMesh::kWidth + options.tile_side - 1) / options.tile_side;
    owner.tile_rows = (KernelMesh::kHeight + options.tile_side - 1) / options.tile_side;
    job.vertices = {transformed.data(), view.mesh.triangles};
    job.arrays.small_count = static_cast<std::uint32_t>(result.small.size());
    job.arrays.large_count = static_cast<std::uint32_t>(result.large.size());
    job.arrays.run_count = static_cast<std::uint32_t>(result.runs.size());
    owner.grow(options.room);
    kernels.setup(job);
    result.small.resize(job.arrays.small_count);
    result.large.resize(job.arrays.large_count);
    result.runs.resize(job.arrays.run_count);
    result.run_tiles.resize(job.arrays.run_count);
    const auto add = [](std::uint64_t& sum, std::uint64_t more) { sum += more; };
    add(result.counters.frustum, job.counters.frustum);
    add(result.counters.backface, job.counters.backface);
    add(result.counters.degenerate, job.counters.degenerate);
    add(result.counters.clipped, job.counters.clipped);
    add(result.counters.no_sample, job.counters.no_sample);
    add(result.counters.small, job.counters.small);
    add(result.counters.large, job.counters.large);
}

}  // namespace tessera::test
