// Geometric transformations (points as column vectors, right-handed) and the maps from the scene to
// the picture. Angles in radians. Everything is computed in double with Tessera's own sine and
// cosine, so the matrices have the same bits on every machine. Depth is reversed: the near plane
// maps to 1, the far plane (or infinity) to 0.
#pragma once

#include <tessera/export.h>
#include <tessera/types.h>

#include <optional>

namespace tessera {

// --- vectors --------------------------------------------------------------------------------

// Orthogonal projection of b on the line along u: (b.u / u.u) u. u must not be zero.
TESSERA_API Vec3 project(Vec3 b, Vec3 u);
// Unit normal of the triangle (a, b, c), counter-clockwise seen from its tip; zero if degenerate.
TESSERA_API Vec3 triangle_normal(Vec3 a, Vec3 b, Vec3 c);
// Barycentric coordinates of p in the plane triangle (a, b, c): [PBC]/[ABC], [PCA]/[ABC],
// [PAB]/[ABC] with signed areas. Empty when the triangle has no area.
TESSERA_API std::optional<Vec3> barycentric(Vec2 p, Vec2 a, Vec2 b, Vec2 c);
// The same in space, for the projection of p onto the triangle's plane.
TESSERA_API std::optional<Vec3> barycentric(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

// A line, ray (t >= 0) or segment (0 <= t <= 1): origin + t * direction.
struct Ray {
    Vec3 origin, direction;
    constexpr Vec3 at(float t) const { return origin + direction * t; }
};

// --- affine and projective transformations ---------------------------------------------------

TESSERA_API Mat4 translation(Vec3 offset);
TESSERA_API Mat4 scaling(Vec3 factors);
TESSERA_API Mat4 rotation_x(float angle);
TESSERA_API Mat4 rotation_y(float angle);
TESSERA_API Mat4 rotation_z(float angle);
// About the axis through the origin (any length above zero), by the right-hand rule.
TESSERA_API Mat4 rotation(Vec3 axis, float angle);
TESSERA_API Mat4 rotation(Quat unit);
TESSERA_API Quat quaternion(Vec3 axis, float angle);
// Shear: x += xy*y + xz*z, y += yx*x + yz*z, z += zx*x + zy*y.
TESSERA_API Mat4 shear(float xy, float xz, float yx, float yz, float zx, float zy);
// translation * rotation * scale.
TESSERA_API Mat4 compose(Vec3 translation, Quat rotation, Vec3 scale);
// Empty when the matrix is singular.
TESSERA_API std::optional<Mat4> inverse(const Mat4& m);
// From coordinates in the orthonormal frame (u, v, e) at `origin` to the frame it is given in.
TESSERA_API Mat4 frame_to_parent(Vec3 u, Vec3 v, Vec3 e, Vec3 origin);
// Its inverse, by transposition.
TESSERA_API Mat4 parent_to_frame(Vec3 u, Vec3 v, Vec3 e, Vec3 origin);

// --- cameras --------------------------------------------------------------------------------

// World to camera: the camera sits at `eye`, looks at `target` along its -Z, `up` points up.
TESSERA_API Mat4 look_at(Vec3 eye, Vec3 target, Vec3 up);
// The camera's placement (camera to world), the inverse of look_at.
TESSERA_API Mat4 camera_placement(Vec3 eye, Vec3 target, Vec3 up);

// Perspective from a frustum with left, right, bottom, top at the near plane; near maps to 1, far to
// 0; rows [2N/(R-L),0,(R+L)/(R-L),0], [0,2N/(T-B),(T+B)/(T-B),0], [0,0,N/(F-N),FN/(F-N)], [0,0,-1,0].
// Without a far plane the third row is [0,0,0,N].
TESSERA_API Mat4 frustum(float left, float right, float bottom, float top, float near, std::optional<float> far);
TESSERA_API Mat4 perspective(float yfov, float aspect, float near, std::optional<float> far);
// Box with the same reversed depth; near and far are distances along -Z.
TESSERA_API Mat4 orthographic(float left, float right, float bottom, float top, float near, float far);
// The textbook's projection: looks along +Z, near maps to +1, far to -1, third row
// [0,0,(N+F)/(N-F),2NF/(F-N)], fourth [0,0,1,0].
TESSERA_API Mat4 frustum_textbook(float left, float right, float bottom, float top, float near, float far);

// --- viewports ------------------------------------------------------------------------------

// A rectangle of the picture in pixels, from the top left.
struct Viewport {
    float x = 0, y = 0, width = 0, height = 0;
};
// Window to viewport (GEO7): normalised device coordinates (-1 .. 1, y up) to pixel coordinates in
// which pixel (i, j) covers [i, i+1) x [j, j+1) and has its centre at (i + 0.5, j + 0.5).
TESSERA_API Vec2 ndc_to_pixel(Vec2 ndc, const Viewport& viewport);
TESSERA_API Vec2 pixel_to_ndc(Vec2 pixel, const Viewport& viewport);
// The same as a matrix on (x, y, z, 1); z is kept.
TESSERA_API Mat4 viewport_matrix(const Viewport& viewport);
// The general map of one rectangle onto another.
TESSERA_API Vec2 window_to_viewport(Vec2 p, const Viewport& window, const Viewport& viewport);

}  // namespace tessera
