#include "geometry/camera.h"

#include <tessera/error.h>

#include "geometry/framing.h"
#include "geometry/matrix.h"
#include "simd/math.h"

namespace tessera {
namespace {

constexpr double kDefaultFov = 0.61086523819801536;  // 35 degrees

glm::dvec3 column(const glm::dmat4& m, int i) { return {m[i].x, m[i].y, m[i].z}; }

// A node's placement without its scale: glTF cameras and lights ignore it.
glm::dmat4 orthonormal(const glm::dmat4& m) {
    const glm::dvec3 eye = column(m, 3);
    return placement_matrix(eye, eye - column(m, 2), column(m, 1));
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
    if (view.turn && (view.camera || view.camera_to_world))
        throw Error(ErrorCode::kUsage, "a turntable is a view that is framed, or placed by eye and target");
    if (!view.camera && view.camera_to_world) return posed_camera(view, yfov, for_each_point);
    if (view.camera || !(view.eye || view.target || view.frame_bounds || view.turn)) {
        for (const int node : nodes.order) {
            const int carried = scene.nodes[static_cast<std::size_t>(node)].camera;
            if (carried == kNone || (view.camera && carried != *view.camera)) continue;
            const glm::dmat4 placement = orthonormal(nodes.world[static_cast<std::size_t>(node)]);
            if (!is_finite(placement)) throw Error(ErrorCode::kUsage, "the camera's placement is not finite");
            PlacedCamera camera{placement, scene.cameras[static_cast<std::size_t>(carried)], {}, {}};
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
        PlacedCamera camera = frame_scene(up, yfov, aspect, view.turn.has_value(), for_each_point);
        if (view.target) {
            const glm::dvec3 eye = column(camera.camera_to_world, 3);
            camera.camera_to_world = placement_matrix(eye, to_dvec3(*view.target), up);
            camera.pivot = to_dvec3(*view.target);
        }
        return camera;
    }

    PlacedCamera camera;
    camera.lens.yfov = static_cast<float>(yfov);
    const Bounds3 bounds = bounds_of(for_each_point);
    const glm::dvec3 centre =
        bounds.empty() ? glm::dvec3(0, 0, 0) : (to_dvec3(bounds.min) + to_dvec3(bounds.max)) * 0.5;
    const glm::dvec3 eye = to_dvec3(*view.eye);
    camera.pivot = view.target ? to_dvec3(*view.target) : centre;
    camera.camera_to_world = placement_matrix(eye, camera.pivot, up);
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

PlacedCamera turned(PlacedCamera camera, const glm::dvec3& up, double angle) {
    if (!(angle - angle == 0)) throw Error(ErrorCode::kUsage, "the turn of the view must be finite");
    // Rodrigues' formula; no turn is exactly the identity.
    const glm::dvec3 u = up * (1.0 / std::sqrt(up.x * up.x + up.y * up.y + up.z * up.z));
    const double c = math::cos(angle), s = math::sin(angle);
    const auto turn = [&](const glm::dvec3& v) {
        const glm::dvec3 across(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
        const double along = u.x * v.x + u.y * v.y + u.z * v.z;
        return v * c + across * s + u * (along * (1 - c));
    };
    for (int i = 0; i < 3; ++i) camera.camera_to_world[i] = glm::dvec4(turn(column(camera.camera_to_world, i)), 0);
    const glm::dvec3 eye = column(camera.camera_to_world, 3);
    camera.camera_to_world[3] = glm::dvec4(camera.pivot + turn(eye - camera.pivot), 1);
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
