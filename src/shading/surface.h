// THE surface function: from a triangle and a picture position to barycentrics, their derivatives
// and depth. Every engine uses it, so equal (triangle, position) pairs give equal bits whatever found
// them. Templates over the number type; spaces as in geometry/draw_data.h; picture positions and
// snapped vertices in 24.8 fixed point (1/256 pixel, y down).
#pragma once

#include "geometry/draw_data.h"
#include "shading/vectors.h"

namespace tessera {

// A vertex in clip space. The order of the sums is part of the contract.
template <class F>
struct ClipVertex {
    F x, y, z, w;
};

// Clip coordinates beyond this are not drawn: their products would leave the range of float.
inline constexpr float kLargestCoordinate = 1e15f;

template <class F>
TESSERA_INLINE ClipVertex<F> to_clip(const float* rows, const Vec3T<F>& p) {
    return {rows[0] * p.x + rows[1] * p.y + rows[2] * p.z + rows[3],
            rows[4] * p.x + rows[5] * p.y + rows[6] * p.z + rows[7],
            rows[8] * p.x + rows[9] * p.y + rows[10] * p.z + rows[11],
            rows[12] * p.x + rows[13] * p.y + rows[14] * p.z + rows[15]};
}

// The guard band: beyond |x| = kGuardBand * w (or y) a triangle is clipped, so that snapped
// coordinates stay within 3.5 half pictures of the centre and fit 24.8 in 32 bits.
inline constexpr float kGuardBand = 3.5f;

// 3D out-codes (Cohen-Sutherland in homogeneous space): a bit per plane that the vertex lies outside of.
enum OutCode : std::uint32_t {
    kOutLeft = 1,
    kOutRight = 2,
    kOutBottom = 4,
    kOutTop = 8,
    kOutNear = 16,
    kOutFar = 32,    // the view volume
    kOutGuard = 64,  // the guard band (any of its four planes)
};

template <class F>
TESSERA_INLINE UintOf<F> out_code(const ClipVertex<F>& v) {
    using U = UintOf<F>;
    const F g = v.w * F(kGuardBand);
    const U none(0u);
    return select(v.x < -v.w, U(kOutLeft), none) | select(v.x > v.w, U(kOutRight), none) |
           select(v.y < -v.w, U(kOutBottom), none) | select(v.y > v.w, U(kOutTop), none) |
           select(v.z > v.w, U(kOutNear), none) | select(v.z < F(0.0f), U(kOutFar), none) |
           select((v.x < -g) | (v.x > g) | (v.y < -g) | (v.y > g), U(kOutGuard), none);
}
// A triangle must be clipped where a vertex has one of these; the other planes need no clipping: the
// sides are decided by the pixels, the far plane by the depth test against a buffer cleared to 0.
inline constexpr std::uint32_t kMustClip = kOutNear | kOutGuard;

// A vertex in the picture, y down, in 1/256 pixel: where it is, and where it snaps to on the grid of
// 24.8 fixed point (nearest, ties to even).
template <class F>
struct PictureVertex {
    F x, y;
    IntOf<F> snapped_x, snapped_y;
};

template <class F>
TESSERA_INLINE PictureVertex<F> to_picture(const ClipVertex<F>& v, float width, float height) {
    const F half_w(width * 128.0f), half_h(height * 128.0f);
    const F x = v.x / v.w * half_w + half_w;
    const F y = half_h - v.y / v.w * half_h;
    return {x, y, to_int(round_even(x)), to_int(round_even(y))};
}

// Normalised device coordinates of a picture position.
template <class F>
TESSERA_INLINE Vec2T<F> sample_ndc(IntOf<F> x, IntOf<F> y, float width, float height) {
    return {to_float(x) * F(2.0f / (256.0f * width)) - F(1.0f), F(1.0f) - to_float(y) * F(2.0f / (256.0f * height))};
}

// --- depth ----------------------------------------------------------------------------------

// Depth is affine over the picture: one canonical plane per triangle, anchored at a point of the
// triangle and clamped to the triangle's own range.
template <class F>
struct DepthPlane {
    IntOf<F> anchor_x, anchor_y;  // 24.8
    F depth, ddx, ddy;            // at the anchor; per 1/256 pixel
    F lowest, highest;

