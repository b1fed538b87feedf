// THE surface function of primary visibility: from a triangle and a picture position to the surface
// point. What a vertex carries, divided by its w, is affine over the picture (Heckbert and Moreton
// 1991, "Interpolation for polygon texture mapping and shading"): one plane per number and triangle,
// through the snapped vertices, anchored at a point of the triangle. The planes of a triangle are made
// once (in lanes: one triangle each), and every sample needs them only. All engines use these formulas
// in this order, so equal (triangle, position) pairs give equal bits.
#pragma once

#include "shading/material.h"
#include "shading/surface.h"

namespace tessera {

// value / w at the anchor, and its change per 1/256 pixel right and down.
template <class F>
struct Plane {
    F at_anchor, ddx, ddy;

    TESSERA_INLINE F at(F dx, F dy) const { return (at_anchor + ddy * dy) + ddx * dx; }
};

// Which planes a triangle of an instance needs for its material: plane 0 is 1 / w; the others are
// where the members say, or absent (-1). `depth` is the distance along the view axis, which 1 / w says
// with perspective. Unlit surfaces have no normal, and without perspective no position.
struct SurfaceLayout {
    int count = 1;
    int normal = -1, tangent = -1, color = -1, depth = -1;
    int uv[kMaxUvSets] = {-1, -1, -1, -1};

    TESSERA_INLINE bool operator==(const SurfaceLayout& o) const {
        bool equal = count == o.count && normal == o.normal && tangent == o.tangent && color == o.color;
        for (int i = 0; i < kMaxUvSets; ++i) equal = equal && uv[i] == o.uv[i];
        return equal && depth == o.depth;
    }
};
inline constexpr int kMaxSurfacePlanes = 1 + 3 + 3 + 4 + 1 + 2 * kMaxUvSets;

// A triangle's planes in memory: a header of four floats (anchor x and y in 1/256 pixel, side, sign of
// the bitangent), then three floats per plane, padded to a multiple of four.
inline constexpr int kSurfaceHeader = 4;
inline constexpr int kMaxSurfaceFloats = (kSurfaceHeader + 3 * kMaxSurfacePlanes + 3) / 4 * 4;
TESSERA_INLINE constexpr int surface_floats(const SurfaceLayout& layout) {
    return (kSurfaceHeader + 3 * layout.count + 3) / 4 * 4;
}

TESSERA_INLINE SurfaceLayout surface_layout(const MeshView& mesh, const MaterialView& material, bool orthographic) {
    SurfaceLayout l;
    const auto add = [&l](int numbers) {
        const int first = l.count;
        l.count += numbers;
        return first;
    };
    const bool lit = material.model != ShadingModel::kUnlit;
    if (lit) l.normal = add(3);
    if (lit && mesh.tangents && material.input(TextureSlot::kNormal).texture) l.tangent = add(3);
    for (int set = 0; set < kMaxUvSets; ++set) {
        bool used = false;
        for (const TextureInput& in : material.inputs) used |= in.texture && in.uv_set == set;
        if (used && mesh.uvs[set]) l.uv[set] = add(2);
    }
    if (mesh.colors) l.color = add(4);
    if (lit && orthographic) l.depth = add(1);
    return l;
}

// Camera-space directions from picture positions to the eye: (x, y, 1) with perspective, minus the
// distance along the axis times that a position; without, the position's x and y with the sign turned.
struct PictureRays {
    float x_scale, x_offset, y_scale, y_offset;  // on positions in 1/256 pixel
    bool orthographic;

    TESSERA_INLINE explicit PictureRays(const ProjectionView& p) : orthographic(p.orthographic) {
        const float* m = p.clip_from_camera;
        const double mx = static_cast<double>(m[0]), my = static_cast<double>(m[5]);
        const double left = orthographic ? -1.0 - static_cast<double>(m[3]) : -1.0 + static_cast<double>(m[2]);
        const double top = orthographic ? 1.0 - static_cast<double>(m[7]) : 1.0 + static_cast<double>(m[6]);
        x_scale = static_cast<float>(-2.0 / (256.0 * static_cast<double>(p.width) * mx));
        x_offset = static_cast<float>(-left / mx);
        y_scale = static_cast<float>(2.0 / (256.0 * static_cast<double>(p.height) * my));
        y_offset = static_cast<float>(-top / my);
    }
};

// The direction to the eye that belongs to a picture position: (x, y, 1), or (x, y, 0) without perspective.
template <class F>
struct EyeDirection {
    F x, y;

    TESSERA_INLINE EyeDirection(const PictureRays& rays, F picture_x, F picture_y)
        : x(picture_x * F(rays.x_scale) + F(rays.x_offset)), y(picture_y * F(rays.y_scale) + F(rays.y_offset)) {}

