// Fills a tile: edge functions in exact integers, the depth test, cut-outs, transparent fragments.
// Part of the kernel file, once per instruction set.
#pragma once

#include "raster/shade_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// An edge over the samples of a tile. With vertices in 24.8 every sample of a pixel grid has the same
// sub-pixel part, so E / 256, rounded down, steps by whole a and b per pixel and keeps the sign of E:
// 64 bits once per tile, 32 bits per sample.
struct TileEdge {
    std::int64_t start, a, b;  // at the tile's first sample; per pixel to the right and down

    TESSERA_INLINE TileEdge(SnappedVertex from, SnappedVertex to, std::int64_t x, std::int64_t y) {
        const std::int64_t dx = static_cast<std::int64_t>(to.x) - from.x, dy = static_cast<std::int64_t>(to.y) - from.y;
        a = -dy;
        b = dx;
        const bool top_left = dy < 0 || (dy == 0 && dx > 0);
        start = (b * (y - from.y) + a * (x - from.x) - (top_left ? 0 : 1)) >> 8;
    }
    // The extremes over the tile's samples: outside everywhere, or inside everywhere.
    TESSERA_INLINE std::int64_t most() const { return start + (kTileSide - 1) * ((a > 0 ? a : 0) + (b > 0 ? b : 0)); }
    TESSERA_INLINE std::int64_t least() const { return start + (kTileSide - 1) * ((a < 0 ? a : 0) + (b < 0 ? b : 0)); }
};

// First and last pixel of a tile (0 .. kTileSide - 1) whose sample lies between two coordinates.
TESSERA_INLINE std::int32_t first_pixel(std::int32_t low, std::int32_t offset, int origin) {
    const std::int32_t p = ((low - offset + 255) >> 8) - origin;
    return p < 0 ? 0 : p;
}
TESSERA_INLINE std::int32_t last_pixel(std::int32_t high, std::int32_t offset, int origin, int pixels) {
    const std::int32_t p = ((high - offset) >> 8) - origin;
    return p > pixels - 1 ? pixels - 1 : p;
}

TESSERA_INLINE std::int32_t least_of(std::int32_t a, std::int32_t b, std::int32_t c) {
    const std::int32_t m = a < b ? a : b;
    return m < c ? m : c;
}
TESSERA_INLINE std::int32_t most_of(std::int32_t a, std::int32_t b, std::int32_t c) {
    const std::int32_t m = a > b ? a : b;
    return m > c ? m : c;
}

// Alpha of one triangle's material at the samples of a row.
inline Float alpha_of(const VisibilityJob& job, const TriangleRecord& r, Int x, Int y) {
    const InstanceView& instance = job.instances[r.instance];
    const SurfacePoint<Float> s = gather_surface(
        instance, *job.shading, job.projection, Int(static_cast<std::int32_t>(r.triangle)), Float(r.orientation), x, y);
    return base_color(job.shading->materials[instance.material], s).w;
}

inline void fill(VisibilityJob& job, std::uint32_t ordinal) {
    constexpr int kWidth = kLanes<Float>;
    const TriangleRecord& r = *job.records[ordinal - 1];
    const std::int32_t x0 = 256 * job.x0 + job.offset.x, y0 = 256 * job.y0 + job.offset.y;
    TileEdge edges[3] = {{r.v[1], r.v[2], x0, y0}, {r.v[2], r.v[0], x0, y0}, {r.v[0], r.v[1], x0, y0}};
    for (TileEdge& e : edges) {
        if (e.most() < 0) return;
        // Inside all over the tile: nothing to step, nothing to overflow.
        if (e.least() >= 0) e.start = e.a = e.b = 0;
    }
    const std::int32_t xl = first_pixel(least_of(r.v[0].x, r.v[1].x, r.v[2].x), job.offset.x, job.x0);
    const std::int32_t xr = last_pixel(most_of(r.v[0].x, r.v[1].x, r.v[2].x), job.offset.x, job.x0, job.width);
    const std::int32_t yt = first_pixel(least_of(r.v[0].y, r.v[1].y, r.v[2].y), job.offset.y, job.y0);
    const std::int32_t yb = last_pixel(most_of(r.v[0].y, r.v[1].y, r.v[2].y), job.offset.y, job.y0, job.height);
    const MaterialView& material = job.shading->materials[job.instances[r.instance].material];
    const Int lanes = iota<Int>();
    const Int a0(static_cast<std::int32_t>(edges[0].a)), a1(static_cast<std::int32_t>(edges[1].a)),
        a2(static_cast<std::int32_t>(edges[2].a));
    for (std::int32_t y = yt; y <= yb; ++y) {
        const auto row = [&](const TileEdge& e) { return Int(static_cast<std::int32_t>(e.start + e.b * y)); };
        const Int row0 = row(edges[0]), row1 = row(edges[1]), row2 = row(edges[2]);
        const Float z_row =
            Float(r.depth.depth) + Float(r.depth.ddy) * Float(static_cast<float>(y0 + 256 * y - r.depth.anchor_y));
        for (std::int32_t x = xl & -kWidth; x <= xr; x += kWidth) {
            const Int column = lanes + Int(x);
            const Mask in_picture = column < Int(job.width);
            const Mask inside =
                in_picture & (((row0 + a0 * column) | (row1 + a1 * column) | (row2 + a2 * column)) > Int(-1));
            if (none(inside)) continue;
            const Int sample_x = Int(x0) + column * Int(256);
            const Float plane = z_row + Float(r.depth.ddx) * to_float(sample_x - Int(r.depth.anchor_x));
            const Float z = min(max(plane, Float(r.depth.lowest)), Float(r.depth.highest));
            float* depth = job.depth + y * kTileSide + x;
            const Float before = load<Float>(depth);
            Mask pass = inside & (z > before);
            if (material.alpha_mode == AlphaMode::kBlend) {
                // Kept where it may end up in front; the final depth decides.
                const std::uint32_t seen = mask_bits(inside & (z >= before) & (z > Float(0.0f)));
                alignas(64) float values[kWidth];
                store(values, z);
                for (std::uint32_t bits = seen; bits; bits &= bits - 1) {
                    const int i = __builtin_ctz(bits);
                    job.add_fragment(job.owner, static_cast<std::uint32_t>(y * kTileSide + x + i), ordinal, values[i]);
                }
                continue;
            }
            if (none(pass)) continue;
            if (material.alpha_mode == AlphaMode::kMask) {
                const Float alpha = alpha_of(job, r, sample_x, Int(y0 + 256 * y));
                pass &= !(alpha < Float(material.alpha_cutoff));
            }
            store_masked(depth, pass, z);
            store_masked(job.ordinal + y * kTileSide + x, pass, Uint(ordinal));
            job.fragments_passed += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(pass)));
        }
    }
}

inline void visibility(VisibilityJob& job) {
    job.fragments_passed = 0;
    for (std::uint32_t i = 1; i <= job.record_count; ++i) fill(job, i);
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
