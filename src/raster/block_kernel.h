// Large triangles in a tile: by blocks of 8x8 pixels, after hierarchical Z and the edges have said which
// blocks there are. Part of the kernel file, once per instruction set.
#pragma once

#include "raster/surface_kernel.h"

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

TESSERA_INLINE std::int32_t least_of(std::int32_t a, std::int32_t b, std::int32_t c) {
    const std::int32_t m = a < b ? a : b;
    return m < c ? m : c;
}
TESSERA_INLINE std::int32_t most_of(std::int32_t a, std::int32_t b, std::int32_t c) {
    const std::int32_t m = a > b ? a : b;
    return m > c ? m : c;
}

// The nearest depth of a plane over a span of samples. The plane's formula rounds monotonically, so
// the value at the corner is a bound, exactly.
TESSERA_INLINE Float nearest_over(const DepthPlane<float>& p, Int x, Int y, std::int32_t span) {
    const Float dx = to_float(x + Int((p.ddx > 0.0f ? span : 0) - p.anchor_x));
    const Float dy = to_float(y + Int((p.ddy > 0.0f ? span : 0) - p.anchor_y));
    const Float plane = (Float(p.depth) + Float(p.ddy) * dy) + Float(p.ddx) * dx;
    return min(max(plane, Float(p.lowest)), Float(p.highest));
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
    // The plane's part of every row of vectors from the first row of blocks on that the triangle reaches.
    int top = 0;
    Float row_parts[kMaxTileSide / kRows];

    TESSERA_INLINE LargeFill(const LargeTriangle& triangle, std::uint32_t number, std::int32_t x, std::int32_t y)
        : t(triangle), ordinal(number), x0(x), y0(y) {}

    TESSERA_INLINE void set_rows(int first_block, int last_block) {
        top = first_block;
        const DepthPlane<float>& p = t.depth;
        Int y = ((lane_row() + Int(first_block * kBlockSide)) << 8) + Int(y0 - p.anchor_y);
        for (int i = 0; i < (last_block - first_block + 1) * kBlockSide / kRows; ++i) {
            row_parts[i] = Float(p.depth) + Float(p.ddy) * to_float(y);
            y += Int(kRows * 256);
        }
    }
};

enum class FillKind { kOpaque, kCutOut, kBlend };

// The nearest or the farthest depth over a block, exactly: see nearest_over().
TESSERA_INLINE float depth_at_corner(const LargeFill& f, std::int32_t px, std::int32_t py, bool nearest) {
    const DepthPlane<float>& p = f.t.depth;
    constexpr std::int32_t kReach = (kBlockSide - 1) * 256;
    const float dx = static_cast<float>(256 * px + f.x0 - p.anchor_x + ((p.ddx > 0.0f) == nearest ? kReach : 0));
    const float dy = static_cast<float>(256 * py + f.y0 - p.anchor_y + ((p.ddy > 0.0f) == nearest ? kReach : 0));
    return (p.depth + p.ddy * dy) + p.ddx * dx;
}

// The least depth of a block, for its floor.
TESSERA_INLINE float least_depth(const float* depth) {
    Float low = load<Float>(depth);
    for (int i = kLanes<Float>; i < kBlockPixels; i += kLanes<Float>) low = min(low, load<Float>(depth + i));
    return least_lane(low);
}

// A block that lies inside all edges, of an opaque triangle: nothing but the depth test. `clamps` where
// the plane leaves the triangle's range.
template <bool kClamps>
TESSERA_INLINE bool fill_inside(const LargeFill& f, const Float (&x_part)[kPerRow], const Float* row_part, float* depth,
                                std::uint32_t* ordinal) {
    const Float lowest(f.t.depth.lowest), highest(f.t.depth.highest);
    const Uint id(f.ordinal);
    Mask all_pass(true);
    for (int at = 0; at < kBlockPixels; ++row_part)
        for (int j = 0; j < kPerRow; ++j, at += kLanes<Float>) {
            Float z = *row_part + x_part[j];
            if (kClamps) z = min(max(z, lowest), highest);
            const Mask pass = z > load<Float>(depth + at);
            store_masked(depth + at, pass, z);
            store_masked(ordinal + at, pass, id);
            all_pass &= pass;
        }
    return all(all_pass);
}

