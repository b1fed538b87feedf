// The material interface: one place where every texture input is read and every material becomes
// the parameters of its lobes. A batch of surface points shares one material, so its factors are
// uniform and everything that varies is of the number type.
#pragma once

#include <tessera/shading_model.h>

#include "geometry/draw_data.h"
#include "shading/surface_point.h"

namespace tessera {

struct TextureInput {
    const TextureView* texture;  // null: the factor alone
    std::int32_t uv_set;
    float transform[6];  // rows of the 2x3 matrix on (u, v, 1)
    bool plain = false;  // that is the identity, and left out
};

struct MaterialView {
    ShadingModel model;
    AlphaMode alpha_mode;
    bool double_sided;
    float alpha_cutoff;
    float base_color[4];
    float metallic, roughness, normal_scale, occlusion_strength;
    float dielectric[3] = {0.04f, 0.04f, 0.04f}, dielectric_edge = 1;  // reflectance of no metal, ahead and grazing
    float reflectance[3] = {0.04f, 0.04f, 0.04f};  // ahead, before the strength and the limit of 1: for textures
    float emission[3];                             // strength included
    float ambient[3], diffuse[3], specular[3];     // ka, kd, ks
    float shininess;
    // Of traced light: kr of the textbooks; the part that enters instead of being scattered, and how it goes on.
    float mirror[3] = {0, 0, 0}, transmission = 0;
    float tint[3] = {1, 1, 1};        // of what enters, of the textbooks' materials
    bool thin = true;                 // light that enters leaves at once, as through a pane
    float ior[3] = {1, 1, 1};         // for red, green and blue
    float absorption[3] = {0, 0, 0};  // per metre within
    int priority = 0;                 // of overlapping media the highest one fills the space
    TextureInput inputs[kTextureSlots];

