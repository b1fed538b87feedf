// The lobes of the shading models: what leaves towards the viewer of the light that arrives from one
// direction, and of ambient light. shade.h sums them over the lights.
#pragma once

#include "shading/light.h"
#include "shading/material.h"
#include "simd/math.h"

namespace tessera {

inline constexpr float kInversePi = 0.31830988618379067154f;

// Light that arrives from one direction.
template <class F>
struct Incidence {
    Vec3T<F> to_light;
    F n_l;  // cosine, not clamped
};

// Exponents up to this that are whole numbers are powers by multiplication.
inline constexpr float kLargestWholeExponent = 1024.0f;

// Out of line, so that loops over whole exponents keep their numbers in registers.
template <class F>
TESSERA_COLD F power_by_logarithm(F x, float exponent) {
    return math::pow(x, F(exponent));
}

// An exponent, looked at once for many powers.
struct Exponent {
    float value;
    int whole = 0;        // or not a whole number
    int highest_bit = 0;  // of that

    TESSERA_INLINE explicit Exponent(float exponent) : value(exponent) {
        if (!(exponent >= 1.0f && exponent <= kLargestWholeExponent)) return;
        const int number = static_cast<int>(exponent);
        if (static_cast<float>(number) != exponent) return;
        whole = number;
        highest_bit = 31 - __builtin_clz(static_cast<unsigned>(number));
    }
};

template <class F>
TESSERA_INLINE F power_cosine(F cosine, const Exponent& exponent) {
    const F x = max(cosine, F(0.0f));
    if (exponent.whole == 0) return power_by_logarithm(x, exponent.value);
    // From the highest bit down (Knuth, The Art of Computer Programming, section 4.6.3).
    F power = x;
    for (int bit = exponent.highest_bit - 1; bit >= 0; --bit) {
        power = power * power;
        if (exponent.whole >> bit & 1) power = power * x;
    }
    return power;
}

// The cosine that a textbook's highlight is a power of, as a quotient whose root is still to be drawn:
// numerator / sqrt(squared).
template <class F>
struct HighlightCosine {
    F numerator, squared;
};

// Phong 1975: v.r with r = 2 (n.l) n - l. Blinn 1977: n.h with h = (l + v) / |l + v|.
template <class F>
TESSERA_INLINE HighlightCosine<F> highlight_cosine(ShadingModel model, const Vec3T<F>& view, const Vec3T<F>& to_light,
                                                   F n_v, F n_l) {
    if (model == ShadingModel::kPhong) return {F(2.0f) * n_l * n_v - dot(view, to_light), F(1.0f)};
    const Vec3T<F> h = to_light + view;
    return {n_l + n_v, dot(h, h)};
}
template <class F>
TESSERA_INLINE F cosine(ShadingModel model, const HighlightCosine<F>& c) {
    return model == ShadingModel::kPhong ? c.numerator : c.numerator / sqrt(max(c.squared, F(1e-12f)));
}

// glTF 2.0 metallic-roughness (specification, appendix B): Lambert under a GGX microfacet layer with
// the height-correlated Smith term (Heitz 2014) and Schlick's Fresnel.
struct MetallicRoughnessLobe {
    // Below this roughness a highlight of a point light would be narrower than float can say.
    static constexpr float kSmallestRoughness = 0.03f;

    template <class F>
    static TESSERA_INLINE Vec3T<F> diffuse_color(const LobeParameters<F>& p) {
        return p.base * (F(1.0f) - p.metallic);
    }

    // Schlick 1994: f0 at normal incidence, f90 at a grazing angle.
    template <class F>
    static TESSERA_INLINE Vec3T<F> schlick(const Vec3T<F>& f0, const Vec3T<F>& f90, F cosine) {
        const F c = F(1.0f) - cosine, c2 = c * c;
        return f0 + (f90 - f0) * (c2 * c2 * c);
    }