    // The position there at a z.
    TESSERA_INLINE Vec3T<F> position(bool orthographic, F z) const {
        if (orthographic) return {-x, -y, z};
        return {x * z, y * z, z};
    }
    // The unit direction, from its z with perspective.
    TESSERA_INLINE F view_z() const { return F(1.0f) / sqrt(x * x + y * y + F(1.0f)); }
    TESSERA_INLINE Vec3T<F> view(bool orthographic, F z) const {
        if (orthographic) return {F(0.0f), F(0.0f), F(1.0f)};
        return {x * z, y * z, z};
    }
};

// Distance along the view axis of a reversed depth.
template <class F>
TESSERA_INLINE F distance_of_depth(const ProjectionView& p, F depth) {
    const F a(p.clip_from_camera[10]), b(p.clip_from_camera[11]);
    return p.orthographic ? (b - depth) / a : b / (depth + a);
}

// --- making the planes of triangles that need no clipping -------------------------------------

// Planes through three snapped vertices, anchored at the first.
template <class F>
struct PlaneBasis {
    F dx1, dy1, dx2, dy2, inverse_area;

    TESSERA_INLINE PlaneBasis(const PictureVertex<F> (&p)[3]) {
        dx1 = to_float(p[1].snapped_x - p[0].snapped_x);
        dy1 = to_float(p[1].snapped_y - p[0].snapped_y);
        dx2 = to_float(p[2].snapped_x - p[0].snapped_x);
        dy2 = to_float(p[2].snapped_y - p[0].snapped_y);
        const F area = dx1 * dy2 - dx2 * dy1;
        const auto flat = area == F(0.0f);
        inverse_area = select(flat, F(0.0f), F(1.0f) / select(flat, F(1.0f), area));
    }
    TESSERA_INLINE Plane<F> through(F g0, F g1, F g2) const {
        const F d1 = g1 - g0, d2 = g2 - g0;
        return {g0, (d1 * dy2 - d2 * dy1) * inverse_area, (d2 * dx1 - d1 * dx2) * inverse_area};
    }
};

// The numbers of one corner in the order of the layout's planes, without the leading 1: normals in
// camera space on the viewer's side (`front` is +1 where the viewer sees the front).
template <class F>
TESSERA_INLINE void corner_numbers(const InstanceView& instance, const SurfaceLayout& l, const Corner<F>& c, F front,
                                   const Vec3T<F>& camera_normal, F* out) {
    if (l.normal >= 0) {
        const Vec3T<F> n = camera_normal * front;
        out[l.normal] = n.x, out[l.normal + 1] = n.y, out[l.normal + 2] = n.z;
    }
    if (l.tangent >= 0) {
        const Vec3T<F> t = transform_direction(instance.object_to_camera, c.tangent.xyz());
        out[l.tangent] = t.x, out[l.tangent + 1] = t.y, out[l.tangent + 2] = t.z;
    }
    for (int set = 0; set < kMaxUvSets; ++set)
        if (l.uv[set] >= 0) out[l.uv[set]] = c.uv[set].x, out[l.uv[set] + 1] = c.uv[set].y;
    if (l.color >= 0) {
        out[l.color] = c.color.x, out[l.color + 1] = c.color.y;
        out[l.color + 2] = c.color.z, out[l.color + 3] = c.color.w;
    }
    if (l.depth >= 0) out[l.depth] = -transform_point(instance.object_to_camera, c.position).z;
}

// Vertex normals in camera space; where one has no direction, the triangle's own, which `flat()` gives.
template <class F, class Flat>
TESSERA_INLINE void camera_normals(const InstanceView& instance, const Corner<F> (&c)[3], Vec3T<F> (&n)[3],
                                   Flat&& flat) {
    MaskOf<F> usable[3];
    for (int i = 0; i < 3; ++i) {
        n[i] = transform_normal(instance.normal_to_camera, c[i].normal);
        usable[i] = has_direction(n[i]);
    }
    if (all(usable[0] & usable[1] & usable[2])) return;
    const Vec3T<F> own = flat();
    for (int i = 0; i < 3; ++i) n[i] = select3(usable[i], n[i], own);
}
template <class F>
TESSERA_INLINE void camera_normals(const InstanceView& instance, const Corner<F> (&c)[3], Vec3T<F> (&n)[3]) {
    camera_normals(instance, c, n,
                   [&] { return geometric_normal(instance, c[0].position, c[1].position, c[2].position); });
}

// Makes the planes from snapped vertices and 1 / w; `emit(i, value)` receives float i of the record as surface_floats()
// counts them. Of the corners' positions only the distance along the axis is read, and by `flat()`, as above.
template <class F, class Flat, class Emit>
TESSERA_INLINE void make_planes(const InstanceView& instance, const SurfaceLayout& l, const Corner<F> (&c)[3],
                                const F (&inverse_w)[3], const PictureVertex<F> (&p)[3], F front, Flat&& flat,
                                Emit&& emit) {
    const PlaneBasis<F> basis(p);
    emit(0, to_float(p[0].snapped_x));
    emit(1, to_float(p[0].snapped_y));
    emit(2, front);
    emit(3, l.tangent >= 0 ? c[0].tangent.w * F(instance.handedness) : F(1.0f));
    const auto put = [&](int plane, const Plane<F>& q) {
        const int at = kSurfaceHeader + 3 * plane;
        emit(at, q.at_anchor);
        emit(at + 1, q.ddx);
        emit(at + 2, q.ddy);
    };
    put(0, basis.through(inverse_w[0], inverse_w[1], inverse_w[2]));
    Vec3T<F> normals[3];
    if (l.normal >= 0) camera_normals(instance, c, normals, flat);
    F numbers[3][kMaxSurfacePlanes];
    for (int i = 0; i < 3; ++i) corner_numbers(instance, l, c[i], front, normals[i], numbers[i]);
    for (int k = 1; k < l.count; ++k)
        put(k, basis.through(numbers[0][k] * inverse_w[0], numbers[1][k] * inverse_w[1], numbers[2][k] * inverse_w[2]));
}
template <class F, class Emit>
TESSERA_INLINE void make_planes(const InstanceView& instance, const SurfaceLayout& l, const Corner<F> (&c)[3],
                                const ClipVertex<F> (&v)[3], const PictureVertex<F> (&p)[3], F front, Emit&& emit) {
    F inverse_w[3];
    for (int i = 0; i < 3; ++i) inverse_w[i] = F(1.0f) / v[i].w;
    make_planes(
        instance, l, c, inverse_w, p, front,
        [&] { return geometric_normal(instance, c[0].position, c[1].position, c[2].position); }, emit);
}

// --- from planes to the surface point ----------------------------------------------------------

// The planes' values at a sample, and what else a point needs of the triangle's record: side, sign of the
// bitangent, and the planes themselves for the footprints.
template <class F>
struct SurfaceSample {
    F value[kMaxSurfacePlanes];
    F side, bitangent_sign;
    F inverse_w_ddx, inverse_w_ddy;
    Footprint<F> uv_plane[kMaxUvSets];
};

// `number(i)` is float i of the triangle's record.
template <class F, class Number>
TESSERA_INLINE void sample_planes(const SurfaceLayout& l, F x, F y, Number&& number, SurfaceSample<F>& out) {
    const F dx = x - number(0), dy = y - number(1);
    out.side = number(2);
    out.bitangent_sign = number(3);
    out.inverse_w_ddx = number(kSurfaceHeader + 1);
    out.inverse_w_ddy = number(kSurfaceHeader + 2);
    for (int k = 0; k < l.count; ++k) {
        const int at = kSurfaceHeader + 3 * k;
        out.value[k] = Plane<F>{number(at), number(at + 1), number(at + 2)}.at(dx, dy);
    }
    for (int set = 0; set < kMaxUvSets; ++set)
        if (l.uv[set] >= 0) {
            const int u = kSurfaceHeader + 3 * l.uv[set];
            out.uv_plane[set] = {number(u + 1), number(u + 4), number(u + 2), number(u + 5)};
        }
}

template <class F>
TESSERA_INLINE SurfacePoint<F> surface_point(const SurfaceLayout& l, const PictureRays& rays,
                                             const SurfaceSample<F>& sample, F x, F y, float footprint_scale) {
    const F* v = sample.value;
    SurfacePoint<F> s;
    const F zero(0.0f), one(1.0f);
    const Vec3T<F> none = Vec3T<F>::splat(zero), toward_eye{zero, zero, one};
    // A sample beside a sliver of a triangle may lie beyond its horizon: farther than all that is drawn.
    const F minus_w = F(-1.0f) / max(v[0], F(1.0f / kLargestCoordinate)), w = -minus_w;
    const EyeDirection<F> eye(rays, x, y);
    const bool orthographic = l.depth >= 0;
    s.position = eye.position(orthographic, orthographic ? v[l.depth] * minus_w : minus_w);
    s.view = eye.view(orthographic, orthographic ? one : eye.view_z());
    s.side = sample.side;
    s.geometric_normal = s.tangent = s.bitangent = none;
    s.normal =
        l.normal >= 0 ? normalize_or(Vec3T<F>{v[l.normal], v[l.normal + 1], v[l.normal + 2]}, toward_eye) : toward_eye;
    if (l.tangent >= 0)
        set_tangent_frame(s, s.normal * sample.side, {v[l.tangent], v[l.tangent + 1], v[l.tangent + 2]},
                          sample.bitangent_sign);
    s.color = {one, one, one, one};
    if (l.color >= 0) s.color = {v[l.color] * w, v[l.color + 1] * w, v[l.color + 2] * w, v[l.color + 3] * w};
    for (int set = 0; set < kMaxUvSets; ++set) {
        s.uv[set] = {zero, zero};
        s.footprint[set] = {zero, zero, zero, zero};
        if (l.uv[set] < 0) continue;
        const Vec2T<F> uv{v[l.uv[set]] * w, v[l.uv[set] + 1] * w};
        s.uv[set] = uv;
        // The quotient rule, per pixel instead of 1/256 of it.
        const F scale = w * F(256.0f * footprint_scale);
        const Footprint<F>& p = sample.uv_plane[set];
        s.footprint[set] = {(p.ux - uv.x * sample.inverse_w_ddx) * scale, (p.vx - uv.y * sample.inverse_w_ddx) * scale,
                            (p.uy - uv.x * sample.inverse_w_ddy) * scale, (p.vy - uv.y * sample.inverse_w_ddy) * scale};
    }
    return s;
}

}  // namespace tessera