    TESSERA_INLINE const TextureInput& input(TextureSlot slot) const { return inputs[static_cast<int>(slot)]; }
};

// The value of a texture input at a point; white where the material has none. Here and below
// kUvSets is how many sets of texture coordinates the material's inputs may name, 0 where it has no
// texture at all: the same bits, less code.
template <int kUvSets = kMaxUvSets, class F>
TESSERA_INLINE Vec4T<F> read_input(const MaterialView& m, TextureSlot slot, const SurfacePoint<F>& s) {
    const TextureInput& in = m.input(slot);
    if (kUvSets == 0 || !in.texture) return {F(1.0f), F(1.0f), F(1.0f), F(1.0f)};
    const float* r = in.transform;
    // By comparison: an index would make the compiler read every set from memory.
    Vec2T<F> uv = s.uv[0];
    Footprint<F> d = s.footprint[0];
    for (int set = 1; set < kUvSets; ++set) {
        if (in.uv_set != set) continue;
        uv = s.uv[set];
        d = s.footprint[set];
    }
    if (!in.plain) {
        uv = {uv.x * F(r[0]) + uv.y * F(r[1]) + F(r[2]), uv.x * F(r[3]) + uv.y * F(r[4]) + F(r[5])};
        d = {d.ux * F(r[0]) + d.vx * F(r[1]), d.ux * F(r[3]) + d.vx * F(r[4]), d.uy * F(r[0]) + d.vy * F(r[1]),
             d.uy * F(r[3]) + d.vy * F(r[4])};
    }
    return sample_texture(*in.texture, uv.x, uv.y, d);
}

// Few materials have textures of what they mirror. Only the code for all sets of texture coordinates reads them,
// so that the others pay nothing.
template <int kUvSets>
inline constexpr bool kReadsSpecular = kUvSets == kMaxUvSets;
TESSERA_INLINE bool has_specular_texture(const MaterialView& m) {
    return m.input(TextureSlot::kSpecular).texture || m.input(TextureSlot::kSpecularColor).texture;
}

// Colour and alpha of the surface itself: texture and vertex colour.
template <int kUvSets = kMaxUvSets, class F>
TESSERA_INLINE Vec4T<F> surface_color(const MaterialView& m, const SurfacePoint<F>& s) {
    return read_input<kUvSets>(m, TextureSlot::kBaseColor, s) * s.color;
}
// The same with the material's factor: the base colour of metallic-roughness and unlit.
template <int kUvSets = kMaxUvSets, class F>
TESSERA_INLINE Vec4T<F> base_color(const MaterialView& m, const SurfacePoint<F>& s) {
    const Vec4T<F> factor{F(m.base_color[0]), F(m.base_color[1]), F(m.base_color[2]), F(m.base_color[3])};
    return factor * surface_color<kUvSets>(m, s);
}

// 1 where nothing is in the way of ambient light.
template <int kUvSets, class F>
TESSERA_INLINE F occlusion(const MaterialView& m, const SurfacePoint<F>& s) {
    return F(1.0f) + F(m.occlusion_strength) * (read_input<kUvSets>(m, TextureSlot::kOcclusion, s).x - F(1.0f));
}

// The part of the light that enters the surface.
template <int kUvSets = kMaxUvSets, class F>
TESSERA_INLINE F transmission(const MaterialView& m, const SurfacePoint<F>& s) {
    return F(m.transmission) * read_input<kUvSets>(m, TextureSlot::kTransmission, s).x;
}

// Alpha as the alpha mode sees it: 1 for opaque materials, 0 or 1 for cut-outs.
template <class F>
TESSERA_INLINE F coverage_of_alpha(const MaterialView& m, F alpha) {
    if (m.alpha_mode == AlphaMode::kOpaque) return F(1.0f);
    if (m.alpha_mode == AlphaMode::kMask) return select(alpha >= F(m.alpha_cutoff), F(1.0f), F(0.0f));
    return saturate(alpha);
}

// The normal that shading takes: the surface's, bent by a normal map where there is one.
template <class F>
TESSERA_INLINE Vec3T<F> shading_normal(const MaterialView& m, const SurfacePoint<F>& s) {
    if (!m.input(TextureSlot::kNormal).texture) return s.normal;
    const Vec4T<F> texel = read_input(m, TextureSlot::kNormal, s);
    const F scale(m.normal_scale);
    const F x = (texel.x * F(2.0f) - F(1.0f)) * scale, y = (texel.y * F(2.0f) - F(1.0f)) * scale;
    const F z = texel.z * F(2.0f) - F(1.0f);
    // The tangent frame belongs to the front; seen from behind all of it is turned.
    return normalize_or((s.tangent * x + s.bitangent * y) * s.side + s.normal * z, s.normal);
}

// What the microfacets need to know of the material at a point.
template <class F>
struct LobeParameters {
    Vec3T<F> normal, view;  // unit; the view direction points to the eye
    F n_v;                  // their cosine, not clamped
    Vec3T<F> base, emission;
    Vec3T<F> f0;  // reflectance at normal incidence
    F f90;        // and at a grazing angle
    F alpha, metallic, roughness, occlusion;
};

// What is mirrored, where textures say so. KHR_materials_specular: the colour and the strength of a dielectric.
// KHR_materials_pbrSpecularGlossiness: the reflectance, which the diffuse part lacks, and the glossiness.
template <int kUvSets, class F>
TESSERA_INLINE void read_reflectance(const MaterialView& m, const SurfacePoint<F>& s, LobeParameters<F>& p) {
    const F one(1.0f);
    const Vec4T<F> color = read_input<kUvSets>(m, TextureSlot::kSpecularColor, s);
    const Vec3T<F> ahead{min(F(m.reflectance[0]) * color.x, one), min(F(m.reflectance[1]) * color.y, one),
                         min(F(m.reflectance[2]) * color.z, one)};
    if (m.model == ShadingModel::kSpecularGlossiness) {
        p.base = p.base * (one - max(max(ahead.x, ahead.y), ahead.z));
        p.roughness = saturate(one - (one - F(m.roughness)) * color.w);
        p.f0 = ahead;
        return;
    }
    const F strength = F(m.dielectric_edge) * read_input<kUvSets>(m, TextureSlot::kSpecular, s).w;
    p.f0 = mix(ahead * strength, p.base, p.metallic);
    p.f90 = strength + (one - strength) * p.metallic;
}

template <int kUvSets = kMaxUvSets, class F>
TESSERA_INLINE LobeParameters<F> evaluate_material(const MaterialView& m, const SurfacePoint<F>& s) {
    LobeParameters<F> p;
    // Number by number: g++ copies a whole Vec3T through memory.
    p.normal = {s.normal.x, s.normal.y, s.normal.z};
    p.view = {s.view.x, s.view.y, s.view.z};
    p.n_v = dot(p.normal, p.view);
    const Vec4T<F> base = base_color<kUvSets>(m, s), mr = read_input<kUvSets>(m, TextureSlot::kMetallicRoughness, s);
    p.base = base.xyz();
    p.alpha = coverage_of_alpha(m, base.w);
    p.metallic = saturate(F(m.metallic) * mr.z);
    p.roughness = saturate(F(m.roughness) * mr.y);
    p.f0 = mix(Vec3T<F>::load(m.dielectric), p.base, p.metallic);
    p.f90 = F(m.dielectric_edge) + (F(1.0f) - F(m.dielectric_edge)) * p.metallic;
    if (kReadsSpecular<kUvSets> && has_specular_texture(m)) read_reflectance<kUvSets>(m, s, p);
    p.emission = Vec3T<F>::load(m.emission) * read_input<kUvSets>(m, TextureSlot::kEmissive, s).xyz();
    p.occlusion = kUvSets > 0 ? occlusion<kUvSets>(m, s) : F(1.0f);
    return p;
}

}  // namespace tessera
