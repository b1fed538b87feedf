// Which camera a picture is taken with, and where it stands: one of the scene's, one placed by eye and
// target, or one that frames what is visible in a three-quarter view. Double precision, world space.
#pragma once

#include <tessera/render.h>

#include "geometry/node_transforms.h"

#include <functional>
#include <glm/mat4x4.hpp>

namespace tessera {

struct PlacedCamera {
    glm::dmat4 camera_to_world{1.0};  // orthonormal
    Camera lens;
    std::optional<Intrinsics> intrinsics;  // in place of the lens' angle
    glm::dvec3 pivot{0.0};                 // what a camera that is not one of the scene's turns around
};

// Throws kUsage for a camera index that does not exist or is carried by no node of the active scene.
// `for_each_point` calls its argument with every visible world-space point; it is called only for
// cameras that need the extent of the scene. View::turn is not applied, but frames for every turn.
using PointVisitor = std::function<void(const glm::dvec3&)>;
PlacedCamera choose_camera(const Scene& scene, const NodeTransforms& nodes, const View& view, double aspect,
                           const std::function<void(const PointVisitor&)>& for_each_point);

// The camera gone around the axis `up` through its pivot, counter-clockwise seen from above, in radians.
PlacedCamera turned(PlacedCamera camera, const glm::dvec3& up, double angle);

// Camera space to clip space for a picture of the given aspect (width / height). Perspective keeps
// yfov; an orthographic volume is widened to the picture's aspect so that all of it is seen.
glm::dmat4 projection_matrix(const Camera& lens, double aspect);

}  // namespace tessera
