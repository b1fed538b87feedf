// The camera that frames what is visible in a three-quarter view: from the front right, a little above. Double
// precision, world space.
#pragma once

#include "geometry/camera.h"

namespace tessera {

// At the smallest distance from which all points are in the picture, with a margin. `turns`: from which they stay in it
// while the camera goes around the axis `up` through the middle of their box, the pivot of the camera.
PlacedCamera frame_scene(const glm::dvec3& up, double yfov, double aspect, bool turns,
                         const std::function<void(const PointVisitor&)>& for_each_point);

}  // namespace tessera
