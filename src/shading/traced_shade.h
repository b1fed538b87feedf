// Shading where light is traced: the shading of shade.h with what arrives of each light, and besides what of the light
// from the mirrored and the refracted direction goes to the viewer. Who traces adds these parts.
#pragma once

#include "shading/shade.h"
#include "shading/transport.h"

namespace tessera {

template <class F>
struct TracedShade {
    Vec3T<F> radiance;             // of lights, ambient light and the surface itself
    F alpha;                       // coverage
    Vec3T<F> reflected, entering;  // factors on the light that is met along the mirrored and refracted rays
};

// Which materials let light through.
TESSERA_INLINE bool may_transmit(const MaterialView& m) {
    return m.transmission > 0 && m.model != ShadingModel::kUnlit;
}

// One ray stands for all mirrored directions: all of the lobe up to a roughness of 1/20, nothing of it from 1/4 on,
// where ambient light does.
template <class F>
TESSERA_INLINE F mirror_share(F roughness) {
    return saturate((F(0.25f) - roughness) * F(5.0f));
}

// `eta`: indices of the viewer's side over those behind the surface. `inside`: the viewer is within the medium.
template <int kUvSets, class F, class Visible>
TESSERA_INLINE TracedShade<F> trace_microfacet(const ShadingContext& context, const MaterialView& m,
                                               const SurfacePoint<F>& s, F eta, const MaskOf<F>& inside, int k,
                                               Visible&& visible) {
    const F zero(0.0f), one(1.0f);
    LobeParameters<F> p = evaluate_material<kUvSets>(m, s);
    const bool transmits = context.bounces && m.transmission > 0.0f;
    const F entering = transmits ? transmission<kUvSets>(m, s) * (one - p.metallic) : zero, scattered = one - entering;
    const Vec3T<F> tint = p.base;
    if (transmits) p.base = p.base * scattered;
    const F sharp = context.bounces ? mirror_share(p.roughness) : zero;
    const Vec3T<F> albedo = MetallicRoughnessLobe::highlight_albedo(p);
    const Vec3T<F> around = p.normal * (F(2.0f) * p.n_v) - p.view;
    // From within only the opaque part is lit: light that enters is what the rays find.
    const bool lit_less = transmits && !m.thin;
    const F lit = lit_less ? select(inside, scattered, one) : one;
    Vec3T<F> ambient = albedo * ambient_radiance(context.ambient, around, p.roughness) * ((one - sharp) * scattered) +
                       (Vec3T<F>::splat(one) - albedo) * MetallicRoughnessLobe::diffuse_color(p) *
                           ambient_radiance(context.ambient, p.normal, one);
    if (lit_less) ambient = ambient * lit;
    Vec3T<F> radiance = p.emission + ambient * p.occlusion;
    for (int i = 0; i < context.light_count; ++i) {
        const LightSample<F> light = sample_light(context.lights[i], s.position);
        const Incidence<F> incidence{light.to_light, dot(p.normal, light.to_light)};
        Vec3T<F> sent = MetallicRoughnessLobe::reflect(p, incidence) * light.irradiance * visible(i, light, k);
        if (lit_less) sent = sent * lit;
        radiance = radiance + sent;
    }
    TracedShade<F> out;
    out.radiance = radiance;
    out.alpha = p.alpha;
    out.reflected = albedo * (sharp * scattered);
    out.entering = Vec3T<F>::splat(zero);
    if (transmits) {
        const F fresnel = refracted(p.view, p.normal, s.geometric_normal, eta).reflected;
        out.reflected = out.reflected + Vec3T<F>::splat(fresnel * entering);
        out.entering = tint * ((one - fresnel) * entering);
    }
    return out;
}

// For a material of the given family, as shade_as(). The batch also says eta(k) and inside(k).
template <ShadingFamily kFamily, int kUvSets, class F, class Batch, class Visible>
TESSERA_INLINE void shade_traced(const ShadingContext& context, const MaterialView& m, const Batch& batch,
                                 Visible&& visible, TracedShade<F>* out) {
    if constexpr (kFamily == ShadingFamily::kMicrofacet) {
        for (int k = 0; k < Batch::kCount; ++k)
            if (batch.used(k))
                out[k] =
                    trace_microfacet<kUvSets>(context, m, batch.point(k), batch.eta(k), batch.inside(k), k, visible);
    } else {
        ShadedPoint<F> shaded[Batch::kCount];
        shade_as<kFamily, kUvSets>(context, m, batch, visible, shaded);
        for (int k = 0; k < Batch::kCount; ++k) {
            if (!batch.used(k)) continue;
            const Vec3T<F> none = Vec3T<F>::splat(F(0.0f));
            out[k] = {shaded[k].radiance, shaded[k].alpha, none, none};
            if constexpr (kFamily == ShadingFamily::kTextbook) {
                out[k].reflected = Vec3T<F>::load(m.mirror);
                if (m.transmission == 0.0f) continue;
                // What could enter is mirrored or enters as Fresnel says; kr counts for the rest.
                const SurfacePoint<F> s = batch.point(k);
                const F fresnel = refracted(s.view, s.normal, s.geometric_normal, batch.eta(k)).reflected;
                out[k].reflected =
                    out[k].reflected * F(1.0f - m.transmission) + Vec3T<F>::splat(fresnel * F(m.transmission));
                out[k].entering = Vec3T<F>::load(m.tint) * ((F(1.0f) - fresnel) * F(m.transmission));
            }
        }
    }
}

// What a surface lets through of light that goes straight on, as shadows have it: by its alpha, and what enters it less
// what is mirrored ahead.
template <class F>
TESSERA_INLINE Vec3T<F> straight_through(const MaterialView& m, const SurfacePoint<F>& s) {
    const F one(1.0f);
    const F alpha = coverage_of_alpha(m, base_color(m, s).w);
    Vec3T<F> entering = Vec3T<F>::splat(F(0.0f));
    if (may_transmit(m)) {
        if (family_of(m.model) == ShadingFamily::kTextbook) {
            entering = Vec3T<F>::load(m.tint) * F(m.transmission);
        } else {
            const LobeParameters<F> p = evaluate_material(m, s);
            entering = p.base * (transmission(m, s) * F(1.0f - m.dielectric[1]) * (one - p.metallic));
        }
    }
    return Vec3T<F>::splat(one - alpha) + entering * alpha;
}

// A ray that meets nothing: ambient light.
template <class F>
TESSERA_INLINE Vec3T<F> radiance_around(const ShadingContext& context, const Vec3T<F>& direction) {
    return ambient_radiance(context.ambient, direction, F(0.0f));
}

}  // namespace tessera
