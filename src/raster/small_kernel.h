// Small triangles in a tile: the pixels of a mask, one by one. Part of the kernel file, once per
// instruction set.
#pragma once

#include "raster/medium_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// What of a mask at (x, y) lies in the tile.
TESSERA_INLINE std::uint64_t cut_mask(std::uint64_t mask, std::int32_t x, std::int32_t y, int side) {
    const std::int32_t inner = side - kBlockSide;
    if ((x < 0) | (y < 0) | (x > inner) | (y > inner)) {
        std::uint64_t columns = 0xff;
        if (x < 0) columns = columns << -x & 0xff;
        if (x > inner) columns >>= x - inner;
        mask &= columns * 0x0101010101010101u;
        if (y < 0) mask &= ~std::uint64_t{0} << (kBlockSide * -y);
        if (y > inner) mask &= ~std::uint64_t{0} >> (kBlockSide * (y - inner));
    }
    return mask;
}

// The depth test at the pixels of a mask. Steps of whole pixels are exact in float, so z is the plane's
// value.
struct SmallFill {
    float depth, ddx, ddy, lowest, highest;  // the plane's: copies, which stores into the tile cannot change
    float dx, dy;                            // from the anchor to the first sample
    const std::int32_t *columns, *rows;

    TESSERA_INLINE std::int32_t place(int bit) const { return columns[bit & 7] + rows[bit >> 3]; }
    TESSERA_INLINE float depth_at(int bit) const {
        static constexpr float kStep[kBlockSide] = {0, 256, 512, 768, 1024, 1280, 1536, 1792};
        const float plane = (depth + ddy * (dy + kStep[bit >> 3])) + ddx * (dx + kStep[bit & 7]);
        return min(max(plane, lowest), highest);
    }
};

template <bool kCount>
TESSERA_INLINE void fill_small(VisibilityJob& job, const PixelPlaces& places, const SmallTriangle& t,
                               std::uint32_t ordinal) {
    const std::int32_t picture_x = static_cast<std::int32_t>(t.position & 0xffffu),
                       picture_y = static_cast<std::int32_t>(t.position >> 16);
    const std::int32_t x = picture_x - job.x0, y = picture_y - job.y0;
    std::uint64_t mask = cut_mask(t.rows[0] | static_cast<std::uint64_t>(t.rows[1]) << 32, x, y, job.side);
    const DepthPlane<float>& p = t.depth;
    const SmallFill f{p.depth,
                      p.ddx,
                      p.ddy,
                      p.lowest,
                      p.highest,
                      static_cast<float>(256 * picture_x + job.offset.x - p.anchor_x),
                      static_cast<float>(256 * picture_y + job.offset.y - p.anchor_y),
                      places.column + x,
                      places.row + y};
    for (; mask; mask &= mask - 1) {
        const int bit = __builtin_ctzll(mask);
        const std::int32_t at = f.place(bit);
        const float z = f.depth_at(bit), before = job.depth[at];
        const bool pass = z > before;
        if constexpr (kCount) {
            const bool counted = before < 3.4e38f;
            job.counters.samples_covered += counted;
            job.counters.fragments_passed += pass;
            if (job.overdraw) job.overdraw[at] += counted;
        }
        if (pass) {
            job.depth[at] = z;
            job.ordinal[at] = ordinal;
        }
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
