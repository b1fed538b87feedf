// What is seen of a tile; and from its sums to the planes of the picture: colours developed, labels
// written. Part of the kernel file, once per instruction set.
#pragma once

#include "raster/visibility_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

inline void find_visible(VisibleJob& job) {
    constexpr int kWidth = kLanes<Float>;
    std::uint8_t* const seen = job.seen;
    const std::uint32_t* const ordinal = job.ordinal;
    __builtin_memset(seen, 0, job.triangle_count + 1);
    // The two triangles that were named last: along an edge between them nothing new comes up.
    std::uint32_t last = 0, before = 0;
    for (int at = 0; at < job.pixels; at += kWidth) {
        const Uint ids = load<Uint>(ordinal + at);
        const Mask known = (ids == Uint(last)) | (ids == Uint(before)) | (ids == Uint(0u));
        if (all(known)) continue;
        // All lanes: which ones are new is hard to predict, and a wrong guess costs as much.
        before = last;
        last = ordinal[at + __builtin_ctz(mask_bits(!known))];
        for (int i = 0; i < kWidth; ++i) seen[ordinal[at + i]] = 1;
    }
    std::uint32_t* const list = job.list;
    std::uint32_t count = 0;
    for (std::uint32_t i = 1; i <= job.triangle_count; ++i) {
        list[count] = i;
        count += seen[i];
    }
    job.count = count;
}

// Visits the vectors of a tile's blocks: visit(place, x, y) with the first pixel in the tile.
template <class Visit>
TESSERA_INLINE void for_each_vector(int side, int width, int height, Visit&& visit) {
    const int blocks = side / kBlockSide;
    for (int by = 0; by * kBlockSide < height; ++by)
        for (int bx = 0; bx * kBlockSide < width; ++bx)
            for (int at = 0; at < kBlockPixels; at += kLanes<Float>)
                visit((by * blocks + bx) * kBlockPixels + at, bx * kBlockSide + at % kBlockSide,
                      by * kBlockSide + at / kBlockSide);
}

// A tile that shows nothing.
inline void fill_tile(const DevelopJob& job, Uint background) {
    alignas(64) std::uint32_t row[kMaxTileSide];
    for (int x = 0; x < kMaxTileSide; x += kLanes<Float>) store(row + x, background);
    const bool streamed = job.streamed && job.width % kLinePixels == 0;
    for (int y = 0; y < job.height; ++y) {
        unsigned char* const to = job.rgba + static_cast<std::size_t>(y) * job.stride;
        if (streamed) {
            auto* const pixels = reinterpret_cast<std::uint32_t*>(to);
            for (int x = 0; x < job.width; x += kLanes<Float>) stream(pixels + x, background);
        } else {
            __builtin_memcpy(to, row, 4 * static_cast<std::size_t>(job.width));
        }
    }
    if (streamed) flush_streams();
}

inline void develop_tile(const DevelopJob& job) {
    const Float weight(job.weight), zero(0.0f);
    const Uint background = display_pixels(job.film, {zero, zero, zero}, zero);
    if (!job.r) return fill_tile(job, background);
    for_each_vector(job.side, job.width, job.height, [&](int at, int x, int y) {
        const Float alpha = load<Float>(job.alpha + at);
        Uint pixels = background;
        if (any(alpha != zero))
            pixels = display_pixels(
                job.film,
                {load<Float>(job.r + at) * weight, load<Float>(job.g + at) * weight, load<Float>(job.b + at) * weight},
                alpha * weight);
        store_pixels(pixels, job.rgba, job.stride, x, y, job.width, job.height);
    });
}

inline void label_tile(const LabelJob& job) {
    for_each_vector(job.side, job.width, job.height, [&](int at, int x, int y) {
        const Uint ordinal = load<Uint>(job.ordinal + at);
        const Mask hit = ordinal != Uint(0u);
        if (job.distance) {
            const Float infinity = as_float(Uint(0x7f800000u));
            const Float distance =
                any(hit) ? select(hit, distance_of_depth(job.projection, load<Float>(job.depth + at)), infinity)
                         : infinity;
            store_pixels(as_uint(distance), reinterpret_cast<unsigned char*>(job.distance), 4 * job.stride, x, y,
                         job.width, job.height);
        }
        if (job.triangle) {
            alignas(64) std::uint32_t numbers[kLanes<Float>];
            for (int lane = 0; lane < kLanes<Float>; ++lane) {
                const std::uint32_t o = job.ordinal[at + lane];
                numbers[lane] = 0;
                if (o == 0) continue;
                const TileTriangle& t = job.triangles[o - 1];
                numbers[lane] = job.instances[t.instance].first_triangle + t.triangle + 1;
            }
            store_pixels(load<Uint>(numbers), reinterpret_cast<unsigned char*>(job.triangle), 4 * job.stride, x, y,
                         job.width, job.height);
        }
    });
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
