// A triangle's vertices in the picture and its depth there. Every engine uses these, so equal
// (triangle, position) pairs give equal bits whatever found them; surface_planes.h goes on from here
// to everything else that shading reads. Templates over the number type; spaces as in
// geometry/draw_data.h; picture positions and snapped vertices in 24.8 fixed point (1/256 pixel, y down).
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

}  // namespace tessera
