// A vertex on its way into the picture: clip space, out-codes, and the grid of 24.8 fixed point that it snaps to.
// Templates over the number type, of which every engine uses the same; spaces as in draw_data.h; picture positions in
// 1/256 pixel, y down.
#pragma once

#include "simd/vec.h"

#include <cmath>
#include <cstdint>

namespace tessera {

// A vertex in clip space. The order of the sums is part of the contract.
template <class F>
struct ClipVertex {
    F x, y, z, w;
};

// Clip coordinates beyond this are not drawn: their products would leave the range of float.
inline constexpr float kLargestCoordinate = 1e15f;

template <class F>
TESSERA_INLINE ClipVertex<F> to_clip(const float* rows, const F& x, const F& y, const F& z) {
    return {rows[0] * x + rows[1] * y + rows[2] * z + rows[3], rows[4] * x + rows[5] * y + rows[6] * z + rows[7],
            rows[8] * x + rows[9] * y + rows[10] * z + rows[11], rows[12] * x + rows[13] * y + rows[14] * z + rows[15]};
}

// Whether a vertex can be drawn at all.
TESSERA_INLINE bool usable(const ClipVertex<float>& v) {
    return std::fabs(v.x) < kLargestCoordinate && std::fabs(v.y) < kLargestCoordinate &&
           std::fabs(v.z) < kLargestCoordinate && std::fabs(v.w) < kLargestCoordinate;
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

}  // namespace tessera
