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
    bool orthographic;
};

template <class F>
struct ShadedPoint {
    Vec3T<F> radiance;
    F alpha;
};

// Unit vector from the point to the eye.
template <class F>
TESSERA_INLINE Vec3T<F> view_direction(const ShadingContext& context, const Vec3T<F>& position) {
    const Vec3T<F> forward{F(0.0f), F(0.0f), F(1.0f)};
    return context.orthographic ? forward : normalize_or(-position, forward);
}

// `visible(light, sample)` gives the part of a light that arrives, 0 .. 1 (shadows). Lights are
// summed in their order.
template <bool kTextured = true, class F, class Visible>
TESSERA_INLINE ShadedPoint<F> shade(const ShadingContext& context, const MaterialView& m, const SurfacePoint<F>& s,
                                    Visible&& visible) {
    if (m.model == ShadingModel::kUnlit) {
        const Vec4T<F> base = base_color<kTextured>(m, s);
        return {base.xyz() * F(context.unlit_scale), coverage_of_alpha(m, base.w)};
    }
    const LobeParameters<F> p = evaluate_material<kTextured>(m, s, view_direction(context, s.position));
    Vec3T<F> radiance = p.emission + reflect_ambient(m, p, context.ambient) * p.occlusion;
    for (int i = 0; i < context.light_count; ++i) {
        const LightSample<F> light = sample_light(context.lights[i], s.position);
        const F arrives = visible(i, light);
        const Incidence<F> incidence{light.to_light, dot(p.normal, light.to_light)};
        radiance = radiance + reflect_light(m, p, incidence) * light.irradiance * arrives;
    }
    return {radiance, p.alpha};
}

}  // namespace tessera
