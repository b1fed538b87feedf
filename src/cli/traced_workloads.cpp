// The workloads of `tessera bench` for light that is traced: the meshes, camera and light of
// bench/peers/embree_scenes.h.
#include "cli/traced_workloads.h"

#include <array>
#include <cmath>

namespace tessera::cli {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Radius 1 around (0, 1, 0): 2 * around * (down - 1) triangles.
Primitive uv_sphere(int around, int down) {
    Primitive p;
    for (int j = 0; j <= down; ++j)
        for (int k = 0; k < around; ++k) {
            const double theta = kPi * j / down, phi = 2 * kPi * k / around;
            const double x = std::sin(theta) * std::cos(phi), y = std::cos(theta), z = std::sin(theta) * std::sin(phi);
            p.positions.push_back({static_cast<float>(x), static_cast<float>(1 + y), static_cast<float>(z)});
        }
    for (int j = 0; j < down; ++j)
        for (int k = 0; k < around; ++k) {
            const auto row = static_cast<std::uint32_t>(around);
            const auto a = static_cast<std::uint32_t>(j * around + k);
            const auto b = static_cast<std::uint32_t>(j * around + (k + 1) % around);
            if (j > 0) p.indices.insert(p.indices.end(), {a, b, b + row});
            if (j < down - 1) p.indices.insert(p.indices.end(), {a, b + row, a + row});
        }
    return p;
}

float height(float x, float z) {
    return 0.40f * std::sin(1.7f * x) * std::cos(1.3f * z) + 0.15f * std::sin(5.1f * x + 1.3f) * std::sin(4.3f * z) +
           0.05f * std::sin(17.f * x) * std::cos(19.f * z);
}

// n x n cells on [-5, 5]^2: 2 * n * n triangles.
Primitive height_field(int n) {
    Primitive p;
    const auto coordinate = [n](int i) { return -5 + 10.f * static_cast<float>(i) / static_cast<float>(n); };
    for (int j = 0; j <= n; ++j)
        for (int k = 0; k <= n; ++k) {
            const float x = coordinate(k), z = coordinate(j);
            p.positions.push_back({x, height(x, z), z});
        }
    for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) {
            const auto a = static_cast<std::uint32_t>(j * (n + 1) + k), c = a + static_cast<std::uint32_t>(n) + 1;
            p.indices.insert(p.indices.end(), {a, c, a + 1, a + 1, c, c + 1});
        }
    return p;
}

Primitive ground() {
    Primitive p;
    p.positions = {{-20, 0, -20}, {20, 0, -20}, {20, 0, 20}, {-20, 0, 20}};
    p.indices = {0, 2, 1, 0, 3, 2};
    return p;
}

// 0.1 + 0.7 n.l of the colour, and a quarter of what is mirrored.
Material lacquer(Vec3 color) {
    Material m;
    m.model = ShadingModel::kLambert;
    m.ambient = color * 0.1f;
    m.diffuse = color * 0.7f;
    m.mirror = {0.25f, 0.25f, 0.25f};
    m.double_sided = true;
    return m;
}

void add(Scene& scene, Primitive mesh, int material) {
    mesh.material = material;
    scene.meshes.push_back({"", {std::move(mesh)}, {}, {}});
    scene.nodes.emplace_back().mesh = static_cast<int>(scene.meshes.size()) - 1;
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()) - 1);
}

struct Description {
    const char* name;
    int cells;  // of the height field; 0: the sphere
    bool whitted;
};
constexpr std::array kWorkloads{
    Description{"whitted_sphere100k", 0, true},         Description{"whitted_heightfield100k", 224, true},
    Description{"whitted_heightfield1m", 708, true},    Description{"primary_sphere100k", 0, false},
    Description{"primary_heightfield100k", 224, false}, Description{"primary_heightfield1m", 708, false},
};

Workload build(const Description& d, int width, int height) {
    Workload w;
    w.name = d.name;
    Scene& scene = w.scene;
    scene.materials = {lacquer({0.8f, 0.4f, 0.3f}), lacquer({0.7f, 0.7f, 0.7f})};
    scene.scenes.push_back({"scene", {}, {}});
    if (d.cells > 0) {
        add(scene, height_field(d.cells), 0);
    } else {
        add(scene, uv_sphere(316, 159), 0);
        add(scene, ground(), 1);
    }
    Light light;
    light.falloff = LightFalloff::kConstant;
    scene.lights.push_back(light);
    Node& lamp = scene.nodes.emplace_back();
    lamp.light = 0;
    lamp.translation = {4, 6, 3};
    scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()) - 1);
    scene.ambient = Vec3{1, 1, 1};
    RenderOptions& o = w.options;
    o.width = width;
    o.height = height;
    o.samples = 1;
    o.exposure_ev = 0.0f;
    o.tone_map = ToneMap::kNone;
    o.view.eye = d.cells > 0 ? Vec3{0, 3, 6} : Vec3{0, 1.6f, 3.6f};
    o.view.target = d.cells > 0 ? Vec3{0, 0, 0} : Vec3{0, 0.9f, 0};
    o.view.yfov = static_cast<float>(kPi / 4);
    o.max_depth = d.whitted ? 1 : 0;
    o.shadows = d.whitted ? Shadows::kAuto : Shadows::kNone;
    return w;
}

}  // namespace

std::vector<std::string> traced_workload_names() {
    std::vector<std::string> names;
    for (const Description& d : kWorkloads) names.emplace_back(d.name);
    return names;
}

std::optional<Workload> make_traced_workload(const std::string& name, int width, int height) {
    for (const Description& d : kWorkloads)
        if (name == d.name) return build(d, width, height);
    return std::nullopt;
}

}  // namespace tessera::cli
