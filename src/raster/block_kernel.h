// Large triangles in a tile: by blocks of 8x8 pixels, after hierarchical Z and the edges have said which
// blocks there are. Part of the kernel file, once per instruction set.
#pragma once

#include "raster/medium_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// An edge over the samples of a tile. With vertices in 24.8 every sample of a pixel grid has the same
// sub-pixel part, so E / 256, rounded down, steps by whole a and b per pixel and keeps the sign of E:
// 64 bits once per tile, 32 bits per sample (vertices lie in the guard band, tiles are 128 pixels at
// most, and 64 in pictures wider or higher than 8192).
struct TileEdge {
    std::int32_t e, a, b;  // at the tile's first sample; per pixel to the right and down

    // False where the tile lies outside. An edge that the tile lies inside of becomes zero.
    TESSERA_INLINE bool set(SnappedVertex from, SnappedVertex to, std::int64_t x, std::int64_t y, int side) {
        const std::int64_t dx = static_cast<std::int64_t>(to.x) - from.x, dy = static_cast<std::int64_t>(to.y) - from.y;
        const bool top_left = dy < 0 || (dy == 0 && dx > 0);
        const std::int64_t start = (dx * (y - from.y) - dy * (x - from.x) - (top_left ? 0 : 1)) >> 8;
        const std::int64_t reach = side - 1;
        const std::int64_t most = start + reach * ((dy < 0 ? -dy : 0) + (dx > 0 ? dx : 0));
        const std::int64_t least = start + reach * ((dy > 0 ? -dy : 0) + (dx < 0 ? dx : 0));
        if (most < 0) return false;
        const bool crosses = least < 0;
        e = crosses ? static_cast<std::int32_t>(start) : 0;
        a = crosses ? static_cast<std::int32_t>(-dy) : 0;
        b = crosses ? static_cast<std::int32_t>(dx) : 0;
        return true;
    }
};

// The plane over blocks whose first samples are given: the nearest depth, or the farthest. The plane's formula
// rounds monotonically, so the value at the corner is a bound, exactly.
TESSERA_INLINE Float depth_at_corner(const DepthPlane<float>& p, Int x, Int y, bool nearest) {
    constexpr std::int32_t kReach = (kBlockSide - 1) * 256;
    const Float dx = to_float(x + Int(((p.ddx > 0.0f) == nearest ? kReach : 0) - p.anchor_x));
    const Float dy = to_float(y + Int(((p.ddy > 0.0f) == nearest ? kReach : 0) - p.anchor_y));
    return (Float(p.depth) + Float(p.ddy) * dy) + Float(p.ddx) * dx;
}

// The lowest of the floors.
inline float tile_floor(const VisibilityJob& job) {
    const int blocks = job.side / kBlockSide * (job.side / kBlockSide);
    Float low = load<Float>(job.floor);
    for (int i = kLanes<Float>; i < blocks; i += kLanes<Float>) low = min(low, load<Float>(job.floor + i));
    return least_lane(low);
}

// A large triangle in a tile.
struct LargeFill {
    const LargeTriangle& t;
    std::uint32_t ordinal;
    TileEdge edges[3];
    std::int32_t x0, y0;  // the tile's first sample, 1/256 pixel
    // The plane's parts of the columns and rows of vectors, from the first blocks on that the triangle reaches.
    int left = 0, top = 0;
    Float column_parts[kMaxTileSide / kBlockSide * kPerRow], row_parts[kMaxTileSide / kRows];

    TESSERA_INLINE LargeFill(const LargeTriangle& triangle, std::uint32_t number, std::int32_t x, std::int32_t y)
        : t(triangle), ordinal(number), x0(x), y0(y) {}

