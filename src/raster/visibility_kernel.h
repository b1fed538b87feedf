// Fills a tile from its bins: masks of small triangles pixel by pixel, large ones by blocks. Part of the
// kernel file, once per instruction set.
#pragma once

#include "raster/block_kernel.h"

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

// Pixel by pixel of its mask. Steps of whole pixels are exact in float, so z is the plane's value.
template <bool kCount>
TESSERA_INLINE void fill_small(VisibilityJob& job, const PixelPlaces& places, const SmallTriangle& t,
                               std::uint32_t ordinal) {
    const std::int32_t picture_x = static_cast<std::int32_t>(t.position & 0xffffu),
                       picture_y = static_cast<std::int32_t>(t.position >> 16);
    const std::int32_t x = picture_x - job.x0, y = picture_y - job.y0;
    std::uint64_t mask = t.rows[0] | static_cast<std::uint64_t>(t.rows[1]) << 32;
    const std::int32_t inner = job.side - kBlockSide;
    if ((x < 0) | (y < 0) | (x > inner) | (y > inner)) {  // it lies in other tiles too
        std::uint64_t columns = 0xff;
        if (x < 0) columns = columns << -x & 0xff;
        if (x > inner) columns >>= x - inner;
        mask &= columns * 0x0101010101010101u;
        if (y < 0) mask &= ~std::uint64_t{0} << (kBlockSide * -y);
        if (y > inner) mask &= ~std::uint64_t{0} >> (kBlockSide * (y - inner));
    }
    static constexpr float kStep[kBlockSide] = {0, 256, 512, 768, 1024, 1280, 1536, 1792};
    const DepthPlane<float>& p = t.depth;
    const float dx = static_cast<float>(256 * picture_x + job.offset.x - p.anchor_x),
                dy = static_cast<float>(256 * picture_y + job.offset.y - p.anchor_y);
    const std::int32_t* const column_places = places.column + x;
    const std::int32_t* const row_places = places.row + y;
    for (; mask; mask &= mask - 1) {
        const int bit = __builtin_ctzll(mask), column = bit & 7, row = bit >> 3;
        const std::int32_t at = column_places[column] + row_places[row];
        const float plane = (p.depth + p.ddy * (dy + kStep[row])) + p.ddx * (dx + kStep[column]);
        const float z = min(max(plane, p.lowest), p.highest);
        const float before = job.depth[at];
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

template <bool kCount>
inline void draw_bins(VisibilityJob& job) {
    const PixelPlaces places(job.side);
    job.counters = {};
    std::uint32_t ordinal = 0;
    float floor = 0;
    std::uint64_t drawn = 0;
    for (std::uint32_t b = 0; b < job.bin_count; ++b) {
        const TileBin& bin = job.bins[b];
        for (std::uint32_t r = 0; r < bin.run_count; ++r) {
            const BinRun run = bin.runs[r];
            if (!run.large()) {
                const SmallTriangle* t = bin.small + run.first;
                for (const SmallTriangle* const end = t + run.count; t != end; ++t) {
                    job.triangles[ordinal++] = {t->triangle, t->instance};
                    fill_small<kCount>(job, places, *t, ordinal);
                }
                continue;
            }
            const LargeTriangle* t = bin.large + run.first;
            for (const LargeTriangle* const end = t + run.size(); t != end; ++t) {
                job.triangles[ordinal++] = {t->triangle, t->instance};
                if (job.hierarchical_z) {
                    if (drawn != job.counters.blocks_drawn) {
                        drawn = job.counters.blocks_drawn;
                        floor = tile_floor(job);
                    }
                    if (t->depth.highest < floor) {
                        ++job.counters.blocks_hidden;
                        continue;
                    }
                }
                fill_large<kCount>(job, *t, ordinal);
            }
        }
    }
}

inline void visibility(VisibilityJob& job) { job.count ? draw_bins<true>(job) : draw_bins<false>(job); }

}  // namespace tessera::TESSERA_ISA_NAMESPACE
