// A triangle's vertices in the picture and its depth there. Every engine uses these, so equal
// (triangle, position) pairs give equal bits whatever found them; surface_planes.h goes on from here
// to everything else that shading reads. Templates over the number type; spaces as in
// geometry/draw_data.h; picture positions and snapped vertices in 24.8 fixed point (1/256 pixel, y down).
#pragma once

#include "geometry/draw_data.h"
#include "geometry/picture_vertex.h"
#include "shading/vectors.h"

namespace tessera {

template <class F>
TESSERA_INLINE ClipVertex<F> to_clip(const float* rows, const Vec3T<F>& p) {
    return to_clip(rows, p.x, p.y, p.z);
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