    TESSERA_INLINE void set_parts(int first_column, int last_column, int first_row, int last_row) {
        left = first_column;
        top = first_row;
        const DepthPlane<float>& p = t.depth;
        Int x = ((lane_column() + Int(left * kBlockSide)) << 8) + Int(x0 - p.anchor_x);
        for (int i = 0; i < (last_column - left + 1) * kPerRow; ++i) {
            column_parts[i] = Float(p.ddx) * to_float(x);
            x += Int(kBlockSide / kPerRow * 256);
        }
        Int y = ((lane_row() + Int(top * kBlockSide)) << 8) + Int(y0 - p.anchor_y);
        for (int i = 0; i < (last_row - top + 1) * kBlockSide / kRows; ++i) {
            row_parts[i] = Float(p.depth) + Float(p.ddy) * to_float(y);
            y += Int(kRows * 256);
        }
    }
    TESSERA_INLINE const Float* columns_of(int block) const { return column_parts + (block - left) * kPerRow; }
    TESSERA_INLINE const Float* rows_of(int block) const { return row_parts + (block - top) * (kBlockSide / kRows); }
};

// What the classification of a group of blocks leaves for each of them.
struct BlockGroup {
    alignas(64) std::int32_t e[3][kLanes<Float>];  // the edges at its first sample
    alignas(64) float farthest[kLanes<Float>];     // the triangle's depth there, at least
    alignas(64) std::int32_t block[kLanes<Float>], column[kLanes<Float>], row[kLanes<Float>];  // in the tile
    std::uint32_t inside, clamps;  // bit per block: within all edges; the plane leaves the range
};

enum class FillKind { kOpaque, kCutOut, kBlend };

// The least depth of a block, for its floor.
TESSERA_INLINE float least_depth(const float* depth) {
    Float low = load<Float>(depth);
    for (int i = kLanes<Float>; i < kBlockPixels; i += kLanes<Float>) low = min(low, load<Float>(depth + i));
    return least_lane(low);
}

// A block that lies inside all edges, of an opaque triangle: nothing but the depth test. `clamps` where
// the plane leaves the triangle's range.
template <bool kClamps>
TESSERA_INLINE bool fill_inside(const LargeFill& f, const Float* column_part, const Float* row_part, float* depth,
                                std::uint32_t* ordinal) {
    const Float lowest(f.t.depth.lowest), highest(f.t.depth.highest);
    const Uint id(f.ordinal);
    Mask all_pass(true);
    for (int at = 0; at < kBlockPixels; ++row_part)
        for (int j = 0; j < kPerRow; ++j, at += kLanes<Float>) {
            Float z = *row_part + column_part[j];
            if (kClamps) z = min(max(z, lowest), highest);
            const Mask pass = z > load<Float>(depth + at);
            store_masked(depth + at, pass, z);
            store_masked(ordinal + at, pass, id);
            all_pass &= pass;
        }
    return all(all_pass);
}

// A block of an opaque triangle that edges cross. `floor`: where the lowest depth goes; null where not wanted.
TESSERA_INLINE void fill_crossed(const LargeFill& f, const BlockGroup& group, int i, const Int (&lane_e)[3][kPerRow],
                                 const Int (&step)[3], const Float* column_part, const Float* row_part, float* depth,
                                 std::uint32_t* ordinal, float* floor) {
    const Float lowest(f.t.depth.lowest), highest(f.t.depth.highest);
    const Uint id(f.ordinal);
    Int e0[kPerRow], e1[kPerRow], e2[kPerRow];
    for (int j = 0; j < kPerRow; ++j) {
        e0[j] = lane_e[0][j] + Int(group.e[0][i]);
        e1[j] = lane_e[1][j] + Int(group.e[1][i]);
        e2[j] = lane_e[2][j] + Int(group.e[2][i]);
    }
    Float low(3.4e38f);
    for (int at = 0; at < kBlockPixels; ++row_part)
        for (int j = 0; j < kPerRow; ++j, at += kLanes<Float>) {
            const Mask covered = or3(e0[j], e1[j], e2[j]) > Int(-1);
            const Float before = load<Float>(depth + at);
            const Float z = min(max(*row_part + column_part[j], lowest), highest);
            const Mask pass = covered & (z > before);
            store_masked(depth + at, pass, z);
            store_masked(ordinal + at, pass, id);
            low = min(low, select(pass, z, before));
            e0[j] += step[0], e1[j] += step[1], e2[j] += step[2];
        }
    if (floor) *floor = least_lane(low);
}

