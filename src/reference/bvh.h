// A plain bounding volume hierarchy over the triangles and exact shapes of a frame in camera space, double precision:
// split by the surface area heuristic, leaves of a few triangles. And the intersection test that both
// it and brute force use.
#pragma once

#include "geometry/frame.h"
#include "shading/vectors.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace tessera {

using Vec3d = Vec3T<double>;

struct CastRay {
    Vec3d origin, direction;  // camera space; any length above zero
};

struct RayHit {
    std::uint32_t triangle;  // number in the frame, 0-based
    double t;                // in units of the direction
    double b[3];             // barycentric coordinates
};

// The triangle (v0, v1, v2) and a ray, from either side, edges inclusive. The sign tests are triple
// products of the ray with each edge, which two triangles that share an edge compute as exact
// opposites: no ray slips between them (Kensler and Shirley 2006, "Optimizing ray-triangle
// intersection via automated search"). Empty for a miss, behind the origin, degenerate or edge-on.
std::optional<RayHit> intersect(const CastRay& ray, const Vec3d& v0, const Vec3d& v1, const Vec3d& v2);

// The same for an instance's shape (ShapeView): of a sphere where the ray enters, or where it leaves.
std::optional<RayHit> intersect_shape(const CastRay& ray, const InstanceView& instance, bool leaving);

class Bvh {
  public:
    // `brute_force` keeps one leaf of everything: O(rays * triangles), for comparison.
    explicit Bvh(const Frame& frame, bool brute_force = false);

    // Calls `visit` for the triangles that the ray hits with t in [t_min, t_max], in no special order.
    // It returns the new t_max, by which farther triangles are skipped; below t_min ends the search.
    void traverse(const CastRay& ray, double t_min, double t_max,
                  const std::function<double(const RayHit&, double t_max)>& visit) const;

    std::size_t triangle_count() const { return order_.size(); }

  private:
    struct Box {
        static constexpr double kInfinity = std::numeric_limits<double>::infinity();
        Vec3d min{kInfinity, kInfinity, kInfinity}, max{-kInfinity, -kInfinity, -kInfinity};
        void add(const Vec3d& p);
        void add(const Box& b);
        double area() const;  // half of the surface
    };
    struct Node {
        Box box;
        std::uint32_t first, count;  // leaf: range of order_; inner: count 0, children first and first + 1
    };
    Box box_of(std::uint32_t first, std::uint32_t count) const;
    std::uint32_t partition(const Node& node, int depth);
    void build();

    std::optional<RayHit> intersect_number(const CastRay& ray, std::uint32_t number) const;

    std::vector<Vec3d> vertices_;                // three per triangle, by number; of shapes the ends of their boxes
    std::vector<const InstanceView*> shape_of_;  // by number: of those that are none null; empty where there are none
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace tessera
