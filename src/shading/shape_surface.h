// Surface points of spheres and discs by their formula, over the number type: what transport.h and surface_planes.h are
// to triangles. Everything that draws an exact shape goes through shape_surface(). Rays in camera space.
#pragma once

#include "shading/label_point.h"
#include "shading/transport.h"

namespace tessera {

// The name of the hit of a ray that leaves a sphere, among the triangles that stand for it; of other hits it is 0.
inline constexpr std::uint32_t kLeavingSphere = 1;

// Where a ray meets a shape, in object space.
template <class F>
struct ShapeHit {
    F t;                                 // along the ray
    Vec3T<F> position, normal;           // normal: unit, of the front
    Vec3T<F> along_u, u_slope, v_slope;  // a direction of growing u; what u and v gain per unit of length
    Vec2T<F> uv;
};

// The sphere by its point nearest to the ray, which keeps precision far away (Haines, Guenther and Akenine-Moeller
// 2019, "Precision improvements for ray/sphere intersection"). A ray that just misses touches the nearest point.
template <class F>
TESSERA_INLINE ShapeHit<F> hit_sphere(const Vec3T<F>& o, const Vec3T<F>& d, F radius, const MaskOf<F>& leaving) {
    const F zero(0.0f), one(1.0f), inverse = one / dot(d, d);
    F nearest = -(dot(o, d) * inverse);
    Vec3T<F> q = o + d * nearest;
    const F rest = dot(q, d) * inverse;  // what rounding left along the ray
    nearest = nearest - rest;
    q = q - d * rest;
    const F half = sqrt(max(radius * radius - dot(q, q), zero) * inverse), step = select(leaving, half, -half);
    ShapeHit<F> hit;
    hit.t = max(nearest + step, zero);
    const Vec3T<F> n = hit.normal = normalize_or(q + d * step, {zero, one, zero});
    hit.position = n * radius;
    constexpr float kTurn = 0.15915494f, kHalfTurn = 0.31830989f;  // 1 / 2 pi, 1 / pi
    const F off_axis = sqrt(n.x * n.x + n.z * n.z);
    hit.uv = {F(0.5f) + math::atan2(n.x, n.z) * F(kTurn), min(math::atan2(off_axis, n.y) * F(kHalfTurn), one)};
    hit.along_u = {n.z, zero, -n.x};
    const F inverse_radius = one / radius, across = inverse_radius / max(off_axis, F(1e-4f));
    hit.u_slope = hit.along_u * (F(kTurn) * across / max(off_axis, F(1e-4f)));
    hit.v_slope = Vec3T<F>{n.x * n.y, -(off_axis * off_axis), n.z * n.y} * (F(kHalfTurn) * across);
    return hit;
}

// The disc, whose plane is y = 0. A ray that just misses meets the rim.
template <class F>
TESSERA_INLINE ShapeHit<F> hit_disc(const Vec3T<F>& o, const Vec3T<F>& d, F radius) {
    const F zero(0.0f), one(1.0f), half(0.5f);
    const auto level = d.y == zero;
    ShapeHit<F> hit;
    hit.t = max(select(level, zero, -o.y / select(level, one, d.y)), zero);
    hit.position = {o.x + d.x * hit.t, zero, o.z + d.z * hit.t};
    const F far = sqrt(hit.position.x * hit.position.x + hit.position.z * hit.position.z);
    hit.position = hit.position * select(far > radius, radius / max(far, radius), one);
    hit.normal = {zero, one, zero};
    const F scale = half / radius;
    hit.uv = {half + hit.position.x * scale, half + hit.position.z * scale};
    hit.along_u = {one, zero, zero};
    hit.u_slope = {scale, zero, zero};
    hit.v_slope = {zero, zero, scale};
    return hit;
}

template <class F>
TESSERA_INLINE ShapeHit<F> hit_shape(const ShapeView& shape, const ConeRay<F>& ray, const MaskOf<F>& leaving) {
    const Vec3T<F> o = transform_point(shape.camera_to_object, ray.origin),
                   d = transform_direction(shape.camera_to_object, ray.direction);
    if (shape.kind == ShapeView::Kind::kDisc) return hit_disc(o, d, F(shape.radius));
    return hit_sphere(o, d, F(shape.radius), leaving);
}

// The surface point of a ray's hit on the instance's shape, and how far the ray came. `leaving`: out of a sphere.
// `footprint_scale` shrinks the footprint, that of the ray's cone, to a sample's.
template <class F>
TESSERA_INLINE RaySurface<F> shape_surface(const InstanceView& instance, const ConeRay<F>& ray,
                                           const MaskOf<F>& leaving, float spread, float footprint_scale) {
    const F zero(0.0f), one(1.0f);
    const ShapeView& shape = instance.shape;
    const ShapeHit<F> hit = hit_shape(shape, ray, leaving);
    RaySurface<F> out;
    out.distance = hit.t;
    out.width = ray.width + F(spread) * hit.t;
    SurfacePoint<F>& s = out.point;
    const Vec3T<F> toward_eye{zero, zero, one};
    const Vec3T<F> ng = normalize_or(transform_normal(instance.normal_to_camera, hit.normal), toward_eye);
    s.side = shape.kind == ShapeView::Kind::kSphere ? select(leaving, -one, one)
                                                    : select(dot(ng, ray.direction) > zero, -one, one);
    s.position = transform_point(instance.object_to_camera, hit.position);
    s.view = -ray.direction;
    s.geometric_normal = s.normal = ng * s.side;
    s.tangent = s.bitangent = Vec3T<F>::splat(zero);
    if (instance.mesh.tangents)
        set_tangent_frame(s, ng, transform_direction(instance.object_to_camera, hit.along_u),
                          F(instance.mesh.tangents[3] * instance.handedness));
    s.color = {one, one, one, one};
    for (int set = 1; set < kMaxUvSets; ++set) {
        s.uv[set] = {zero, zero};
        s.footprint[set] = {zero, zero, zero, zero};
    }
    s.uv[0] = hit.uv;
    // The footprint is an ellipse: across the ray, and along its projection on the surface.
    const Vec3T<F> sideways = normalize_or(cross(ng, ray.direction), {one, zero, zero});
    const F stretch = one / max(abs(dot(ng, ray.direction)), F(1e-3f)), width = out.width * F(footprint_scale);
    const Vec3T<F> a = transform_direction(shape.camera_to_object, sideways * width),
                   b = transform_direction(shape.camera_to_object, cross(sideways, ng) * (width * stretch));
    s.footprint[0] = {dot(hit.u_slope, a), dot(hit.v_slope, a), dot(hit.u_slope, b), dot(hit.v_slope, b)};
    return out;
}

// The camera's ray through a picture position; its cone is as wide as a pixel.
template <class F>
TESSERA_INLINE ConeRay<F> picture_ray(const ProjectionView& projection, const PictureRays& rays, F x, F y) {
    const F zero(0.0f), one(1.0f);
    const EyeDirection<F> eye(rays, x, y);
    if (rays.orthographic) return {eye.position(true, zero), {zero, zero, -one}, F(pixel_width(projection))};
    return {Vec3T<F>::splat(zero), -eye.view(false, eye.view_z()), zero};
}

// The canonical depth of a point in camera space.
TESSERA_INLINE float depth_of(const ProjectionView& projection, const Vec3T<float>& position) {
    const ClipVertex<float> clip = to_clip(projection.clip_from_camera, position);
    return clip.z / clip.w;
}

// What labels say of a shape at a picture position, where its canonical depth is known.
inline LabelPoint<float> shape_label(const SurfaceLabels& labels, const InstanceView& instance,
                                     const MaterialView& material, const ProjectionView& projection,
                                     const float* label_from_camera, bool leaving, float depth, SamplePosition at) {
    const PictureRays rays(projection);
    const float x = static_cast<float>(at.x), y = static_cast<float>(at.y);
    SurfacePoint<float> s =
        shape_surface<float>(instance, picture_ray(projection, rays, x, y), leaving, picture_spread(projection), 1.0f)
            .point;
    s.position = position_of_depth(projection, rays, depth, x, y);
    return label_point(labels, label_layout(instance.mesh, material, labels, projection.orthographic), material,
                       label_from_camera, s);
}

}  // namespace tessera