// A block where fragments are counted, cut out or kept.
template <FillKind kKind, bool kCount>
TESSERA_INLINE void fill_specially(VisibilityJob& job, const LargeFill& f, const BlockGroup& group, int i,
                                   const Int (&lane_e)[3][kPerRow], const Int (&step)[3], const float* record,
                                   const SurfaceLayout* layout) {
    const int block = group.block[i], block_x = group.column[i], block_y = group.row[i];
    const std::int32_t px = block_x * kBlockSide, py = block_y * kBlockSide;
    float* const depth = job.depth + block * kBlockPixels;
    std::uint32_t* const ordinal = job.ordinal + block * kBlockPixels;
    const Int columns = lane_column(), rows = lane_row();
    const Float lowest(f.t.depth.lowest), highest(f.t.depth.highest);
    const Float *column_part = f.columns_of(block_x), *row_part = f.rows_of(block_y);
    Int e[3][kPerRow];
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < kPerRow; ++j) e[k][j] = lane_e[k][j] + Int(group.e[k][i]);
    Float low(3.4e38f);
    for (int row = 0; row < kBlockSide; row += kRows, ++row_part) {
        for (int j = 0; j < kPerRow; ++j) {
            const int at = row * kBlockSide + j * kLanes<Float>;
            const Float before = load<Float>(depth + at);
            const Float z = min(max(*row_part + column_part[j], lowest), highest);
            const Mask covered = or3(e[0][j], e[1][j], e[2][j]) > Int(-1);
            for (int k = 0; k < 3; ++k) e[k][j] += step[k];
            if constexpr (kCount) {
                const Mask counted = covered & (before < Float(3.4e38f));
                job.counters.samples_covered += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(counted)));
                if (job.overdraw) {
                    std::uint32_t* tested = job.overdraw + block * kBlockPixels + at;
                    store(tested, load<Uint>(tested) + select(counted, Uint(1u), Uint(0u)));
                }
            }
            if constexpr (kKind == FillKind::kBlend) {
                // Kept where it may end up in front; the final depth decides.
                alignas(64) float values[kLanes<Float>];
                store(values, z);
                std::uint32_t seen = mask_bits(covered & (z >= before) & (z > Float(0.0f)));
                for (; seen; seen &= seen - 1) {
                    const int lane = __builtin_ctz(seen);
                    job.add_fragment(job.owner, static_cast<std::uint32_t>(block * kBlockPixels + at + lane), f.ordinal,
                                     values[lane]);
                }
            } else {
                Mask pass = covered & (z > before);
                if constexpr (kKind == FillKind::kCutOut) {
                    if (any(pass)) {
                        const Int column = columns + Int(px + j * kLanes<Float>);
                        const Float sx = to_float((column << 8) + Int(f.x0));
                        const Float sy = to_float(((rows + Int(py + row)) << 8) + Int(f.y0));
                        pass &= !cut_out(*job.source, f.t.instance, *layout, record, sx, sy);
                    }
                }
                store_masked(depth + at, pass, z);
                store_masked(ordinal + at, pass, Uint(f.ordinal));
                low = min(low, select(pass, z, before));
                if constexpr (kCount)
                    job.counters.fragments_passed += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(pass)));
            }
        }
    }
    if (kKind != FillKind::kBlend && job.hierarchical_z) job.floor[block] = least_lane(low);
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
        make_surfaces({job.source, &instance, layout, &f.t.triangle, 1, record});
    }
    fill_blocks<kKind, true>(job, f, box, record, &layout);
}

template <bool kCount>
TESSERA_INLINE void fill_large(VisibilityJob& job, const PixelPlaces& places, const LargeTriangle& t,
                               std::uint32_t ordinal) {
    const TriangleBox box(t.v);
    const AlphaMode mode = job.source->shading->materials[job.source->instances[t.instance].material].alpha_mode;
    if (mode == AlphaMode::kOpaque && box.fits(kMediumSide)) return fill_medium<kCount>(job, places, t, box, ordinal);
    LargeFill f(t, ordinal, 256 * job.x0 + job.offset.x, 256 * job.y0 + job.offset.y);
    for (int k = 0; k < 3; ++k)
        if (!f.edges[k].set(t.v[k], t.v[k == 2 ? 0 : k + 1], f.x0, f.y0, job.side)) return;
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
