// Large triangles in a tile: which blocks of 8x8 pixels the edges and hierarchical Z leave. Part of the kernel
// file, once per instruction set.
#pragma once

#include "raster/block_kernel.h"
#include "raster/medium_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// The lowest of the floors.
inline float tile_floor(const VisibilityJob& job) {
    const int blocks = job.side / kBlockSide * (job.side / kBlockSide);
    Float low = load<Float>(job.floor);
    for (int i = kLanes<Float>; i < blocks; i += kLanes<Float>) low = min(low, load<Float>(job.floor + i));
    return least_lane(low);
}

// Which blocks of a group lie before their floors. `bound`: nothing of the triangle is nearer. A transparent
// fragment at equal depth may still be in front.
template <FillKind kKind>
TESSERA_INLINE std::uint32_t shown_blocks(const float* floors, std::uint32_t rest, Float bound, const int* block,
                                          bool consecutive) {
    if (consecutive) {
        const Float floor = load<Float>(floors + block[0]);
        return rest & ~mask_bits(kKind == FillKind::kBlend ? bound < floor : bound <= floor);
    }
    alignas(64) float nearest[kLanes<Float>];
    store_aligned(nearest, bound);
    std::uint32_t shown = 0;
    for (; rest; rest &= rest - 1) {
        const int i = __builtin_ctz(rest);
        const float floor = floors[block[i]];
        shown |= static_cast<std::uint32_t>(kKind == FillKind::kBlend ? nearest[i] >= floor : nearest[i] > floor) << i;
    }
    return shown;
}

// Classifies the blocks of the triangle's box, as many at a time as there are lanes, then fills those that are
// left.
template <FillKind kKind, bool kCount>
TESSERA_INLINE void fill_blocks(VisibilityJob& job, LargeFill& f, const TriangleBox& box, const float* record,
                                const SurfaceLayout* layout) {
    constexpr int kWidth = kLanes<Float>;
    const int blocks = job.side / kBlockSide;
    const auto block_of = [&](std::int32_t at) {
        const std::int32_t b = at >> 11;  // 8 pixels of 256
        return b < 0 ? 0 : b > blocks - 1 ? blocks - 1 : b;
    };
    const std::int32_t x = 256 * job.x0, y = 256 * job.y0;
    const int left = block_of(box.left - x), top = block_of(box.top - y);
    const int right = block_of(box.right - x), bottom = block_of(box.bottom - y);
    f.set_parts(left, right, top, bottom);
    constexpr std::int32_t kReach = kBlockSide - 1;
    const Int columns = lane_column(), rows = lane_row();
    Int most[3], least[3], lane_e[3][kPerRow], step[3];
    for (int k = 0; k < 3; ++k) {
        const std::int32_t a = f.edges[k].a, b = f.edges[k].b;
        most[k] = Int((a > 0 ? a : 0) * kReach + (b > 0 ? b : 0) * kReach);
        least[k] = Int((a < 0 ? a : 0) * kReach + (b < 0 ? b : 0) * kReach);
        step[k] = Int(b * kRows);
        for (int j = 0; j < kPerRow; ++j) lane_e[k][j] = Int(a) * (columns + Int(j * kWidth)) + Int(b) * rows;
    }
    const DepthPlane<float>& plane = f.t.depth;
    const Float lowest(plane.lowest), highest(plane.highest);
    // Blocks of the box are numbered row by row; / width as a product, exact for numbers below 65536 / width.
    const int width = right - left + 1, count = width * (bottom - top + 1);
    const Int inverse((65535 + width) / width);
    BlockGroup g;
    for (int group = 0; group < count; group += kWidth) {
        // Beyond the last block: that one again.
        const Int index = min(iota<Int>() + Int(group), Int(count - 1));
        const Int row = (index * inverse) >> 16;
        const Int bx = index - row * Int(width) + Int(left), by = row + Int(top);
        const Int px = bx << 3, py = by << 3;
        Mask todo = first_n<Float>(count - group), inside(true);
        for (int k = 0; k < 3; ++k) {
            const Int e = Int(f.edges[k].e) + Int(f.edges[k].a) * px + Int(f.edges[k].b) * py;
            todo &= e + most[k] > Int(-1);
            inside &= e + least[k] > Int(-1);
            store_aligned(g.e[k], e);
        }
        std::uint32_t rest = mask_bits(todo);
        if (!rest) continue;
        const Int sx = (px << 8) + Int(f.x0), sy = (py << 8) + Int(f.y0);
        const Float nearest = depth_at_corner(plane, sx, sy, true), farthest = depth_at_corner(plane, sx, sy, false);
        store_aligned(g.block, by * Int(blocks) + bx);
        if (job.hierarchical_z) {
            const bool consecutive = width == blocks && count - group >= kWidth;
            const std::uint32_t shown =
                shown_blocks<kKind>(job.floor, rest, min(max(nearest, lowest), highest), g.block, consecutive);
            job.counters.blocks_hidden += static_cast<std::uint64_t>(__builtin_popcount(rest ^ shown));
            rest = shown;
            if (!rest) continue;
        }
        job.counters.blocks_drawn += static_cast<std::uint64_t>(__builtin_popcount(rest));
        g.inside = mask_bits(inside);
        g.clamps = mask_bits((farthest < lowest) | (nearest > highest));
        store_aligned(g.farthest, min(max(farthest, lowest), highest));
        store_aligned(g.column, bx);
        store_aligned(g.row, by);
        for (; rest; rest &= rest - 1) {
            const int i = __builtin_ctz(rest), block = g.block[i];
            if constexpr (kKind == FillKind::kOpaque && !kCount) {
                float* const depth = job.depth + block * kBlockPixels;
                std::uint32_t* const ordinal = job.ordinal + block * kBlockPixels;
                const Float *column_part = f.columns_of(g.column[i]), *row_part = f.rows_of(g.row[i]);
                if (g.inside >> i & 1) {
                    const bool filled = g.clamps >> i & 1
                                            ? fill_inside<true>(f, column_part, row_part, depth, ordinal)
                                            : fill_inside<false>(f, column_part, row_part, depth, ordinal);
                    if (job.hierarchical_z) job.floor[block] = filled ? g.farthest[i] : least_depth(depth);
                } else {
                    fill_crossed(f, g, i, lane_e, step, column_part, row_part, depth, ordinal,
                                 job.hierarchical_z ? job.floor + block : nullptr);
                }
            } else {
                fill_specially<kKind, kCount>(job, f, g, i, lane_e, step, record, layout);
            }
        }
    }
}

