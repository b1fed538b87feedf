// The camera of a frame as matrices, composed in double: from one of the scene's or the view's cameras,
// or from the matrices of a host.
#pragma once

#include "geometry/camera.h"
#include "geometry/draw_data.h"

namespace tessera {

struct FrameCamera {
    glm::dmat4 world_to_camera{1.0}, camera_to_clip{1.0};
    std::optional<glm::dmat4> world_to_clip;  // a host's own, which is used as it is
    double clip_scale = 1;                    // its w over that of camera_to_clip
    ProjectionView projection{};

    glm::dmat4 node_to_clip(const glm::dmat4& node_to_world, const glm::dmat4& node_to_camera) const {
        return world_to_clip ? *world_to_clip * node_to_world : camera_to_clip * node_to_camera;
    }
};

FrameCamera frame_camera(const PlacedCamera& camera, int width, int height);

// From the matrices that View documents. Perspective or orthographic is told by the row of w. Throws
// kUsage when a number is not finite, the placement is not rigid, or the two do not fit together: w must
// be a distance along -Z of camera space, or constant.
FrameCamera host_camera(const Mat4& clip_from_world, const Mat4& camera_from_world, int width, int height);

// Whether the picture is square to the camera's axes: x and y of clip space go with x and y of camera space.
bool is_square(const ProjectionView& projection);

}  // namespace tessera
