// Light along rays, over the number type: where rays start, how they are mirrored and refracted, what a medium takes of
// them, and the surface point that a ray anywhere hits. Shared by the ray tracer and its reference. Camera space.
#pragma once

#include "shading/light.h"
#include "shading/surface_point.h"
#include "simd/math.h"

namespace tessera {

// What a ray starts away from its surface, relative to the size of the coordinates: their rounding, that of the
// matrices and that of the intersection test, with room to spare.
inline constexpr float kRayOffset = 4e-6f;

// Of all that counts for a point's rounding: the largest coordinate of its instance in camera space, or its own.
template <class F>
TESSERA_INLINE F coordinate_size(const Vec3T<F>& p, F instance_size) {
    return max(max(abs(p.x), abs(p.y)), max(abs(p.z), instance_size));
}

// The origin of a ray that leaves the surface at `p` in a direction: on that side of the surface, whose normal is `ng`.
template <class F>
TESSERA_INLINE Vec3T<F> ray_origin(const Vec3T<F>& p, const Vec3T<F>& ng, const Vec3T<F>& direction, F size) {
    const F step = size * F(kRayOffset);
    return p + ng * select(dot(ng, direction) < F(0.0f), -step, step);
}

// The point moved along the normal onto the plane of its triangle, which goes through `on_plane` = dot(ng, vertex).
template <class F>
TESSERA_INLINE Vec3T<F> onto_plane(const Vec3T<F>& p, const Vec3T<F>& ng, F on_plane) {
    return p - ng * (dot(ng, p) - on_plane);
}

// Turns a point to the side from which it is seen, whatever snapping made of its triangle: `ng` is the normal of the
// front.
template <class F>
TESSERA_INLINE void turn_to_viewer(SurfacePoint<F>& s, const Vec3T<F>& ng) {
    const F side = select(dot(ng, s.view) < F(0.0f), F(-1.0f), F(1.0f));
    s.normal = s.normal * (side * s.side);
    s.side = side;
    s.geometric_normal = ng * side;
}

// A direction that points to the side of `ng` at least a little (bent normals may turn it into the surface).
template <class F>
TESSERA_INLINE Vec3T<F> kept_above(const Vec3T<F>& d, const Vec3T<F>& ng) {
    constexpr float kLeast = 1e-3f;
    const F height = dot(d, ng);
    const auto below = height < F(kLeast);
    if (!any(below)) return d;
    return select3(below, normalize_or(d + ng * (F(kLeast) - height), ng), d);
}

template <class F>
TESSERA_INLINE Vec3T<F> mirrored(const Vec3T<F>& view, const Vec3T<F>& normal, const Vec3T<F>& ng) {
    return kept_above(normal * (F(2.0f) * dot(normal, view)) - view, ng);
}

// Snell's law and Fresnel's equations at a smooth boundary between dielectrics. `eta` = n1 / n2 of the indices on the
// viewer's side and behind the surface (Born and Wolf, Principles of Optics, section 1.5).
template <class F>
struct Refraction {
    Vec3T<F> direction;
    F reflected;  // part of unpolarised light; 1 where it is reflected totally
};
template <class F>
TESSERA_INLINE Refraction<F> refracted(const Vec3T<F>& view, const Vec3T<F>& normal, const Vec3T<F>& ng, F eta) {
    const F zero(0.0f), one(1.0f);
    const F c = saturate(dot(normal, view));
    const F k = (one - eta * eta) + (eta * eta) * (c * c);
    const F t = sqrt(max(k, zero));
    const F across = (eta * c - t) / (eta * c + t), along = (c - eta * t) / (c + eta * t);
    const F part = F(0.5f) * (across * across + along * along);
    const Vec3T<F> straight = normal * (eta * c - t) - view * eta;
    Refraction<F> r;
    // A vanishing cosine gives 0 / 0 where the indices are equal, and then nothing is mirrored.
    r.reflected = select(k > zero, select(part == part, min(part, one), zero), select(eta > one, one, zero));
    r.direction = kept_above(normalize_or(straight, -view), -ng);
    return r;
}

// What is left of light after a way through a medium (Beer's law).
template <class F>
TESSERA_INLINE Vec3T<F> transmittance(const Vec3T<F>& absorption, F distance) {
    return {math::exp(-(absorption.x * distance)), math::exp(-(absorption.y * distance)),
            math::exp(-(absorption.z * distance))};
}

// How wide a pixel is at distance 1 along the view axis, or everywhere without perspective; and what the cone of a
// camera's ray gains with distance.
inline float pixel_width(const ProjectionView& picture) { return 2.0f / (picture.height * picture.scale_y); }
inline float picture_spread(const ProjectionView& picture) {
    return picture.orthographic ? 0.0f : pixel_width(picture);
}

// --- hits of rays anywhere ----------------------------------------------------------------------

// A ray in camera space whose footprint is a cone: its width at the origin, and what it gains per unit of length
// (Amanatides 1984, "Ray tracing with cones").
template <class F>
struct ConeRay {
    Vec3T<F> origin, direction;  // unit
    F width;
};

// Where the ray meets the plane of a triangle given in camera space: barycentrics kept within it, distance, and the
// change of the barycentrics over the footprint, which is an ellipse across the ray's projection and along it.
template <class F>
struct RayPoint {
    Barycentrics<F> barycentrics;
    F distance, width;  // of the cone there
};
template <class F>
TESSERA_INLINE RayPoint<F> ray_point(const ConeRay<F>& ray, const Vec3T<F> (&v)[3], const Vec3T<F>& ng, float spread) {
    const F zero(0.0f), one(1.0f);
    // Moeller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection".
    const Vec3T<F> e1 = v[1] - v[0], e2 = v[2] - v[0], from = ray.origin - v[0];
    const Vec3T<F> p = cross(ray.direction, e2), q = cross(from, e1);
    const F det = dot(e1, p);
    const auto flat = det == zero;
    const F inverse = one / select(flat, one, det);
    const F b1 = saturate(dot(from, p) * inverse), b2 = min(saturate(dot(ray.direction, q) * inverse), one - b1);
    RayPoint<F> r;
    r.barycentrics.b[0] = (one - b1) - b2, r.barycentrics.b[1] = b1, r.barycentrics.b[2] = b2;
    r.distance = max(select(flat, zero, dot(e2, q) * inverse), zero);
    r.width = ray.width + F(spread) * r.distance;
    // b1 and b2 are linear over the plane: their gradients are the edges turned by 90 degrees.
    const Vec3T<F> n = cross(e1, e2);
    const F area = dot(n, n);
    const F scale = select(area > zero, r.width / select(area > zero, area, one), zero);
    const Vec3T<F> g1 = cross(e2, n) * scale, g2 = cross(n, e1) * scale;
    const Vec3T<F> sideways = normalize_or(cross(ng, ray.direction), {one, zero, zero});
    const Vec3T<F> forward = cross(sideways, ng) * (one / max(abs(dot(ng, ray.direction)), F(1e-3f)));
    const F x1 = dot(g1, sideways), x2 = dot(g2, sideways), y1 = dot(g1, forward), y2 = dot(g2, forward);
    auto& bary = r.barycentrics;
    bary.ddx[0] = -(x1 + x2), bary.ddx[1] = x1, bary.ddx[2] = x2;
    bary.ddy[0] = -(y1 + y2), bary.ddy[1] = y1, bary.ddy[2] = y2;
    return r;
}

// The surface point of a hit on the triangle with these corners, and how far the ray came.
template <class F>
struct RaySurface {
    SurfacePoint<F> point;
    F distance, width;
};
template <class F>
TESSERA_INLINE RaySurface<F> ray_surface(const InstanceView& instance, const Corner<F> (&c)[3], const ConeRay<F>& ray,
                                         float spread, float footprint_scale) {
    Vec3T<F> v[3];
    for (int i = 0; i < 3; ++i) v[i] = transform_point(instance.object_to_camera, c[i].position);
    const Vec3T<F> ng = geometric_normal(instance, c[0].position, c[1].position, c[2].position);
    const F one(1.0f);
    const F front = select(dot(ng, ray.direction) > F(0.0f), -one, one);
    const RayPoint<F> at = ray_point(ray, v, ng, spread);
    return {surface_point(instance, c, at.barycentrics, -ray.direction, front, footprint_scale), at.distance, at.width};
}

}  // namespace tessera
