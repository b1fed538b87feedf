// Visible samples to radiance: as many at a time as there are lanes, through the templates that the
// reference uses with plain numbers. Part of a kernel file, once per instruction set.
#pragma once

#include "raster/surface_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// What the lanes of a batch share: copies, which no store of pixels can change.
struct Batch {
    const ShadeJob& job;
    const ShadingContext context;
    const MaterialView material;
    const PictureRays rays;

    explicit Batch(const ShadeJob& j)
        : job(j), context(*j.source->shading), material(*j.material), rays(j.source->projection) {}
};

// What a kernel knows of its jobs beforehand: planes, whether there are textures, and the shading family.
template <class Layout, ShadingFamily kFamily, bool kTextured>
struct Known : Layout {
    static TESSERA_INLINE ShadedPoint<Float> shade_point(const Batch& batch, const SurfacePoint<Float>& s) {
        return shade_as<kFamily, kTextured>(batch.context, batch.material, s,
                                            [](int, const LightSample<Float>&) { return Float(1.0f); });
    }
};
struct Unknown : AnyLayout {
    static TESSERA_INLINE ShadedPoint<Float> shade_point(const Batch& batch, const SurfacePoint<Float>& s) {
        return shade(batch.context, batch.material, s, [](int, const LightSample<Float>&) { return Float(1.0f); });
    }
};

// Calls visit(kind) with the kind of the job.
template <class Visit>
TESSERA_INLINE void with_kind(const ShadeJob& job, Visit&& visit) {
    bool textured = false;
    for (const TextureInput& in : job.material->inputs) textured |= in.texture != nullptr;
    const ShadingFamily family = family_of(job.material->model);
    const bool textbook = family == ShadingFamily::kTextbook, unlit = family == ShadingFamily::kUnlit;
    if (!textured && !unlit && job.layout == NormalOnly::kLayout)
        return textbook ? visit(Known<NormalOnly, ShadingFamily::kTextbook, false>())
                        : visit(Known<NormalOnly, ShadingFamily::kMicrofacet, false>());
    if (textured && !unlit && job.layout == NormalAndUv::kLayout)
        return textbook ? visit(Known<NormalAndUv, ShadingFamily::kTextbook, true>())
                        : visit(Known<NormalAndUv, ShadingFamily::kMicrofacet, true>());
    if (!textured && unlit && job.layout == ColorOnly::kLayout && job.develop)
        return visit(Known<ColorOnly, ShadingFamily::kUnlit, false>());
    visit(Unknown());
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
    return Kind::shade_point(batch, s);
}

inline constexpr std::uint32_t kAllLanes = (1u << (kLanes<Float> - 1) << 1) - 1;

// A vector of pixels of a tile.
struct TileVector {
    int column, row, place;  // its first pixel, in the tile and in the tile's planes
    Float x, y;              // picture positions
    Uint ordinals;
    std::uint32_t used;  // lanes with an ordinal
};

// Visits the vectors of a tile in the order of its blocks.
template <class Visit>
TESSERA_INLINE void for_each_vector_of_tile(const ShadeJob& job, Visit&& visit) {
    constexpr int kWidth = kLanes<Float>;
    const int blocks = job.side / kBlockSide;
    // Whole numbers below 2^24, so their sums are exact.
    const Float columns = to_float(lane_column() << 8), rows = to_float(lane_row() << 8);
    const float x0 = static_cast<float>(256 * job.x0 + job.offset.x),
                y0 = static_cast<float>(256 * job.y0 + job.offset.y);
    TileVector v;
    v.place = 0;
    for (int block_row = 0; block_row < blocks; ++block_row)
        for (int block_column = 0; block_column < blocks; ++block_column)
            for (int at = 0; at < kBlockPixels; at += kWidth) {
                v.column = block_column * kBlockSide + at % kBlockSide;
                v.row = block_row * kBlockSide + at / kBlockSide;
                v.x = columns + Float(x0 + static_cast<float>(256 * v.column));
                v.y = rows + Float(y0 + static_cast<float>(256 * v.row));
                v.ordinals = load<Uint>(job.ordinal + v.place);
                v.used = mask_bits(v.ordinals != Uint(0u));
                visit(v);
                v.place += kWidth;
            }
}

// One sample a pixel: from the surface to the picture.
template <class Kind>
inline void shade_and_develop_tile(const ShadeJob& job) {
    const Batch batch(job);
    const DevelopJob& film = *job.develop;
    const Float zero(0.0f), one(1.0f);
    const Uint background = display_pixels(film.film, {zero, zero, zero}, zero);
    for_each_vector_of_tile(job, [&](const TileVector& v) TESSERA_INLINE_LAMBDA {
        Uint pixels = background;
        if (v.used) {
            Vec3T<Float> c = shade_lanes<Kind>(batch, v.ordinals, v.used, v.x, v.y).radiance;
            Float coverage = one;
            if (v.used != kAllLanes) {
                const Mask covered = v.ordinals != Uint(0u);
                c = {select(covered, c.x, zero), select(covered, c.y, zero), select(covered, c.z, zero)};
                coverage = select(covered, one, zero);
            }
            pixels = display_pixels(film.film, c, coverage);
            job.hit[v.place / kBlockPixels] |= static_cast<std::uint64_t>(v.used) << v.place % kBlockPixels;
        }
        store_pixels(pixels, film.rgba, film.stride, v.column, v.row, film.width, film.height);
    });
}

template <class Kind>
inline void shade_tile_as(const ShadeJob& job) {
    const Batch batch(job);
    const Float zero(0.0f);
    for_each_vector_of_tile(job, [&](const TileVector& v) TESSERA_INLINE_LAMBDA {
        const int at = v.place;
        if (!v.used) {
            if (!job.first) return;
            store(job.r + at, zero);
            store(job.g + at, zero);
            store(job.b + at, zero);
            store(job.alpha + at, zero);
            return;
        }
        const Mask covered = v.ordinals != Uint(0u);
        const ShadedPoint<Float> c = shade_lanes<Kind>(batch, v.ordinals, v.used, v.x, v.y);
        const auto add = [&](float* plane, Float value) {
            const Float before = job.first ? zero : load<Float>(plane + at);
            store(plane + at, before + select(covered, value, zero));
        };
        add(job.r, c.radiance.x);
        add(job.g, c.radiance.y);
        add(job.b, c.radiance.z);
        add(job.alpha, Float(1.0f));
        job.hit[at / kBlockPixels] |= static_cast<std::uint64_t>(v.used) << at % kBlockPixels;
    });
}

template <class Kind>
inline void shade_points_as(const ShadeJob& job) {
    const Batch batch(job);
    constexpr int kWidth = kLanes<Float>;
    for (std::uint32_t i = 0; i < job.count; i += kWidth) {
        const std::uint32_t left = job.count - i;
        const ShadedPoint<Float> c =
            shade_lanes<Kind>(batch, load<Uint>(job.list + i), left < kWidth ? (1u << left) - 1 : kAllLanes,
                              to_float(load<Int>(job.x + i)), to_float(load<Int>(job.y + i)));
        store(job.r + i, c.radiance.x);
        store(job.g + i, c.radiance.y);
        store(job.b + i, c.radiance.z);
        store(job.alpha + i, c.alpha);
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
