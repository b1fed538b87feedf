// A pinhole camera by the textbook, in double: which way a picture position looks, and where a point is seen.
#pragma once

#include <tessera/view.h>

#include <array>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tessera::test {

inline constexpr double kFocal = 110;
inline constexpr Intrinsics kPinhole{kFocal, kFocal, 61, 43};

using Point = glm::dvec3;

// An eye that looks at a target.
struct Eye {
    Vec3 eye, target;

    View view() const {
        View v;
        v.eye = eye;
        v.target = target;
        v.intrinsics = kPinhole;
        return v;
    }
    Point at() const { return {eye.x, eye.y, eye.z}; }
    std::array<Point, 3> axes() const {  // right, down, forward
        const Point f = glm::normalize(Point(target.x, target.y, target.z) - at());
        const Point r = glm::normalize(glm::cross(f, Point(0, 1, 0)));
        return {r, glm::cross(f, r), f};
    }
    Point direction(double px, double py) const {  // through a picture position; 1 along the axis
        const auto [r, d, f] = axes();
        return f + r * ((px - 0.5 - kPinhole.cx) / kFocal) + d * ((py - 0.5 - kPinhole.cy) / kFocal);
    }
    std::array<double, 2> project(const Point& p) const {
        const auto [r, d, f] = axes();
        const Point q = p - at();
        const double z = glm::dot(q, f);
        return {kFocal * glm::dot(q, r) / z + kPinhole.cx + 0.5, kFocal * glm::dot(q, d) / z + kPinhole.cy + 0.5};
    }
};

}  // namespace tessera::test