// One block: `inside` says that no edge needs a look.
template <FillKind kKind, bool kCount>
TESSERA_INLINE void fill_block(VisibilityJob& job, const LargeFill& f, int block_x, int block_y, bool inside,
                               const float* record, const SurfaceLayout* layout) {
    const int block = block_y * (job.side / kBlockSide) + block_x;
    const std::int32_t px = block_x * kBlockSide, py = block_y * kBlockSide;
    float* const depth = job.depth + block * kBlockPixels;
    std::uint32_t* const ordinal = job.ordinal + block * kBlockPixels;
    const DepthPlane<float>& plane = f.t.depth;
    const Int columns = lane_column(), rows = lane_row();
    const Float lowest(plane.lowest), highest(plane.highest);
    const Float* row_part = f.row_parts + (block_y - f.top) * (kBlockSide / kRows);
    Float x_part[kPerRow];
    for (int j = 0; j < kPerRow; ++j)
        x_part[j] =
            Float(plane.ddx) * to_float(((columns + Int(px + j * kLanes<Float>)) << 8) + Int(f.x0 - plane.anchor_x));
    if constexpr (kKind == FillKind::kOpaque && !kCount)
        if (inside) {
            const float farthest = depth_at_corner(f, px, py, false);
            const bool clamps = farthest < plane.lowest || depth_at_corner(f, px, py, true) > plane.highest;
            const bool filled = clamps ? fill_inside<true>(f, x_part, row_part, depth, ordinal)
                                       : fill_inside<false>(f, x_part, row_part, depth, ordinal);
            if (job.hierarchical_z)
                job.floor[block] = filled ? min(max(farthest, plane.lowest), plane.highest) : least_depth(depth);
            return;
        }
    Int e[3][kPerRow], step[3];
    for (int k = 0; k < 3; ++k) {
        step[k] = Int(f.edges[k].b * kRows);
        for (int j = 0; j < kPerRow; ++j)
            e[k][j] = Int(f.edges[k].e) + Int(f.edges[k].a) * (columns + Int(px + j * kLanes<Float>)) +
                      Int(f.edges[k].b) * (rows + Int(py));
    }
    Float low(3.4e38f);
    for (int row = 0; row < kBlockSide; row += kRows, ++row_part) {
        for (int j = 0; j < kPerRow; ++j) {
            const int at = row * kBlockSide + j * kLanes<Float>;
            const Float before = load<Float>(depth + at);
            const Float z = min(max(*row_part + x_part[j], lowest), highest);
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
                    const int i = __builtin_ctz(seen);
                    job.add_fragment(job.owner, static_cast<std::uint32_t>(block * kBlockPixels + at + i), f.ordinal,
                                     values[i]);
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

// Classifies as many blocks at a time as there are lanes, then fills those that are left.
template <FillKind kKind, bool kCount>
TESSERA_INLINE void fill_blocks(VisibilityJob& job, LargeFill& f, const float* record, const SurfaceLayout* layout) {
    constexpr int kWidth = kLanes<Float>;
    const int blocks = job.side / kBlockSide, shift = __builtin_ctz(static_cast<unsigned>(blocks));
    const SnappedVertex* v = f.t.v;
    const auto block_of = [&](std::int32_t at) {
        const std::int32_t b = at >> 11;  // 8 pixels of 256
        return b < 0 ? 0 : b > blocks - 1 ? blocks - 1 : b;
    };
    const std::int32_t x = 256 * job.x0, y = 256 * job.y0;
    const int left = block_of(least_of(v[0].x, v[1].x, v[2].x) - x),
              top = block_of(least_of(v[0].y, v[1].y, v[2].y) - y);
    const int right = block_of(most_of(v[0].x, v[1].x, v[2].x) - x),
              bottom = block_of(most_of(v[0].y, v[1].y, v[2].y) - y);
    if (top > bottom) return;
    f.set_rows(top, bottom);
    constexpr std::int32_t kReach = kBlockSide - 1;
    Int most[3], least[3];
    for (int k = 0; k < 3; ++k) {
        const std::int32_t a = f.edges[k].a * kReach, b = f.edges[k].b * kReach;
        most[k] = Int(f.edges[k].e + (a > 0 ? a : 0) + (b > 0 ? b : 0));
        least[k] = Int((a < 0 ? a : 0) + (b < 0 ? b : 0)) - Int((a > 0 ? a : 0) + (b > 0 ? b : 0));
    }
    for (int group = (top << shift) & -kWidth; group < (bottom + 1) << shift; group += kWidth) {
        const Int index = iota<Int>() + Int(group);
        const Int bx = index & Int(blocks - 1), by = index >> shift;
        const Int px = bx << 3, py = by << 3;
        Mask todo = !((bx < Int(left)) | (bx > Int(right)) | (by < Int(top)) | (by > Int(bottom)));
        Mask inside(true);
        for (int k = 0; k < 3; ++k) {
            const Int e = most[k] + Int(f.edges[k].a) * px + Int(f.edges[k].b) * py;
            todo &= e > Int(-1);
            inside &= e + least[k] > Int(-1);
        }
        std::uint32_t rest = mask_bits(todo);
        if (!rest) continue;
        if (job.hierarchical_z) {
            const Float nearest = nearest_over(f.t.depth, (px << 8) + Int(f.x0), (py << 8) + Int(f.y0), kReach * 256);
            const Float floor = load<Float>(job.floor + group);
            // A transparent fragment at equal depth may still be in front.
            const Mask hidden = kKind == FillKind::kBlend ? nearest < floor : nearest <= floor;
            const std::uint32_t shown = rest & ~mask_bits(hidden);
            job.counters.blocks_hidden += static_cast<std::uint64_t>(__builtin_popcount(rest ^ shown));
            rest = shown;
        }
        job.counters.blocks_drawn += static_cast<std::uint64_t>(__builtin_popcount(rest));
        const std::uint32_t full = mask_bits(inside);
        for (; rest; rest &= rest - 1) {
            const int i = __builtin_ctz(rest), block = group + i;
            if (full >> i & 1)
                fill_block<kKind, kCount>(job, f, block & (blocks - 1), block >> shift, true, record, layout);
            else
                fill_block<kKind, kCount>(job, f, block & (blocks - 1), block >> shift, false, record, layout);
        }
    }
}

// Cut-outs and transparent triangles: the rare kinds pay for themselves.
template <FillKind kKind>
__attribute__((noinline)) void fill_special(VisibilityJob& job, LargeFill& f) {
    alignas(64) float record[kMaxSurfaceFloats * kMaxLanes];
    SurfaceLayout layout;
    if (kKind == FillKind::kCutOut) {
        const InstanceView& instance = job.source->instances[f.t.instance];
        layout = layout_of(*job.source, instance);
        make_surfaces({job.source, f.t.instance, layout, &f.t.triangle, 1, record});
    }
    fill_blocks<kKind, true>(job, f, record, &layout);
}

template <bool kCount>
TESSERA_INLINE void fill_large(VisibilityJob& job, const LargeTriangle& t, std::uint32_t ordinal) {
    LargeFill f(t, ordinal, 256 * job.x0 + job.offset.x, 256 * job.y0 + job.offset.y);
    for (int k = 0; k < 3; ++k)
        if (!f.edges[k].set(t.v[k], t.v[k == 2 ? 0 : k + 1], f.x0, f.y0, job.side)) return;
    const MaterialView& material = job.source->shading->materials[job.source->instances[t.instance].material];
    switch (material.alpha_mode) {
        case AlphaMode::kOpaque:
            return fill_blocks<FillKind::kOpaque, kCount>(job, f, nullptr, nullptr);
        case AlphaMode::kMask:
            return fill_special<FillKind::kCutOut>(job, f);
        case AlphaMode::kBlend:
            return fill_special<FillKind::kBlend>(job, f);
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
