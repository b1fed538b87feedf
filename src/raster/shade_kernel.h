// Visible samples to radiance: as many at a time as there are lanes, through the templates that the
// reference uses with plain numbers. Part of a kernel file, once per instruction set.
#pragma once

#include "raster/raster_data.h"
#include "simd/records.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// What the lanes of a batch share.
struct Batch {
    const ShadeJob& job;
    const ShadingContext& context;
    const MaterialView& material;
    const PictureRays rays;

    explicit Batch(const ShadeJob& j)
        : job(j), context(*j.source->shading), material(*j.material), rays(j.source->projection) {}
};

// The layouts that most scenes have are constants of the code, which then keeps all planes in
// registers; the others are read from the job.
struct NormalOnly {
    static constexpr bool kTextured = false;
    static constexpr SurfaceLayout kLayout{.count = 4, .normal = 1};
    static constexpr const SurfaceLayout& layout(const ShadeJob&) { return kLayout; }
};
struct NormalAndUv {
    static constexpr bool kTextured = true;
    static constexpr SurfaceLayout kLayout{.count = 6, .normal = 1, .uv = {4, -1, -1, -1}};
    static constexpr const SurfaceLayout& layout(const ShadeJob&) { return kLayout; }
};
struct ColorOnly {
    static constexpr bool kTextured = false;
    static constexpr SurfaceLayout kLayout{.count = 5, .color = 1};
    static constexpr const SurfaceLayout& layout(const ShadeJob&) { return kLayout; }
};
struct AnyLayout {
    static constexpr bool kTextured = true;
    static const SurfaceLayout& layout(const ShadeJob& job) { return job.layout; }
};

// Calls visit(kind) with the kind of the job.
template <class Visit>
TESSERA_INLINE void with_layout(const ShadeJob& job, Visit&& visit) {
    bool textured = false;
    for (const TextureInput& in : job.material->inputs) textured |= in.texture != nullptr;
    if (!textured && job.layout == NormalOnly::kLayout) return visit(NormalOnly());
    if (textured && job.layout == NormalAndUv::kLayout) return visit(NormalAndUv());
    if (!textured && job.layout == ColorOnly::kLayout) return visit(ColorOnly());
    visit(AnyLayout());
}

// Triangles that a vector may show before its lanes fetch records of their own.
inline constexpr int kFew = 4;

TESSERA_INLINE void blend_samples(const SurfaceLayout& l, Mask mask, const SurfaceSample<Float>& from,
                                  SurfaceSample<Float>& to) {
    for (int k = 0; k < l.count; ++k) to.value[k] = select(mask, from.value[k], to.value[k]);
    to.inverse_w_ddx = select(mask, from.inverse_w_ddx, to.inverse_w_ddx);
    to.inverse_w_ddy = select(mask, from.inverse_w_ddy, to.inverse_w_ddy);
    for (int set = 0; set < kMaxUvSets; ++set) {
        if (l.uv[set] < 0) continue;
        const Footprint<Float>& a = from.uv_plane[set];
        Footprint<Float>& b = to.uv_plane[set];
        b = {select(mask, a.ux, b.ux), select(mask, a.vx, b.vx), select(mask, a.uy, b.uy), select(mask, a.vy, b.vy)};
    }
}

// The sample of each lane's own triangle. `place` is where the lanes' records start; `used` the lanes
// that count, at least one.
template <class Kind>
TESSERA_INLINE void sample_lanes(const ShadeJob& job, const Uint& place, std::uint32_t used, Float x, Float y,
                                 SurfaceSample<Float>& sample, Float& side, Float& sign) {
    constexpr int kWidth = kLanes<Float>;
    const SurfaceLayout& l = Kind::layout(job);
    alignas(64) std::uint32_t places[kWidth];
    store(places, place);
    std::uint32_t rest = used;
    const auto sample_of = [&](const float* record, SurfaceSample<Float>& out) {
        sample_planes(l, x, y, [record](int i) { return Float(record[i]); }, out);
    };
    {
        const std::uint32_t first = places[__builtin_ctz(rest)];
        const float* record = job.records + first;
        sample_of(record, sample);
        side = Float(record[2]);
        sign = Float(record[3]);
        rest &= ~mask_bits(place == Uint(first));
    }
    if constexpr (kWidth > 1) {
        for (int n = 1; n < kFew && rest; ++n) {
            const std::uint32_t next = places[__builtin_ctz(rest)];
            const Mask same = place == Uint(next);
            const float* record = job.records + next;
            SurfaceSample<Float> other;
            sample_of(record, other);
            blend_samples(l, same, other, sample);
            side = select(same, Float(record[2]), side);
            sign = select(same, Float(record[3]), sign);
            rest &= ~mask_bits(same);
        }
        if (!rest) return;
        Float numbers[kMaxSurfaceFloats];
        const int floats = surface_floats(l);
        for (int i = 0; i < floats; i += 4)
            load_records([&](int lane) { return job.records + places[lane] + i; }, numbers[i], numbers[i + 1],
                         numbers[i + 2], numbers[i + 3]);
        sample_planes(l, x, y, [&numbers](int i) { return numbers[i]; }, sample);
        side = numbers[2];
        sign = numbers[3];
    }
}

