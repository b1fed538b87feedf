#include "load/polygon.h"

#include "core/fp_environment.h"

#include <cmath>
#include <cstddef>

namespace tessera {
namespace {

struct Point {
    double x, y;
};

// Twice the signed area of a triangle.
double area(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Newell's area vector of a polygon (Sutherland, Sproull and Schumacker 1974), whose largest component says
// which coordinates to keep. Turned so that the polygon goes counter-clockwise.
std::vector<Point> in_plane(std::span<const Vec3> corners) {
    double n[3] = {0, 0, 0};
    const double ox = corners[0].x, oy = corners[0].y, oz = corners[0].z;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3 &a = corners[i], &b = corners[i + 1 < corners.size() ? i + 1 : 0];
        const double ax = a.x - ox, ay = a.y - oy, az = a.z - oz, bx = b.x - ox, by = b.y - oy, bz = b.z - oz;
        n[0] += ay * bz - az * by;
        n[1] += az * bx - ax * bz;
        n[2] += ax * by - ay * bx;
    }
    int axis = std::abs(n[0]) > std::abs(n[1]) ? 0 : 1;
    if (std::abs(n[2]) >= std::abs(n[axis])) axis = 2;
    const double sign = n[axis] < 0 ? -1 : 1;
    std::vector<Point> points;
    points.reserve(corners.size());
    for (const Vec3& p : corners) {
        const double c[3] = {p.x, p.y, p.z};
        points.push_back({c[(axis + 1) % 3] * sign, c[(axis + 2) % 3]});
    }
    return points;
}

// Cuts ears off a ring of corners.
class EarClipper {
  public:
    explicit EarClipper(std::vector<Point> points)
        : points_(std::move(points)), next_(count()), previous_(count()), budget_(4096 + 512 * std::int64_t{count()}) {
        for (std::uint32_t i = 0; i < count(); ++i) {
            next_[i] = i + 1 < count() ? i + 1 : 0;
            previous_[i] = i > 0 ? i - 1 : count() - 1;
        }
        for (std::uint32_t i = 0; i < count(); ++i)
            if (turn(i) <= 0) reflex_.push_back(i);
    }

    bool convex() const { return reflex_.empty(); }

    void run(std::vector<std::uint32_t>& triangles) {
        std::uint32_t at = 0, left = count(), tried = 0;
        while (left > 3) {
            // A whole round without an ear, or too much work: any corner must do.
            if (tried < left && budget_ > 0 && !is_ear(at)) {
                at = next_[at];
                ++tried;
                continue;
            }
            const std::uint32_t before = previous_[at], after = next_[at];
            triangles.insert(triangles.end(), {before, at, after});
            next_[before] = after;
            previous_[after] = before;
            next_[at] = at;  // out of the ring
            --left;
            tried = 0;
            at = next_[after];  // not beside the last ear: fans of slivers look bad
            if (left <= 3) at = after;
        }
        triangles.insert(triangles.end(), {previous_[at], at, next_[at]});
    }

  private:
    std::uint32_t count() const { return static_cast<std::uint32_t>(points_.size()); }
    double turn(std::uint32_t i) const { return area(points_[previous_[i]], points_[i], points_[next_[i]]); }

    bool is_ear(std::uint32_t i) {
        --budget_;
        if (turn(i) <= 0) return false;
        const Point &a = points_[previous_[i]], &b = points_[i], &c = points_[next_[i]];
        for (const std::uint32_t r : reflex_) {
            --budget_;
            if (next_[r] == r || r == previous_[i] || r == i || r == next_[i] || turn(r) > 0) continue;
            const Point& p = points_[r];
            if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0 && !same(p, a) && !same(p, c))
                return false;
        }
        return true;
    }
    // Bridges to holes pass the same point twice.
    static bool same(const Point& p, const Point& q) { return p.x == q.x && p.y == q.y; }

    std::vector<Point> points_;
    std::vector<std::uint32_t> next_, previous_, reflex_;
    // Tests that may be made: what simple polygons need, and what keeps time linear in the size of a file.
    std::int64_t budget_;
};

}  // namespace

void triangulate_polygon(std::span<const Vec3> corners, std::vector<std::uint32_t>& triangles) {
    const FpEnvironment exact;
    const auto count = static_cast<std::uint32_t>(corners.size());
    if (count == 3) {
        triangles.insert(triangles.end(), {0, 1, 2});
        return;
    }
    if (count < 3) return;
    EarClipper ears(in_plane(corners));
    if (!ears.convex()) return ears.run(triangles);
    for (std::uint32_t i = 1; i + 1 < count; ++i) triangles.insert(triangles.end(), {0, i, i + 1});
}

}  // namespace tessera
