#include "geometry/camera.h"

#include <tessera/error.h>

#include "geometry/matrix.h"
#include "simd/math.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

constexpr double kDefaultFov = 0.61086523819801536;  // 35 degrees
// Three-quarter view: from the front right, a little above.
constexpr double kAzimuth = 0.61086523819801536;    // 35 degrees
constexpr double kElevation = 0.41887902047863912;  // 24 degrees
constexpr double kMargin = 1.12;                    // of the picture around the framed points

glm::dvec3 column(const glm::dmat4& m, int i) { return {m[i].x, m[i].y, m[i].z}; }

// A node's placement without its scale: glTF cameras and lights ignore it.
glm::dmat4 orthonormal(const glm::dmat4& m) {
    const glm::dvec3 eye = column(m, 3);
    return placement_matrix(eye, eye - column(m, 2), column(m, 1));
}

// The corner points of the framing problem in the axes of a camera at the origin.
struct Extent {
    double right = -std::numeric_limits<double>::infinity(), left = right, top = right, bottom = right;
    double nearest = right;  // largest z: closest to the camera, which looks along -Z
    bool empty = true;
};

// The camera at the smallest distance from which all points lie inside the frustum, looking along -Z
// of `axes`: with t the tangent of the half angle, a point (a, b, c) is inside when
// |a - x| <= t (z - c). Both side planes together bound z; the larger of the two directions wins.
PlacedCamera frame_points(const glm::dmat4& axes, double yfov, double aspect,
                          const std::function<void(const PointVisitor&)>& for_each_point) {
    const double ty = math::tan(0.5 * yfov) / kMargin, tx = ty * aspect;
    const glm::dmat4 to_axes = rigid_inverse(axes);
    Extent e;
    for_each_point([&](const glm::dvec3& world) {
        const glm::dvec3 p = transform_point(to_axes, world);
        if (!is_finite(p)) return;
        e.right = std::max(e.right, p.x + tx * p.z);
        e.left = std::max(e.left, -p.x + tx * p.z);
        e.top = std::max(e.top, p.y + ty * p.z);
        e.bottom = std::max(e.bottom, -p.y + ty * p.z);
        e.nearest = std::max(e.nearest, p.z);
        e.empty = false;
    });
    glm::dvec3 eye(0, 0, 3);
    double near = 0.1;
    if (!e.empty) {
        eye = {0.5 * (e.right - e.left), 0.5 * (e.top - e.bottom),
               std::max((e.right + e.left) / (2 * tx), (e.top + e.bottom) / (2 * ty))};
        // A single point (or a line of sight) has no extent: stand back by its own scale.
        const double size = std::max({std::abs(eye.x), std::abs(eye.y), std::abs(e.nearest), 1e-3});
        if (!(eye.z - e.nearest > 1e-6 * size)) eye.z = e.nearest + 2 * size;
        near = 0.5 * (eye.z - e.nearest);
    }
    PlacedCamera camera;
    camera.camera_to_world = axes;
    const glm::dvec3 world_eye = transform_point(axes, eye);
    camera.camera_to_world[3] = glm::dvec4(world_eye, 1.0);
    camera.lens.yfov = static_cast<float>(yfov);
    camera.lens.znear = static_cast<float>(near);
    return camera;
}

glm::dvec3 unit(const glm::dvec3& v) { return v * (1.0 / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z)); }

// The direction from the scene to the framing camera: `up` is up, and +Z is the front (glTF), or -Y
// where Z is up.
glm::dvec3 three_quarter_direction(const glm::dvec3& up) {
    const glm::dvec3 u = unit(up);
    const glm::dvec3 forward = std::abs(u.z) > 0.7 ? glm::dvec3(0, -1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 front = unit(forward - u * (forward.x * u.x + forward.y * u.y + forward.z * u.z));
    const glm::dvec3 right(u.y * front.z - u.z * front.y, u.z * front.x - u.x * front.z, u.x * front.y - u.y * front.x);
    const double ce = math::cos(kElevation), se = math::sin(kElevation);
    return right * (math::sin(kAzimuth) * ce) + front * (math::cos(kAzimuth) * ce) + u * se;
}

Bounds3 bounds_of(const std::function<void(const PointVisitor&)>& for_each_point) {
    Bounds3 bounds;
    for_each_point([&](const glm::dvec3& p) {
        if (is_finite(p)) bounds.add(to_vec3(p));
    });
    return bounds;
}

// The near plane of a camera that stands anywhere. Reversed depth in float is precise however near the plane; a
// thousandth of the distance scale keeps it out of the way.
float near_for(const glm::dvec3& eye, const Bounds3& bounds) {
    const glm::dvec3 centre =
        bounds.empty() ? glm::dvec3(0, 0, 0) : (to_dvec3(bounds.min) + to_dvec3(bounds.max)) * 0.5;
    const glm::dvec3 d = centre - eye;
    const glm::dvec3 half = bounds.empty() ? glm::dvec3(1, 1, 1) : to_dvec3(bounds.max) - centre;
    const double scale =
        std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) + std::sqrt(half.x * half.x + half.y * half.y + half.z * half.z);
    return static_cast<float>(scale > 0 ? 1e-3 * scale : 1e-3);
}

