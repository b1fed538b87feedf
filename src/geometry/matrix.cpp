#include "geometry/matrix.h"

#include "simd/math.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace tessera {
namespace {

double largest(double a, double b) { return a < b ? b : a; }

// 2^-e with 2^e <= x < 2^(e+1): scaling by it is exact. 1 for 0.
double power_of_two_below(double x) { return x > 0 ? std::scalbn(1.0, -std::ilogb(x)) : 1; }

// The linear part scaled by a power of two, so that products of its elements keep their range.
glm::dmat3 scaled_linear_part(const glm::dmat4& m) {
    double peak = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) peak = largest(peak, std::fabs(m[c][r]));
    const double s = power_of_two_below(peak);
    return glm::dmat3(glm::dvec3(m[0]) * s, glm::dvec3(m[1]) * s, glm::dvec3(m[2]) * s);
}

// v / |v|, or zero where v has no length.
glm::dvec3 unit(const glm::dvec3& v) {
    const double s = power_of_two_below(largest(largest(std::fabs(v.x), std::fabs(v.y)), std::fabs(v.z)));
    const glm::dvec3 w = v * s;
    const double l = std::sqrt(glm::dot(w, w));
    return l > 0 ? w / l : glm::dvec3(0);
}

}  // namespace

glm::dmat4 to_dmat4(const Mat4& m) {
    glm::dmat4 r(1);
    for (int c = 0; c < 4; ++c)
        for (int row = 0; row < 4; ++row) r[c][row] = m(row, c);
    return r;
}

Mat4 to_mat4(const glm::dmat4& m) {
    Mat4 r;
    for (int c = 0; c < 4; ++c)
        for (int row = 0; row < 4; ++row) r(row, c) = static_cast<float>(m[c][row]);
    return r;
}

bool is_finite(const glm::dmat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

glm::dmat4 rotation_matrix(const glm::dvec4& rotation) {
    const double qx = rotation.x, qy = rotation.y, qz = rotation.z, qw = rotation.w;
    const double squared = qx * qx + qy * qy + qz * qz + qw * qw;
    const double s = squared > 0 ? 2 / squared : 0;  // 2 q q* / |q|^2: needs no square root
    glm::dmat4 m(1);
    m[0] = {1 - s * (qy * qy + qz * qz), s * (qx * qy + qw * qz), s * (qx * qz - qw * qy), 0};
    m[1] = {s * (qx * qy - qw * qz), 1 - s * (qx * qx + qz * qz), s * (qy * qz + qw * qx), 0};
    m[2] = {s * (qx * qz + qw * qy), s * (qy * qz - qw * qx), 1 - s * (qx * qx + qy * qy), 0};
    return m;
}

glm::dmat4 compose_matrix(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale) {
    glm::dmat4 m = rotation_matrix(rotation);
    m[0] *= scale.x;
    m[1] *= scale.y;
    m[2] *= scale.z;
    m[3] = glm::dvec4(translation, 1);
    return m;
}

glm::dmat4 compose_matrix(Vec3 translation, Quat rotation, Vec3 scale) {
    return compose_matrix(to_dvec3(translation), glm::dvec4(rotation.x, rotation.y, rotation.z, rotation.w),
                          to_dvec3(scale));
}

std::optional<glm::dmat4> inverse_matrix(const glm::dmat4& m) {
    if (!is_finite(m)) return std::nullopt;
    // Columns, then rows, are scaled to a largest element of 1 .. 2, exactly; a pivot's size then
    // says how independent the columns are, whatever their units.
    std::array<double, 4> column_scale{}, row_scale{};
    std::array<std::array<double, 8>, 4> a{};  // rows of (scaled m | identity)
    for (int c = 0; c < 4; ++c) {
        double peak = 0;
        for (int r = 0; r < 4; ++r) peak = largest(peak, std::fabs(m[c][r]));
        column_scale[c] = power_of_two_below(peak);
    }
    for (int r = 0; r < 4; ++r) {
        double peak = 0;
        for (int c = 0; c < 4; ++c) peak = largest(peak, std::fabs(a[r][c] = m[c][r] * column_scale[c]));
        row_scale[r] = power_of_two_below(peak);
        for (int c = 0; c < 4; ++c) a[r][c] *= row_scale[r];
        a[r][4 + r] = 1;
    }
    for (int c = 0; c < 4; ++c) {
        int pivot = c;
        for (int r = c + 1; r < 4; ++r)
            if (std::fabs(a[r][c]) > std::fabs(a[pivot][c])) pivot = r;
        if (!(std::fabs(a[pivot][c]) > 1e-13)) return std::nullopt;
        std::swap(a[c], a[pivot]);
        const double d = a[c][c];
        for (double& x : a[c]) x /= d;
        for (int r = 0; r < 4; ++r) {
            if (r == c) continue;
            const double f = a[r][c];
            if (f != 0)
                for (int k = 0; k < 8; ++k) a[r][k] -= f * a[c][k];
        }
    }
    glm::dmat4 result(1);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) result[c][r] = a[r][4 + c] * column_scale[r] * row_scale[c];
    if (!is_finite(result)) return std::nullopt;
    return result;
}

