#include "reference/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr std::uint32_t kLeafSize = 4;

double dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
glm::dvec3 cross(const glm::dvec3& a, const glm::dvec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// The camera-space position as the surface function has it, carried on in double.
glm::dvec3 to_camera(const float* rows, const float* p) {
    const double x = p[0], y = p[1], z = p[2];
    return {rows[0] * x + rows[1] * y + rows[2] * z + rows[3], rows[4] * x + rows[5] * y + rows[6] * z + rows[7],
            rows[8] * x + rows[9] * y + rows[10] * z + rows[11]};
}

}  // namespace

std::optional<RayHit> intersect(const CastRay& ray, const glm::dvec3& v0, const glm::dvec3& v1, const glm::dvec3& v2) {
    const glm::dvec3 &d = ray.direction, q0 = v0 - ray.origin, q1 = v1 - ray.origin, q2 = v2 - ray.origin;
    const double e0 = dot(d, cross(q1, q2)), e1 = dot(d, cross(q2, q0)), e2 = dot(d, cross(q0, q1));
    const bool positive = e0 >= 0 && e1 >= 0 && e2 >= 0, negative = e0 <= 0 && e1 <= 0 && e2 <= 0;
    const double sum = e0 + e1 + e2;
    if (!(positive || negative) || sum == 0) return std::nullopt;
    const double b0 = e0 / sum, b1 = e1 / sum, b2 = e2 / sum;
    const double t = (b0 * dot(q0, d) + b1 * dot(q1, d) + b2 * dot(q2, d)) / dot(d, d);
    if (!(t >= 0)) return std::nullopt;
    return RayHit{0, t, {b0, b1, b2}};
}

Bvh::Bvh(const Frame& frame, bool brute_force) {
    vertices_.reserve(3 * std::size_t{frame.triangle_count});
    for (const InstanceView& instance : frame.instances)
        for (std::size_t i = 0; i < 3 * std::size_t{instance.mesh.triangle_count}; ++i)
            vertices_.push_back(to_camera(instance.object_to_camera,
                                          instance.mesh.positions + 3 * std::size_t{instance.mesh.triangles[i]}));
    order_.resize(vertices_.size() / 3);
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    if (order_.empty()) return;
    const auto count = static_cast<std::uint32_t>(order_.size());
    nodes_.push_back({box_of(0, count), 0, count});
    if (!brute_force) build();
}

Bvh::Box Bvh::box_of(std::uint32_t first, std::uint32_t count) const {
    const double inf = std::numeric_limits<double>::infinity();
    Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
    for (std::uint32_t i = first; i < first + count; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3& v = vertices_[3 * std::size_t{order_[i]} + k];
            for (int axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], v[axis]);
                box.max[axis] = std::max(box.max[axis], v[axis]);
            }
        }
    return box;
}

void Bvh::build() {
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const std::uint32_t index = open.back();
        open.pop_back();
        const Node node = nodes_[index];
        if (node.count <= kLeafSize) continue;
        const glm::dvec3 extent = node.box.max - node.box.min;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
        const auto centre = [&](std::uint32_t t) {
            return vertices_[3 * std::size_t{t}][axis] + vertices_[3 * std::size_t{t} + 1][axis] +
                   vertices_[3 * std::size_t{t} + 2][axis];
        };
        const std::uint32_t half = node.count / 2;
        const auto begin = order_.begin() + node.first;
        std::nth_element(begin, begin + half, begin + node.count, [&](std::uint32_t a, std::uint32_t b) {
            const double ca = centre(a), cb = centre(b);
            return ca != cb ? ca < cb : a < b;
        });
        const auto child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({box_of(node.first, half), node.first, half});
        nodes_.push_back({box_of(node.first + half, node.count - half), node.first + half, node.count - half});
        nodes_[index].first = child;
        nodes_[index].count = 0;
        open.push_back(child);
        open.push_back(child + 1);
    }
}

void Bvh::traverse(const CastRay& ray, double t_min, double t_max,
                   const std::function<double(const RayHit&, double)>& visit) const {
    if (nodes_.empty()) return;
    // Distance along the ray to a box (the slabs of Kay and Kajiya 1986), widened against rounding;
    // infinite for a miss.
    const glm::dvec3 inverse{1.0 / ray.direction.x, 1.0 / ray.direction.y, 1.0 / ray.direction.z};
    const auto entry = [&](const Box& box) {
        double enter = t_min, leave = t_max;
        for (int axis = 0; axis < 3; ++axis) {
            double a = (box.min[axis] - ray.origin[axis]) * inverse[axis];
            double b = (box.max[axis] - ray.origin[axis]) * inverse[axis];
            if (a > b) std::swap(a, b);
            // A ray within a slab's own plane gives NaN: such a slab decides nothing.
            if (a == a) enter = std::max(enter, a - 1e-12 * std::fabs(a));
            if (b == b) leave = std::min(leave, b + 1e-12 * std::fabs(b));
        }
        return enter <= leave ? enter : std::numeric_limits<double>::infinity();
    };
    // Halving 2^32 triangles gives a tree of at most 33 levels, each of which leaves one node open.
    std::array<std::uint32_t, 64> open;
    std::size_t depth = 0;
    open[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[open[--depth]];
        if (!(entry(node.box) <= t_max)) continue;
        if (node.count == 0) {
            const std::uint32_t a = node.first, b = node.first + 1;
            const bool a_first = entry(nodes_[a].box) <= entry(nodes_[b].box);
            open[depth++] = a_first ? b : a;
            open[depth++] = a_first ? a : b;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const std::size_t v = 3 * std::size_t{order_[i]};
            std::optional<RayHit> hit = intersect(ray, vertices_[v], vertices_[v + 1], vertices_[v + 2]);
            if (!hit || hit->t < t_min || hit->t > t_max) continue;
            hit->triangle = order_[i];
            t_max = visit(*hit, t_max);
            if (t_max < t_min) return;
        }
    }
}

}  // namespace tessera
