// Visible samples to radiance: as many at a time as there are lanes, through the templates that the
// reference uses with plain numbers. Part of the kernel file, once per instruction set.
#pragma once

#include "raster/visibility_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

inline void find_visible(VisibleJob& job) {
    constexpr int kWidth = kLanes<Float>;
    __builtin_memset(job.seen, 0, job.triangle_count + 1);
    std::uint32_t last = 0;
    for (int at = 0; at < job.pixels; at += kWidth) {
        const Uint ids = load<Uint>(job.ordinal + at);
        if (all((ids == Uint(last)) | (ids == Uint(0u)))) continue;
        for (int lane = 0; lane < kWidth; ++lane) {
            last = job.ordinal[at + lane];
            job.seen[last] = 1;
        }
    }
    job.count = 0;
    for (std::uint32_t i = 1; i <= job.triangle_count; ++i) {
        job.list[job.count] = i;
        job.count += job.seen[i];
    }
}

// What the lanes of a batch share.
struct Batch {
    const ShadingContext& context;
    const MaterialView& material;
    const SurfaceLayout& layout;
    const PictureRays rays;
    const float* records;

    explicit Batch(const ShadeJob& job)
        : context(*job.source->shading),
          material(*job.material),
          layout(job.layout),
          rays(job.source->projection),
          records(job.records) {}
};

// Triangles that a vector may show before its lanes fetch records of their own.
inline constexpr int kFew = 4;

TESSERA_INLINE void blend_samples(const SurfaceLayout& l, Mask mask, const SurfaceSample<Float>& from,
                                  SurfaceSample<Float>& to) {
    for (int k = 0; k < l.count; ++k) to.value[k] = select(mask, from.value[k], to.value[k]);
    for (int set = 0; set < kMaxUvSets; ++set) {
        if (l.uv[set] < 0) continue;
        const Footprint<Float>& a = from.uv_plane[set];
        Footprint<Float>& b = to.uv_plane[set];
        b = {select(mask, a.ux, b.ux), select(mask, a.vx, b.vx), select(mask, a.uy, b.uy), select(mask, a.vy, b.vy)};
        to.inverse_w_ddx = select(mask, from.inverse_w_ddx, to.inverse_w_ddx);
        to.inverse_w_ddy = select(mask, from.inverse_w_ddy, to.inverse_w_ddy);
    }
}

// The sample of each lane's own triangle. `place` is where the lanes' records start; `used` the lanes
// that count, at least one.
TESSERA_INLINE void sample_lanes(const Batch& batch, const std::uint32_t* place, std::uint32_t used, Float x, Float y,
                                 SurfaceSample<Float>& sample, Float& side, Float& sign) {
    const SurfaceLayout& l = batch.layout;
    if constexpr (kLanes<Float> == 1) {
        const float* record = batch.records + place[0];
        sample_planes(l, x, y, [record](int i) { return Float(record[i]); }, sample);
        side = Float(record[2]);
        sign = Float(record[3]);
        return;
    }
    const Uint places = load<Uint>(place);
    std::uint32_t rest = used;
    for (int n = 0; n < kFew; ++n) {
        const std::uint32_t first = place[__builtin_ctz(rest)];
        const Mask same = places == Uint(first);
        const float* record = batch.records + first;
        const auto number = [record](int i) { return Float(record[i]); };
        if (n == 0) {
            sample_planes(l, x, y, number, sample);
            side = Float(record[2]);
            sign = Float(record[3]);
        } else {
            SurfaceSample<Float> other;
            sample_planes(l, x, y, number, other);
            blend_samples(l, same, other, sample);
            side = select(same, Float(record[2]), side);
            sign = select(same, Float(record[3]), sign);
        }
        rest &= ~mask_bits(same);
        if (!rest) return;
    }
    Float numbers[kMaxSurfaceFloats];
    const std::uint32_t spare = place[__builtin_ctz(used)];
    std::uint32_t own[kLanes<Float>];
    for (int lane = 0; lane < kLanes<Float>; ++lane) own[lane] = used >> lane & 1 ? place[lane] : spare;
    const int floats = surface_floats(l);
    for (int i = 0; i < floats; i += 4)
        load_records([&](int lane) { return batch.records + own[lane] + i; }, numbers[i], numbers[i + 1],
                     numbers[i + 2], numbers[i + 3]);
    sample_planes(l, x, y, [&numbers](int i) { return numbers[i]; }, sample);
    side = numbers[2];
    sign = numbers[3];
}

