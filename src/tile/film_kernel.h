// What is seen of a tile; and from its sums to the picture: colours developed. Part of the kernel file, once
// per instruction set.
#pragma once

#include "tile/pixel_kernel.h"

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

inline void develop_tile(const DevelopJob& job) {
    const Float weight(job.weight), zero(0.0f);
    const Uint background = display_pixels(job.film, {zero, zero, zero}, zero);
    if (!job.r) return fill_tile(job.rgba, job.window, background);
    write_tile(job.rgba, job.window, [&](int at) {
        const Float alpha = load<Float>(job.alpha + at);
        if (!any(alpha != zero)) return background;
        return display_pixels(
            job.film,
            {load<Float>(job.r + at) * weight, load<Float>(job.g + at) * weight, load<Float>(job.b + at) * weight},
            alpha * weight);
    });
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
