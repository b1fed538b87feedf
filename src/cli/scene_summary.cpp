#include "cli/scene_summary.h"

#include "cli/json_writer.h"
#include "cli/material_summary.h"
#include "cli/report.h"

#include <tessera/render.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace tessera::cli {
namespace {

struct Elements {
    std::uint64_t triangles = 0, lines = 0, points = 0;
};

void count(const Primitive& primitive, Elements& sum) {
    const std::uint64_t n = primitive.indices.empty() ? primitive.positions.size() : primitive.indices.size();
    switch (primitive.mode) {
        case PrimitiveMode::kTriangles:
            sum.triangles += n / 3;
            break;
        case PrimitiveMode::kTriangleStrip:
        case PrimitiveMode::kTriangleFan:
            sum.triangles += n < 3 ? 0 : n - 2;
            break;
        case PrimitiveMode::kLines:
            sum.lines += n / 2;
            break;
        case PrimitiveMode::kLineLoop:
            sum.lines += n < 2 ? 0 : n;
            break;
        case PrimitiveMode::kLineStrip:
            sum.lines += n < 2 ? 0 : n - 1;
            break;
        case PrimitiveMode::kPoints:
            sum.points += n;
            break;
    }
}

const char* type_name(const Camera& camera) {
    return camera.type == Camera::Type::kPerspective ? "perspective" : "orthographic";
}

const char* type_name(const Light& light) {
    switch (light.type) {
        case Light::Type::kDirectional:
            return "directional";
        case Light::Type::kPoint:
            return "point";
        case Light::Type::kSpot:
            return "spot";
    }
    return "";
}

int width(const Picture& picture) { return picture.pixels ? picture.pixels->width() : 0; }
int height(const Picture& picture) { return picture.pixels ? picture.pixels->height() : 0; }

// --- text -----------------------------------------------------------------------------------

std::string vector_text(Vec3 v) { return number(v.x) + ", " + number(v.y) + ", " + number(v.z); }

// One aligned line of the report.
std::string line(std::string_view label, const std::string& value) {
    std::string text(label);
    text.resize(std::max<std::size_t>(text.size() + 1, 14), ' ');
    return text + value + "\n";
}

// Long lists end with how many more there are.
template <class T, class Describe>
std::string list(std::string_view label, const std::vector<T>& items, Describe describe) {
    constexpr std::size_t kListed = 16;
    std::string text = line(label, std::to_string(items.size()));
    for (std::size_t i = 0; i < std::min(items.size(), kListed); ++i)
        text += "  " + std::to_string(i) + ": " + printable(describe(items[i])) + "\n";
    if (items.size() > kListed) text += "  and " + std::to_string(items.size() - kListed) + " more\n";
    return text;
}

template <class T>
std::string titled(const T& item, const std::string& rest) {
    return item.name.empty() ? rest : item.name + " (" + rest + ")";
}

std::string names(std::string_view label, const std::vector<std::string>& items) {
    if (items.empty()) return {};
    std::string joined;
    for (const std::string& item : items) joined += (joined.empty() ? "" : ", ") + printable(item);
    return line(label, joined);
}

// --- JSON -----------------------------------------------------------------------------------

void write(JsonWriter& json, std::string_view key, const std::vector<std::string>& items) {
    json.key(key).begin_array();
    for (const std::string& item : items) json.value(std::string_view(item));
    json.end_array();
}

template <class T, class Members>
void write(JsonWriter& json, std::string_view key, const std::vector<T>& items, Members members) {
    json.key(key).begin_array();
    for (const T& item : items) {
        json.begin_object().member("name", item.name);
        members(item);
        json.end_object();
    }
    json.end_array();
}

}  // namespace

SceneSummary summarize(const Scene& scene) {
    SceneSummary summary;
    std::vector<Elements> of_mesh;
    for (const Mesh& mesh : scene.meshes) {
        Elements& elements = of_mesh.emplace_back();
        for (const Primitive& primitive : mesh.primitives) {
            ++summary.primitives;
            summary.shapes += primitive.shape ? 1 : 0;
            summary.vertices += primitive.positions.size();
            count(primitive, elements);
        }
        summary.triangles += elements.triangles;
    }
    // The nodes are a forest, so an explicit stack sees each at most once.
    std::vector<int> pending;
    if (scene.active_scene != kNone && !scene.scenes.empty())
        pending = scene.scenes[static_cast<std::size_t>(scene.active_scene)].nodes;
    while (!pending.empty()) {
        const Node& node = scene.nodes[static_cast<std::size_t>(pending.back())];
        pending.pop_back();
        pending.insert(pending.end(), node.children.begin(), node.children.end());
        if (node.mesh == kNone) continue;
        const std::uint64_t copies = node.instances.empty() ? 1 : node.instances.size();
        summary.drawn_instances += copies;
        const Elements& elements = of_mesh[static_cast<std::size_t>(node.mesh)];
        summary.drawn_triangles += copies * elements.triangles;
        summary.drawn_lines += copies * elements.lines;
        summary.drawn_points += copies * elements.points;
    }
    summary.memory_bytes = memory_bytes(scene);
    summary.bounds = visible_bounds(scene);
    return summary;
}