glm::dmat3 normal_matrix(const glm::dmat4& m) {
    const glm::dmat3 a = scaled_linear_part(m);
    const glm::dmat3 cofactors(glm::cross(a[1], a[2]), glm::cross(a[2], a[0]), glm::cross(a[0], a[1]));
    return glm::dot(a[0], cofactors[0]) < 0 ? -cofactors : cofactors;
}

int determinant_sign(const glm::dmat4& m) {
    const glm::dmat3 a = scaled_linear_part(m);
    const double d = glm::dot(a[0], glm::cross(a[1], a[2]));
    return d < 0 ? -1 : d > 0 ? 1 : 0;
}

bool is_rigid(const glm::dmat4& m) {
    constexpr double kRigid = 1e-4;
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b)
            if (!(std::abs(glm::dot(glm::dvec3(m[a]), glm::dvec3(m[b])) - (a == b ? 1 : 0)) <= kRigid)) return false;
    return determinant_sign(m) > 0 && m[0].w == 0 && m[1].w == 0 && m[2].w == 0 && m[3].w == 1;
}

glm::dmat4 placement_matrix(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
    glm::dvec3 back = unit(eye - target);
    if (back == glm::dvec3(0)) back = {0, 0, 1};
    glm::dvec3 right = glm::cross(unit(up), back);
    if (!(glm::dot(right, right) > 1e-18)) {  // up is missing or parallel to the view
        const glm::dvec3 a = glm::abs(back);
        const glm::dvec3 axis = a.y <= a.x && a.y <= a.z ? glm::dvec3(0, 1, 0)
                                : a.z <= a.x             ? glm::dvec3(0, 0, 1)
                                                         : glm::dvec3(1, 0, 0);
        right = glm::cross(axis, back);
    }
    right = unit(right);
    const glm::dvec3 v = glm::cross(back, right);
    return glm::dmat4(glm::dvec4(right, 0), glm::dvec4(v, 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
}

glm::dmat4 rigid_inverse(const glm::dmat4& placement) {
    const glm::dvec3 u(placement[0]), v(placement[1]), e(placement[2]), origin(placement[3]);
    return glm::dmat4(u.x, v.x, e.x, 0, u.y, v.y, e.y, 0, u.z, v.z, e.z, 0, -glm::dot(u, origin), -glm::dot(v, origin),
                      -glm::dot(e, origin), 1);
}

glm::dmat4 frustum_matrix(double left, double right, double bottom, double top, double near,
                          std::optional<double> far) {
    const double z = far ? near / (*far - near) : 0;
    const double w = far ? *far * near / (*far - near) : near;
    return glm::dmat4(2 * near / (right - left), 0, 0, 0, 0, 2 * near / (top - bottom), 0, 0,
                      (right + left) / (right - left), (top + bottom) / (top - bottom), z, -1, 0, 0, w, 0);
}

glm::dmat4 perspective_matrix(double yfov, double aspect, double near, std::optional<double> far) {
    const double top = near * math::tan(yfov / 2);
    const double right = top * aspect;
    return frustum_matrix(-right, right, -top, top, near, far);
}

glm::dmat4 orthographic_matrix(double left, double right, double bottom, double top, double near, double far) {
    const double w = right - left, h = top - bottom, d = far - near;
    return glm::dmat4(2 / w, 0, 0, 0, 0, 2 / h, 0, 0, 0, 0, 1 / d, 0, -(right + left) / w, -(top + bottom) / h, far / d,
                      1);
}

double determinant_of_rows(const float* m) {
    const double a = m[0], b = m[1], c = m[2], d = m[4], e = m[5], f = m[6], g = m[8], h = m[9], i = m[10];
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
}

bool invert_rows(const float* m, float* out) {
    const auto squared = [&](int c) {
        const double x = m[c], y = m[4 + c], z = m[8 + c];
        return x * x + y * y + z * z;
    };
    const double det = determinant_of_rows(m), size = std::abs(det);
    constexpr double kLeastVolume = 1e-3, kMostScale = 1e12;
    if (!(size > 1e-30 && size < 1e30 && size > kLeastVolume * std::sqrt(squared(0) * squared(1) * squared(2))))
        return false;
    const auto at = [&](int r, int c) { return static_cast<double>(m[4 * (r % 3) + c % 3]); };
    double inverse[3][3];
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            inverse[r][c] = (at(c + 1, r + 1) * at(c + 2, r + 2) - at(c + 1, r + 2) * at(c + 2, r + 1)) / det;
    }
    for (int r = 0; r < 3; ++r) {
        double offset = 0;
        for (int c = 0; c < 3; ++c) {
            if (!(std::abs(inverse[r][c]) < kMostScale)) return false;
            out[4 * r + c] = static_cast<float>(inverse[r][c]);
            offset -= inverse[r][c] * m[4 * c + 3];
        }
        out[4 * r + 3] = static_cast<float>(offset);
        if (!std::isfinite(out[4 * r + 3])) return false;
    }
    return true;
}

}  // namespace tessera
