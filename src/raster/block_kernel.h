// One block of 8x8 pixels of a large triangle: coverage and depth test. Part of the kernel file, once per
// instruction set.
#pragma once

#include "tile/surface_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// An edge over the samples of a tile. With vertices in 24.8 every sample of a pixel grid has the same
// sub-pixel part, so E / 256, rounded down, steps by whole a and b per pixel and keeps the sign of E:
// 64 bits once per tile, 32 bits per sample (vertices lie in the guard band, tiles are 128 pixels at
// most, and 64 in pictures wider or higher than 8192).
struct TileEdge {
    std::int32_t e, a, b;  // at the tile's first sample; per pixel to the right and down

    // False where the tile lies outside. An edge that the tile lies inside of becomes zero.
    TESSERA_INLINE bool set(SnappedVertex from, SnappedVertex to, std::uint8_t ties, std::int64_t x, std::int64_t y,
                            int side) {
        const std::int64_t dx = static_cast<std::int64_t>(to.x) - from.x, dy = static_cast<std::int64_t>(to.y) - from.y;
        const std::int64_t start = (dx * (y - from.y) - dy * (x - from.x) - (owns_edge(dx, dy, ties) ? 0 : 1)) >> 8;
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

}  // namespace tessera::TESSERA_ISA_NAMESPACE