// Cut-outs and transparent triangles: the rare kinds pay for themselves.
template <FillKind kKind>
__attribute__((noinline)) void fill_special(VisibilityJob& job, LargeFill& f, const TriangleBox& box) {
    alignas(64) float record[kMaxSurfaceFloats * kMaxLanes];
    SurfaceLayout layout;
    if (kKind == FillKind::kCutOut) {
        const InstanceView& instance = job.source->instances[f.t.instance];
        layout = layout_of(*job.source, instance);
        make_surfaces({job.source, f.t.instance, layout, &f.t.triangle, 1, record});
    }
    fill_blocks<kKind, true>(job, f, box, record, &layout);
}

template <bool kCount>
TESSERA_INLINE void fill_large(VisibilityJob& job, const PixelPlaces& places, const LargeTriangle& t,
                               std::uint32_t ordinal) {
    const TriangleBox box(t.v);
    const InstanceView& instance = job.source->instances[t.instance];
    const AlphaMode mode = job.source->shading->materials[instance.material].alpha_mode;
    const std::uint8_t ties = instance.mesh.tie_rule(t.triangle);
    if (mode == AlphaMode::kOpaque && box.fits(kMediumSide))
        return fill_medium<kCount>(job, places, t, box, ties, ordinal);
    LargeFill f(t, ordinal, 256 * job.x0 + job.offset.x, 256 * job.y0 + job.offset.y);
    for (int k = 0; k < 3; ++k)
        if (!f.edges[k].set(t.v[k], t.v[k == 2 ? 0 : k + 1], ties, f.x0, f.y0, job.side)) return;
    switch (mode) {
        case AlphaMode::kOpaque:
            return fill_blocks<FillKind::kOpaque, kCount>(job, f, box, nullptr, nullptr);
        case AlphaMode::kMask:
            return fill_special<FillKind::kCutOut>(job, f, box);
        case AlphaMode::kBlend:
            return fill_special<FillKind::kBlend>(job, f, box);
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
