#include "geometry/frame.h"

#include <tessera/error.h>

#include "geometry/bounds.h"
#include "geometry/matrix.h"
#include "geometry/normals.h"
#include "geometry/tangents.h"
#include "geometry/texture_transform.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <set>
#include <span>

namespace tessera {
namespace {

template <class T>
const float* floats(const std::vector<T>& v) {
    return v.empty() ? nullptr : reinterpret_cast<const float*>(v.data());
}

Bounds3 bounds_of(std::span<const Vec3> points) {
    Bounds3 b;
    for (const Vec3& p : points) b.add(p);
    return b;
}

void store_rows(const glm::dmat4& m, int rows, float* out) {
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < 4; ++c) out[4 * r + c] = static_cast<float>(m[c][r]);
}

// Tangents for the texture coordinates that the normal texture is sampled with: transformed, where its
// reference turns or mirrors them. Moving and scaling evenly leave tangents as they are.
Primitive with_tangents_for(const Primitive& p, const TextureRef& normal_map) {
    const auto set = static_cast<std::size_t>(normal_map.uv_set);
    const bool same_frame = normal_map.rotation == 0 && normal_map.scale.x > 0 && normal_map.scale.y > 0;
    if (same_frame || set >= p.texcoords.size()) return with_tangents(p, normal_map.uv_set);
    Primitive mapped = p;
    float m[6];
    texture_transform(normal_map, m);
    std::vector<Vec2> uv = p.texcoords[set];
    for (Vec2& t : uv) t = {m[0] * t.x + m[1] * t.y, m[3] * t.x + m[4] * t.y};
    mapped.texcoords.push_back(std::move(uv));
    mapped = with_tangents(mapped, static_cast<int>(p.texcoords.size()));
    mapped.texcoords.pop_back();
    return mapped;
}

// Adds the normals and tangents that drawing with this material needs and the file lacks.
Primitive complete(const Primitive& p, const Material* material) {
    Primitive made;
    if (p.normals.empty()) made = with_flat_normals(p);
    const TextureRef* normal_map = material ? &material->texture(TextureSlot::kNormal) : nullptr;
    if (normal_map && normal_map->texture != kNone) {
        const Primitive& current = made.positions.empty() ? p : made;
        if (current.tangents.empty()) made = with_tangents_for(current, *normal_map);
    }
    return made;
}

MeshView view_of(const PreparedMesh& mesh) {
    const Primitive& p = mesh.primitive();
    MeshView v{};
    v.positions = floats(p.positions);
    v.normals = floats(p.normals);
    v.tangents = floats(p.tangents);
    for (std::size_t i = 0; i < p.texcoords.size() && i < kMaxUvSets; ++i) v.uvs[i] = floats(p.texcoords[i]);
    if (!p.colors.empty()) v.colors = floats(p.colors[0]);
    v.triangles = mesh.triangles.indices().data();
    v.triangle_count = static_cast<std::uint32_t>(mesh.triangles.count());
    v.vertex_count = static_cast<std::uint32_t>(p.positions.size());
    return v;
}

ProjectionView make_projection(const Camera& lens, int width, int height) {
    const glm::dmat4 m = projection_matrix(lens, static_cast<double>(width) / height);
    ProjectionView p{};
    p.width = static_cast<float>(width);
    p.height = static_cast<float>(height);
    p.orthographic = lens.type == Camera::Type::kOrthographic;
    store_rows(m, 4, p.clip_from_camera);
    p.scale_x = p.clip_from_camera[0];
    p.scale_y = p.clip_from_camera[5];
    p.near = lens.znear;
    return p;
}

// Whether a second copy at the same place would be hidden by the first one, sample by sample.
bool is_solid(const Scene& scene, const Primitive& p) {
    return p.material == kNone || scene.materials[static_cast<std::size_t>(p.material)].alpha_mode != AlphaMode::kBlend;
}

// Where primitives have been placed. An exact duplicate of a solid one loses every depth test against
// the first (equal depth, higher number), so it is dropped before it costs anything.
class Placements {
  public:
    // False when the primitive was placed there before.
    bool insert(const Primitive* primitive, const glm::dmat4& world) {
        std::array<std::uint64_t, 17> key{};
        key[0] = reinterpret_cast<std::uintptr_t>(primitive);
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                key[static_cast<std::size_t>(1 + 4 * c + r)] = std::bit_cast<std::uint64_t>(world[c][r]);
        return seen_.insert(key).second;
    }

  private:
    std::set<std::array<std::uint64_t, 17>> seen_;
};

}  // namespace

PreparedMesh::PreparedMesh(Primitive&& m, const Primitive& s)
    : made(std::move(m)), source(&s), triangles(primitive()), bounds(bounds_of(primitive().positions)) {}

const InstanceView& Frame::instance_of(std::uint32_t number) const {
    const auto after = std::upper_bound(instances.begin(), instances.end(), number,
                                        [](std::uint32_t n, const InstanceView& i) { return n < i.first_triangle; });
    return *(after - 1);
}