std::string summary_text(const std::string& file, const Scene& scene, const SceneSummary& s) {
    std::string text = line("file", printable(file));
    if (!scene.generator.empty()) text += line("generator", printable(scene.generator));
    if (!scene.copyright.empty()) text += line("copyright", printable(scene.copyright));
    text += line("triangles", std::to_string(s.drawn_triangles) + " drawn by " + std::to_string(s.drawn_instances) +
                                  " mesh instances (" + std::to_string(s.triangles) + " stored)");
    if (s.drawn_lines > 0) text += line("lines", std::to_string(s.drawn_lines) + " drawn");
    if (s.drawn_points > 0) text += line("points", std::to_string(s.drawn_points) + " drawn");
    text += line("vertices", std::to_string(s.vertices));
    text += s.bounds.empty()
                ? line("bounds", s.drawn_triangles > 0 ? "none" : "nothing is drawn")
                : line("bounds", "(" + vector_text(s.bounds.min) + ") to (" + vector_text(s.bounds.max) + ")");
    text += line("memory", number(static_cast<double>(s.memory_bytes) / 1048576) + " MiB");
    text +=
        line("nodes", std::to_string(scene.nodes.size()) + " in " + std::to_string(scene.scenes.size()) + " scenes");
    text +=
        line("meshes", std::to_string(scene.meshes.size()) + " with " + std::to_string(s.primitives) + " primitives" +
                           (s.shapes > 0 ? ", " + std::to_string(s.shapes) + " of them shapes" : ""));
    text += list("materials", scene.materials, [](const Material& m) { return titled(m, material_text(m)); });
    text += line("textures", std::to_string(scene.textures.size()));
    text += list("pictures", scene.pictures, [](const Picture& p) {
        const std::string size = std::to_string(width(p)) + "x" + std::to_string(height(p));
        return titled(p, size + (p.uri.empty() || p.uri.compare(0, 5, "data:") == 0 ? ", embedded" : ", " + p.uri));
    });
    text += list("cameras", scene.cameras, [](const Camera& c) { return titled(c, type_name(c)); });
    text += list("lights", scene.lights, [](const Light& l) { return titled(l, type_name(l)); });
    text += line("skins", std::to_string(scene.skins.size()));
    text +=
        list("animations", scene.animations, [](const Animation& a) { return titled(a, number(duration(a)) + " s"); });
    text += names("variants", scene.variants) + names("extensions used", scene.extensions_used) +
            names("extensions required", scene.extensions_required) +
            names("extensions ignored", scene.extensions_ignored);
    for (const std::string& warning : scene.warnings) text += line("warning", printable(warning));
    return text;
}

std::string summary_json(const std::string& file, const Scene& scene, const SceneSummary& s) {
    JsonWriter json;
    json.begin_object().member("file", file);
    json.member("generator", scene.generator).member("copyright", scene.copyright);
    json.key("counts").begin_object();
    json.member("scenes", scene.scenes.size()).member("nodes", scene.nodes.size());
    json.member("meshes", scene.meshes.size()).member("primitives", s.primitives).member("shapes", s.shapes);
    json.member("vertices", s.vertices).member("triangles", s.triangles);
    json.member("drawn_instances", s.drawn_instances).member("drawn_triangles", s.drawn_triangles);
    json.member("drawn_lines", s.drawn_lines).member("drawn_points", s.drawn_points);
    json.member("materials", scene.materials.size()).member("textures", scene.textures.size());
    json.member("pictures", scene.pictures.size()).member("samplers", scene.samplers.size());
    json.member("cameras", scene.cameras.size()).member("lights", scene.lights.size());
    json.member("skins", scene.skins.size()).member("animations", scene.animations.size()).end_object();
    json.key("bounds");
    if (s.bounds.empty()) {
        json.null();
    } else {
        json.begin_object().key("min");
        write(json, s.bounds.min);
        json.key("max");
        write(json, s.bounds.max);
        json.end_object();
    }
    json.member("memory_bytes", s.memory_bytes);
    write(json, "materials", scene.materials, [&](const Material& m) { write_material(json, m); });
    write(json, "pictures", scene.pictures, [&](const Picture& p) {
        const bool data = p.uri.compare(0, 5, "data:") == 0;
        json.member("uri", data ? std::string("data:") : p.uri).member("width", width(p)).member("height", height(p));
    });
    write(json, "cameras", scene.cameras, [&](const Camera& c) { json.member("type", type_name(c)); });
    write(json, "lights", scene.lights, [&](const Light& l) { json.member("type", type_name(l)); });
    write(json, "animations", scene.animations, [&](const Animation& a) { json.member("duration_s", duration(a)); });
    write(json, "variants", scene.variants);
    write(json, "extensions_used", scene.extensions_used);
    write(json, "extensions_required", scene.extensions_required);
    write(json, "extensions_ignored", scene.extensions_ignored);
    write(json, "warnings", scene.warnings);
    return json.end_object().text();
}

}  // namespace tessera::cli
