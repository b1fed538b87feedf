#include "load/mesh_scene.h"

#include <cmath>
#include <utility>

namespace tessera {

Material plain_material() {
    Material material;
    material.base_color = {0.8f, 0.8f, 0.8f, 1};
    material.metallic = 0;
    material.roughness = 0.6f;
    material.double_sided = true;
    return material;
}

void charge_polygon(LoadContext& context, std::size_t corners, std::size_t& largest) {
    constexpr std::uint64_t kBytesPerCorner = 64;
    if (corners <= largest) return;
    context.charge(kBytesPerCorner * (corners - largest));
    largest = corners;
}

Vec3 unit_normal(const Vec3& n) {
    const double x = n.x, y = n.y, z = n.z, squared = x * x + y * y + z * z;
    if (!(squared > 1e-60 && squared < 1e60)) return {0, 0, 1};
    const double length = std::sqrt(squared);
    return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

bool is_turned(const Vec3 (&p)[3], const Vec3 (&normals)[3]) {
    double e[2][3];
    for (int k = 0; k < 2; ++k) {
        e[k][0] = static_cast<double>(p[k + 1].x) - static_cast<double>(p[0].x);
        e[k][1] = static_cast<double>(p[k + 1].y) - static_cast<double>(p[0].y);
        e[k][2] = static_cast<double>(p[k + 1].z) - static_cast<double>(p[0].z);
    }
    const double n[3] = {e[0][1] * e[1][2] - e[0][2] * e[1][1], e[0][2] * e[1][0] - e[0][0] * e[1][2],
                         e[0][0] * e[1][1] - e[0][1] * e[1][0]};
    // Where the three disagree nothing is certain.
    int behind = 0;
    for (const Vec3& v : normals)
        behind +=
            n[0] * static_cast<double>(v.x) + n[1] * static_cast<double>(v.y) + n[2] * static_cast<double>(v.z) < 0;
    return behind == 3;
}

void add_mesh(LoadContext& context, Scene& scene, Mesh&& mesh) {
    context.charge(sizeof(Mesh) + sizeof(Node) + sizeof(int) + sizeof(Primitive) + 2 * mesh.name.size());
    if (scene.nodes.size() >= context.options().max_nodes)
        throw Error(ErrorCode::kLimit, "more nodes than the limit of " + std::to_string(context.options().max_nodes),
                    context.file());
    if (scene.scenes.empty()) scene.scenes.emplace_back();
    Node node;
    node.name = mesh.name;
    node.mesh = static_cast<int>(scene.meshes.size());
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
    scene.meshes.push_back(std::move(mesh));
}

void count_triangles(const LoadContext& context, std::uint64_t triangles, const std::string& place) {
    const std::uint64_t most = context.options().max_triangles;
    if (triangles > most)
        throw Error(ErrorCode::kLimit, "more triangles than the limit of " + std::to_string(most), context.file(),
                    place);
}

void finish_scene(const LoadContext& context, Scene& scene) {
    if (scene.scenes.empty()) scene.scenes.emplace_back();
    try {
        validate(scene);
    } catch (const Error& error) {
        context.fail(error.message(), error.location());
    }
    scene.warnings = context.warnings();
}

}  // namespace tessera
