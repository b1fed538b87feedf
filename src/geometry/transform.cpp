#include <tessera/transform.h>

#include "geometry/matrix.h"
#include "simd/math.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// A matrix from its rows, as they are written on paper, rounded to float.
Mat4 from_rows(const glm::dvec4& a, const glm::dvec4& b, const glm::dvec4& c, const glm::dvec4& d) {
    return to_mat4(glm::transpose(glm::dmat4(a, b, c, d)));
}
const glm::dvec4 kLastRow{0, 0, 0, 1};

std::optional<double> widen(std::optional<float> x) {
    return x ? std::optional<double>(static_cast<double>(*x)) : std::nullopt;
}

Mat4 axis_rotation(glm::dvec3 axis, double angle) {
    const double l = std::sqrt(glm::dot(axis, axis));
    if (!(l > 0)) return {};
    axis /= l;
    // Rodrigues: R = c I + (1 - c) a a^T + s [a]x.
    const double c = math::cos(angle), s = math::sin(angle), t = 1 - c;
    const double x = axis.x, y = axis.y, z = axis.z;
    return from_rows({t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0},
                     {t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0},
                     {t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0}, kLastRow);
}

}  // namespace

Vec3 project(Vec3 b, Vec3 u) {
    const glm::dvec3 db = to_dvec3(b), du = to_dvec3(u);
    return to_vec3(du * (glm::dot(db, du) / glm::dot(du, du)));
}

Vec3 triangle_normal(Vec3 a, Vec3 b, Vec3 c) {
    const glm::dvec3 da = to_dvec3(a);
    const glm::dvec3 n = glm::cross(to_dvec3(b) - da, to_dvec3(c) - da);
    const double l = std::sqrt(glm::dot(n, n));
    return l > 0 ? to_vec3(n / l) : Vec3{};
}

std::optional<Vec3> barycentric(Vec2 p, Vec2 a, Vec2 b, Vec2 c) {
    const auto area = [](Vec2 i, Vec2 j, Vec2 k) {  // twice the signed area [ijk]
        const double x = i.x, y = i.y;
        return (j.x - x) * (k.y - y) - (j.y - y) * (k.x - x);
    };
    const double whole = area(a, b, c);
    if (!(whole != 0)) return std::nullopt;
    return to_vec3({area(p, b, c) / whole, area(p, c, a) / whole, area(p, a, b) / whole});
}

std::optional<Vec3> barycentric(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
    const glm::dvec3 dp = to_dvec3(p), da = to_dvec3(a), db = to_dvec3(b), dc = to_dvec3(c);
    const glm::dvec3 n = glm::cross(db - da, dc - da);
    const double whole = glm::dot(n, n);
    if (!(whole > 0)) return std::nullopt;
    // Areas are measured along the normal, which projects p onto the plane.
    const auto area = [&](const glm::dvec3& i, const glm::dvec3& j) { return glm::dot(glm::cross(i - dp, j - dp), n); };
    return to_vec3({area(db, dc) / whole, area(dc, da) / whole, area(da, db) / whole});
}

Mat4 translation(Vec3 offset) { return to_mat4(compose_matrix(offset, {}, {1, 1, 1})); }
Mat4 scaling(Vec3 factors) { return to_mat4(compose_matrix({}, {}, factors)); }
Mat4 rotation_x(float angle) { return axis_rotation({1, 0, 0}, angle); }
Mat4 rotation_y(float angle) { return axis_rotation({0, 1, 0}, angle); }
Mat4 rotation_z(float angle) { return axis_rotation({0, 0, 1}, angle); }
Mat4 rotation(Vec3 axis, float angle) { return axis_rotation(to_dvec3(axis), angle); }
Mat4 rotation(Quat unit) { return to_mat4(rotation_matrix(unit)); }

Quat quaternion(Vec3 axis, float angle) {
    const glm::dvec3 a = to_dvec3(axis);
    const double l = std::sqrt(glm::dot(a, a)), half = static_cast<double>(angle) / 2;
    if (!(l > 0)) return {};
    const Vec3 v = to_vec3(a * (math::sin(half) / l));
    return {v.x, v.y, v.z, static_cast<float>(math::cos(half))};
}

