#include "geometry/prepared_mesh.h"

#include "geometry/normals.h"
#include "geometry/tangents.h"
#include "geometry/texture_transform.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace tessera {
namespace {

template <class T>
const float* floats(const std::vector<T>& v) {
    return v.empty() ? nullptr : reinterpret_cast<const float*>(v.data());
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
    if (!has_triangles(p.mode)) return made;
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
    v.whole = p.shape.has_value();
    return v;
}

}  // namespace

PreparedMesh::PreparedMesh(Primitive&& m, const Primitive& s) : made(std::move(m)), source(&s), triangles(primitive()) {
    view = view_of(*this);
    measure();
    if (view.triangle_count == 0) return;
    std::uint32_t low = view.triangles[0], high = low;
    for (std::size_t i = 0; i < 3 * std::size_t{view.triangle_count}; ++i) {
        low = std::min(low, view.triangles[i]);
        high = std::max(high, view.triangles[i]);
    }
    lowest_vertex = low;
    highest_vertex = high;
}

void PreparedMesh::measure() {
    bounds = {};
    for (const Vec3& p : primitive().positions) bounds.add(p);
}

PreparedMesh prepare_mesh(const Primitive& primitive, const Material* material) {
    return {complete(primitive, material), primitive};
}

}  // namespace tessera
