// Visible samples to radiance: as many at a time as there are lanes, through the templates that the
// reference uses with plain numbers. Part of a kernel file, once per instruction set.
#pragma once

#include "raster/surface_kernel.h"

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

// Materials without any texture.
template <class Layout>
struct Untextured : Layout {
    static constexpr bool kTextured = false;
};
template <class Layout>
struct Textured : Layout {
    static constexpr bool kTextured = true;
};

// Calls visit(kind) with the kind of the job.
template <class Visit>
TESSERA_INLINE void with_kind(const ShadeJob& job, Visit&& visit) {
    bool textured = false;
    for (const TextureInput& in : job.material->inputs) textured |= in.texture != nullptr;
    if (!textured && job.layout == NormalOnly::kLayout) return visit(Untextured<NormalOnly>());
    if (textured && job.layout == NormalAndUv::kLayout) return visit(Textured<NormalAndUv>());
    if (!textured && job.layout == ColorOnly::kLayout && job.develop) return visit(Untextured<ColorOnly>());
    visit(Textured<AnyLayout>());
}

// Triangles that a vector may show before its lanes fetch records of their own.
inline constexpr int kFew = kLanes<Float> < 4 ? kLanes<Float> : 4;

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

// The sample of each lane's own triangle. `used` are the lanes that count, at least one.
template <class Kind>
TESSERA_INLINE void sample_lanes(const ShadeJob& job, const Uint& ordinals, std::uint32_t used, Float x, Float y,
                                 SurfaceSample<Float>& sample, Float& side, Float& sign) {
    constexpr int kWidth = kLanes<Float>;
    const SurfaceLayout& l = Kind::layout(job);
    alignas(64) std::uint32_t ordinal[kWidth];
    store(ordinal, ordinals);
    const auto record_of = [&](int lane) { return job.records + job.record_of[ordinal[lane]]; };
    const auto sample_of = [&](const float* record, SurfaceSample<Float>& out) {
        sample_planes(
            l, x, y, [record](int i) { return Float(record[i]); }, out);
    };
    // The few triangles that the lanes show, and who shows them.
    int first[kFew] = {}, few = 0;
    std::uint32_t rest = used;
    Mask shows[kFew];
    for (; few < kFew && rest; ++few) {
        first[few] = __builtin_ctz(rest);
        shows[few] = ordinals == Uint(ordinal[first[few]]);
        rest &= ~mask_bits(shows[few]);
    }
    if (!rest) {
        const float* record = record_of(first[0]);
        sample_of(record, sample);
        side = Float(record[2]);
        sign = Float(record[3]);
        for (int n = 1; n < few; ++n) {
            record = record_of(first[n]);
            SurfaceSample<Float> other;
            sample_of(record, other);
            blend_samples(l, shows[n], other, sample);
            side = select(shows[n], Float(record[2]), side);
            sign = select(shows[n], Float(record[3]), sign);
        }
        return;
    }
    Float numbers[kMaxSurfaceFloats];
    const int floats = surface_floats(l);
    const float* records[kWidth];
    for (int lane = 0; lane < kWidth; ++lane) records[lane] = record_of(lane);
    for (int i = 0; i < floats; i += 4)
        load_records([&](int lane) { return records[lane] + i; }, numbers[i], numbers[i + 1], numbers[i + 2],
                     numbers[i + 3]);
    sample_planes(
        l, x, y, [&numbers](int i) { return numbers[i]; }, sample);
    side = numbers[2];
    sign = numbers[3];
}

template <class Kind>
TESSERA_INLINE ShadedPoint<Float> shade_lanes(const Batch& batch, const Uint& ordinals, std::uint32_t used, Float x,
                                              Float y) {
    SurfaceSample<Float> sample;
    Float side, sign;
    sample_lanes<Kind>(batch.job, ordinals, used, x, y, sample, side, sign);
    const SurfacePoint<Float> s =
        surface_point(Kind::layout(batch.job), batch.rays, sample, x, y, side, sign, batch.context.footprint_scale);
    return shade<Kind::kTextured>(batch.context, batch.material, s,
                                  [](int, const LightSample<Float>&) { return Float(1.0f); });
}

inline constexpr std::uint32_t kAllLanes = (1u << (kLanes<Float> - 1) << 1) - 1;

// Visits batches of lanes: a tile in the order of its blocks, or a list of points.
// visit(ordinals, used, x, y, where the answer goes).
template <class Visit>
TESSERA_INLINE void for_each_batch(const ShadeJob& job, Visit&& visit) {
    constexpr int kWidth = kLanes<Float>;
    if (job.list) {
        for (std::uint32_t i = 0; i < job.count; i += kWidth) {
            const std::uint32_t left = job.count - i;
            visit(load<Uint>(job.list + i), left < kWidth ? (1u << left) - 1 : kAllLanes,
                  to_float(load<Int>(job.x + i)), to_float(load<Int>(job.y + i)), static_cast<int>(i));
        }
        return;
    }
    const int blocks = job.side / kBlockSide;
    const Int columns = lane_column(), rows = lane_row();
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

// One sample a pixel: from the surface to the picture.
template <class Kind>
inline void shade_and_develop_tile(const ShadeJob& job) {
    const Batch batch(job);
    const DevelopJob& film = *job.develop;
    const Float zero(0.0f), one(1.0f);
    const Uint background = display_pixels(film.film, {zero, zero, zero}, zero);
    const int blocks = job.side / kBlockSide;
    for_each_batch(job, [&](const Uint& ordinals, std::uint32_t used, Float x, Float y, int at) {
        const int block = at / kBlockPixels, place = at % kBlockPixels;
        Uint pixels = background;
        if (used) {
            Vec3T<Float> c = shade_lanes<Kind>(batch, ordinals, used, x, y).radiance;
            Float coverage = one;
            if (used != kAllLanes) {
                const Mask covered = ordinals != Uint(0u);
                c = {select(covered, c.x, zero), select(covered, c.y, zero), select(covered, c.z, zero)};
                coverage = select(covered, one, zero);
            }
            pixels = display_pixels(film.film, c, coverage);
            job.hit[block] |= static_cast<std::uint64_t>(used) << place;
        }
        store_pixels(pixels, film.rgba, film.stride, block % blocks * kBlockSide + place % kBlockSide,
                     block / blocks * kBlockSide + place / kBlockSide, film.width, film.height);
    });
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
        const ShadedPoint<Float> c = shade_lanes<Kind>(batch, ordinals, used, x, y);
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
        const ShadedPoint<Float> c = shade_lanes<Kind>(batch, ordinals, used, x, y);
        store(job.r + at, c.radiance.x);
        store(job.g + at, c.radiance.y);
        store(job.b + at, c.radiance.z);
        store(job.alpha + at, c.alpha);
    });
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