__attribute__((noinline)) void shade_lanes(const Batch& batch, const std::uint32_t* place, std::uint32_t used, Float x,
                                           Float y, ShadedPoint<Float>& out) {
    SurfaceSample<Float> sample;
    Float side, sign;
    sample_lanes(batch, place, used, x, y, sample, side, sign);
    const SurfacePoint<Float> s =
        surface_point(batch.layout, batch.rays, sample, x, y, side, sign, batch.context.footprint_scale);
    out = shade(batch.context, batch.material, s, [](int, const LightSample<Float>&) { return Float(1.0f); });
}

// A whole tile of one material and layout, in the order of its blocks.
inline void shade_tile(const ShadeJob& job) {
    constexpr int kWidth = kLanes<Float>;
    const Batch batch(job);
    const int blocks = job.side / kBlockSide;
    const Float zero(0.0f);
    for (int block = 0; block < blocks * blocks; ++block) {
        const int px = block % blocks * kBlockSide, py = block / blocks * kBlockSide;
        for (int at = 0; at < kBlockPixels; at += kWidth) {
            const std::size_t place = static_cast<std::size_t>(block * kBlockPixels + at);
            const std::uint32_t* ordinal = job.ordinal + place;
            const Mask covered = load<Uint>(ordinal) != Uint(0u);
            const std::uint32_t used = mask_bits(covered);
            if (!used) {
                if (!job.first) continue;
                store(job.r + place, zero);
                store(job.g + place, zero);
                store(job.b + place, zero);
                store(job.alpha + place, zero);
                continue;
            }
            std::uint32_t records[kWidth];
            for (int lane = 0; lane < kWidth; ++lane) records[lane] = job.record_of[ordinal[lane]];
            const Int column = lane_column() + Int(px + at % kBlockSide);
            const Int row = lane_row() + Int(py + at / kBlockSide);
            const Float x = to_float((column << 8) + Int(256 * job.x0 + job.offset.x));
            const Float y = to_float((row << 8) + Int(256 * job.y0 + job.offset.y));
            ShadedPoint<Float> c;
            shade_lanes(batch, records, used, x, y, c);
            const auto add = [&](float* plane, Float v) {
                const Float before = job.first ? zero : load<Float>(plane + place);
                store(plane + place, before + select(covered, v, zero));
            };
            add(job.r, c.radiance.x);
            add(job.g, c.radiance.y);
            add(job.b, c.radiance.z);
            add(job.alpha, Float(1.0f));
            job.hit[block] |= static_cast<std::uint64_t>(used) << at;
        }
    }
}

inline void shade_points(const ShadeJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    const Batch batch(job);
    for (std::uint32_t i = 0; i < job.count; i += kWidth) {
        std::uint32_t records[kWidth];
        for (std::uint32_t lane = 0; lane < kWidth; ++lane) records[lane] = job.record_of[job.list[i + lane]];
        const std::uint32_t left = job.count - i;
        ShadedPoint<Float> c;
        shade_lanes(batch, records, left < kWidth ? (1u << left) - 1 : (1u << (kWidth - 1) << 1) - 1,
                    to_float(load<Int>(job.x + i)), to_float(load<Int>(job.y + i)), c);
        store(job.r + i, c.radiance.x);
        store(job.g + i, c.radiance.y);
        store(job.b + i, c.radiance.z);
        store(job.alpha + i, c.alpha);
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
