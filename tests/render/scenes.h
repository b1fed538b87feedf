// Small scenes for tests of whole pictures, built in code as an embedder would.
#pragma once

#include <tessera/tessera.h>

#include <cmath>
#include <string>

namespace tessera::test {

// One of the scenes/.
inline Scene scene_file(const char* name) {
    std::string path = TESSERA_SOURCE_DIR "/scenes/";
    return load_scene(path += name);
}

// An upright rectangle centred at (0, 0, z) that faces +Z.
inline Primitive rectangle(float half_width, float half_height, float z, int material) {
    Primitive p;
    p.positions = {{-half_width, -half_height, z},
                   {half_width, -half_height, z},
                   {half_width, half_height, z},
                   {-half_width, half_height, z}};
    p.normals.assign(4, {0, 0, 1});
    p.texcoords = {{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
    p.indices = {0, 1, 2, 0, 2, 3};
    p.material = material;
    return p;
}

inline void add_mesh(Scene& scene, Primitive p) {
    if (scene.scenes.empty()) scene.scenes.push_back({});
    scene.meshes.push_back({"", {std::move(p)}, {}, {}});
    Node node;
    node.mesh = static_cast<int>(scene.meshes.size()) - 1;
    scene.nodes.push_back(node);
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()) - 1);
}

inline int add_material(Scene& scene, const Material& m) {
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
}

inline Material unlit(Vec4 color) {
    Material m;
    m.model = ShadingModel::kUnlit;
    m.base_color = color;
    m.double_sided = true;
    return m;
}

inline Material lambert(Vec3 diffuse) {
    Material m;
    m.model = ShadingModel::kLambert;
    m.diffuse = diffuse;
    m.double_sided = true;
    return m;
}

// An orthographic camera at z = 10 that sees -1 .. 1 vertically.
inline void add_orthographic(Scene& scene) {
    Camera c;
    c.type = Camera::Type::kOrthographic;
    c.xmag = c.ymag = 1;
    c.znear = 0.1f;
    c.zfar = 20;
    scene.cameras.push_back(c);
    Node node;
    node.camera = static_cast<int>(scene.cameras.size()) - 1;
    node.translation = {0, 0, 10};
    scene.nodes.push_back(node);
    if (scene.scenes.empty()) scene.scenes.push_back({});
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()) - 1);
}

inline void add_light(Scene& scene, const Light& light, Vec3 translation, Quat rotation = {}) {
    scene.lights.push_back(light);
    Node node;
    node.light = static_cast<int>(scene.lights.size()) - 1;
    node.translation = translation;
    node.rotation = rotation;
    scene.nodes.push_back(node);
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()) - 1);
}

inline RenderOptions small(int width = 32, int height = 32, int samples = 1) {
    RenderOptions o;
    o.width = width;
    o.height = height;
    o.samples = samples;
    o.exposure_ev = 0.0f;
    o.tone_map = ToneMap::kNone;
    o.background.reset();
    o.want_linear = true;
    return o;
}

inline Vec4 linear_at(const RenderResult& r, int x, int y) {
    const float* p =
        r.linear.data<float>() +
        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(r.linear.width()) + static_cast<std::size_t>(x));
    return {p[0], p[1], p[2], p[3]};
}

inline bool same_bytes(const Image& a, const Image& b) {
    return a.width() == b.width() && a.height() == b.height() && a.format() == b.format() &&
           std::equal(a.bytes().begin(), a.bytes().end(), b.bytes().begin());
}

}  // namespace tessera::test
