// From a surface point to radiance: material, lights, sum. The one shading of every engine.
#pragma once

#include "shading/lobes.h"

namespace tessera {

// Everything that shading reads, for a whole frame. Plain data; owned by render/.
struct ShadingContext {
    const MaterialView* materials;
    const LightView* lights;
    int light_count;
    AmbientView ambient;
    float unlit_scale;      // radiance of an unlit white: the inverse of the exposure
    float footprint_scale;  // footprint of a sample in pixels
};

template <class F>
struct ShadedPoint {
    Vec3T<F> radiance;
    F alpha;
};

// The models by what their light adds up to. A kernel that knows the family beforehand has less code.
enum class ShadingFamily { kUnlit, kTextbook, kMicrofacet };

TESSERA_INLINE ShadingFamily family_of(ShadingModel model) {
    switch (model) {
        case ShadingModel::kUnlit:
            return ShadingFamily::kUnlit;
        case ShadingModel::kLambert:
        case ShadingModel::kPhong:
        case ShadingModel::kBlinnPhong:
            return ShadingFamily::kTextbook;
        case ShadingModel::kMetallicRoughness:
            break;
    }
    return ShadingFamily::kMicrofacet;
}

// Three numbers that all lanes share, times another.
template <class F>
TESSERA_INLINE Vec3T<F> scaled(const float (&v)[3], float scale) {
    return {F(v[0] * scale), F(v[1] * scale), F(v[2] * scale)};
}

// I = ke + Ia ka + sum over lights of kd I_l (l.n) + ks I_l (highlight); the base colour modulates ka and
// kd. Coefficients that all lanes share are multiplied once, after the sums.
template <bool kTextured, class F, class Visible>
TESSERA_INLINE ShadedPoint<F> shade_textbook(const ShadingContext& context, const MaterialView& m,
                                             const SurfacePoint<F>& s, Visible&& visible) {
    LobeParameters<F> p;
    set_directions<kTextured>(m, s, p);
    Vec3T<F> diffuse = Vec3T<F>::splat(F(0.0f)), highlights = diffuse;
    for (int i = 0; i < context.light_count; ++i) {
        const LightView& view = context.lights[i];
        const Vec3T<F> intensity = Vec3T<F>::load(view.intensity);
        const LightSample<F> light = sample_light(view, s.position);
        const F strength = light.strength * visible(i, light);
        const Incidence<F> incidence{light.to_light, dot(p.normal, light.to_light)};
        diffuse = diffuse + intensity * (lambert_cosine(incidence) * strength);
        if (m.model != ShadingModel::kLambert)
            highlights = highlights + intensity * (highlight(m, p, incidence) * strength);
    }
    set_colors<kTextured>(m, s, p);
    const Vec3T<F> ambient = ambient_radiance(context.ambient, p.normal, F(1.0f)) * p.occlusion;
    const Vec3T<F> ka = Vec3T<F>::load(m.ambient), kd = scaled<F>(m.diffuse, kInversePi),
                   ks = scaled<F>(m.specular, kInversePi);
    return {p.emission + (p.base * (ka * ambient + kd * diffuse) + ks * highlights), p.alpha};
}

template <bool kTextured, class F, class Visible>
TESSERA_INLINE ShadedPoint<F> shade_microfacet(const ShadingContext& context, const MaterialView& m,
                                               const SurfacePoint<F>& s, Visible&& visible) {
    LobeParameters<F> p;
    set_directions<kTextured>(m, s, p);
    set_colors<kTextured>(m, s, p);
    set_microfacets<kTextured>(m, s, p);
    Vec3T<F> radiance = p.emission + MetallicRoughnessLobe::reflect_ambient(p, context.ambient) * p.occlusion;
    for (int i = 0; i < context.light_count; ++i) {
        const LightSample<F> light = sample_light(context.lights[i], s.position);
        const F arrives = visible(i, light);
        const Incidence<F> incidence{light.to_light, dot(p.normal, light.to_light)};
        radiance = radiance + MetallicRoughnessLobe::reflect(p, incidence) * light.irradiance * arrives;
    }
    return {radiance, p.alpha};
}

template <bool kTextured, class F>
TESSERA_INLINE ShadedPoint<F> shade_unlit(const ShadingContext& context, const MaterialView& m,
                                          const SurfacePoint<F>& s) {
    const Vec4T<F> base = base_color<kTextured>(m, s);
    return {base.xyz() * F(context.unlit_scale), coverage_of_alpha(m, base.w)};
}

// For a material of the given family. `visible(light, sample)` gives the part of a light that arrives,
// 0 .. 1 (shadows). Lights are summed in their order.
template <ShadingFamily kFamily, bool kTextured, class F, class Visible>
TESSERA_INLINE ShadedPoint<F> shade_as(const ShadingContext& context, const MaterialView& m, const SurfacePoint<F>& s,
                                       Visible&& visible) {
    if constexpr (kFamily == ShadingFamily::kUnlit)
        return shade_unlit<kTextured>(context, m, s);
    else if constexpr (kFamily == ShadingFamily::kTextbook)
        return shade_textbook<kTextured>(context, m, s, visible);
    else
        return shade_microfacet<kTextured>(context, m, s, visible);
}

template <class F, class Visible>
TESSERA_INLINE ShadedPoint<F> shade(const ShadingContext& context, const MaterialView& m, const SurfacePoint<F>& s,
                                    Visible&& visible) {
    switch (family_of(m.model)) {
        case ShadingFamily::kUnlit:
            return shade_as<ShadingFamily::kUnlit, true>(context, m, s, visible);
        case ShadingFamily::kTextbook:
            return shade_as<ShadingFamily::kTextbook, true>(context, m, s, visible);
        case ShadingFamily::kMicrofacet:
            break;
    }
    return shade_as<ShadingFamily::kMicrofacet, true>(context, m, s, visible);
}

}  // namespace tessera
