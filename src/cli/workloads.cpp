#include "cli/workloads.h"

#include "cli/parse.h"
#include "cli/traced_workloads.h"
#include "cli/workload_meshes.h"

#include <array>
#include <cmath>
#include <memory>

namespace tessera::cli {
namespace {

enum class Shape { kSphere, kTerrain, kSoup, kLayers };
enum class Look { kBlinnPhong, kTextured, kFlat, kDepthOnly, kStudio };

struct Description {
    const char* name;
    Shape shape;
    int size;  // of the mesh; for layers 1 is front to back, -1 back to front
    Look look;
    std::uint64_t pixels, tolerance;  // at 1920 x 1080
};

// llvmpipe, MaskedOcclusionCulling and a scalar rasterizer agree on the counts. Of sphere10k two libraries
// have this one; samples that lie on an edge after snapping explain the tolerance.
constexpr std::array kWorkloads{
    Description{"sphere1m", Shape::kSphere, 500, Look::kBlinnPhong, 715620, 0},
    Description{"sphere100k", Shape::kSphere, 158, Look::kBlinnPhong, 715564, 0},
    Description{"sphere10k", Shape::kSphere, 50, Look::kBlinnPhong, 714916, 4},
    Description{"terrain1m", Shape::kTerrain, 707, Look::kBlinnPhong, 1242631, 0},
    Description{"terrain100k", Shape::kTerrain, 224, Look::kBlinnPhong, 1242622, 0},
    Description{"soup20k", Shape::kSoup, 20000, Look::kTextured, 2072594, 0},
    Description{"quads_f2b", Shape::kLayers, 1, Look::kFlat, 2073600, 0},
    Description{"quads_b2f", Shape::kLayers, -1, Look::kFlat, 2073600, 0},
    Description{"depth_sphere1m", Shape::kSphere, 500, Look::kDepthOnly, 715620, 0},
    Description{"depth_terrain1m", Shape::kTerrain, 707, Look::kDepthOnly, 1242631, 0},
    Description{"studio_sphere100k", Shape::kSphere, 158, Look::kStudio, 715564, 0},
};
constexpr int kKnownWidth = 1920, kKnownHeight = 1080;
constexpr int kLayerCount = 20;

float dot3(Vec3 a, Vec3 b) {
    const float x = a.x * b.x, y = a.y * b.y, z = a.z * b.z;
    return x + y + z;
}
Vec3 unit(Vec3 v) {
    const float s = 1.0f / std::sqrt(dot3(v, v));
    return {v.x * s, v.y * s, v.z * s};
}

Mat4 gl_look_at(Vec3 eye, Vec3 target) {
    const Vec3 forward = unit(target - eye), side = unit(cross(forward, Vec3{0, 1, 0})), up = cross(side, forward);
    const Vec3 rows[3] = {side, up, -forward};
    Mat4 m;
    for (int r = 0; r < 3; ++r) m(r, 0) = rows[r].x, m(r, 1) = rows[r].y, m(r, 2) = rows[r].z;
    m(0, 3) = -dot3(side, eye);
    m(1, 3) = -dot3(up, eye);
    m(2, 3) = dot3(forward, eye);
    return m;
}

Mat4 gl_perspective(int width, int height) {
    const float aspect = static_cast<float>(width) / static_cast<float>(height), near = 0.1f, far = 20.0f;
    const float half = std::tan(60.0f * 0.01745329251994329576923690768489f / 2.0f);
    Mat4 m{};
    m(0, 0) = 1.0f / (aspect * half);
    m(1, 1) = 1.0f / half;
    m(2, 2) = -(far + near) / (far - near);
    m(2, 3) = -(2.0f * far * near) / (far - near);
    m(3, 2) = -1.0f;
    m(3, 3) = 0.0f;
    return m;
}

// Clip space itself as a scene: z is turned so that it looks along -Z, two units away.
View layer_view() {
    View view;
    view.clip_from_world.emplace();
    (*view.clip_from_world)(2, 2) = -1;
    view.camera_from_world.emplace();
    (*view.camera_from_world)(2, 3) = -2;
    return view;
}

Scene scene_of(Primitive mesh, const Material& material) {
    Scene scene;
    scene.materials.push_back(material);
    mesh.material = 0;
    scene.meshes.push_back({"mesh", {std::move(mesh)}, {}, {}});
    scene.nodes.emplace_back().mesh = 0;
    scene.scenes.push_back({"scene", {0}, {}});
    return scene;
}

// albedo (0.1 + 0.9 n.l) + 0.4 (n.h)^32
Material blinn_phong(Vec3 albedo) {
    Material m;
    m.model = ShadingModel::kBlinnPhong;
    m.ambient = albedo * 0.1f;
    m.diffuse = albedo * 0.9f;
    m.specular = {0.4f, 0.4f, 0.4f};
    m.shininess = 32;
    return m;
}

void add_light(Scene& scene) {
    Light light;
    light.falloff = LightFalloff::kConstant;
    scene.lights.push_back(light);
    Node node;
    node.light = 0;
    node.translation = {3, 4, 5};
    scene.nodes.push_back(node);
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()) - 1);
    scene.ambient = Vec3{1, 1, 1};
}

