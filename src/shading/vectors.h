// Small vectors over a number type F: a float, or a SIMD vector of floats that holds one component of
// as many points as it has lanes. Plain data; every operation is spelled out in a fixed order.
#pragma once

#include "simd/vec.h"

namespace tessera {

template <class F>
struct Vec2T {
    F x, y;
};

template <class F>
struct Vec3T {
    F x, y, z;

    static TESSERA_INLINE Vec3T splat(F v) { return {v, v, v}; }
    static TESSERA_INLINE Vec3T load(const float* p) { return {F(p[0]), F(p[1]), F(p[2])}; }

    friend TESSERA_INLINE Vec3T operator+(const Vec3T& a, const Vec3T& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend TESSERA_INLINE Vec3T operator-(const Vec3T& a, const Vec3T& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend TESSERA_INLINE Vec3T operator*(const Vec3T& a, const Vec3T& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend TESSERA_INLINE Vec3T operator*(const Vec3T& a, F s) { return {a.x * s, a.y * s, a.z * s}; }
    friend TESSERA_INLINE Vec3T operator-(const Vec3T& a) { return {-a.x, -a.y, -a.z}; }
};

template <class F>
struct Vec4T {
    F x, y, z, w;

    TESSERA_INLINE Vec3T<F> xyz() const { return {x, y, z}; }
    friend TESSERA_INLINE Vec4T operator*(const Vec4T& a, const Vec4T& b) {
        return {a.x * b.x, a.y * b.y, a.z * b.z, a.w * b.w};
    }
};

template <class F>
TESSERA_INLINE F dot(const Vec3T<F>& a, const Vec3T<F>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class F>
TESSERA_INLINE Vec3T<F> cross(const Vec3T<F>& a, const Vec3T<F>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// a / |a|, or `fallback` where |a| is zero, too small to square, or not a number.
template <class F>
TESSERA_INLINE Vec3T<F> normalize_or(const Vec3T<F>& a, const Vec3T<F>& fallback) {
    F squared = dot(a, a);
    const auto usable = (squared > F(1e-37f)) & (squared < F(1e37f));
    const bool all_usable = all(usable);
    if (!all_usable) squared = select(usable, squared, F(1.0f));
    const F scale = F(1.0f) / sqrt(squared);
    F x = a.x * scale, y = a.y * scale, z = a.z * scale;
    if (!all_usable) {
        x = select(usable, x, fallback.x);
        y = select(usable, y, fallback.y);
        z = select(usable, z, fallback.z);
    }
    return {x, y, z};
}

template <class M, class F>
TESSERA_INLINE Vec3T<F> select3(const M& mask, const Vec3T<F>& a, const Vec3T<F>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

template <class F>
TESSERA_INLINE Vec3T<F> mix(const Vec3T<F>& a, const Vec3T<F>& b, F t) {
    return a + (b - a) * t;
}
template <class F>
TESSERA_INLINE F mix1(F a, F b, F t) {
    return a + (b - a) * t;
}
template <class F>
TESSERA_INLINE F saturate(F x) {
    return min(max(x, F(0.0f)), F(1.0f));
}

// Rows of a 3x4 affine matrix times a point, and its linear part times a direction.
template <class F>
TESSERA_INLINE Vec3T<F> transform_point(const float* rows, const Vec3T<F>& p) {
    return {rows[0] * p.x + rows[1] * p.y + rows[2] * p.z + rows[3],
            rows[4] * p.x + rows[5] * p.y + rows[6] * p.z + rows[7],
            rows[8] * p.x + rows[9] * p.y + rows[10] * p.z + rows[11]};
}
template <class F>
TESSERA_INLINE Vec3T<F> transform_direction(const float* rows, const Vec3T<F>& d) {
    return {rows[0] * d.x + rows[1] * d.y + rows[2] * d.z, rows[4] * d.x + rows[5] * d.y + rows[6] * d.z,
            rows[8] * d.x + rows[9] * d.y + rows[10] * d.z};
}
// Rows of a 3x3 matrix times a direction.
template <class F>
TESSERA_INLINE Vec3T<F> transform_normal(const float* rows, const Vec3T<F>& n) {
    return {rows[0] * n.x + rows[1] * n.y + rows[2] * n.z, rows[3] * n.x + rows[4] * n.y + rows[5] * n.z,
            rows[6] * n.x + rows[7] * n.y + rows[8] * n.z};
}

}  // namespace tessera
