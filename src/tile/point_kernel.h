// The first stage of shading: from ordinals and picture positions to surface points, some blocks at a
// time. The stages hand each other blocks, not vectors, so that several vectors of a stage are under way
// while the square roots and divisions of one take their time. Part of a kernel file, once per
// instruction set.
#pragma once

#include "tile/surface_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// As many blocks of a tile at a time as the first-level cache holds.
inline constexpr int kPointBlocks = 4;
inline constexpr int kBlockVectors = kBlockPixels / kLanes<Float>, kVectors = kPointBlocks * kBlockVectors;
inline constexpr std::uint32_t kAllLanes = (1u << (kLanes<Float> - 1) << 1) - 1;

// Some blocks of a tile, or a part of a list, on their way through the stages.
struct Points {
    static constexpr int kNumbers = 2 + 3 + 4 + 6 * kMaxUvSets;

    const std::uint32_t* numbers;       // ordinals
    std::uint32_t used[kVectors];       // lanes that count
    Float x[kVectors], y[kVectors];     // picture positions
    Float surface[kVectors][kNumbers];  // as visit_numbers() orders them
    ShadedPoint<Float> shaded[kVectors];

    TESSERA_INLINE Uint ordinals(int k) const { return load<Uint>(numbers + k * kLanes<Float>); }
};

// What the points of a job share: copies, which no store can change.
struct ShadeConstants {
    const ShadeJob& job;
    const ShadingContext context;
    const MaterialView material;
    const PictureRays rays;

    explicit ShadeConstants(const ShadeJob& j)
        : job(j), context(*j.source->shading), material(*j.material), rays(j.source->projection) {}
};

// visit(place, number) for what a layout makes of a surface point; all else in it is constant.
template <class Point, class Visit>
TESSERA_INLINE void visit_numbers(const SurfaceLayout& l, Point& s, Visit&& visit) {
    int n = 0;
    if (l.normal >= 0) {
        visit(n++, s.position.z), visit(n++, s.view.z);  // what lies on the way to them is the picture position's
        visit(n++, s.normal.x), visit(n++, s.normal.y), visit(n++, s.normal.z);
    }
    if (l.color >= 0) visit(n++, s.color.x), visit(n++, s.color.y), visit(n++, s.color.z), visit(n++, s.color.w);
    for (int set = 0; set < kMaxUvSets; ++set) {
        if (l.uv[set] < 0) continue;
        visit(n++, s.uv[set].x), visit(n++, s.uv[set].y);
        visit(n++, s.footprint[set].ux), visit(n++, s.footprint[set].vx);
        visit(n++, s.footprint[set].uy), visit(n++, s.footprint[set].vy);
    }
}

// Without the geometry behind the normal, which shading does not read.
TESSERA_INLINE SurfacePoint<Float> load_point(const SurfaceLayout& l, const EyeDirection<Float>& eye,
                                              const Float* numbers) {
    const Float zero(0.0f), one(1.0f);
    SurfacePoint<Float> s;
    s.position = s.geometric_normal = s.tangent = s.bitangent = {zero, zero, zero};
    s.view = s.normal = {zero, zero, one};
    s.side = one;
    s.color = {one, one, one, one};
    for (int set = 0; set < kMaxUvSets; ++set) {
        s.uv[set] = {zero, zero};
        s.footprint[set] = {zero, zero, zero, zero};
    }
    visit_numbers(l, s, [numbers](int n, Float& number) TESSERA_INLINE_LAMBDA { number = numbers[n]; });
    if (l.normal >= 0) {
        s.position = eye.position(l.depth >= 0, s.position.z);
        s.view = eye.view(l.depth >= 0, s.view.z);
    }
    return s;
}

// Triangles that a vector may show before its lanes fetch records of their own.
inline constexpr int kFew = kLanes<Float> < 4 ? kLanes<Float> : 4;