Mat4 shear(float xy, float xz, float yx, float yz, float zx, float zy) {
    return from_rows({1, xy, xz, 0}, {yx, 1, yz, 0}, {zx, zy, 1, 0}, kLastRow);
}

Mat4 compose(Vec3 translation, Quat rotation, Vec3 scale) {
    return to_mat4(compose_matrix(translation, rotation, scale));
}

std::optional<Mat4> inverse(const Mat4& m) {
    const std::optional<glm::dmat4> inverted = inverse_matrix(to_dmat4(m));
    if (!inverted) return std::nullopt;
    const Mat4 result = to_mat4(*inverted);
    if (!is_finite(to_dmat4(result))) return std::nullopt;  // beyond the range of float
    return result;
}

Mat4 frame_to_parent(Vec3 u, Vec3 v, Vec3 e, Vec3 origin) {
    return to_mat4(glm::dmat4(glm::dvec4(to_dvec3(u), 0), glm::dvec4(to_dvec3(v), 0), glm::dvec4(to_dvec3(e), 0),
                              glm::dvec4(to_dvec3(origin), 1)));
}

Mat4 parent_to_frame(Vec3 u, Vec3 v, Vec3 e, Vec3 origin) {
    return to_mat4(rigid_inverse(to_dmat4(frame_to_parent(u, v, e, origin))));
}

Mat4 look_at(Vec3 eye, Vec3 target, Vec3 up) {
    return to_mat4(rigid_inverse(placement_matrix(to_dvec3(eye), to_dvec3(target), to_dvec3(up))));
}

Mat4 camera_placement(Vec3 eye, Vec3 target, Vec3 up) {
    return to_mat4(placement_matrix(to_dvec3(eye), to_dvec3(target), to_dvec3(up)));
}

Mat4 frustum(float left, float right, float bottom, float top, float near, std::optional<float> far) {
    return to_mat4(frustum_matrix(left, right, bottom, top, near, widen(far)));
}

Mat4 perspective(float yfov, float aspect, float near, std::optional<float> far) {
    return to_mat4(perspective_matrix(yfov, aspect, near, widen(far)));
}

Mat4 orthographic(float left, float right, float bottom, float top, float near, float far) {
    return to_mat4(orthographic_matrix(left, right, bottom, top, near, far));
}

Mat4 frustum_textbook(float left, float right, float bottom, float top, float near, float far) {
    const double l = left, r = right, b = bottom, t = top, n = near, f = far;
    return from_rows({2 * n / (r - l), 0, -(r + l) / (r - l), 0}, {0, 2 * n / (t - b), -(t + b) / (t - b), 0},
                     {0, 0, (n + f) / (n - f), 2 * n * f / (f - n)}, {0, 0, 1, 0});
}

Vec2 ndc_to_pixel(Vec2 ndc, const Viewport& viewport) {
    return window_to_viewport({ndc.x, -ndc.y}, {-1, -1, 2, 2}, viewport);
}

Vec2 pixel_to_ndc(Vec2 pixel, const Viewport& viewport) {
    const Vec2 p = window_to_viewport(pixel, viewport, {-1, -1, 2, 2});
    return {p.x, -p.y};
}

Mat4 viewport_matrix(const Viewport& viewport) {
    const double w = viewport.width, h = viewport.height;
    return from_rows({w / 2, 0, 0, viewport.x + w / 2}, {0, -h / 2, 0, viewport.y + h / 2}, {0, 0, 1, 0}, kLastRow);
}

Vec2 window_to_viewport(Vec2 p, const Viewport& window, const Viewport& viewport) {
    const auto map = [](double x, double from, double from_size, double to, double to_size) {
        return static_cast<float>(to + (x - from) / from_size * to_size);
    };
    return {map(p.x, window.x, window.width, viewport.x, viewport.width),
            map(p.y, window.y, window.height, viewport.y, viewport.height)};
}

}  // namespace tessera
