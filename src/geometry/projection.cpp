#include "geometry/projection.h"

#include <tessera/error.h>

#include "geometry/matrix.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// What the rounding of a host's own floats may amount to.
constexpr double kTolerance = 1e-4;

[[noreturn]] void refuse(const char* reason) { throw Error(ErrorCode::kUsage, reason); }

void store_projection(const glm::dmat4& camera_to_clip, int width, int height, ProjectionView& p) {
    p.width = static_cast<float>(width);
    p.height = static_cast<float>(height);
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) p.clip_from_camera[4 * r + c] = static_cast<float>(camera_to_clip[c][r]);
    p.scale_x = p.clip_from_camera[0];
    p.scale_y = p.clip_from_camera[5];
}

bool is_rigid(const glm::dmat4& m) {
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b)
            if (!(std::abs(glm::dot(glm::dvec3(m[a]), glm::dvec3(m[b])) - (a == b ? 1 : 0)) <= kTolerance))
                return false;
    return determinant_sign(m) > 0 && m[0].w == 0 && m[1].w == 0 && m[2].w == 0 && m[3].w == 1;
}

}  // namespace

FrameCamera frame_camera(const PlacedCamera& camera, int width, int height) {
    FrameCamera f;
    f.world_to_camera = rigid_inverse(camera.camera_to_world);
    f.camera_to_clip = projection_matrix(camera.lens, static_cast<double>(width) / height);
    store_projection(f.camera_to_clip, width, height, f.projection);
    f.projection.orthographic = camera.lens.type == Camera::Type::kOrthographic;
    f.projection.near = camera.lens.znear;
    return f;
}

FrameCamera host_camera(const Mat4& clip_from_world, const Mat4& camera_from_world, int width, int height) {
    FrameCamera f;
    f.world_to_camera = to_dmat4(camera_from_world);
    glm::dmat4 clip = to_dmat4(clip_from_world);
    if (!is_finite(f.world_to_camera) || !is_finite(clip)) refuse("the view's matrices must be finite");
    if (!is_rigid(f.world_to_camera))
        refuse("camera_from_world must be rigid: a rotation and a translation, without scale or mirroring");
    for (int c = 0; c < 4; ++c) clip[c].z = 0.5 * (clip[c].w - clip[c].z);
    f.world_to_clip = clip;

    // Scaled so that w is the distance along the axis, or 1.
    glm::dmat4 p = clip * *inverse_matrix(f.world_to_camera);
    const double along = -p[2].w, constant = p[3].w;
    f.projection.orthographic = std::abs(constant) > std::abs(along);
    const double w = f.projection.orthographic ? constant : along;
    const double rest = f.projection.orthographic ? along : constant;
    if (!(w > 0) || std::max({std::abs(p[0].w), std::abs(p[1].w), std::abs(rest)}) > kTolerance * w)
        refuse(
            "clip_from_world does not fit camera_from_world: w must be a distance along -Z of the camera, or constant");
    p /= w;
    f.camera_to_clip = p;
    store_projection(p, width, height, f.projection);
    // z' = w at the near plane, where z' is a z + b.
    const double a = p[2].z, b = p[3].z;
    const double near = f.projection.orthographic ? (b - 1) / a : b / (a + 1);
    f.projection.near = static_cast<float>(near);
    if (!(near - near == 0) || (!f.projection.orthographic && !(near > 0)))
        refuse("clip_from_world has no near plane in front of the camera");
    if (f.projection.scale_x == 0 || f.projection.scale_y == 0) refuse("clip_from_world flattens the picture");
    return f;
}

bool is_centred(const ProjectionView& projection) {
    const float* x = projection.clip_from_camera;
    const float* y = x + 4;
    const float off = std::max(
        {std::fabs(x[1]), std::fabs(x[2]), std::fabs(x[3]), std::fabs(y[0]), std::fabs(y[2]), std::fabs(y[3])});
    return off <= static_cast<float>(kTolerance) * std::min(std::fabs(x[0]), std::fabs(y[1]));
}

}  // namespace tessera
