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
    bool bounces = false;   // mirrored and refracted light is traced
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
        case ShadingModel::kSpecularGlossiness:
            break;
    }
    return ShadingFamily::kMicrofacet;
}

// What arrives of a light where nothing casts shadows: all of it.
struct Unshadowed {};
template <class F>
TESSERA_INLINE Vec3T<F> operator*(const Vec3T<F>& light, Unshadowed) {
    return light;
}

// A batch is what shading takes at a time: kCount points (or vectors of them), of which it reads what it
// needs by their number. One point is the batch of the reference; kernels have blocks.
template <class F>
struct BatchOfOne {
    static constexpr int kCount = 1;
    static constexpr bool kColored = true;
    const SurfacePoint<F>& s;

    TESSERA_INLINE bool used(int) const { return true; }
    TESSERA_INLINE Vec3T<F> position(int) const { return s.position; }
    TESSERA_INLINE Vec3T<F> normal(int) const { return s.normal; }
    TESSERA_INLINE Vec3T<F> view(int) const { return s.view; }
    TESSERA_INLINE const SurfacePoint<F>& point(int) const { return s; }
};

// Products of numbers that all lanes share.
template <class F>
TESSERA_INLINE Vec3T<F> product(const float (&a)[3], const float (&b)[3], float scale) {
    return {F(a[0] * b[0] * scale), F(a[1] * b[1] * scale), F(a[2] * b[2] * scale)};
}

// I = ke + Ia ka + sum over lights of kd I_l (l.n) + ks I_l (highlight). Texture and vertex colour
// modulate ka and kd, textures of their own ks and ns. In short loops over the batch, so that the square
// roots and divisions of its vectors overlap. `visible(light, sample, point)` as below.
template <int kUvSets, class F, class Batch, class Visible>
TESSERA_INLINE void shade_textbook(const ShadingContext& context, const MaterialView& m, const Batch& batch,
                                   Visible&& visible, ShadedPoint<F>* out) {
    constexpr int kCount = Batch::kCount;
    constexpr bool kColored = kUvSets > 0 || Batch::kColored;
    const Exponent exponent(m.shininess);
    const bool highlights_vary = kReadsSpecular<kUvSets> && has_specular_texture(m);
    Vec3T<F> color[kCount];
    for (int k = 0; k < kCount; ++k) {
        if (!batch.used(k)) continue;
        Vec3T<F> radiance = product<F>(m.ambient, context.ambient.ground, 1.0f);
        if (!context.ambient.uniform)
            radiance = Vec3T<F>::load(m.ambient) * ambient_radiance(context.ambient, batch.normal(k), F(1.0f));
        Vec3T<F> emission = Vec3T<F>::load(m.emission);
        F alpha(m.base_color[3]);
        if constexpr (kColored) {
            // The point is read anew for every input: kept, it would lie in memory a second time.
            const Vec4T<F> c = surface_color<kUvSets>(m, batch.point(k));
            color[k] = c.xyz();
            alpha = alpha * c.w;
            radiance = radiance * color[k];
            if constexpr (kUvSets > 0) {
                if (m.input(TextureSlot::kOcclusion).texture)
                    radiance = radiance * occlusion<kUvSets>(m, batch.point(k));
                if (m.input(TextureSlot::kEmissive).texture)
                    emission = emission * read_input<kUvSets>(m, TextureSlot::kEmissive, batch.point(k)).xyz();
            }
        }
        out[k].radiance = radiance + emission;
        out[k].alpha = coverage_of_alpha(m, alpha);
    }
    for (int i = 0; i < context.light_count; ++i) {
        const LightView light = context.lights[i];
        const Vec3T<F> kd = product<F>(m.diffuse, light.intensity, kInversePi),
                       ks = product<F>(m.specular, light.intensity, kInversePi);
        F n_l[kCount], strength[kCount];
        HighlightCosine<F> highlight[kCount];
        decltype(visible(0, LightSample<F>{}, 0)) arrives[kCount];
        for (int k = 0; k < kCount; ++k) {
            if (!batch.used(k)) continue;
            const LightSample<F> sample = sample_light(light, batch.position(k));
            strength[k] = sample.strength;
            arrives[k] = visible(i, sample, k);
            n_l[k] = dot(batch.normal(k), sample.to_light);
            if (m.model == ShadingModel::kLambert) continue;
            const Vec3T<F> view = batch.view(k);
            highlight[k] = highlight_cosine(m.model, view, sample.to_light, dot(batch.normal(k), view), n_l[k]);
        }
        for (int k = 0; k < kCount; ++k) {
            if (!batch.used(k)) continue;
            const F zero(0.0f);
            Vec3T<F> diffuse = kd * (max(n_l[k], zero) * strength[k]);
            if constexpr (kColored) diffuse = diffuse * color[k];
            Vec3T<F> sum = out[k].radiance + diffuse * arrives[k];
            if (m.model != ShadingModel::kLambert) {
                const F base = cosine(m.model, highlight[k]);
                Vec3T<F> mirrored = ks;
                F power;
                if (highlights_vary) {
                    // Anew for every light, which keeps memory of it out of the loops that most materials take.
                    const SurfacePoint<F> point = batch.point(k);
                    mirrored = ks * read_input<kUvSets>(m, TextureSlot::kSpecularColor, point).xyz();
                    const F scale = read_input<kUvSets>(m, TextureSlot::kSpecular, point).w;
                    power = m.input(TextureSlot::kSpecular).texture ? math::pow(max(base, zero), F(m.shininess) * scale)
                                                                    : power_cosine(base, exponent);
                } else {
                    power = power_cosine(base, exponent);
                }
                sum = sum + mirrored * (select(n_l[k] > zero, power, zero) * strength[k]) * arrives[k];
            }
            out[k].radiance = sum;
        }
    }
}