// Where the view says, as a matrix.
PlacedCamera posed_camera(const View& view, double yfov,
                          const std::function<void(const PointVisitor&)>& for_each_point) {
    PlacedCamera camera;
    camera.camera_to_world = to_dmat4(*view.camera_to_world);
    if (!is_finite(camera.camera_to_world) || !is_rigid(camera.camera_to_world))
        throw Error(ErrorCode::kUsage,
                    "camera_to_world must be rigid: a rotation and a translation, without scale or mirroring");
    camera.lens.yfov = static_cast<float>(yfov);
    camera.lens.znear = near_for(column(camera.camera_to_world, 3), bounds_of(for_each_point));
    return camera;
}

PlacedCamera place_camera(const Scene& scene, const NodeTransforms& nodes, const View& view, double aspect,
                          const std::function<void(const PointVisitor&)>& for_each_point) {
    const double yfov = view.yfov ? static_cast<double>(*view.yfov) : kDefaultFov;
    if (!(yfov > 0 && yfov < 3.1415))
        throw Error(ErrorCode::kUsage, "the field of view must be above 0 and below 180 degrees");
    if (view.camera) {
        const int wanted = *view.camera;
        if (wanted < 0 || wanted >= static_cast<int>(scene.cameras.size()))
            throw Error(ErrorCode::kUsage, "camera " + std::to_string(wanted) + " does not exist: the scene has " +
                                               std::to_string(scene.cameras.size()));
    }
    if (!view.camera && view.camera_to_world) return posed_camera(view, yfov, for_each_point);
    if (view.camera || !(view.eye || view.target || view.frame_bounds)) {
        for (const int node : nodes.order) {
            const int carried = scene.nodes[static_cast<std::size_t>(node)].camera;
            if (carried == kNone || (view.camera && carried != *view.camera)) continue;
            const glm::dmat4 placement = orthonormal(nodes.world[static_cast<std::size_t>(node)]);
            if (!is_finite(placement)) throw Error(ErrorCode::kUsage, "the camera's placement is not finite");
            PlacedCamera camera{placement, scene.cameras[static_cast<std::size_t>(carried)], {}};
            if (view.yfov) camera.lens.yfov = *view.yfov;
            return camera;
        }
        if (view.camera)
            throw Error(ErrorCode::kUsage,
                        "camera " + std::to_string(*view.camera) + " is carried by no node of the active scene");
    }

    const glm::dvec3 up = to_dvec3(view.up);
    if (!is_finite(up) || (up.x == 0 && up.y == 0 && up.z == 0))
        throw Error(ErrorCode::kUsage, "the up vector must be finite and not zero");
    if (!view.eye) {
        // Framed; a target alone is looked at from the framing distance around it.
        const glm::dmat4 axes = placement_matrix(three_quarter_direction(up), glm::dvec3(0, 0, 0), up);
        glm::dmat4 turned = axes;
        turned[3] = glm::dvec4(0, 0, 0, 1);
        PlacedCamera camera = frame_points(turned, yfov, aspect, for_each_point);
        if (view.target) {
            const glm::dvec3 eye = column(camera.camera_to_world, 3);
            camera.camera_to_world = placement_matrix(eye, to_dvec3(*view.target), up);
        }
        return camera;
    }

    PlacedCamera camera;
    camera.lens.yfov = static_cast<float>(yfov);
    const Bounds3 bounds = bounds_of(for_each_point);
    const glm::dvec3 centre =
        bounds.empty() ? glm::dvec3(0, 0, 0) : (to_dvec3(bounds.min) + to_dvec3(bounds.max)) * 0.5;
    const glm::dvec3 eye = to_dvec3(*view.eye);
    camera.camera_to_world = placement_matrix(eye, view.target ? to_dvec3(*view.target) : centre, up);
    if (!is_finite(camera.camera_to_world)) throw Error(ErrorCode::kUsage, "eye and target must be finite");
    camera.lens.znear = near_for(eye, bounds);
    return camera;
}

}  // namespace

PlacedCamera choose_camera(const Scene& scene, const NodeTransforms& nodes, const View& view, double aspect,
                           const std::function<void(const PointVisitor&)>& for_each_point) {
    PlacedCamera camera = place_camera(scene, nodes, view, aspect, for_each_point);
    camera.intrinsics = view.intrinsics;
    return camera;
}

glm::dmat4 projection_matrix(const Camera& lens, double aspect) {
    const std::optional<double> far = lens.zfar ? std::optional<double>(*lens.zfar) : std::nullopt;
    if (lens.type == Camera::Type::kPerspective) return perspective_matrix(lens.yfov, aspect, lens.znear, far);
    double x = std::abs(lens.xmag), y = std::abs(lens.ymag);
    if (x < y * aspect)
        x = y * aspect;
    else
        y = x / aspect;
    return orthographic_matrix(-x, x, -y, y, lens.znear, far ? *far : lens.znear + 1e4);
}

}  // namespace tessera