    TESSERA_INLINE F at(IntOf<F> x, IntOf<F> y) const {
        const F plane = (depth + ddy * to_float(y - anchor_y)) + ddx * to_float(x - anchor_x);
        return min(max(plane, lowest), highest);
    }
};

// For a triangle that needs no clipping: through its vertices where they are, not where they snap to,
// and their depths z / w. The anchor is the first snapped vertex.
template <class F>
TESSERA_INLINE DepthPlane<F> depth_plane(const PictureVertex<F> (&p)[3], const F (&z)[3]) {
    const F dx1 = p[1].x - p[0].x, dy1 = p[1].y - p[0].y;
    const F dx2 = p[2].x - p[0].x, dy2 = p[2].y - p[0].y;
    const F dz1 = z[1] - z[0], dz2 = z[2] - z[0];
    const F area = dx1 * dy2 - dx2 * dy1;
    // A triangle that has area only by snapping is as good as level.
    const auto flat = area == F(0.0f);
    const F inverse = select(flat, F(0.0f), F(1.0f) / select(flat, F(1.0f), area));
    DepthPlane<F> plane;
    plane.anchor_x = p[0].snapped_x;
    plane.anchor_y = p[0].snapped_y;
    plane.ddx = (dz1 * dy2 - dz2 * dy1) * inverse;
    plane.ddy = (dz2 * dx1 - dz1 * dx2) * inverse;
    plane.depth =
        (z[0] + plane.ddy * (to_float(p[0].snapped_y) - p[0].y)) + plane.ddx * (to_float(p[0].snapped_x) - p[0].x);
    plane.lowest = min(min(z[0], z[1]), z[2]);
    plane.highest = max(max(z[0], z[1]), z[2]);
    return plane;
}

// --- barycentrics ---------------------------------------------------------------------------

// Perspective-correct barycentric coordinates and their change per pixel to the right and down.
template <class F>
struct Barycentrics {
    F b[3], ddx[3], ddy[3];
};

// With P the position in normalised device coordinates and q_i = (x_i, y_i) - P w_i, the homogeneous
// barycentrics are the edge functions q_j x q_k (Olano and Greer 1997, "Triangle scan conversion
// using 2D homogeneous coordinates", section 4): no division by w, so vertices behind the eye do no
// harm. `front` is +1 where the triangle is counter-clockwise, -1 where it is clockwise. Coordinates
// are clamped to the triangle, for the position may lie outside by the snapping of the vertices.
template <class F>
TESSERA_INLINE Barycentrics<F> barycentrics(const ClipVertex<F> (&v)[3], const Vec2T<F>& p, F front, float width,
                                            float height) {
    F qx[3], qy[3], e[3], ex[3], ey[3];
    for (int i = 0; i < 3; ++i) {
        qx[i] = v[i].x - p.x * v[i].w;
        qy[i] = v[i].y - p.y * v[i].w;
    }
    const F step_x = front * F(2.0f / width), step_y = front * F(-2.0f / height);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        e[i] = max((qx[j] * qy[k] - qy[j] * qx[k]) * front, F(0.0f));
        ex[i] = (qy[j] * v[k].w - v[j].w * qy[k]) * step_x;
        ey[i] = (v[j].w * qx[k] - qx[j] * v[k].w) * step_y;
    }
    const F sum = e[0] + e[1] + e[2];
    // Below that the reciprocal would overflow.
    const auto usable = sum > F(1e-37f);
    const F inverse = F(1.0f) / select(usable, sum, F(1.0f));
    const F sum_x = ex[0] + ex[1] + ex[2], sum_y = ey[0] + ey[1] + ey[2];
    Barycentrics<F> r;
    for (int i = 0; i < 3; ++i) {
        r.b[i] = select(usable, e[i] * inverse, F(i == 0 ? 1.0f : 0.0f));
        r.ddx[i] = select(usable, (ex[i] - r.b[i] * sum_x) * inverse, F(0.0f));
        r.ddy[i] = select(usable, (ey[i] - r.b[i] * sum_y) * inverse, F(0.0f));
    }
    return r;
}

template <class F>
TESSERA_INLINE F interpolate(const F (&b)[3], F a0, F a1, F a2) {
    return b[0] * a0 + b[1] * a1 + b[2] * a2;
}

}  // namespace tessera