void add_texture(Scene& scene) {
    scene.pictures.push_back({"checker", "", std::make_shared<const Image>(workload_texture(true)), ""});
    scene.textures.push_back({"checker", 0, kNone, ""});
    scene.materials[0].texture(TextureSlot::kBaseColor).texture = 0;
}

Material material_for(Look look) {
    if (look == Look::kStudio) return {};
    if (look == Look::kTextured) return blinn_phong({1, 1, 1});
    Material m = blinn_phong({0.8f, 0.5f, 0.3f});
    if (look == Look::kFlat) m.model = ShadingModel::kUnlit;
    return m;
}

Primitive mesh_for(const Description& d, int width, int height) {
    switch (d.shape) {
        case Shape::kSphere:
            return sphere_mesh(d.size);
        case Shape::kTerrain:
            return terrain_mesh(d.size);
        case Shape::kSoup:
            return soup_mesh(d.size, 8, width, height);
        case Shape::kLayers:
            break;
    }
    Primitive mesh = layer_mesh(kLayerCount, d.size > 0);
    for (Vec3& p : mesh.positions) p.z = -p.z;
    return mesh;
}

View view_for(Shape shape, int width, int height) {
    switch (shape) {
        case Shape::kSphere:
            return workload_view({0, 0, 2.2f}, {0, 0, 0}, width, height);
        case Shape::kTerrain:
            return workload_view({0, 0.9f, 1.3f}, {0, -0.15f, 0}, width, height);
        case Shape::kSoup:
            return workload_view({0, 0, 0}, {0, 0, -1}, width, height);
        case Shape::kLayers:
            break;
    }
    return layer_view();
}

Workload build(const Description& d, int width, int height) {
    Workload w;
    w.name = d.name;
    w.scene = scene_of(mesh_for(d, width, height), material_for(d.look));
    w.options.width = width;
    w.options.height = height;
    w.options.samples = 1;
    w.options.raster.count_samples = false;
    w.options.view = view_for(d.shape, width, height);
    if (d.look != Look::kStudio) {
        add_light(w.scene);
        w.options.exposure_ev = 0.0f;
        w.options.tone_map = ToneMap::kNone;
        w.options.encoding = Encoding::kLinear;
        w.options.background.reset();
    }
    if (d.look == Look::kTextured) add_texture(w.scene);
    if (d.look == Look::kDepthOnly) {
        w.options.want_color = false;
        w.options.want_depth = true;
    }
    if (width == kKnownWidth && height == kKnownHeight) {
        w.pixels = d.pixels;
        w.tolerance = d.tolerance;
    }
    return w;
}

}  // namespace

std::vector<std::string> workload_names() {
    std::vector<std::string> names;
    for (const Description& d : kWorkloads) names.emplace_back(d.name);
    for (const std::string& name : traced_workload_names()) names.push_back(name);
    return names;
}

Workload make_workload(const std::string& name, int width, int height) {
    for (const Description& d : kWorkloads)
        if (name == d.name) return build(d, width, height);
    if (std::optional<Workload> traced = make_traced_workload(name, width, height)) return *std::move(traced);
    std::string names;
    for (const std::string& known : workload_names()) names.append(names.empty() ? "" : ", ").append(known);
    refuse("--workload", "'" + name + "' is none of " + names);
}

std::string pixel_fault(const Workload& w, std::uint64_t covered) {
    if (!w.pixels || (covered > *w.pixels ? covered - *w.pixels : *w.pixels - covered) <= w.tolerance) return {};
    return w.name + ": " + std::to_string(*w.pixels) + " pixels wanted, " + std::to_string(covered) + " covered";
}

View workload_view(Vec3 eye, Vec3 target, int width, int height) {
    View view;
    view.camera_from_world = gl_look_at(eye, target);
    view.clip_from_world = gl_perspective(width, height) * *view.camera_from_world;
    return view;
}

}  // namespace tessera::cli
