#include "reference/bvh.h"

#include "shading/shape_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace tessera {
namespace {

constexpr std::uint32_t kLeafSize = 4;
constexpr int kDeepest = 40;

double component(const Vec3d& v, int axis) { return axis == 0 ? v.x : (axis == 1 ? v.y : v.z); }

// The camera-space position as the surface function has it, carried on in double.
Vec3d to_camera(const float* rows, const Vec3d& p) {
    const double x = p.x, y = p.y, z = p.z;
    return {rows[0] * x + rows[1] * y + rows[2] * z + rows[3], rows[4] * x + rows[5] * y + rows[6] * z + rows[7],
            rows[8] * x + rows[9] * y + rows[10] * z + rows[11]};
}
Vec3d to_camera(const float* rows, const float* p) {
    return to_camera(rows, Vec3d{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
}

// The box around an instance's shape in camera space.
std::pair<Vec3d, Vec3d> shape_box(const InstanceView& instance) {
    const float* m = instance.object_to_camera;
    const auto reach = [&](int row) {
        const double x = m[4 * row], y = instance.shape.kind == ShapeView::Kind::kDisc ? 0.0f : m[4 * row + 1],
                     z = m[4 * row + 2];
        return instance.shape.radius * std::sqrt(x * x + y * y + z * z) * (1 + 1e-9);
    };
    const Vec3d centre = to_camera(m, Vec3d{0, 0, 0}), half{reach(0), reach(1), reach(2)};
    return {centre - half, centre + half};
}

}  // namespace

std::optional<RayHit> intersect(const CastRay& ray, const Vec3d& v0, const Vec3d& v1, const Vec3d& v2) {
    const Vec3d &d = ray.direction, q0 = v0 - ray.origin, q1 = v1 - ray.origin, q2 = v2 - ray.origin;
    const double e0 = dot(d, cross(q1, q2)), e1 = dot(d, cross(q2, q0)), e2 = dot(d, cross(q0, q1));
    const bool positive = e0 >= 0 && e1 >= 0 && e2 >= 0, negative = e0 <= 0 && e1 <= 0 && e2 <= 0;
    const double sum = e0 + e1 + e2;
    if (!(positive || negative) || sum == 0) return std::nullopt;
    const double b0 = e0 / sum, b1 = e1 / sum, b2 = e2 / sum;
    const double t = (b0 * dot(q0, d) + b1 * dot(q1, d) + b2 * dot(q2, d)) / dot(d, d);
    if (!(t >= 0)) return std::nullopt;
    return RayHit{0, t, {b0, b1, b2}};
}

std::optional<RayHit> intersect_shape(const CastRay& ray, const InstanceView& instance, bool leaving) {
    const ShapeView& shape = instance.shape;
    const float* m = shape.camera_to_object;
    const Vec3d o = to_camera(m, ray.origin), d = to_camera(m, ray.origin + ray.direction) - o;
    const double r = shape.radius;
    double t = 0;
    if (shape.kind == ShapeView::Kind::kDisc) {
        t = -o.y / d.y;
        const double x = o.x + d.x * t, z = o.z + d.z * t;
        if (d.y == 0 || !(x * x + z * z <= r * r)) return std::nullopt;
    } else {
        const double a = dot(d, d), nearest = -dot(o, d) / a;
        const Vec3d p = o + d * nearest;
        const double rest = r * r - dot(p, p);
        if (!(rest >= 0)) return std::nullopt;
        t = nearest + (leaving ? std::sqrt(rest / a) : -std::sqrt(rest / a));
    }
    if (!(t >= 0)) return std::nullopt;
    return RayHit{0, t, {1, 0, 0}};
}

Bvh::Bvh(const Frame& frame, bool brute_force) {
    vertices_.reserve(3 * std::size_t{frame.triangle_count});
    if (frame.has_exact_shapes) shape_of_.resize(frame.triangle_count, nullptr);
    for (const InstanceView& instance : frame.instances) {
        if (instance.shape) {
            const auto [low, high] = shape_box(instance);
            for (std::uint32_t i = 0; i < instance.mesh.triangle_count; ++i) {
                shape_of_[vertices_.size() / 3] = &instance;
                vertices_.insert(vertices_.end(), {low, high, (low + high) * 0.5});
            }
            continue;
        }
        for (std::size_t i = 0; i < 3 * std::size_t{instance.mesh.triangle_count}; ++i)
            vertices_.push_back(to_camera(instance.object_to_camera,
                                          instance.mesh.positions + 3 * std::size_t{instance.mesh.triangles[i]}));
    }
    order_.resize(vertices_.size() / 3);
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    if (order_.empty()) return;
    const auto count = static_cast<std::uint32_t>(order_.size());
    nodes_.push_back({box_of(0, count), 0, count});
    if (!brute_force) build();
}

void Bvh::Box::add(const Vec3d& p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
}

void Bvh::Box::add(const Box& b) {
    if (!(b.min.x <= b.max.x)) return;
    add(b.min);
    add(b.max);
}

double Bvh::Box::area() const {
    const Vec3d e = max - min;
    return min.x <= max.x ? e.x * e.y + e.y * e.z + e.z * e.x : 0.0;
}

Bvh::Box Bvh::box_of(std::uint32_t first, std::uint32_t count) const {
    Box box;
    for (std::uint32_t i = first; i < first + count; ++i)
        for (std::size_t k = 0; k < 3; ++k) box.add(vertices_[3 * std::size_t{order_[i]} + k]);
    return box;
}

// Where to cut a node's range: by the surface area heuristic over sixteen bins of the centroids'
// longest axis (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"); in the
// middle where that finds no cut, or where the tree has grown deep.
std::uint32_t Bvh::partition(const Node& node, int depth) {
    constexpr int kBins = 16;
    const auto centre = [&](std::uint32_t t) {
        const Vec3d* v = &vertices_[3 * std::size_t{t}];
        return v[0] + v[1] + v[2];  // three times the centroid
    };
    Box centres;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) centres.add(centre(order_[i]));
    const Vec3d extent = centres.max - centres.min;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
    const auto begin = order_.begin() + node.first, end = begin + node.count;
    const double low = component(centres.min, axis), length = component(extent, axis);
    const auto bin_of = [&](std::uint32_t t) {
        return std::min(kBins - 1, static_cast<int>(kBins * (component(centre(t), axis) - low) / length));
    };
    if (length > 0 && depth < kDeepest) {
        Box boxes[kBins];
        std::uint32_t counts[kBins] = {};
        for (auto t = begin; t != end; ++t) {
            const int bin = bin_of(*t);
            ++counts[bin];
            for (std::size_t k = 0; k < 3; ++k) boxes[bin].add(vertices_[3 * std::size_t{*t} + k]);
        }
        double right_cost[kBins] = {};
        Box box;
        std::uint32_t count = 0;
        for (int i = kBins - 1; i > 0; --i) {
            box.add(boxes[i]);
            count += counts[i];
            right_cost[i] = count * box.area();
        }
        double best = std::numeric_limits<double>::infinity();
        int cut = 0;
        box = Box();
        count = 0;
        for (int i = 1; i < kBins; ++i) {
            box.add(boxes[i - 1]);
            count += counts[i - 1];
            const double cost = count * box.area() + right_cost[i];
            if (count > 0 && count < node.count && cost < best) {
                best = cost;
                cut = i;
            }
        }
        if (cut > 0)
            return static_cast<std::uint32_t>(
                std::partition(begin, end, [&](std::uint32_t t) { return bin_of(t) < cut; }) - begin);
    }
    const std::uint32_t half = node.count / 2;
    std::nth_element(begin, begin + half, end, [&](std::uint32_t x, std::uint32_t y) {
        const double cx = component(centre(x), axis), cy = component(centre(y), axis);
        return cx != cy ? cx < cy : x < y;
    });
    return half;
}

void Bvh::build() {
    struct Open {
        std::uint32_t node;
        int depth;
    };
    std::vector<Open> open{{0, 0}};
    while (!open.empty()) {
        const auto [index, depth] = open.back();
        open.pop_back();
        const Node node = nodes_[index];
        if (node.count <= kLeafSize) continue;
        const std::uint32_t left = partition(node, depth);
        const auto child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({box_of(node.first, left), node.first, left});
        nodes_.push_back({box_of(node.first + left, node.count - left), node.first + left, node.count - left});
        nodes_[index].first = child;
        nodes_[index].count = 0;
        open.push_back({child, depth + 1});
        open.push_back({child + 1, depth + 1});
    }
}

std::optional<RayHit> Bvh::intersect_number(const CastRay& ray, std::uint32_t number) const {
    if (!shape_of_.empty() && shape_of_[number]) {
        const InstanceView& instance = *shape_of_[number];
        return intersect_shape(ray, instance, number - instance.first_triangle == kLeavingSphere);
    }
    const std::size_t v = 3 * std::size_t{number};
    return intersect(ray, vertices_[v], vertices_[v + 1], vertices_[v + 2]);
}

void Bvh::traverse(const CastRay& ray, double t_min, double t_max,
                   const std::function<double(const RayHit&, double)>& visit) const {
    if (nodes_.empty()) return;
    // Distance along the ray to a box (the slabs of Kay and Kajiya 1986), widened against rounding;
    // infinite for a miss.
    const Vec3d inverse{1.0 / ray.direction.x, 1.0 / ray.direction.y, 1.0 / ray.direction.z};
    const auto entry = [&](const Box& box) {
        double enter = t_min, leave = t_max;
        for (int axis = 0; axis < 3; ++axis) {
            const double from = component(ray.origin, axis), scale = component(inverse, axis);
            double a = (component(box.min, axis) - from) * scale, b = (component(box.max, axis) - from) * scale;
            if (a > b) std::swap(a, b);
            // A ray within a slab's own plane gives NaN: such a slab decides nothing.
            constexpr double kLess = 1 - 1e-12, kMore = 1 + 1e-12;
            if (a == a) enter = std::max(enter, a * (a < 0 ? kMore : kLess));
            if (b == b) leave = std::min(leave, b * (b < 0 ? kLess : kMore));
        }
        return enter <= leave ? enter : std::numeric_limits<double>::infinity();
    };
    // Every level leaves one node open; from kDeepest on, 2^32 triangles halve at most 32 times more.
    std::array<std::uint32_t, kDeepest + 34> open;
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
            std::optional<RayHit> hit = intersect_number(ray, order_[i]);
            if (!hit || hit->t < t_min || hit->t > t_max) continue;
            hit->triangle = order_[i];
            t_max = visit(*hit, t_max);
            if (t_max < t_min) return;
        }
    }
}

}  // namespace tessera
