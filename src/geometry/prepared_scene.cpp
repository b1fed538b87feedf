#include "geometry/prepared_scene.h"

#include "geometry/bounds.h"
#include "geometry/matrix.h"
#include "geometry/normals.h"
#include "geometry/tangents.h"
#include "geometry/texture_transform.h"

#include <algorithm>
#include <array>
#include <bit>
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

// Whether a second copy at the same place would be hidden by the first one, sample by sample.
bool is_solid(const Scene& scene, const Primitive& p) {
    return p.material == kNone || scene.materials[static_cast<std::size_t>(p.material)].alpha_mode != AlphaMode::kBlend;
}

// Where primitives have been placed. An exact duplicate of a solid one loses every depth test against
// the first (equal depth, higher number), so it is dropped before it costs anything.
class PlacesTaken {
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
    : made(std::move(m)),
      source(&s),
      triangles(primitive()),
      bounds(bounds_of(primitive().positions)),
      view(view_of(*this)) {
    if (view.triangle_count == 0) return;
    std::uint32_t low = view.triangles[0], high = low;
    for (std::size_t i = 0; i < 3 * std::size_t{view.triangle_count}; ++i) {
        low = std::min(low, view.triangles[i]);
        high = std::max(high, view.triangles[i]);
    }
    lowest_vertex = low;
    highest_vertex = high;
}

PreparedScene::PreparedScene(const Scene& scene) : scene_(scene), transforms_(node_transforms(scene)) {
    PlacesTaken taken;
    for (const int index : transforms_.order) {
        const Node& node = scene.nodes[static_cast<std::size_t>(index)];
        const auto first = static_cast<std::uint32_t>(placements_.size());
        PreparedNode prepared{index, node.light, node.mesh != kNone, false, first, first};
        if (prepared.has_mesh)
            for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
                if (!is_drawn(p.mode)) {
                    prepared.has_undrawn = true;
                    continue;
                }
                if (triangle_count(p) == 0) continue;
                if (is_solid(scene, p) && !taken.insert(&p, world(index))) continue;
                const int material = p.material == kNone ? static_cast<int>(scene.materials.size()) : p.material;
                placements_.push_back({&prepare(p), static_cast<std::uint32_t>(material)});
            }
        prepared.placement_end = static_cast<std::uint32_t>(placements_.size());
        if (prepared.has_mesh || prepared.light != kNone) nodes_.push_back(prepared);
    }
}

const PreparedMesh& PreparedScene::prepare(const Primitive& p) {
    const PreparedMesh*& mesh = prepared_[&p];
    if (!mesh) {
        const Material* material =
            p.material == kNone ? nullptr : &scene_.materials[static_cast<std::size_t>(p.material)];
        meshes_.push_back(std::make_unique<PreparedMesh>(complete(p, material), p));
        mesh = meshes_.back().get();
    }
    return *mesh;
}

std::vector<bool> PreparedScene::used_materials() const {
    std::vector<bool> used(scene_.materials.size() + 1, false);
    for (const Placement& p : placements_) used[p.material] = true;
    return used;
}

const PlacedCamera& PreparedScene::camera(const View& view, double aspect) {
    if (!chosen_ || chosen_->aspect != aspect || chosen_->view != view)
        chosen_ = {view, aspect, choose_camera(scene_, transforms_, view, aspect, [this](const PointVisitor& visit) {
                       visit_points(visit);
                   })};
    return chosen_->camera;
}

void PreparedScene::visit_points(const PointVisitor& visit) const {
    std::map<const Primitive*, std::vector<Vec3>> used;  // of each primitive, for its many instances
    for (const PreparedNode& n : nodes_) {
        if (!n.has_mesh) continue;
        const Node& node = scene_.nodes[static_cast<std::size_t>(n.node)];
        for (const Primitive& p : scene_.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
            if (!is_drawn(p.mode)) continue;
            std::vector<Vec3>& points = used[&p];
            if (points.empty()) points = used_positions(p);
            for (const Vec3& v : points) visit(transform_point(world(n.node), to_dvec3(v)));
        }
    }
}

}  // namespace tessera
