// Set-up of as many triangles at a time as there are lanes: trivial rejects, snapping, facing, culling,
// depth planes, the coverage of small triangles, bins. Part of the kernel file, once per instruction
// set.
#pragma once

#include "raster/vertex_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Triangles whose box is smaller than 64 pixels have areas and edges that are exact in 32 bits.
inline constexpr std::int32_t kExactSide = 64 * 256;

TESSERA_INLINE void count_lanes(std::uint64_t& counter, std::uint32_t lanes) {
    counter += static_cast<std::uint64_t>(__builtin_popcount(lanes));
}

// The corners of kLanes triangles as they were transformed.
struct SetupCorners {
    Float x[3], y[3], z[3], inverse_w[3];

    // Three indices each.
    TESSERA_INLINE SetupCorners(const TransformedVertex* vertices, const std::uint32_t* indices) {
        TESSERA_UNROLL(3)
        for (int k = 0; k < 3; ++k)
            load_records([&](int lane) { return vertices[indices[3 * lane + k]].numbers; }, x[k], y[k], z[k],
                         inverse_w[k]);
    }
    TESSERA_INLINE Mask plain(int k) const { return inverse_w[k] > Float(0.0f); }
    TESSERA_INLINE Mask all_plain() const { return min(min(inverse_w[0], inverse_w[1]), inverse_w[2]) > Float(0.0f); }
};

// What is to become of triangles that are not plainly inside.
struct Rejects {
    std::uint32_t unusable, outside;  // lanes; the former first, the rest to the scalar path
};

// Triangles with a corner that is not plain. Those of plain corners have codes only where no rounding can have brought
// them there, so that what is left out here the scalar path leaves out, too.
TESSERA_INLINE Rejects reject_special(const SetupCorners& c, Float width, Float height) {
    Uint every(~0u), some(0u);
    for (int k = 0; k < 3; ++k) {
        const Float zero(0.0f);
        const Uint none(0u);
        const Uint picture =
            select(c.x[k] < zero, Uint(kOutLeft), none) | select(c.x[k] > width, Uint(kOutRight), none) |
            select(c.y[k] < zero, Uint(kOutTop), none) | select(c.y[k] > height, Uint(kOutBottom), none) |
            select(c.z[k] < zero, Uint(kOutFar), none);
        const Mask plain = c.plain(k);
        every &= select(plain, picture, as_uint(c.z[k]));
        some |= select(plain, none, as_uint(c.z[k]));
    }
    return {mask_bits((some & Uint(kUnusable)) != Uint(0u)),
            mask_bits((every & Uint(~static_cast<std::uint32_t>(kOutGuard))) != Uint(0u))};
}

// The samples that a box may hold.
struct SampleBox {
    Int left, top, right, bottom;  // inclusive
};

// One edge of kLanes triangles at a sample, as E / 256 rounded down, which keeps the sign of E and
// steps by whole a and b per pixel (see TileEdge).
struct LaneEdge {
    Int a, b, e;

    template <class Ties>
    TESSERA_INLINE LaneEdge(Int ax, Int ay, Int bx, Int by, Int x, Int y, const Ties& ties) {
        a = ay - by;
        b = bx - ax;
        e = (a * (x - ax) + b * (y - ay) + select(ties.own(a, b), Int(0), Int(-1))) >> 8;
    }
};

// Whose the samples on an edge with the gradient (a, b) are, as owns_edge() says: of meshes and points, and of lines.
struct TopLeft {
    TESSERA_INLINE Mask own(Int a, Int b) const { return (a > Int(0)) | ((a == Int(0)) & (b > Int(0))); }
};
struct LaneTies {
    Int rules;

    // Of the lines of kLanes triangles, of which `count` are there.
    TESSERA_INLINE LaneTies(const MeshView& mesh, std::uint32_t first, std::uint32_t count) {
        alignas(64) std::int32_t lanes[kLanes<Int>] = {};
        for (std::uint32_t i = 0; i < count; ++i) lanes[i] = mesh.ties[(first + i) >> 1];
        rules = load<Int>(lanes);
    }
    TESSERA_INLINE Mask has(int bit) const { return (rules & Int(bit)) != Int(0); }
    TESSERA_INLINE Mask own(Int a, Int b) const {
        const Int right = select(has(kTieLeft), Int(0) - a, a), down = select(has(kTieUp), Int(0) - b, b);
        const Mask down_first = has(kTieDownFirst);
        return TopLeft{}.own(select(down_first, down, right), select(down_first, right, down));
    }
};