TESSERA_INLINE void blend_samples(const SurfaceLayout& l, Mask mask, const SurfaceSample<Float>& from,
                                  SurfaceSample<Float>& to) {
    for (int k = 0; k < l.count; ++k) to.value[k] = select(mask, from.value[k], to.value[k]);
    to.side = select(mask, from.side, to.side);
    if (l.tangent >= 0) to.bitangent_sign = select(mask, from.bitangent_sign, to.bitangent_sign);
    bool any_uv = false;
    for (int set = 0; set < kMaxUvSets; ++set) {
        if (l.uv[set] < 0) continue;
        any_uv = true;
        const Footprint<Float>& a = from.uv_plane[set];
        Footprint<Float>& b = to.uv_plane[set];
        b.ux = select(mask, a.ux, b.ux), b.vx = select(mask, a.vx, b.vx);
        b.uy = select(mask, a.uy, b.uy), b.vy = select(mask, a.vy, b.vy);
    }
    if (!any_uv) return;
    to.inverse_w_ddx = select(mask, from.inverse_w_ddx, to.inverse_w_ddx);
    to.inverse_w_ddy = select(mask, from.inverse_w_ddy, to.inverse_w_ddy);
}

// The sample of each lane's own triangle, from the records of a ShadeJob or LabelSurfaceJob. `used` are the lanes that
// count, at least one; `numbers` are the ordinals one by one.
template <class Job>
TESSERA_INLINE void sample_lanes(const Job& job, const SurfaceLayout& l, const Uint& ordinals,
                                 const std::uint32_t* numbers, std::uint32_t used, Float x, Float y,
                                 SurfaceSample<Float>& sample) {
    constexpr int kWidth = kLanes<Float>;
    const auto record_of = [&](int lane) { return job.records + job.record_of[numbers[lane]]; };
    const auto sample_of = [&](const float* record, SurfaceSample<Float>& out) {
        sample_planes(
            l, x, y, [record](int i) { return Float(record[i]); }, out);
    };
    // The first lanes of the few triangles that are shown.
    int first[kFew] = {}, few = 0;
    std::uint32_t rest = used;
    for (; few < kFew && rest; ++few) {
        first[few] = __builtin_ctz(rest);
        rest &= ~mask_bits(ordinals == Uint(numbers[first[few]]));
    }
    if (!rest) {
        sample_of(record_of(first[0]), sample);
        for (int n = 1; n < few; ++n) {
            SurfaceSample<Float> other;
            sample_of(record_of(first[n]), other);
            blend_samples(l, ordinals == Uint(numbers[first[n]]), other, sample);
        }
        return;
    }
    Float record[kMaxSurfaceFloats];
    const float* records[kWidth];
    for (int lane = 0; lane < kWidth; ++lane) records[lane] = record_of(lane);
    for (int i = 0; i < surface_floats(l); i += 4)
        load_records([&](int lane) { return records[lane] + i; }, record[i], record[i + 1], record[i + 2],
                     record[i + 3]);
    sample_planes(
        l, x, y, [&record](int i) { return record[i]; }, sample);
}

// From ordinals and positions to Points::surface.
template <class Layout>
__attribute__((noinline)) void find_surfaces(const ShadeConstants& constants, Points& points) {
    const ShadeJob& job = constants.job;
    const SurfaceLayout& l = Layout::layout(job);
    const PictureRays rays = constants.rays;
    const float footprint_scale = constants.context.footprint_scale;
    for (int k = 0; k < kVectors; ++k) {
        if (!points.used[k]) continue;
        const Float x = points.x[k], y = points.y[k];
        SurfaceSample<Float> sample;
        sample_lanes(job, l, points.ordinals(k), points.numbers + k * kLanes<Float>, points.used[k], x, y, sample);
        SurfacePoint<Float> s = surface_point(l, rays, sample, x, y, footprint_scale);
        if (l.tangent >= 0) s.normal = shading_normal(constants.material, s);
        Float* const numbers = points.surface[k];
        visit_numbers(l, s, [numbers](int n, const Float& number) TESSERA_INLINE_LAMBDA { numbers[n] = number; });
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
