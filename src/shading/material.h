// The material interface: one place where every texture input is read and every material becomes
// the parameters of its lobes. A batch of surface points shares one material, so its factors are
// uniform and everything that varies is of the number type.
#pragma once

#include <tessera/shading_model.h>

#include "geometry/draw_data.h"
#include "shading/surface.h"
#include "shading/texture.h"

namespace tessera {

struct TextureInput {
    const TextureView* texture;  // null: the factor alone
    std::int32_t uv_set;
    float transform[6];  // rows of the 2x3 matrix on (u, v, 1)
};

struct MaterialView {
    ShadingModel model;
    AlphaMode alpha_mode;
    bool double_sided;
    float alpha_cutoff;
    float base_color[4];
    float metallic, roughness, normal_scale, occlusion_strength;
    float emission[3];                          // strength included
    float ambient[3], diffuse[3], specular[3];  // ka, kd, ks
    float shininess;
    TextureInput inputs[kTextureSlots];

    TESSERA_INLINE const TextureInput& input(TextureSlot slot) const { return inputs[static_cast<int>(slot)]; }
};

// The attributes of one corner of the triangle, as the engine fetched them.
template <class F>
struct Corner {
    Vec3T<F> position, normal;
    Vec4T<F> tangent, color;
    Vec2T<F> uv[kMaxUvSets];
};

// A point of a surface in camera space.
template <class F>
struct SurfacePoint {
    Vec3T<F> position;
    Vec3T<F> geometric_normal, normal;  // unit, on the viewer's side for two-sided surfaces
    Vec3T<F> tangent, bitangent;        // orthonormal with the normal (before it is turned)
    F side;                             // +1 front, -1 back
    Vec4T<F> color;
    Vec2T<F> uv[kMaxUvSets];
    Footprint<F> footprint[kMaxUvSets];
};

// From barycentrics and corners to the surface point. `front` is +1 where the viewer sees the front.
// `footprint_scale` shrinks the pixel's footprint to that of a sample.
template <class F>
TESSERA_INLINE SurfacePoint<F> surface_point(const InstanceView& instance, const Corner<F> (&c)[3],
                                             const Barycentrics<F>& bary, F front, float footprint_scale) {
    const auto& b = bary.b;
    SurfacePoint<F> s;
    s.side = front;
    const Vec3T<F> position = c[0].position * b[0] + c[1].position * b[1] + c[2].position * b[2];
    s.position = transform_point(instance.object_to_camera, position);

    // Edges scaled so that their product neither overflows nor vanishes for tiny or huge meshes.
    const Vec3T<F> zero = Vec3T<F>::splat(F(0.0f));
    const Vec3T<F> e1 = normalize_or(c[1].position - c[0].position, zero);
    const Vec3T<F> e2 = normalize_or(c[2].position - c[0].position, zero);
    const Vec3T<F> toward_eye{F(0.0f), F(0.0f), F(1.0f)};
    const Vec3T<F> ng = normalize_or(transform_normal(instance.normal_to_camera, cross(e1, e2)), toward_eye);
    const Vec3T<F> n = normalize_or(
        transform_normal(instance.normal_to_camera, c[0].normal * b[0] + c[1].normal * b[1] + c[2].normal * b[2]), ng);
    s.geometric_normal = ng * front;
    s.normal = n * front;

    if (instance.mesh.tangents) {
        const Vec3T<F> t =
            transform_direction(instance.object_to_camera,
                                c[0].tangent.xyz() * b[0] + c[1].tangent.xyz() * b[1] + c[2].tangent.xyz() * b[2]);
        // Any perpendicular of the normal serves where the tangent is missing or parallel to it.
        const auto steep = abs(n.x) > F(0.7f);
        const Vec3T<F> other{select(steep, F(0.0f), F(1.0f)), select(steep, F(1.0f), F(0.0f)), F(0.0f)};
        const Vec3T<F> fallback = normalize_or(cross(other, n), toward_eye);
        // What is left of a tangent along the normal is rounding, and points anywhere.
        const Vec3T<F> across = t - n * dot(n, t);
        const auto usable = dot(across, across) > F(1e-6f) * dot(t, t);
        s.tangent = select3(usable, normalize_or(across, fallback), fallback);
        s.bitangent = cross(n, s.tangent) * (c[0].tangent.w * F(instance.handedness));
    } else {
        s.tangent = s.bitangent = zero;
    }
    if (instance.mesh.colors) {
        s.color = {interpolate(b, c[0].color.x, c[1].color.x, c[2].color.x),
                   interpolate(b, c[0].color.y, c[1].color.y, c[2].color.y),
                   interpolate(b, c[0].color.z, c[1].color.z, c[2].color.z),
                   interpolate(b, c[0].color.w, c[1].color.w, c[2].color.w)};
    } else {
        s.color = {F(1.0f), F(1.0f), F(1.0f), F(1.0f)};
    }
    const F scale(footprint_scale);
    for (int i = 0; i < kMaxUvSets; ++i) {
        if (!instance.mesh.uvs[i]) {
            s.uv[i] = {F(0.0f), F(0.0f)};
            s.footprint[i] = {F(0.0f), F(0.0f), F(0.0f), F(0.0f)};
            continue;
        }
        const Vec2T<F>&u0 = c[0].uv[i], &u1 = c[1].uv[i], &u2 = c[2].uv[i];
        s.uv[i] = {interpolate(b, u0.x, u1.x, u2.x), interpolate(b, u0.y, u1.y, u2.y)};
        s.footprint[i] = {
            interpolate(bary.ddx, u0.x, u1.x, u2.x) * scale, interpolate(bary.ddx, u0.y, u1.y, u2.y) * scale,
            interpolate(bary.ddy, u0.x, u1.x, u2.x) * scale, interpolate(bary.ddy, u0.y, u1.y, u2.y) * scale};
    }
    return s;
}

// The value of a texture input at a point; white where the material has none.
template <class F>
TESSERA_INLINE Vec4T<F> read_input(const MaterialView& m, TextureSlot slot, const SurfacePoint<F>& s) {
    const TextureInput& in = m.input(slot);
    if (!in.texture) return {F(1.0f), F(1.0f), F(1.0f), F(1.0f)};
    const float* r = in.transform;
    const Vec2T<F>& uv = s.uv[in.uv_set];
    const Footprint<F>& d = s.footprint[in.uv_set];
    const Footprint<F> footprint{d.ux * F(r[0]) + d.vx * F(r[1]), d.ux * F(r[3]) + d.vx * F(r[4]),
                                 d.uy * F(r[0]) + d.vy * F(r[1]), d.uy * F(r[3]) + d.vy * F(r[4])};
    return sample_texture(*in.texture, uv.x * F(r[0]) + uv.y * F(r[1]) + F(r[2]),
                          uv.x * F(r[3]) + uv.y * F(r[4]) + F(r[5]), footprint);
}

// Base colour and alpha: factor, texture and vertex colour.
template <class F>
TESSERA_INLINE Vec4T<F> base_color(const MaterialView& m, const SurfacePoint<F>& s) {
    const Vec4T<F> factor{F(m.base_color[0]), F(m.base_color[1]), F(m.base_color[2]), F(m.base_color[3])};
    return factor * read_input(m, TextureSlot::kBaseColor, s) * s.color;
}

// Alpha as the alpha mode sees it: 1 for opaque materials, 0 or 1 for cut-outs.
template <class F>
TESSERA_INLINE F coverage_of_alpha(const MaterialView& m, F alpha) {
    if (m.alpha_mode == AlphaMode::kOpaque) return F(1.0f);
    if (m.alpha_mode == AlphaMode::kMask) return select(alpha >= F(m.alpha_cutoff), F(1.0f), F(0.0f));
    return saturate(alpha);
}

// What the lobes need to know of the material at a point.
template <class F>
struct LobeParameters {
    Vec3T<F> normal, view;  // unit; the view direction points to the eye
    Vec3T<F> base;          // base colour, or the factor on ka and kd
    Vec3T<F> emission;
    F alpha, metallic, roughness, occlusion;
};

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

template <class F>
TESSERA_INLINE LobeParameters<F> evaluate_material(const MaterialView& m, const SurfacePoint<F>& s,
                                                   const Vec3T<F>& view) {
    LobeParameters<F> p;
    const Vec4T<F> base = base_color(m, s);
    p.base = base.xyz();
    p.alpha = coverage_of_alpha(m, base.w);
    p.view = view;
    p.normal = shading_normal(m, s);
    p.emission = Vec3T<F>::load(m.emission) * read_input(m, TextureSlot::kEmissive, s).xyz();
    const Vec4T<F> mr = read_input(m, TextureSlot::kMetallicRoughness, s);
    p.metallic = saturate(F(m.metallic) * mr.z);
    p.roughness = saturate(F(m.roughness) * mr.y);
    const F occlusion = read_input(m, TextureSlot::kOcclusion, s).x;
    p.occlusion = F(1.0f) + F(m.occlusion_strength) * (occlusion - F(1.0f));
    return p;
}

}  // namespace tessera