template <class Kind>
TESSERA_INLINE ShadedPoint<Float> shade_lanes(const Batch& batch, const Uint& place, std::uint32_t used, Float x,
                                              Float y) {
    SurfaceSample<Float> sample;
    Float side, sign;
    sample_lanes<Kind>(batch.job, place, used, x, y, sample, side, sign);
    const SurfacePoint<Float> s = surface_point(Kind::layout(batch.job), batch.rays, sample, x, y, side, sign,
                                                batch.context.footprint_scale);
    return shade<Kind::kTextured>(batch.context, batch.material, s,
                                  [](int, const LightSample<Float>&) { return Float(1.0f); });
}

// Visits batches of lanes: a tile in the order of its blocks, or a list of points.
// visit(ordinals, used, x, y, where the answer goes).
template <class Visit>
TESSERA_INLINE void for_each_batch(const ShadeJob& job, Visit&& visit) {
    constexpr int kWidth = kLanes<Float>;
    constexpr std::uint32_t kAll = (1u << (kWidth - 1) << 1) - 1;
    if (job.list) {
        for (std::uint32_t i = 0; i < job.count; i += kWidth) {
            const std::uint32_t left = job.count - i;
            visit(load<Uint>(job.list + i), left < kWidth ? (1u << left) - 1 : kAll, to_float(load<Int>(job.x + i)),
                  to_float(load<Int>(job.y + i)), static_cast<int>(i));
        }
        return;
    }
    const int blocks = job.side / kBlockSide;
    const Int columns = iota<Int>() & Int(kBlockSide - 1), rows = iota<Int>() >> 3;
    for (int block = 0; block < blocks * blocks; ++block) {
        const int px = block % blocks * kBlockSide, py = block / blocks * kBlockSide;
        for (int at = 0; at < kBlockPixels; at += kWidth) {
            const int place = block * kBlockPixels + at;
            const Uint ordinals = load<Uint>(job.ordinal + place);
            const std::uint32_t used = mask_bits(ordinals != Uint(0u));
            const Int column = columns + Int(px + at % kBlockSide), row = rows + Int(py + at / kBlockSide);
            visit(ordinals, used, to_float((column << 8) + Int(256 * job.x0 + job.offset.x)),
                  to_float((row << 8) + Int(256 * job.y0 + job.offset.y)), place);
        }
    }
}

template <class Kind>
inline void shade_tile_as(const ShadeJob& job) {
    const Batch batch(job);
    const Float zero(0.0f);
    for_each_batch(job, [&](const Uint& ordinals, std::uint32_t used, Float x, Float y, int at) {
        if (!used) {
            if (!job.first) return;
            store(job.r + at, zero);
            store(job.g + at, zero);
            store(job.b + at, zero);
            store(job.alpha + at, zero);
            return;
        }
        const Mask covered = ordinals != Uint(0u);
        const ShadedPoint<Float> c =
            shade_lanes<Kind>(batch, gather(job.record_of, as_int(ordinals)), used, x, y);
        const auto add = [&](float* plane, Float v) {
            const Float before = job.first ? zero : load<Float>(plane + at);
            store(plane + at, before + select(covered, v, zero));
        };
        add(job.r, c.radiance.x);
        add(job.g, c.radiance.y);
        add(job.b, c.radiance.z);
        add(job.alpha, Float(1.0f));
        job.hit[at / kBlockPixels] |= static_cast<std::uint64_t>(used) << at % kBlockPixels;
    });
}

template <class Kind>
inline void shade_points_as(const ShadeJob& job) {
    const Batch batch(job);
    for_each_batch(job, [&](const Uint& ordinals, std::uint32_t used, Float x, Float y, int at) {
        const ShadedPoint<Float> c =
            shade_lanes<Kind>(batch, gather(job.record_of, as_int(ordinals)), used, x, y);
        store(job.r + at, c.radiance.x);
        store(job.g + at, c.radiance.y);
        store(job.b + at, c.radiance.z);
        store(job.alpha + at, c.alpha);
    });
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
