// Plain vectors, quaternions, matrices and boxes: the value types of the public API. No invariants,
// no alignment demands; arrays of them are tightly packed. Vectors are column vectors; matrices are
// stored by columns as in glTF. Angles are radians. Functions that need trigonometry or that build
// camera matrices are in transform.h.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tessera {

struct Vec2 {
    float x = 0, y = 0;
    friend constexpr bool operator==(const Vec2&, const Vec2&) = default;
};

struct Vec3 {
    float x = 0, y = 0, z = 0;
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

struct Vec4 {
    float x = 0, y = 0, z = 0, w = 0;
    friend constexpr bool operator==(const Vec4&, const Vec4&) = default;
};

// Rotation x i + y j + z k + w; unit length where used as a rotation.
struct Quat {
    float x = 0, y = 0, z = 0, w = 1;
    friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

// m[4 * column + row]; the default is the identity.
struct Mat4 {
    std::array<float, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    constexpr float& operator()(int row, int column) { return m[static_cast<std::size_t>(4 * column + row)]; }
    constexpr float operator()(int row, int column) const { return m[static_cast<std::size_t>(4 * column + row)]; }
    friend constexpr bool operator==(const Mat4&, const Mat4&) = default;
};

// Axis-aligned box; the default is empty (min > max).
struct Bounds3 {
    Vec3 min{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
             std::numeric_limits<float>::infinity()};
    Vec3 max{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
             -std::numeric_limits<float>::infinity()};

    constexpr bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    constexpr void add(const Vec3& p) {
        min = {p.x < min.x ? p.x : min.x, p.y < min.y ? p.y : min.y, p.z < min.z ? p.z : min.z};
        max = {p.x > max.x ? p.x : max.x, p.y > max.y ? p.y : max.y, p.z > max.z ? p.z : max.z};
    }
    constexpr void add(const Bounds3& b) {
        if (!b.empty()) {
            add(b.min);
            add(b.max);
        }
    }
};

constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
constexpr Vec2 operator*(Vec2 a, float s) { return {a.x * s, a.y * s}; }
constexpr Vec2 operator*(float s, Vec2 a) { return a * s; }
constexpr float dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
// Signed area of the parallelogram (a, b): positive when b is counter-clockwise of a.
constexpr float cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(float s, Vec3 a) { return a * s; }
constexpr Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Vec3 operator/(Vec3 a, float s) { return {a.x / s, a.y / s, a.z / s}; }
constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

constexpr Vec4 operator+(Vec4 a, Vec4 b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
constexpr Vec4 operator-(Vec4 a, Vec4 b) { return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; }
constexpr Vec4 operator*(Vec4 a, float s) { return {a.x * s, a.y * s, a.z * s, a.w * s}; }
constexpr Vec4 operator*(float s, Vec4 a) { return a * s; }
constexpr float dot(Vec4 a, Vec4 b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }

// Euclidean norm |a|.
inline float length(Vec2 a) { return std::sqrt(dot(a, a)); }
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
// a / |a|; the zero vector stays zero.
inline Vec3 normalize(Vec3 a) {
    const float l = length(a);
    return l > 0 ? a / l : Vec3{};
}

// Homogeneous coordinates: a point has w = 1, a direction w = 0.
constexpr Vec4 point(Vec3 p) { return {p.x, p.y, p.z, 1}; }
constexpr Vec4 direction(Vec3 d) { return {d.x, d.y, d.z, 0}; }
// The Cartesian point of a homogeneous one; w must not be 0.
constexpr Vec3 cartesian(Vec4 p) { return {p.x / p.w, p.y / p.w, p.z / p.w}; }

constexpr Vec4 operator*(const Mat4& m, Vec4 v) {
    return {m.m[0] * v.x + m.m[4] * v.y + m.m[8] * v.z + m.m[12] * v.w,
            m.m[1] * v.x + m.m[5] * v.y + m.m[9] * v.z + m.m[13] * v.w,
            m.m[2] * v.x + m.m[6] * v.y + m.m[10] * v.z + m.m[14] * v.w,
            m.m[3] * v.x + m.m[7] * v.y + m.m[11] * v.z + m.m[15] * v.w};
}
constexpr Mat4 operator*(const Mat4& a, const Mat4& b) {
    Mat4 r;
    for (int c = 0; c < 4; ++c) {
        const Vec4 column = a * Vec4{b(0, c), b(1, c), b(2, c), b(3, c)};
        r(0, c) = column.x, r(1, c) = column.y, r(2, c) = column.z, r(3, c) = column.w;
    }
    return r;
}
constexpr Mat4 transpose(const Mat4& a) {
    Mat4 r;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) r(i, j) = a(j, i);
    return r;
}

}  // namespace tessera
