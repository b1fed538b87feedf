// Matrices in double: what evaluation composes before anything is rounded to float. GLM's dmat4
// (columns, as in Mat4) is the type; its trigonometry is not used, because libm changes bits with the
// processor. Points are column vectors, right-handed, depth reversed as in transform.h.
#pragma once

#include <tessera/types.h>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

namespace tessera {

inline glm::dvec3 to_dvec3(Vec3 v) { return {v.x, v.y, v.z}; }
// Rounds to nearest.
inline Vec3 to_vec3(const glm::dvec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
glm::dmat4 to_dmat4(const Mat4& m);
// Rounds to nearest; elements beyond the range of float become infinite.
Mat4 to_mat4(const glm::dmat4& m);

inline bool is_finite(const glm::dvec3& v) { return v.x - v.x == 0 && v.y - v.y == 0 && v.z - v.z == 0; }
bool is_finite(const glm::dmat4& m);

// The point (p, 1) under an affine matrix: its last row is taken as (0, 0, 0, 1).
inline glm::dvec3 transform_point(const glm::dmat4& m, const glm::dvec3& p) {
    return {m[0].x * p.x + m[1].x * p.y + m[2].x * p.z + m[3].x, m[0].y * p.x + m[1].y * p.y + m[2].y * p.z + m[3].y,
            m[0].z * p.x + m[1].z * p.y + m[2].z * p.z + m[3].z};
}

// translation * rotation * scale. The quaternion is normalised first; the zero one is the identity.
glm::dmat4 compose_matrix(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale);
glm::dmat4 compose_matrix(Vec3 translation, Quat rotation, Vec3 scale);
glm::dmat4 rotation_matrix(const glm::dvec4& rotation);  // x, y, z, w
inline glm::dmat4 rotation_matrix(Quat q) { return rotation_matrix(glm::dvec4(q.x, q.y, q.z, q.w)); }

// Gauss-Jordan with pivoting on the equilibrated matrix. Empty when singular (a pivot below 1e-13 of
// its row and column) or when the inverse is not finite.
std::optional<glm::dmat4> inverse_matrix(const glm::dmat4& m);

// Inverse transpose of the linear part up to a positive factor: it takes normals to normals that
// must be normalised again. Made of cofactors, so a matrix that flattens one axis still has one.
glm::dmat3 normal_matrix(const glm::dmat4& m);
// -1 when the linear part mirrors (triangles change their winding), 0 when it flattens, else 1.
int determinant_sign(const glm::dmat4& m);

// Of 3x4 rows of float: the determinant of the linear part, and the inverse, rounded at the end. False where rays would
// lose their precision in object space: flattened objects, axes within a thousandth of one plane, and extreme scales.
double determinant_of_rows(const float* m);
bool invert_rows(const float* m, float* out);

// Whether the matrix is a rotation and a translation, up to what the rounding of floats may amount to.
bool is_rigid(const glm::dmat4& m);

// transform.h's camera matrices before rounding. The placement is orthonormal for any input: without
// a direction of view it looks along -Z, and where `up` is no help the axis farthest from the view is.
glm::dmat4 placement_matrix(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up);
// Inverse of an orthonormal placement, by transposition.
glm::dmat4 rigid_inverse(const glm::dmat4& placement);
glm::dmat4 frustum_matrix(double left, double right, double bottom, double top, double near, std::optional<double> far);
glm::dmat4 perspective_matrix(double yfov, double aspect, double near, std::optional<double> far);
glm::dmat4 orthographic_matrix(double left, double right, double bottom, double top, double near, double far);

}  // namespace tessera
