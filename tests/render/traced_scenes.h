// Bodies of glass, mirrors and lamps for tests of traced light, and counts of pixels that differ.
#pragma once

#include "reference/workload_scene.h"
#include "render/scenes.h"

#include <array>
#include <cstring>
#include <filesystem>

namespace tessera::test {

inline constexpr std::array kTracers{Engine::kTrace, Engine::kHybrid, Engine::kReferenceTrace};

// Clear and smooth: a body of glass, or a pane of it.
inline Material glass(float ior, Vec3 tint = {1, 1, 1}) {
    Material m;
    m.base_color = {tint.x, tint.y, tint.z, 1};
    m.metallic = m.roughness = 0;
    m.transmission = 1;
    m.ior = ior;
    m.volume.thickness = 1;
    return m;
}
inline Material pane(Vec3 tint = {1, 1, 1}) {
    Material m = glass(1.5f, tint);
    m.volume.thickness = 0;
    m.double_sided = true;
    return m;
}

inline Primitive sphere(int rings, int material) {
    Primitive p = make_scene(wl::sphere(rings)).meshes[0].primitives[0];
    p.material = material;
    return p;
}

// Flat faces, each a convex polygon, counter-clockwise from outside.
inline Primitive solid(const std::vector<std::vector<Vec3>>& faces, int material) {
    Primitive p;
    p.material = material;
    for (const std::vector<Vec3>& face : faces) {
        const auto first = static_cast<std::uint32_t>(p.positions.size());
        for (std::uint32_t i = 0; i < face.size(); ++i) {
            p.positions.push_back(face[i]);
            p.normals.push_back(normalize(cross(face[1] - face[0], face[2] - face[0])));
            if (i >= 2) p.indices.insert(p.indices.end(), {first, first + i - 1, first + i});
        }
    }
    return p;
}

inline Primitive box(Vec3 half, int material) {
    const auto corner = [&](int i) {
        return Vec3{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
    };
    std::vector<std::vector<Vec3>> faces;
    for (const auto& f : {std::array{4, 5, 7, 6}, std::array{1, 0, 2, 3}, std::array{5, 1, 3, 7},
                          std::array{0, 4, 6, 2}, std::array{6, 7, 3, 2}, std::array{0, 1, 5, 4}})
        faces.push_back({corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])});
    return solid(faces, material);
}

inline Node& place(Scene& scene, Primitive p, Vec3 translation, Quat rotation = {}, Vec3 scale = {1, 1, 1}) {
    add_mesh(scene, std::move(p));
    Node& node = scene.nodes.back();
    node.translation = translation, node.rotation = rotation, node.scale = scale;
    return node;
}

// Turns -Z, along which lights shine and cameras look, to a unit direction (not +Z).
inline Quat toward(Vec3 d) {
    const float w = std::sqrt((1 - d.z) / 2);
    return {d.y / (2 * w), -d.x / (2 * w), 0, w};
}

inline void add_sun(Scene& scene, Vec3 to_light, float intensity = 3) {
    Light sun;
    sun.type = LightType::kDirectional;
    sun.intensity = intensity;
    if (scene.scenes.empty()) scene.scenes.push_back({});
    add_light(scene, sun, {}, toward(normalize(-to_light)));
}

// Only what the scene's lights and bodies send, all of it.
inline RenderOptions traced(Engine engine, int width, int height) {
    RenderOptions o = small(width, height);
    o.engine = engine;
    o.lighting = Lighting::kScene;
    o.ambient = 0.0f;
    o.min_contribution = 0;
    return o;
}

// Pixels whose bytes are not the same.
inline std::size_t differing_pixels(const Image& a, const Image& b) {
    if (a.width() != b.width() || a.height() != b.height() || a.format() != b.format()) return std::size_t(-1);
    const std::size_t size = bytes_per_pixel(a.format()), pixels = a.bytes().size() / size;
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels; ++i)
        count += std::memcmp(a.bytes().data() + i * size, b.bytes().data() + i * size, size) != 0;
    return count;
}

// Every glTF file of scenes/, sorted.
inline std::vector<std::string> all_scene_files() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(TESSERA_SOURCE_DIR "/scenes"))
        if (entry.path().extension() == ".gltf") names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace tessera::test
