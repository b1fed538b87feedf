#include "geometry/framing.h"

#include "geometry/matrix.h"
#include "simd/math.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

// Three-quarter view: from the front right, a little above.
constexpr double kAzimuth = 0.61086523819801536;    // 35 degrees
constexpr double kElevation = 0.41887902047863912;  // 24 degrees
constexpr double kMargin = 1.12;                    // of the picture around the framed points

// The corner points of the framing problem in the axes of a camera at the origin.
struct Extent {
    double right = -std::numeric_limits<double>::infinity(), left = right, top = right, bottom = right;
    double nearest = right;  // largest z: closest to the camera, which looks along -Z
    bool empty = true;

    void add(double r, double l, double t, double b, double z) {
        right = std::max(right, r), left = std::max(left, l);
        top = std::max(top, t), bottom = std::max(bottom, b);
        nearest = std::max(nearest, z);
        empty = false;
    }
};

// Tangents of the half angles, the margin taken off.
struct HalfAngles {
    double x, y;
};

// The camera at the smallest distance from which all points lie inside the frustum, looking along -Z
// of `axes`: with t the tangent of the half angle, a point (a, b, c) is inside when
// |a - x| <= t (z - c). Both side planes together bound z; the larger of the two directions wins.
PlacedCamera camera_around(const Extent& e, const glm::dmat4& axes, double yfov, HalfAngles t) {
    glm::dvec3 eye(0, 0, 3);
    double near = 0.1;
    if (!e.empty) {
        eye = {0.5 * (e.right - e.left), 0.5 * (e.top - e.bottom),
               std::max((e.right + e.left) / (2 * t.x), (e.top + e.bottom) / (2 * t.y))};
        // A single point (or a line of sight) has no extent but what rounding makes of it: stand back by its own
        // scale. Very small scenes, and small ones far away, do have one.
        constexpr double kRounding = 1e-12, kAtTheOrigin = 1e-3;
        const double size = std::max({std::abs(eye.x), std::abs(eye.y), std::abs(e.nearest)});
        if (!(eye.z - e.nearest > kRounding * size)) eye.z = e.nearest + 2 * (size > 0 ? size : kAtTheOrigin);
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

Extent extent_of_points(const glm::dmat4& axes, HalfAngles t,
                        const std::function<void(const PointVisitor&)>& for_each_point) {
    const glm::dmat4 to_axes = rigid_inverse(axes);
    Extent e;
    for_each_point([&](const glm::dvec3& world) {
        const glm::dvec3 p = transform_point(to_axes, world);
        if (is_finite(p)) e.add(p.x + t.x * p.z, -p.x + t.x * p.z, p.y + t.y * p.z, -p.y + t.y * p.z, p.z);
    });
    return e;
}

double dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
glm::dvec3 unit(const glm::dvec3& v) { return v * (1.0 / std::sqrt(dot(v, v))); }

// The frame of the ground: `up` is up, and +Z is the front (glTF), or -Y where Z is up.
struct Ground {
    glm::dvec3 right, front, up;
};

Ground ground_of(const glm::dvec3& up) {
    const glm::dvec3 u = unit(up);
    const glm::dvec3 forward = std::abs(u.z) > 0.7 ? glm::dvec3(0, -1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 front = unit(forward - u * dot(forward, u));
    return {{u.y * front.z - u.z * front.y, u.z * front.x - u.x * front.z, u.x * front.y - u.y * front.x}, front, u};
}

// The direction from the scene to the framing camera.
glm::dvec3 three_quarter_direction(const Ground& g) {
    const double ce = math::cos(kElevation), se = math::sin(kElevation);
    return g.right * (math::sin(kAzimuth) * ce) + g.front * (math::cos(kAzimuth) * ce) + g.up * se;
}

// The middle of the points' box in the frame of the ground, world space.
glm::dvec3 middle_of_points(const Ground& g, const std::function<void(const PointVisitor&)>& for_each_point) {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    glm::dvec3 low(kFar, kFar, kFar), high(-kFar, -kFar, -kFar);
    for_each_point([&](const glm::dvec3& p) {
        const double at[3] = {dot(p, g.right), dot(p, g.front), dot(p, g.up)};
        if (!is_finite(p)) return;
        for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], at[i]), high[i] = std::max(high[i], at[i]);
    });
    if (!(low.x <= high.x)) return {0, 0, 0};
    const glm::dvec3 middle = (low + high) * 0.5;
    return g.right * middle.x + g.front * middle.y + g.up * middle.z;
}

// What the points reach while they go once around the axis `up` through `pivot`, seen along `axes`, whose right is
// level: at height h and radius r a point's circle is (r sin a, h ce - r cos a se, h se + r cos a ce), and each bound
// of the extent is a sine of a, whose greatest value is its amplitude.
Extent extent_of_circles(const Ground& g, const glm::dvec3& pivot, HalfAngles t,
                         const std::function<void(const PointVisitor&)>& for_each_point) {
    const double ce = math::cos(kElevation), se = math::sin(kElevation);
    const double side = std::sqrt(1 + t.x * t.x * ce * ce);
    Extent e;
    for_each_point([&](const glm::dvec3& world) {
        const glm::dvec3 p = world - pivot;
        const double h = dot(p, g.up), x = dot(p, g.right), z = dot(p, g.front), r = std::sqrt(x * x + z * z);
        if (!is_finite(p) || !(r - r == 0)) return;
        const double across = t.x * h * se + r * side;
        e.add(across, across, h * (ce + t.y * se) + r * std::abs(t.y * ce - se),
              h * (t.y * se - ce) + r * (t.y * ce + se), h * se + r * ce);
    });
    return e;
}

}  // namespace

PlacedCamera frame_scene(const glm::dvec3& up, double yfov, double aspect, bool turns,
                         const std::function<void(const PointVisitor&)>& for_each_point) {
    const Ground ground = ground_of(up);
    const double ty = math::tan(0.5 * yfov) / kMargin;
    const HalfAngles t{ty * aspect, ty};
    glm::dmat4 axes = placement_matrix(three_quarter_direction(ground), glm::dvec3(0, 0, 0), up);
    axes[3] = glm::dvec4(0, 0, 0, 1);
    if (!turns) return camera_around(extent_of_points(axes, t, for_each_point), axes, yfov, t);
    const glm::dvec3 pivot = middle_of_points(ground, for_each_point);
    axes[3] = glm::dvec4(pivot, 1);
    PlacedCamera camera = camera_around(extent_of_circles(ground, pivot, t, for_each_point), axes, yfov, t);
    camera.pivot = pivot;
    return camera;
}

}  // namespace tessera
