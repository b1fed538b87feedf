// What labels say of a surface at a picture position: normals, texture coordinates, position, albedo. The
// surface is that of surface_planes.h, with the planes that the wanted labels need instead of the material's.
// Normals and positions go through a matrix out of camera space; a label that is no number is 0.
#pragma once

#include "shading/surface_planes.h"

namespace tessera {

// Which ones are wanted.
struct SurfaceLabels {
    bool normal = false;          // as interpolated over the triangle
    bool shading_normal = false;  // bent by the normal map
    bool uv = false;              // the first set, as the mesh has it
    bool position = false;
    bool albedo = false;

    TESSERA_INLINE bool any() const { return normal || shading_normal || uv || position || albedo; }
    // Whether the material has a say.
    TESSERA_INLINE bool of_material() const { return shading_normal || albedo; }
};

TESSERA_INLINE SurfaceLayout label_layout(const MeshView& mesh, const MaterialView& material,
                                          const SurfaceLabels& labels, bool orthographic) {
    SurfaceLayout l;
    const auto add = [&l](int numbers) {
        const int first = l.count;
        l.count += numbers;
        return first;
    };
    const bool bent =
        labels.shading_normal && mesh.normals && mesh.tangents && material.input(TextureSlot::kNormal).texture;
    if ((labels.normal || labels.shading_normal) && mesh.normals) l.normal = add(3);  // else towards the eye
    if (bent) l.tangent = add(3);
    for (int set = 0; set < kMaxUvSets; ++set) {
        bool used = labels.uv && set == 0;
        for (int slot = 0; slot < static_cast<int>(kTextureSlots); ++slot) {
            const TextureInput& in = material.inputs[slot];
            if (in.texture && in.uv_set == set)
                used |= labels.albedo || (bent && static_cast<TextureSlot>(slot) == TextureSlot::kNormal);
        }
        if (used && mesh.uvs[set]) l.uv[set] = add(2);
    }
    if (labels.albedo && mesh.colors) l.color = add(4);
    if (orthographic) l.depth = add(1);
    return l;
}

// The part of the arriving light that the surface would scatter, were it matt: base colour, kd or diffuse colour with
// texture and vertex colour.
template <class F>
TESSERA_INLINE Vec3T<F> albedo(const MaterialView& m, const SurfacePoint<F>& s) {
    switch (m.model) {
        case ShadingModel::kLambert:
        case ShadingModel::kPhong:
        case ShadingModel::kBlinnPhong:
            return Vec3T<F>::load(m.diffuse) * surface_color(m, s).xyz();
        case ShadingModel::kSpecularGlossiness:
            return evaluate_material(m, s).base;  // less what is mirrored
        case ShadingModel::kMetallicRoughness:
        case ShadingModel::kUnlit:
            break;
    }
    return base_color(m, s).xyz();
}

template <class F>
struct LabelPoint {
    Vec3T<F> normal, shading_normal, position, albedo;
    Vec2T<F> uv;
};

// `label_from_camera` are the 3x4 rows of a rigid matrix.
template <class F>
TESSERA_INLINE LabelPoint<F> label_point(const SurfaceLabels& labels, const SurfaceLayout& l, const MaterialView& m,
                                         const float* label_from_camera, const SurfacePoint<F>& s) {
    const auto numbers = [](const Vec3T<F>& v) {
        const F zero(0.0f);
        return Vec3T<F>{select(v.x == v.x, v.x, zero), select(v.y == v.y, v.y, zero), select(v.z == v.z, v.z, zero)};
    };
    const Vec3T<F> none = Vec3T<F>::splat(F(0.0f));
    LabelPoint<F> out{none, none, none, none, {none.x, none.y}};
    if (labels.normal) out.normal = numbers(transform_direction(label_from_camera, s.normal));
    if (labels.shading_normal)
        out.shading_normal =
            numbers(transform_direction(label_from_camera, l.tangent >= 0 ? shading_normal(m, s) : s.normal));
    if (labels.position) out.position = numbers(transform_point(label_from_camera, s.position));
    if (labels.albedo) out.albedo = numbers(albedo(m, s));
    if (labels.uv) {
        const Vec3T<F> uv = numbers({s.uv[0].x, s.uv[0].y, none.x});
        out.uv = {uv.x, uv.y};
    }
    return out;
}

// Where in camera space the surface of a reversed depth is: the position that agrees with the label of depth.
template <class F>
TESSERA_INLINE Vec3T<F> position_of_depth(const ProjectionView& p, const PictureRays& rays, F depth, F x, F y) {
    return EyeDirection<F>(rays, x, y).position(rays.orthographic, -distance_of_depth(p, depth));
}

// The distance to the eye of what is `distance` away along the view axis, at a picture position.
template <class F>
TESSERA_INLINE F euclidean_distance(const PictureRays& rays, F distance, F x, F y) {
    if (rays.orthographic) return distance;
    const EyeDirection<F> eye(rays, x, y);
    return distance * sqrt(eye.x * eye.x + eye.y * eye.y + F(1.0f));
}

}  // namespace tessera
