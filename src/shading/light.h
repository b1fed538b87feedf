// Lights over the number type: what arrives at a point. Camera space. Sources of the formulas: glTF
// extension KHR_lights_punctual (range window, spot cones).
#pragma once

#include <tessera/shading_model.h>

#include "shading/vectors.h"

namespace tessera {

struct LightView {
    LightType type;
    LightFalloff falloff;
    SpotProfile profile;
    float position[3];              // point and spot
    float to_light[3];              // directional: unit, towards the light; spot: against its axis
    float intensity[3];             // colour * intensity: lux for directional, candela for the others
    float inverse_range;            // 0: unlimited
    float spot_scale, spot_offset;  // angular fall = saturate(cos * scale + offset)
};

// Ambient radiance by direction: `sky` from above, `ground` from below along `up`; equal for uniform
// ambient light.
struct AmbientView {
    float sky[3], ground[3], up[3];
    bool uniform = false;  // sky and ground are equal
};

template <class F>
struct LightSample {
    Vec3T<F> to_light;  // unit
    F distance;         // infinite for directional lights
    F strength;         // factor on the light's intensity
    Vec3T<F>
        irradiance;  // on a surface that faces the light: the intensity times that; 1/pi of it is the textbooks' I_l
};

inline constexpr float kPi = 3.14159265358979323846f;

template <class F>
TESSERA_INLINE LightSample<F> sample_light(const LightView& light, const Vec3T<F>& at) {
    const Vec3T<F> intensity = Vec3T<F>::load(light.intensity);
    // The textbooks' constant light arrives as I_l = intensity, that is irradiance pi * intensity.
    F strength(light.falloff == LightFalloff::kConstant ? kPi : 1.0f), distance(3.4e38f);
    F x(light.to_light[0]), y(light.to_light[1]), z(light.to_light[2]);
    if (light.type != LightType::kDirectional) {
        const Vec3T<F> axis{x, y, z}, d = Vec3T<F>::load(light.position) - at;
        const F squared = max(dot(d, d), F(1e-20f));
        distance = sqrt(squared);
        const F inverse = F(1.0f) / distance;
        x = d.x * inverse, y = d.y * inverse, z = d.z * inverse;
        if (light.falloff != LightFalloff::kConstant) strength = F(1.0f) / squared;
        if (light.inverse_range > 0.0f) {
            const F r = distance * F(light.inverse_range);
            strength = strength * saturate(F(1.0f) - (r * r) * (r * r));
        }
        if (light.type == LightType::kSpot) {
            const F cosine = axis.x * x + axis.y * y + axis.z * z;
            const F angular = saturate(cosine * F(light.spot_scale) + F(light.spot_offset));
            strength = strength * (light.profile == SpotProfile::kCones ? angular * angular : angular);
        }
    }
    return {{x, y, z}, distance, strength, intensity * strength};
}

// Mean ambient radiance around `direction`; `softness` 0 (a mirror's sharp horizon) to 1 (diffuse).
template <class F>
TESSERA_INLINE Vec3T<F> ambient_radiance(const AmbientView& ambient, const Vec3T<F>& direction, F softness) {
    if (ambient.uniform) return Vec3T<F>::load(ambient.ground);
    const F height = dot(Vec3T<F>::load(ambient.up), direction);
    const F t = saturate(F(0.5f) + F(0.5f) * height / (F(0.25f) + F(0.75f) * softness));
    return mix(Vec3T<F>::load(ambient.ground), Vec3T<F>::load(ambient.sky), t * t * (F(3.0f) - F(2.0f) * t));
}

}  // namespace tessera
