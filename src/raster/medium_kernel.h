// Medium triangles in a tile: opaque ones whose box is at most kMediumSide pixels wide and high. Their box is
// walked vector by vector, without blocks, floors or 64-bit edges. Part of the kernel file, once per
// instruction set.
#pragma once

#include "tile/surface_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Where the pixels of a tile lie: pixel (x, y) at column[x] + row[y].
struct PixelPlaces {
    std::int32_t column[kMaxTileSide], row[kMaxTileSide];

    TESSERA_INLINE explicit PixelPlaces(int side) {
        for (int i = 0; i < side; ++i) {
            column[i] = (i & -kBlockSide) << 3 | (i & (kBlockSide - 1));
            row[i] = (i & -kBlockSide) * side + ((i & (kBlockSide - 1)) << 3);
        }
    }
};

TESSERA_INLINE std::int32_t least_of(std::int32_t a, std::int32_t b, std::int32_t c) {
    const std::int32_t m = a < b ? a : b;
    return m < c ? m : c;
}
TESSERA_INLINE std::int32_t most_of(std::int32_t a, std::int32_t b, std::int32_t c) {
    const std::int32_t m = a > b ? a : b;
    return m > c ? m : c;
}

// The box of a triangle's vertices.
struct TriangleBox {
    std::int32_t left, top, right, bottom;

    TESSERA_INLINE explicit TriangleBox(const SnappedVertex (&v)[3])
        : left(least_of(v[0].x, v[1].x, v[2].x)),
          top(least_of(v[0].y, v[1].y, v[2].y)),
          right(most_of(v[0].x, v[1].x, v[2].x)),
          bottom(most_of(v[0].y, v[1].y, v[2].y)) {}
    TESSERA_INLINE bool fits(std::int32_t side) const { return right - left <= side && bottom - top <= side; }
};

// Larger ones gain more from blocks than they lose. At this side edges are exact in 32 bits (kExactSide).
inline constexpr std::int32_t kMediumSide = 16 * 256;

template <bool kCount>
TESSERA_INLINE void fill_medium(VisibilityJob& job, const PixelPlaces& places, const LargeTriangle& t,
                                const TriangleBox& box, std::uint8_t ties, std::uint32_t ordinal) {
    const std::int32_t x0 = 256 * job.x0 + job.offset.x, y0 = 256 * job.y0 + job.offset.y;
    // The samples of the box, in the tile.
    const std::int32_t left = max((box.left - x0 + 255) >> 8, 0), top = max((box.top - y0 + 255) >> 8, 0);
    const std::int32_t right = min((box.right - x0) >> 8, job.side - 1),
                       bottom = min((box.bottom - y0) >> 8, job.side - 1);
    if (left > right || top > bottom) return;
    const std::int32_t first_x = left & -kPixelColumns, first_y = top & -kRows;
    const Int lane_x = lane_column(), lane_y = lane_row();
    Int start[3], right_step[3], down_step[3];
    for (int k = 0; k < 3; ++k) {
        const SnappedVertex from = t.v[k], to = t.v[k == 2 ? 0 : k + 1];
        const std::int32_t dx = to.x - from.x, dy = to.y - from.y;
        const std::int32_t rule = owns_edge(dx, dy, ties) ? 0 : 1;
        const std::int32_t e = (dx * (y0 + 256 * top - from.y) - dy * (x0 + 256 * left - from.x) - rule) >> 8;
        start[k] = Int(e - dy * (first_x - left) + dx * (first_y - top)) + (Int(dx) * lane_y - Int(dy) * lane_x);
        right_step[k] = Int(-dy * kPixelColumns);
        down_step[k] = Int(dx * kRows);
    }
    const DepthPlane<float>& p = t.depth;
    const Float ddx(p.ddx), ddy(p.ddy), origin(p.depth), lowest(p.lowest), highest(p.highest);
    const Uint id(ordinal);
    Float dx = to_float((lane_x << 8) + Int(x0 + 256 * first_x - p.anchor_x));
    const Float first_dy = to_float((lane_y << 8) + Int(y0 + 256 * first_y - p.anchor_y));
    for (std::int32_t x = first_x; x <= right; x += kPixelColumns) {
        Int e0 = start[0], e1 = start[1], e2 = start[2];
        const Float x_part = ddx * dx;
        Float dy = first_dy;
        for (std::int32_t y = first_y; y <= bottom; y += kRows) {
            const Mask covered = or3(e0, e1, e2) > Int(-1);
            // Vectors test without a look at what they cover, which is hard to predict.
            if (kLanes < Float >> 1 || any(covered)) {
                const std::int32_t at = places.column[x] + places.row[y];
                const Float before = load<Float>(job.depth + at);
                const Float z = min(max((origin + ddy * dy) + x_part, lowest), highest);
                const Mask pass = covered & (z > before);
                if constexpr (kCount) {
                    const Mask counted = covered & (before < Float(3.4e38f));
                    job.counters.samples_covered += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(counted)));
                    job.counters.fragments_passed += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(pass)));
                    if (job.overdraw)
                        store(job.overdraw + at, load<Uint>(job.overdraw + at) + select(counted, Uint(1u), Uint(0u)));
                }
                store_masked(job.depth + at, pass, z);
                store_masked(job.ordinal + at, pass, id);
            }
            e0 += down_step[0], e1 += down_step[1], e2 += down_step[2];
            dy += Float(256.0f * kRows);  // whole numbers: exact
        }
        start[0] += right_step[0], start[1] += right_step[1], start[2] += right_step[2];
        dx += Float(256.0f * kPixelColumns);
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
