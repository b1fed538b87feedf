// Set-up of as many triangles at a time as there are lanes: trivial rejects, snapping, facing, culling,
// depth planes, the coverage of small triangles, bins. Part of the kernel file, once per instruction
// set.
#pragma once

#include "raster/vertex_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Triangles whose box is smaller than 64 pixels have areas and edges that are exact in 32 bits.
inline constexpr std::int32_t kExactSide = 64 * 256;

TESSERA_INLINE void count_lanes(std::uint64_t& counter, Mask m) {
    counter += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(m)));
}

// The corners of kLanes triangles as they were transformed.
struct SetupCorners {
    Float x[3], y[3], z[3], inverse_w[3];

    // Three indices each.
    TESSERA_INLINE SetupCorners(const TransformedVertex* vertices, const std::uint32_t* indices) {
        for (int k = 0; k < 3; ++k)
            load_records([&](int lane) { return vertices[indices[3 * lane + k]].numbers; }, x[k], y[k], z[k],
                         inverse_w[k]);
    }
    TESSERA_INLINE Mask plain(int k) const { return inverse_w[k] != Float(0.0f); }
    TESSERA_INLINE Mask all_plain() const { return plain(0) & plain(1) & plain(2); }
};

// What is to become of triangles that are not plainly inside.
struct Rejects {
    Mask unusable, outside;  // the former first; the rest: to the scalar path
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
    const Mask unusable = (some & Uint(kUnusable)) != Uint(0u);
    const Mask outside = (every & Uint(~static_cast<std::uint32_t>(kOutGuard))) != Uint(0u);
    return {unusable, outside};
}

// The samples that a box may hold.
struct SampleBox {
    Int left, top, right, bottom;  // inclusive
};

// One edge of kLanes triangles at a sample, as E / 256 rounded down, which keeps the sign of E and
// steps by whole a and b per pixel (see TileEdge).
struct LaneEdge {
    Int a, b, e;

    TESSERA_INLINE LaneEdge(Int ax, Int ay, Int bx, Int by, Int x, Int y) {
        a = ay - by;
        b = bx - ax;
        const Mask top_left = (a > Int(0)) | ((a == Int(0)) & (b > Int(0)));
        e = (a * (x - ax) + b * (y - ay) + select(top_left, Int(0), Int(-1))) >> 8;
    }
};

