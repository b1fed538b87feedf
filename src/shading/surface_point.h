// A point of a surface as shading reads it, and the last step towards it that every engine shares:
// from interpolated attributes to unit normals and the tangent frame. Camera space.
#pragma once

#include "geometry/draw_data.h"
#include "shading/texture.h"

namespace tessera {

// The attributes of one corner of a triangle, as the engine fetched them. Object space.
template <class F>
struct Corner {
    Vec3T<F> position, normal;
    Vec4T<F> tangent, color;
    Vec2T<F> uv[kMaxUvSets];
};

template <class F>
struct SurfacePoint {
    Vec3T<F> position;
    Vec3T<F> view;  // unit, towards the eye or the origin of the ray
    // Unit, on the viewer's side for two-sided surfaces. The geometric normal is set where a ray
    // starts from the point.
    Vec3T<F> geometric_normal, normal;
    Vec3T<F> tangent, bitangent;  // orthonormal with the normal (before it is turned)
    F side;                       // +1 front, -1 back
    Vec4T<F> color;
    Vec2T<F> uv[kMaxUvSets];
    Footprint<F> footprint[kMaxUvSets];
};

// Perspective-correct barycentric coordinates, and their change per pixel to the right and down.
template <class F>
struct Barycentrics {
    F b[3], ddx[3], ddy[3];
};

template <class F>
TESSERA_INLINE F interpolate(const F (&b)[3], F a0, F a1, F a2) {
    return b[0] * a0 + b[1] * a1 + b[2] * a2;
}

// The unit normal of the triangle itself, of its front.
template <class F>
TESSERA_INLINE Vec3T<F> geometric_normal(const InstanceView& instance, const Vec3T<F>& p0, const Vec3T<F>& p1,
                                         const Vec3T<F>& p2) {
    // Edges scaled so that their product neither overflows nor vanishes for tiny or huge meshes.
    const Vec3T<F> zero = Vec3T<F>::splat(F(0.0f));
    const Vec3T<F> e1 = normalize_or(p1 - p0, zero), e2 = normalize_or(p2 - p0, zero);
    const Vec3T<F> toward_eye{F(0.0f), F(0.0f), F(1.0f)};
    const Vec3T<F> front = cross(e1, e2) * F(instance.skin_side);
    return normalize_or(transform_normal(instance.normal_to_camera, front), toward_eye);
}

// Whether a normal has a direction at all.
template <class F>
TESSERA_INLINE MaskOf<F> has_direction(const Vec3T<F>& n) {
    const F squared = dot(n, n);
    return (squared > F(1e-37f)) & (squared < F(1e37f));
}

// Sets the tangent frame from a unit normal (before it is turned), an interpolated tangent and the
// sign of the bitangent.
template <class F>
TESSERA_INLINE void set_tangent_frame(SurfacePoint<F>& s, const Vec3T<F>& n, const Vec3T<F>& t, F sign) {
    // Any perpendicular of the normal serves where the tangent is missing or parallel to it.
    const auto steep = abs(n.x) > F(0.7f);
    const Vec3T<F> other{select(steep, F(0.0f), F(1.0f)), select(steep, F(1.0f), F(0.0f)), F(0.0f)};
    const Vec3T<F> toward_eye{F(0.0f), F(0.0f), F(1.0f)};
    const Vec3T<F> fallback = normalize_or(cross(other, n), toward_eye);
    // What is left of a tangent along the normal is rounding, and points anywhere.
    const Vec3T<F> across = t - n * dot(n, t);
    const auto usable = dot(across, across) > F(1e-6f) * dot(t, t);
    s.tangent = select3(usable, normalize_or(across, fallback), fallback);
    s.bitangent = cross(n, s.tangent) * sign;
}

// The surface point of a ray's hit anywhere on a triangle, from its barycentrics (primary visibility
// goes through surface_planes.h). `view` is the unit direction against the ray, `front` is +1 where the
// ray sees the front. `footprint_scale` shrinks the pixel's footprint to that of a sample.
template <class F>
TESSERA_INLINE SurfacePoint<F> surface_point(const InstanceView& instance, const Corner<F> (&c)[3],
                                             const Barycentrics<F>& bary, const Vec3T<F>& view, F front,
                                             float footprint_scale) {
    const auto& b = bary.b;
    SurfacePoint<F> s;
    s.view = view;
    s.side = front;
    const Vec3T<F> position = c[0].position * b[0] + c[1].position * b[1] + c[2].position * b[2];
    s.position = transform_point(instance.object_to_camera, position);
    const Vec3T<F> ng = geometric_normal(instance, c[0].position, c[1].position, c[2].position);
    const Vec3T<F> n = normalize_or(
        transform_normal(instance.normal_to_camera, c[0].normal * b[0] + c[1].normal * b[1] + c[2].normal * b[2]), ng);
    s.geometric_normal = ng * front;
    s.normal = n * front;

    const Vec3T<F> zero = Vec3T<F>::splat(F(0.0f));
    s.tangent = s.bitangent = zero;
    if (instance.mesh.tangents) {
        const Vec3T<F> t =
            transform_direction(instance.object_to_camera,
                                c[0].tangent.xyz() * b[0] + c[1].tangent.xyz() * b[1] + c[2].tangent.xyz() * b[2]);
        set_tangent_frame(s, n, t, c[0].tangent.w * F(instance.handedness));
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

}  // namespace tessera
