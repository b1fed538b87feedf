// Radiance of the points of a wave, and what they send on. Part of a kernel file, once per instruction set.
#pragma once

#include "trace/ray_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// A few vectors of points as a batch of shading.
template <bool kHasColors>
struct WaveBatch {
    static constexpr int kCount = 4;
    static constexpr bool kColored = kHasColors;
    const TracedShadeJob& job;
    const SurfaceLayout& layout;
    std::uint32_t first, vectors;  // vectors: that there are

    TESSERA_INLINE bool used(int k) const { return static_cast<std::uint32_t>(k) < vectors; }
    TESSERA_INLINE std::uint32_t at(int k) const { return first + static_cast<std::uint32_t>(k * kLanes<Float>); }
    TESSERA_INLINE Vec3T<Float> position(int k) const { return load3(job.points, kPositionX, at(k)); }
    TESSERA_INLINE Vec3T<Float> view(int k) const { return load3(job.points, kViewX, at(k)); }
    TESSERA_INLINE Vec3T<Float> normal(int k) const { return load3(job.points, kNormalX, at(k)); }
    TESSERA_INLINE Float eta(int k) const { return load<Float>(job.points[kEtaG] + at(k)); }
    TESSERA_INLINE Mask inside(int k) const { return load<Float>(job.points[kFacing] + at(k)) < Float(0.0f); }
    TESSERA_INLINE SurfacePoint<Float> point(int k) const {
        const Float zero(0.0f), one(1.0f);
        SurfacePoint<Float> s;
        s.position = position(k), s.view = view(k), s.normal = normal(k);
        s.geometric_normal = load3(job.points, kFlatX, at(k));
        s.tangent = s.bitangent = {zero, zero, zero};
        s.side = load<Float>(job.points[kFacing] + at(k));
        s.color = {one, one, one, one};
        if (kHasColors && layout.color >= 0) {
            const Vec3T<Float> c = load3(job.points, kColorR, at(k));
            s.color = {c.x, c.y, c.z, load<Float>(job.points[kColorA] + at(k))};
        }
        for (int set = 0; set < kMaxUvSets; ++set) {
            s.uv[set] = {zero, zero};
            s.footprint[set] = {zero, zero, zero, zero};
            if (layout.uv[set] < 0) continue;
            const auto number = [&](int n) { return load<Float>(job.points[kUv + 6 * set + n] + at(k)); };
            s.uv[set] = {number(0), number(1)};
            s.footprint[set] = {number(2), number(3), number(4), number(5)};
        }
        return s;
    }
};

template <int kChannels, ShadingFamily kFamily, int kUvSets, bool kHasColors>
__attribute__((noinline)) void shade_as_traced(const TracedShadeJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    using Batch = WaveBatch<kHasColors>;
    const ShadingContext context = *job.shading;
    const MaterialView material = *job.material;
    const SurfaceLayout layout = job.layout;
    const std::uint32_t vectors = (job.count + kWidth - 1) / kWidth;
    for (std::uint32_t v = 0; v < vectors; v += Batch::kCount) {
        const Batch batch{job, layout, job.first + v * kWidth, vectors - v};
        const auto visible = [&](int light, const LightSample<Float>&, int k) TESSERA_INLINE_LAMBDA {
            const float* const from =
                job.arrival.arrives + static_cast<std::size_t>(light * kChannels) * job.arrival.stride + batch.at(k);
            if constexpr (kChannels == 1) {
                return load<Float>(from);
            } else {
                return Vec3T<Float>{load<Float>(from), load<Float>(from + job.arrival.stride),
                                    load<Float>(from + 2 * job.arrival.stride)};
            }
        };
        TracedShade<Float> out[Batch::kCount] = {};
        shade_traced<kFamily, kUvSets>(context, material, batch, visible, out);
        for (int k = 0; k < Batch::kCount; ++k) {
            if (!batch.used(k)) continue;
            const std::uint32_t at = batch.at(k);
            store3(job.shades, kRadianceR, at, out[k].radiance);
            store(job.shades[kAlpha] + at, out[k].alpha);
            store3(job.shades, kReflectedR, at, out[k].reflected);
            store3(job.shades, kEnteringR, at, out[k].entering);
        }
    }
}

template <int kChannels>
inline void shade_by_kind(const TracedShadeJob& job) {
    using enum ShadingFamily;
    int uv_sets = has_specular_texture(*job.material) ? kMaxUvSets : 0;
    for (const TextureInput& in : job.material->inputs)
        if (in.texture && in.uv_set >= uv_sets) uv_sets = in.uv_set + 1;
    const ShadingFamily family = family_of(job.material->model);
    if (uv_sets == 0 && job.layout.color < 0 && family != kUnlit) {
        if (family == kTextbook) return shade_as_traced<kChannels, kTextbook, 0, false>(job);
        return shade_as_traced<kChannels, kMicrofacet, 0, false>(job);
    }
    if (family == kUnlit) return shade_as_traced<kChannels, kUnlit, kMaxUvSets, true>(job);
    if (family == kTextbook) return shade_as_traced<kChannels, kTextbook, kMaxUvSets, true>(job);
    if (uv_sets <= 1) return shade_as_traced<kChannels, kMicrofacet, 1, true>(job);
    shade_as_traced<kChannels, kMicrofacet, kMaxUvSets, true>(job);
}

inline void shade_wave(const TracedShadeJob& job) {
    if (job.arrival.channels == 1) return shade_by_kind<1>(job);
    shade_by_kind<3>(job);
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
