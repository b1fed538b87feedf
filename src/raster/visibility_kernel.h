// Fills a tile from its bins: small triangles by their masks, medium ones by their boxes, large ones by blocks.
// Part of the kernel file, once per instruction set.
#pragma once

#include "raster/large_kernel.h"
#include "raster/small_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Runs lie apart, and are too short for the processor to foresee where they go on.
TESSERA_INLINE void prefetch_run(const TileBin& bin, BinRun run) {
    const char* first = run.large() ? reinterpret_cast<const char*>(bin.large + run.first)
                                    : reinterpret_cast<const char*>(bin.small + run.first);
    for (int line = 0; line < 12; ++line) __builtin_prefetch(first + 64 * line);
}

template <bool kCount>
inline void draw_bins(VisibilityJob& job) {
    const PixelPlaces places(job.side);
    job.counters = {};
    std::uint32_t ordinal = 0;
    float floor = 0;
    // A quarter of the tile's blocks drawn: worth a look whether all of them are higher now.
    const auto renewal = static_cast<std::uint64_t>(job.side * job.side / (4 * kBlockPixels));
    std::uint64_t drawn = 0;
    for (std::uint32_t b = 0; b < job.bin_count; ++b) {
        const TileBin& bin = job.bins[b];
        for (std::uint32_t r = 0; r < bin.run_count; ++r) {
            const BinRun run = bin.runs[r];
            if (r + 1 < bin.run_count) prefetch_run(bin, bin.runs[r + 1]);
            if (!run.large()) {
                const SmallTriangle* t = bin.small + run.first;
                for (const SmallTriangle* const end = t + run.count; t != end; ++t) {
                    __builtin_prefetch(t + 16);  // past the end of the run it is wasted, not wrong
                    job.triangles[ordinal++] = {t->triangle, t->instance};
                    fill_small<kCount>(job, places, *t, ordinal);
                }
                continue;
            }
            const LargeTriangle* t = bin.large + run.first;
            for (const LargeTriangle* const end = t + run.size(); t != end; ++t) {
                job.triangles[ordinal++] = {t->triangle, t->instance};
                if (job.hierarchical_z) {
                    if (job.counters.blocks_drawn - drawn >= renewal) {
                        drawn = job.counters.blocks_drawn;
                        floor = tile_floor(job);
                    }
                    if (t->depth.highest < floor) {
                        ++job.counters.blocks_hidden;
                        continue;
                    }
                }
                fill_large<kCount>(job, places, *t, ordinal);
            }
        }
    }
}

inline void visibility(VisibilityJob& job) { job.count ? draw_bins<true>(job) : draw_bins<false>(job); }

}  // namespace tessera::TESSERA_ISA_NAMESPACE