template <int kUvSets, class F, class Visible>
TESSERA_INLINE ShadedPoint<F> shade_microfacet(const ShadingContext& context, const MaterialView& m,
                                               const SurfacePoint<F>& s, int k, Visible&& visible) {
    const LobeParameters<F> p = evaluate_material<kUvSets>(m, s);
    Vec3T<F> radiance = p.emission + MetallicRoughnessLobe::reflect_ambient(p, context.ambient) * p.occlusion;
    for (int i = 0; i < context.light_count; ++i) {
        const LightSample<F> light = sample_light(context.lights[i], s.position);
        const auto arrives = visible(i, light, k);
        const Incidence<F> incidence{light.to_light, dot(p.normal, light.to_light)};
        radiance = radiance + MetallicRoughnessLobe::reflect(p, incidence) * light.irradiance * arrives;
    }
    return {radiance, p.alpha};
}

template <int kUvSets, class F>
TESSERA_INLINE ShadedPoint<F> shade_unlit(const ShadingContext& context, const MaterialView& m,
                                          const SurfacePoint<F>& s) {
    const Vec4T<F> base = base_color<kUvSets>(m, s);
    return {base.xyz() * F(context.unlit_scale), coverage_of_alpha(m, base.w)};
}

// For a material of the given family. `visible(light, sample, point)` gives the part of a light that arrives
// at a point of the batch, Unshadowed or a colour (shadows). Lights are summed in their order.
template <ShadingFamily kFamily, int kUvSets, class F, class Batch, class Visible>
TESSERA_INLINE void shade_as(const ShadingContext& context, const MaterialView& m, const Batch& batch,
                             Visible&& visible, ShadedPoint<F>* out) {
    if constexpr (kFamily == ShadingFamily::kTextbook) {
        shade_textbook<kUvSets>(context, m, batch, visible, out);
    } else {
        for (int k = 0; k < Batch::kCount; ++k) {
            if (!batch.used(k)) continue;
            ShadedPoint<F> c;
            if constexpr (kFamily == ShadingFamily::kUnlit)
                c = shade_unlit<kUvSets>(context, m, batch.point(k));
            else
                c = shade_microfacet<kUvSets>(context, m, batch.point(k), k, visible);
            out[k].radiance.x = c.radiance.x, out[k].radiance.y = c.radiance.y, out[k].radiance.z = c.radiance.z;
            out[k].alpha = c.alpha;
        }
    }
}

template <class F, class Visible>
TESSERA_INLINE ShadedPoint<F> shade(const ShadingContext& context, const MaterialView& m, const SurfacePoint<F>& s,
                                    Visible&& visible) {
    const BatchOfOne<F> one{s};
    const auto see = [&](int light, const LightSample<F>& sample, int) { return visible(light, sample); };
    ShadedPoint<F> c;
    switch (family_of(m.model)) {
        case ShadingFamily::kUnlit:
            shade_as<ShadingFamily::kUnlit, kMaxUvSets>(context, m, one, see, &c);
            break;
        case ShadingFamily::kTextbook:
            shade_as<ShadingFamily::kTextbook, kMaxUvSets>(context, m, one, see, &c);
            break;
        case ShadingFamily::kMicrofacet:
            shade_as<ShadingFamily::kMicrofacet, kMaxUvSets>(context, m, one, see, &c);
            break;
    }
    return c;
}

}  // namespace tessera