// Four rows of coverage, a bit each: of all eight columns, or of the first four. The edges go on to the next row.
template <int kColumns>
TESSERA_INLINE Uint cover_rows(LaneEdge (&edges)[3]) {
    Uint covered(0u);
    TESSERA_UNROLL(4)
    for (int row = 0; row < 4; ++row) {
        Int e[3] = {edges[0].e, edges[1].e, edges[2].e};
        TESSERA_UNROLL(8)
        for (int column = 0; column < kColumns; ++column) {
            covered |= select(or3(e[0], e[1], e[2]) < Int(0), Uint(0u), Uint(1u << (kBlockSide * row + column)));
            for (int k = 0; k < 3; ++k) e[k] += edges[k].a;
        }
        for (LaneEdge& edge : edges) edge.e += edge.b;
    }
    return covered;
}

// Coverage of 8x8 samples from (x, y) on by triangles that run clockwise on the screen, a bit each.
// `wide` and `high`: whether any of the triangles reaches beyond four columns or rows.
template <class Ties>
TESSERA_INLINE void cover_small(const Int (&x)[3], const Int (&y)[3], Int first_x, Int first_y, bool wide, bool high,
                                const Ties& ties, Uint (&rows)[2]) {
    LaneEdge edges[3] = {{x[0], y[0], x[1], y[1], first_x, first_y, ties},
                         {x[1], y[1], x[2], y[2], first_x, first_y, ties},
                         {x[2], y[2], x[0], y[0], first_x, first_y, ties}};
    rows[0] = wide ? cover_rows<8>(edges) : cover_rows<4>(edges);
    rows[1] = Uint(0u);
    if (high) rows[1] = wide ? cover_rows<8>(edges) : cover_rows<4>(edges);
}

// The same for triangles of lines, from `first` of the job on.
__attribute__((noinline)) inline void cover_lines(const SetupJob& job, std::uint32_t first, const Int (&x)[3],
                                                  const Int (&y)[3], Int first_x, Int first_y, bool wide, bool high,
                                                  Uint (&rows)[2]) {
    const std::uint32_t left = job.count - first, width = kLanes<Int>;
    const LaneTies ties(job.instance->mesh, job.first + first, left < width ? left : width);
    cover_small(x, y, first_x, first_y, wide, high, ties, rows);
}

// Adds `count` small triangles from `first` on to a tile: to its last run, where they follow on it.
TESSERA_INLINE void add_run(ChunkArrays& c, std::uint32_t tile, std::uint32_t first, std::uint32_t count) {
    if (c.run_count > 0 && c.run_tiles[c.run_count - 1] == tile) {
        BinRun& run = c.runs[c.run_count - 1];
        if (!run.large() && run.first + run.count == first) {
            run.count += count;
            return;
        }
    }
    c.run_tiles[c.run_count] = tile;
    c.runs[c.run_count++] = {first, count};
}