Frame make_frame(const Scene& scene, const View& view, int width, int height) {
    const NodeTransforms nodes = node_transforms(scene);
    Frame frame;
    std::map<const Primitive*, std::vector<Vec3>> used;  // of each primitive, for its many instances
    const PlacedCamera camera =
        choose_camera(scene, nodes, view, static_cast<double>(width) / height, [&](const PointVisitor& visit) {
            for (const int node : nodes.order) {
                const int mesh = scene.nodes[static_cast<std::size_t>(node)].mesh;
                if (mesh == kNone) continue;
                const glm::dmat4& world = nodes.world[static_cast<std::size_t>(node)];
                for (const Primitive& p : scene.meshes[static_cast<std::size_t>(mesh)].primitives)
                    if (is_drawn(p.mode)) {
                        std::vector<Vec3>& points = used[&p];
                        if (points.empty()) points = used_positions(p);
                        for (const Vec3& v : points) visit(transform_point(world, to_dvec3(v)));
                    }
            }
        });
    frame.camera_to_world = camera.camera_to_world;
    frame.lens = camera.lens;
    frame.projection = make_projection(camera.lens, width, height);
    const glm::dmat4 world_to_camera = rigid_inverse(camera.camera_to_world);
    const glm::dmat4 camera_to_clip = projection_matrix(camera.lens, static_cast<double>(width) / height);

    std::map<const Primitive*, const PreparedMesh*> prepared;
    std::uint64_t triangles = 0;
    bool skipped_mode = false;
    Placements placements;
    for (const int index : nodes.order) {
        const Node& node = scene.nodes[static_cast<std::size_t>(index)];
        const glm::dmat4 node_to_camera = world_to_camera * nodes.world[static_cast<std::size_t>(index)];
        if (node.light != kNone) frame.lights.push_back({node.light, node_to_camera});
        if (node.mesh == kNone) continue;
        const glm::dmat4 node_to_clip = camera_to_clip * node_to_camera;
        // Nothing can be said of where such a mesh is.
        if (!is_finite(node_to_clip) || !is_finite(to_dmat4(to_mat4(node_to_clip)))) {
            frame.warnings.push_back("node " + std::to_string(index) + ": its placement overflows; not drawn");
            continue;
        }
        for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
            if (!is_drawn(p.mode)) {
                skipped_mode = true;
                continue;
            }
            if (triangle_count(p) == 0) continue;
            if (is_solid(scene, p) && !placements.insert(&p, nodes.world[static_cast<std::size_t>(index)])) continue;
            const PreparedMesh*& mesh = prepared[&p];
            if (!mesh) {
                const Material* material =
                    p.material == kNone ? nullptr : &scene.materials[static_cast<std::size_t>(p.material)];
                frame.meshes.push_back(std::make_unique<PreparedMesh>(complete(p, material), p));
                mesh = frame.meshes.back().get();
            }
            InstanceView instance{};
            instance.mesh = view_of(*mesh);
            store_rows(node_to_clip, 4, instance.object_to_clip);
            store_rows(node_to_camera, 3, instance.object_to_camera);
            const glm::dmat3 normals = normal_matrix(node_to_camera);
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) instance.normal_to_camera[3 * r + c] = static_cast<float>(normals[c][r]);
            instance.handedness = determinant_sign(node_to_camera) < 0 ? -1.0f : 1.0f;
            instance.first_triangle = static_cast<std::uint32_t>(triangles);
            instance.material =
                static_cast<std::uint32_t>(p.material == kNone ? static_cast<int>(scene.materials.size()) : p.material);
            instance.node = static_cast<std::uint32_t>(index);
            triangles += instance.mesh.triangle_count;
            if (triangles > 0xfffffffeu) throw Error(ErrorCode::kLimit, "the scene has more than 4294967294 triangles");
            frame.instances.push_back(instance);
            frame.prepared.push_back(mesh);
        }
    }
    frame.triangle_count = static_cast<std::uint32_t>(triangles);
    if (skipped_mode) frame.warnings.push_back("points and lines are not drawn");
    return frame;
}

bool outside_view(const InstanceView& instance, const Bounds3& box) {
    if (box.empty()) return true;
    // Bit i stays set while every corner is outside plane i. The tolerance covers the rounding of the
    // vertices' own transformation in float, with room to spare.
    unsigned all = 63;
    for (int corner = 0; corner < 8; ++corner) {
        const double p[3] = {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                             corner & 4 ? box.max.z : box.min.z};
        double c[4], size = 0;
        for (int r = 0; r < 4; ++r) {
            const float* m = instance.object_to_clip + 4 * r;
            c[r] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
            size = std::max(size, std::abs(m[0] * p[0]) + std::abs(m[1] * p[1]) + std::abs(m[2] * p[2]) +
                                      std::abs(static_cast<double>(m[3])));
        }
        const double eps = 1e-5 * size;
        all &= (c[0] < -c[3] - eps ? 1u : 0u) | (c[0] > c[3] + eps ? 2u : 0u) | (c[1] < -c[3] - eps ? 4u : 0u) |
               (c[1] > c[3] + eps ? 8u : 0u) | (c[2] > c[3] + eps ? 16u : 0u) | (c[2] < -eps ? 32u : 0u);
    }
    return all != 0;
}

}  // namespace tessera
