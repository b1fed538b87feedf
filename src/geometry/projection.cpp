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

// Of OpenCV's pixels to clip space: u and v of a direction, which lies along -Z here and whose Y points up.
glm::dmat4 pinhole_matrix(const Intrinsics& k, int width, int height, double near, std::optional<double> far) {
    glm::dmat4 m = perspective_matrix(1.0, 1.0, near, far);  // for its rows of z and w
    m[0].x = 2 * k.fx / width;
    m[1].y = 2 * k.fy / height;
    m[2].x = 1 - (2 * k.cx + 1) / width;
    m[2].y = (2 * k.cy + 1) / height - 1;
    return m;
}

}  // namespace

FrameCamera frame_camera(const PlacedCamera& camera, int width, int height) {
    FrameCamera f;
    f.world_to_camera = rigid_inverse(camera.camera_to_world);
    const Camera& lens = camera.lens;
    if (!camera.intrinsics) {
        f.camera_to_clip = projection_matrix(lens, static_cast<double>(width) / height);
    } else {
        if (lens.type == Camera::Type::kOrthographic) refuse("intrinsics do not fit an orthographic camera");
        const std::optional<double> far = lens.zfar ? std::optional<double>(*lens.zfar) : std::nullopt;
        f.camera_to_clip = pinhole_matrix(*camera.intrinsics, width, height, lens.znear, far);
    }
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
    f.clip_scale = w;
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

bool is_square(const ProjectionView& projection) {
    const float* x = projection.clip_from_camera;
    const float* y = x + 4;
    const float off = std::max(std::fabs(x[1]), std::fabs(y[0]));
    return off <= static_cast<float>(kTolerance) * std::min(std::fabs(x[0]), std::fabs(y[1]));
}

}  // namespace tessera