// Coverage of 8x8 samples from (x, y) on by triangles that run clockwise on the screen, a bit each.
// `wide` and `high`: whether any of the triangles reaches beyond four columns or rows.
TESSERA_INLINE void cover_small(const Int (&x)[3], const Int (&y)[3], Int first_x, Int first_y, bool wide, bool high,
                                Uint (&rows)[2]) {
    LaneEdge e0(x[0], y[0], x[1], y[1], first_x, first_y), e1(x[1], y[1], x[2], y[2], first_x, first_y),
        e2(x[2], y[2], x[0], y[0], first_x, first_y);
    const int columns = wide ? 8 : 4;
    rows[1] = Uint(0u);
    for (int half = 0; half < (high ? 2 : 1); ++half) {
        Uint covered(0u);
        for (int row = 0; row < 4; ++row) {
            Int r0 = e0.e, r1 = e1.e, r2 = e2.e;
            for (int column = 0; column < columns; column += 4)
                for (int i = 0; i < 4; ++i) {
                    const std::uint32_t bit = 1u << (8 * row + column + i);
                    covered |= select(or3(r0, r1, r2) < Int(0), Uint(0u), Uint(bit));
                    r0 += e0.a, r1 += e1.a, r2 += e2.a;
                }
            e0.e += e0.b, e1.e += e1.b, e2.e += e2.b;
        }
        rows[half] = covered;
    }
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
    alignas(64) float made[kWidth][sizeof(SmallTriangle) / sizeof(float)];
    const Int width(static_cast<std::int32_t>(job.width) * 256), height(static_cast<std::int32_t>(job.height) * 256);
    std::uint32_t rest_indices[3 * kWidth];
    alignas(64) std::int32_t vx[3][kWidth], vy[3][kWidth], tile_x[2][kWidth], tile_y[2][kWidth];
    alignas(64) std::int32_t tiles[kWidth];
    for (std::uint32_t t = 0; t < job.count; t += kWidth) {
        const std::uint32_t left = job.count - t;
        const Mask valid = first_n<Float>(left < std::uint32_t{kWidth} ? static_cast<int>(left) : kWidth);
        const std::uint32_t* indices = job.vertices.corners + 3 * (std::size_t{job.first} + t);
        if (left < std::uint32_t{kWidth}) {  // the last triangle repeated
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
        Mask inside = valid & corners.all_plain(), outside(false), slow_lanes(false);
        if (!all(inside)) {
            const Mask special = valid & !inside;
            if (any(special)) {
                const Rejects r = reject_special(corners, to_float(width), to_float(height));
                const Mask usable = special & !r.unusable;
                outside = usable & r.outside;
                slow_lanes = usable & !r.outside;
                count_lanes(job.counters.degenerate, special & r.unusable);
            }
        }
        const Mask borderline = inside & ((high_x <= Int(0)) | (low_x >= width) | (high_y <= Int(0)) |
                                          (low_y >= height) | (highest <= Float(0.0f)));
        if (any(borderline)) {
            const Mask beyond = borderline & ((high_x < Int(0)) | (low_x > width) | (high_y < Int(0)) |
                                              (low_y > height) | (highest < Float(0.0f)));
            outside |= beyond;
            slow_lanes |= borderline & !beyond;
            inside &= !borderline;
        }
        count_lanes(job.counters.frustum, outside);
        const Mask exact = inside & (max(high_x - low_x, high_y - low_y) < Int(kExactSide));
        const Int dx1 = p[1].snapped_x - p[0].snapped_x, dy1 = p[1].snapped_y - p[0].snapped_y;
        const Int dx2 = p[2].snapped_x - p[0].snapped_x, dy2 = p[2].snapped_y - p[0].snapped_y;
        // Meaningless, but harmless, where not exact.
        const Int area = as_int(as_uint(dx1) * as_uint(dy2) - as_uint(dx2) * as_uint(dy1));
        const Mask flat = exact & (area == Int(0));
        const Mask counter_clockwise = area < Int(0);
        const Mask front = job.instance->handedness > 0 ? counter_clockwise : !counter_clockwise;
        const Mask facing = job.double_sided ? exact : exact & front;
        Mask keep = facing & !flat;
        count_lanes(job.counters.degenerate, flat);
        count_lanes(job.counters.backface, exact & !flat & !facing);
        const std::uint32_t slow = mask_bits(slow_lanes | (inside & !exact));
        if (!(mask_bits(keep) | slow)) continue;

        SampleBox box;
        box.left = max((low_x + Int(255 - job.sample.x)) >> 8, Int(0));
        box.top = max((low_y + Int(255 - job.sample.y)) >> 8, Int(0));
        box.right = min((high_x - Int(job.sample.x)) >> 8, last_x);
        box.bottom = min((high_y - Int(job.sample.y)) >> 8, last_y);
        if (job.one_sample) {
            const Mask reached = !((box.left > box.right) | (box.top > box.bottom));
            count_lanes(job.counters.no_sample, keep & !reached);
            keep &= reached;
        }
        std::uint32_t kept = mask_bits(keep);
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
            const Mask fits = keep & (max(columns, lines) < Int(kBlockSide));
            if (any(fits)) {
                const bool wide = any(fits & (columns > Int(3))), high = any(fits & (lines > Int(3)));
                cover_small(x, y, (box.left << 8) + Int(job.sample.x), (box.top << 8) + Int(job.sample.y), wide, high,
                            rows);
                const Mask covers = fits & ((rows[0] | rows[1]) != Uint(0u));
                small = mask_bits(covers);
                const std::uint32_t nothing = mask_bits(fits) & ~small;
                job.counters.no_sample += static_cast<std::uint64_t>(__builtin_popcount(nothing));
                kept &= ~nothing;
                if (!(kept | slow)) continue;
            }
        }
        if (kept) {
            const DepthPlane<Float> depth = depth_plane(p, corners.z);
            const Uint number = as_uint(iota<Int>()) + Uint(job.first + t);
            store_records([&](int i) { return made[i]; }, as_float(depth.anchor_x), as_float(depth.anchor_y),
                          depth.depth, depth.ddx);
            store_records([&](int i) { return made[i] + 4; }, depth.ddy, depth.lowest, depth.highest,
                          as_float((box.top << 16) | box.left));
            if (small) {
                store_records([&](int i) { return made[i] + 8; }, as_float(rows[0]), as_float(rows[1]),
                              as_float(number), as_float(Uint(job.instance_index)));
                const Int first_x = box.left >> job.tile_shift, first_y = box.top >> job.tile_shift;
                const Int last_tile_x = box.right >> job.tile_shift, last_tile_y = box.bottom >> job.tile_shift;
                const Int tile = first_y * Int(job.tile_columns) + first_x;
                const Mask spread = (first_x != last_tile_x) | (first_y != last_tile_y);
                const int any_small = __builtin_ctz(small);
                store(tiles, tile);
                if (small == (kept | slow) && !(mask_bits(spread | (tile != Int(tiles[any_small]))) & small)) {
                    // All of them small and in one tile, as most often.
                    ChunkArrays& c = job.arrays;
                    const auto count = static_cast<std::uint32_t>(__builtin_popcount(small));
                    add_run(c, static_cast<std::uint32_t>(tiles[any_small]), c.small_count, count);
                    for (std::uint32_t rest = small; rest; rest &= rest - 1)
                        __builtin_memcpy(&c.small[c.small_count++], made[__builtin_ctz(rest)], sizeof(SmallTriangle));
                    job.counters.small += count;
                    continue;
                }
                store(tile_x[0], first_x);
                store(tile_y[0], first_y);
                store(tile_x[1], last_tile_x);
                store(tile_y[1], last_tile_y);
            }
            if (kept & ~small)
                for (int k = 0; k < 3; ++k) {
                    store(vx[k], x[k]);
                    store(vy[k], y[k]);
                }
        }
        for (std::uint32_t rest = kept | slow; rest; rest &= rest - 1) {
            const int i = __builtin_ctz(rest);
            const std::uint32_t bit = rest & (0u - rest);
            ChunkArrays& c = job.arrays;
            if (small & bit) {
                const std::uint32_t n = c.small_count++;
                __builtin_memcpy(&c.small[n], made[i], sizeof(SmallTriangle));
                for (std::int32_t row = tile_y[0][i]; row <= tile_y[1][i]; ++row)
                    for (std::int32_t column = tile_x[0][i]; column <= tile_x[1][i]; ++column)
                        add_run(c, static_cast<std::uint32_t>(row * job.tile_columns + column), n, 1);
                ++job.counters.small;
            } else if (kept & bit) {
                LargeTriangle& r = c.large[c.large_count++];
                for (int k = 0; k < 3; ++k) r.v[k] = {vx[k][i], vy[k][i]};
                __builtin_memcpy(&r.depth, made[i], sizeof(r.depth));
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
