#include "geometry/bounds.h"

#include "core/fp_environment.h"
#include "geometry/matrix.h"
#include "geometry/node_transforms.h"
#include "geometry/prepared_scene.h"
#include "geometry/triangles.h"
#include "scene/shapes.h"

#include <tessera/render.h>

#include <cstddef>
#include <glm/common.hpp>
#include <limits>
#include <span>

namespace tessera {
namespace {

struct Box {
    glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3& p) {
        if (!is_finite(p)) return;
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    bool holds(const glm::dvec3& p) const {
        return glm::all(glm::lessThanEqual(min, p)) && glm::all(glm::lessThanEqual(p, max));
    }
};

void add_points(Box& box, std::span<const Vec3> points, const glm::dmat4& to_world) {
    for (const Vec3& p : points) box.add(transform_point(to_world, to_dvec3(p)));
}

// Whether the transformed points can widen the box: not when the corners of their own box, with room
// for rounding, lie inside it. Spares most of the work where a mesh has many instances.
bool may_widen(const Box& box, const Bounds3& local, const glm::dmat4& to_world) {
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p{corner & 1 ? local.max.x : local.min.x, corner & 2 ? local.max.y : local.min.y,
                           corner & 4 ? local.max.z : local.min.z};
        const glm::dvec3 q = transform_point(to_world, p);
        const glm::dvec3 size = glm::abs(glm::dvec3(to_world[0]) * p.x) + glm::abs(glm::dvec3(to_world[1]) * p.y) +
                                glm::abs(glm::dvec3(to_world[2]) * p.z) + glm::abs(glm::dvec3(to_world[3]));
        const glm::dvec3 slack = size * 1e-14;
        if (!is_finite(q) || !box.holds(q - slack) || !box.holds(q + slack)) return true;
    }
    return false;
}

Bounds3 rounded(const Box& box) {
    Bounds3 result;
    if (!(box.min.x <= box.max.x)) return result;
    const glm::dvec3 limit(static_cast<double>(std::numeric_limits<float>::max()));
    result.add(to_vec3(glm::clamp(box.min, -limit, limit)));
    result.add(to_vec3(glm::clamp(box.max, -limit, limit)));
    return result;
}

struct MeshPoints {
    bool ready = false;
    std::vector<Vec3> points;
    Bounds3 box;
};

MeshPoints drawn_points(const Mesh& mesh) {
    MeshPoints result{true, {}, {}};
    for (const Primitive& primitive : mesh.primitives) {
        const std::vector<Vec3> used = used_positions(primitive);
        result.points.insert(result.points.end(), used.begin(), used.end());
    }
    for (const Vec3& p : result.points) result.box.add(p);
    return result;
}

// Whether vertices are elsewhere than in the arrays of the scene.
bool is_deformed(const Scene& scene) {
    if (!scene.skins.empty()) return true;
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives)
            if (is_morphed(p)) return true;
    return false;
}

}  // namespace

std::vector<Vec3> used_positions(const Primitive& primitive) {
    if (primitive.shape && is_endless(*primitive.shape)) return {};
    const std::size_t count = used_index_count(primitive);
    if (primitive.indices.empty()) {
        const std::span<const Vec3> used = std::span(primitive.positions).first(count);
        return {used.begin(), used.end()};
    }
    std::vector<char> is_used(primitive.positions.size(), 0);
    for (const std::uint32_t i : std::span(primitive.indices).first(count)) is_used[i] = 1;
    std::vector<Vec3> result;
    for (std::size_t i = 0; i < is_used.size(); ++i)
        if (is_used[i]) result.push_back(primitive.positions[i]);
    return result;
}

Bounds3 transformed_bounds(const Primitive& primitive, const glm::dmat4& to_world) {
    const FpEnvironment exact;
    Box box;
    add_points(box, used_positions(primitive), to_world);
    return rounded(box);
}

Bounds3 visible_bounds(const Scene& scene) {
    const FpEnvironment exact;
    if (is_deformed(scene)) {
        Box box;
        PreparedScene(scene).visit_points([&](const glm::dvec3& p) { box.add(p); });
        return rounded(box);
    }
    const NodeTransforms nodes = node_transforms(scene);
    std::vector<MeshPoints> meshes(scene.meshes.size());
    Box box;
    for (const int n : nodes.order) {
        const int mesh = scene.nodes[static_cast<std::size_t>(n)].mesh;
        if (mesh == kNone) continue;
        MeshPoints& drawn = meshes[static_cast<std::size_t>(mesh)];
        if (!drawn.ready) drawn = drawn_points(scene.meshes[static_cast<std::size_t>(mesh)]);
        const auto add = [&](const glm::dmat4& to_world) {
            if (may_widen(box, drawn.box, to_world)) add_points(box, drawn.points, to_world);
        };
        const glm::dmat4& world = nodes.world[static_cast<std::size_t>(n)];
        const std::vector<MeshInstance>& instances = scene.nodes[static_cast<std::size_t>(n)].instances;
        if (instances.empty()) add(world);
        for (const MeshInstance& instance : instances) add(world * instance_matrix(instance));
    }
    return rounded(box);
}

}  // namespace tessera