    // What enters the base under the microfacets. Appendix B's 1 - F(v.h) returns up to 1.8 times the
    // light that arrives at a grazing angle. Here it is one minus what the microfacets return in the
    // flatter of the two directions: reciprocal, and it never gains. Rough surfaces return less at a
    // grazing angle; f90 is fitted to the integrals of the lobe so that the white furnace stays below 1.
    template <class F>
    static TESSERA_INLINE Vec3T<F> into_base(const Vec3T<F>& f0, F roughness, F flatter_cosine) {
        const F f90 = F(1.0f) / (F(1.0f) + F(11.5f) * (roughness * roughness * roughness));
        const Vec3T<F> highest{max(f90, f0.x), max(f90, f0.y), max(f90, f0.z)};
        return Vec3T<F>::splat(F(1.0f)) - schlick(f0, highest, flatter_cosine);
    }

    template <class F>
    static TESSERA_INLINE Vec3T<F> reflect(const LobeParameters<F>& p, const Incidence<F>& i) {
        const Vec3T<F> h = normalize_or(i.to_light + p.view, p.normal);
        const F n_l = max(i.n_l, F(0.0f)), n_v = max(p.n_v, F(1e-4f));
        const F n_h = saturate(dot(p.normal, h)), v_h = saturate(dot(p.view, h));
        const F rough = max(p.roughness, F(kSmallestRoughness));
        const F a = rough * rough, a2 = a * a;

        const Vec3T<F> fresnel = schlick(p.f0, Vec3T<F>::splat(p.f90), v_h);

        // 1 - (n.h)^2 + a2 (n.h)^2, its sine taken from the cross product: near the peak of a smooth
        // surface's highlight the difference would cancel.
        const Vec3T<F> sine = cross(p.normal, h);
        const F denominator = dot(sine, sine) + a2 * (n_h * n_h);
        const F distribution = a2 * F(kInversePi) / max(denominator * denominator, F(1e-30f));
        const F smith = n_l * sqrt(n_v * n_v * (F(1.0f) - a2) + a2) + n_v * sqrt(n_l * n_l * (F(1.0f) - a2) + a2);
        const F specular = distribution * F(0.5f) / max(smith, F(1e-30f));

        const Vec3T<F> diffuse = into_base(p.f0, rough, saturate(min(n_l, n_v))) * diffuse_color(p) * F(kInversePi);
        return (diffuse + fresnel * specular) * n_l;
    }

    // What the microfacets return of light from everywhere: Karis' fit to the split-sum integral ("Physically
    // Based Shading on Mobile", 2014).
    template <class F>
    static TESSERA_INLINE Vec3T<F> highlight_albedo(const LobeParameters<F>& p) {
        const F n_v = saturate(p.n_v);
        const F rx = F(1.0f) - p.roughness, ry = F(0.0425f) - F(0.0275f) * p.roughness;
        const F a004 = min(rx * rx, math::exp2(F(-9.28f) * n_v)) * rx + ry;
        const F scale = F(1.04f) - F(0.572f) * p.roughness - F(1.04f) * a004;
        const F bias = F(0.022f) * p.roughness - F(0.04f) + F(1.04f) * a004;
        const Vec3T<F> fit = p.f0 * scale + Vec3T<F>::splat(max(bias, F(0.0f)) * p.f90);
        return {min(fit.x, F(1.0f)), min(fit.y, F(1.0f)), min(fit.z, F(1.0f))};
    }

    template <class F>
    static TESSERA_INLINE Vec3T<F> reflect_ambient(const LobeParameters<F>& p, const AmbientView& ambient) {
        const Vec3T<F> albedo = highlight_albedo(p);
        const Vec3T<F> mirrored = p.normal * (F(2.0f) * p.n_v) - p.view;
        return albedo * ambient_radiance(ambient, mirrored, p.roughness) +
               (Vec3T<F>::splat(F(1.0f)) - albedo) * diffuse_color(p) * ambient_radiance(ambient, p.normal, F(1.0f));
    }
};

}  // namespace tessera