inline void setup(SetupJob& job) {
    constexpr int kWidth = kLanes<Float>;
    const Int last_x(static_cast<std::int32_t>(job.width) - 1), last_y(static_cast<std::int32_t>(job.height) - 1);
    alignas(64) float depths[kWidth][8];
    const Int width(static_cast<std::int32_t>(job.width) * 256), height(static_cast<std::int32_t>(job.height) * 256);
    std::uint32_t rest_indices[3 * kWidth];
    alignas(64) std::int32_t vx[3][kWidth], vy[3][kWidth], tile_x[2][kWidth], tile_y[2][kWidth];
    alignas(64) std::int32_t tiles[kWidth];
    // Lanes whose front is clockwise as a viewer sees it, and those of which either side is drawn.
    const std::uint32_t turned = job.instance->handedness > 0 ? 0 : ~0u, either = job.double_sided ? ~0u : 0;
    const bool of_lines = job.instance->mesh.ties != nullptr;
    for (std::uint32_t t = 0; t < job.count; t += kWidth) {
        const std::uint32_t left = job.count - t;
        // Which lanes are what: as bits, for it takes many operations on few of them.
        std::uint32_t valid = (1u << kWidth) - 1;
        const std::uint32_t* indices = job.vertices.corners + 3 * (std::size_t{job.first} + t);
        if (left < std::uint32_t{kWidth}) {  // the last triangle repeated
            valid = (1u << left) - 1;
            for (std::uint32_t i = 0; i < 3 * std::uint32_t{kWidth}; ++i)
                rest_indices[i] = indices[i < 3 * left ? i : 3 * (left - 1) + i % 3];
            indices = rest_indices;
        }
        const SetupCorners corners(job.vertices.vertices, indices);
        PictureVertex<Float> p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = {corners.x[k], corners.y[k], nearest_int(corners.x[k]), nearest_int(corners.y[k])};
        const Int low_x = min(min(p[0].snapped_x, p[1].snapped_x), p[2].snapped_x);
        const Int high_x = max(max(p[0].snapped_x, p[1].snapped_x), p[2].snapped_x);
        const Int low_y = min(min(p[0].snapped_y, p[1].snapped_y), p[2].snapped_y);
        const Int high_y = max(max(p[0].snapped_y, p[1].snapped_y), p[2].snapped_y);
        const Float highest = max(max(corners.z[0], corners.z[1]), corners.z[2]);
        // Outside a plane of the view volume: for certain where beyond it in the picture. What touches it may be so,
        // too, and rounded; the scalar path knows.
        std::uint32_t inside = valid & mask_bits(corners.all_plain()), outside = 0, slow = 0;
        if (const std::uint32_t special = valid & ~inside) {
            const Rejects r = reject_special(corners, to_float(width), to_float(height));
            outside = special & ~r.unusable & r.outside;
            slow = special & ~r.unusable & ~r.outside;
            count_lanes(job.counters.degenerate, special & r.unusable);
        }
        const Int from_borders =
            or3(high_x - Int(1), width - Int(1) - low_x, high_y - Int(1)) | (height - Int(1) - low_y);
        if (const std::uint32_t border = inside & mask_bits((from_borders < Int(0)) | (highest <= Float(0.0f)))) {
            const Int beyond = or3(high_x, width - low_x, high_y) | (height - low_y);
            const std::uint32_t certain = border & mask_bits((beyond < Int(0)) | (highest < Float(0.0f)));
            outside |= certain;
            slow |= border & ~certain;
            inside &= ~border;
        }
        if (outside) count_lanes(job.counters.frustum, outside);
        if (!(inside | slow)) continue;
        const std::uint32_t exact = inside & mask_bits(max(high_x - low_x, high_y - low_y) < Int(kExactSide));
        slow |= inside & ~exact;
        const Int dx1 = p[1].snapped_x - p[0].snapped_x, dy1 = p[1].snapped_y - p[0].snapped_y;
        const Int dx2 = p[2].snapped_x - p[0].snapped_x, dy2 = p[2].snapped_y - p[0].snapped_y;
        // Meaningless, but harmless, where not exact.
        const Int area = as_int(as_uint(dx1) * as_uint(dy2) - as_uint(dx2) * as_uint(dy1));
        const Mask counter_clockwise = area < Int(0);
        const std::uint32_t flat = exact & mask_bits(area == Int(0));
        const std::uint32_t front = mask_bits(counter_clockwise) ^ turned;
        const std::uint32_t facing = exact & (front | either);
        std::uint32_t kept = facing & ~flat;
        count_lanes(job.counters.degenerate, flat);
        count_lanes(job.counters.backface, exact & ~flat & ~facing);
        if (!(kept | slow)) continue;

        SampleBox box;
        box.left = max((low_x + Int(255 - job.sample.x)) >> 8, Int(0));
        box.top = max((low_y + Int(255 - job.sample.y)) >> 8, Int(0));
        box.right = min((high_x - Int(job.sample.x)) >> 8, last_x);
        box.bottom = min((high_y - Int(job.sample.y)) >> 8, last_y);
        if (job.one_sample) {
            const std::uint32_t missed = kept & mask_bits(((box.right - box.left) | (box.bottom - box.top)) < Int(0));
            count_lanes(job.counters.no_sample, missed);
            kept &= ~missed;
        }
        if (!(kept | slow)) continue;
        if (job.arrays.room() < kMaxLanes) job.reserve(job);

        // Counter-clockwise ones are turned, so that all run clockwise on the screen.
        const Int x[3] = {p[0].snapped_x, select(counter_clockwise, p[2].snapped_x, p[1].snapped_x),
                          select(counter_clockwise, p[1].snapped_x, p[2].snapped_x)};
        const Int y[3] = {p[0].snapped_y, select(counter_clockwise, p[2].snapped_y, p[1].snapped_y),
                          select(counter_clockwise, p[1].snapped_y, p[2].snapped_y)};
        std::uint32_t small = 0;
        Uint rows[2];
        if (job.masks && kept) {
            // Beyond the picture too, so that a mask does not depend on its neighbours' sizes.
            const Int columns = ((high_x - Int(job.sample.x)) >> 8) - box.left;
            const Int lines = ((high_y - Int(job.sample.y)) >> 8) - box.top;
            if (const std::uint32_t fits = kept & mask_bits(max(columns, lines) < Int(kBlockSide))) {
                const bool wide = fits & mask_bits(columns > Int(3)), high = fits & mask_bits(lines > Int(3));
                const Int first_x = (box.left << 8) + Int(job.sample.x), first_y = (box.top << 8) + Int(job.sample.y);
                if (of_lines)
                    cover_lines(job, t, x, y, first_x, first_y, wide, high, rows);
                else
                    cover_small(x, y, first_x, first_y, wide, high, TopLeft{}, rows);
                small = fits & mask_bits((rows[0] | rows[1]) != Uint(0u));
                const std::uint32_t nothing = fits & ~small;
                count_lanes(job.counters.no_sample, nothing);
                kept &= ~nothing;
                if (!(kept | slow)) continue;
            }
        }
        ChunkArrays& c = job.arrays;
        std::uint32_t next_small = c.small_count;
        if (kept) {
            const DepthPlane<Float> depth = depth_plane(p, corners.z);
            if (small) {
                const Mask covers = mask_of_bits<Mask>(small);
                // Whole vectors: those of lanes that are not small lie behind the last, where there is room.
                float* const to = reinterpret_cast<float*>(c.small + c.small_count);
                const auto put = [&](int at, Float n0, Float n1, Float n2, Float n3) TESSERA_INLINE_LAMBDA {
                    constexpr int kNumbers = sizeof(SmallTriangle) / sizeof(float);
                    store_records([&](int i) { return to + kNumbers * i + at; }, compress(n0, covers),
                                  compress(n1, covers), compress(n2, covers), compress(n3, covers));
                };
                put(0, as_float(depth.anchor_x), as_float(depth.anchor_y), depth.depth, depth.ddx);
                put(4, depth.ddy, depth.lowest, depth.highest, as_float((box.top << 16) | box.left));
                put(8, as_float(rows[0]), as_float(rows[1]), as_float(as_uint(iota<Int>()) + Uint(job.first + t)),
                    as_float(Uint(job.instance_index)));
                const auto count = static_cast<std::uint32_t>(__builtin_popcount(small));
                c.small_count += count;
                job.counters.small += count;
                const Int first_x = box.left >> job.tile_shift, first_y = box.top >> job.tile_shift;
                const Int last_tile_x = box.right >> job.tile_shift, last_tile_y = box.bottom >> job.tile_shift;
                const Int tile = first_y * Int(job.tile_columns) + first_x;
                const Mask spread = (first_x != last_tile_x) | (first_y != last_tile_y);
                store(tiles, tile);
                const std::int32_t first_tile = tiles[__builtin_ctz(small)];
                if (small == (kept | slow) && none(covers & (spread | (tile != Int(first_tile))))) {
                    // All of them small and in one tile, as most often.
                    add_run(c, static_cast<std::uint32_t>(first_tile), next_small, count);
                    continue;
                }
                store(tile_x[0], first_x);
                store(tile_y[0], first_y);
                store(tile_x[1], last_tile_x);
                store(tile_y[1], last_tile_y);
            }
            if (kept & ~small) {
                store_records([&](int i) { return depths[i]; }, as_float(depth.anchor_x), as_float(depth.anchor_y),
                              depth.depth, depth.ddx);
                store_records([&](int i) { return depths[i] + 4; }, depth.ddy, depth.lowest, depth.highest,
                              depth.highest);
                for (int k = 0; k < 3; ++k) {
                    store(vx[k], x[k]);
                    store(vy[k], y[k]);
                }
            }
        }
        for (std::uint32_t rest = kept | slow; rest; rest &= rest - 1) {
            const int i = __builtin_ctz(rest);
            const std::uint32_t bit = rest & (0u - rest);
            if (small & bit) {
                for (std::int32_t row = tile_y[0][i]; row <= tile_y[1][i]; ++row)
                    for (std::int32_t column = tile_x[0][i]; column <= tile_x[1][i]; ++column)
                        add_run(c, static_cast<std::uint32_t>(row * job.tile_columns + column), next_small, 1);
                ++next_small;
            } else if (kept & bit) {
                LargeTriangle& r = c.large[c.large_count++];
                for (int k = 0; k < 3; ++k) r.v[k] = {vx[k][i], vy[k][i]};
                __builtin_memcpy(&r.depth, depths[i], sizeof(r.depth));
                r.triangle = job.first + t + static_cast<std::uint32_t>(i);
                r.instance = job.instance_index;
                ++job.counters.large;
                job.bin_large(job);
            } else {
                job.set_up_slowly(job, job.first + t + static_cast<std::uint32_t>(i));
            }
        }
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
