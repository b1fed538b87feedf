#include "cli/scene_input.h"

#include "cli/files.h"
#include "cli/parse.h"

#include <tessera/error.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

namespace tessera::cli {
namespace {

std::optional<int> index_below(const std::string& text, int count) {
    int index = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    const bool number = error == std::errc{} && end == text.data() + text.size();
    if (number && index >= 0 && index < count) return index;
    return std::nullopt;
}

const std::string& name_of(const std::string& name) { return name; }
template <class Part>
const std::string& name_of(const Part& part) {
    return part.name;
}

template <class Part>
[[noreturn]] void refuse_unknown(const std::string& option, const std::string& what, const std::string& text,
                                 const std::vector<Part>& parts) {
    std::string reason = "the scene has no " + what + " '" + text + "'";
    constexpr std::size_t kListed = 12;
    for (std::size_t i = 0; i < std::min(parts.size(), kListed); ++i)
        reason += (i == 0 ? "; there are: " : ", ") + std::to_string(i) +
                  (name_of(parts[i]).empty() ? "" : " '" + name_of(parts[i]) + "'");
    if (parts.size() > kListed) reason += ", ...";
    refuse(option, reason);
}

}  // namespace

std::string input_name(const std::string& path) { return path == "-" ? "<stdin>" : path; }

Scene load_input(const std::string& path, const LoadOptions& options) {
    try {
        if (path != "-") return load_scene(path, options);
        return load_scene_from_memory(read_stdin(options.max_bytes), "", options, "<stdin>");
    } catch (const Error& error) {
        if (!error.file().empty()) throw;
        throw Error(error.code(), error.message(), input_name(path), error.location());
    }
}

int find_camera(const Scene& scene, const std::string& text) {
    const int count = static_cast<int>(scene.cameras.size());
    const auto camera =
        std::find_if(scene.cameras.begin(), scene.cameras.end(), [&](const Camera& c) { return c.name == text; });
    if (camera != scene.cameras.end()) return static_cast<int>(camera - scene.cameras.begin());
    for (const Node& node : scene.nodes)
        if (node.camera != kNone && node.name == text) return node.camera;

    if (const std::optional<int> index = index_below(text, count)) return *index;
    refuse_unknown("--camera", "camera", text, scene.cameras);
}

int find_animation(const Scene& scene, const std::string& text) {
    if (scene.animations.empty()) refuse("--animation", "the scene has no animations");
    for (std::size_t i = 0; i < scene.animations.size(); ++i)
        if (scene.animations[i].name == text) return static_cast<int>(i);
    if (text == "all") return kEveryAnimation;
    if (const std::optional<int> index = index_below(text, static_cast<int>(scene.animations.size()))) return *index;
    refuse_unknown("--animation", "animation", text, scene.animations);
}

int find_variant(const Scene& scene, const std::string& text) {
    if (scene.variants.empty()) refuse("--variant", "the scene has no variants");
    for (std::size_t i = 0; i < scene.variants.size(); ++i)
        if (scene.variants[i] == text) return static_cast<int>(i);
    if (const std::optional<int> index = index_below(text, static_cast<int>(scene.variants.size()))) return *index;
    refuse_unknown("--variant", "variant", text, scene.variants);
}

Vec3 turn_z_up(Vec3 p) { return {p.x, p.z, -p.y}; }

void turn_z_up(Scene& scene) {
    if (scene.active_scene == kNone || scene.scenes.empty()) return;
    SceneRoots& active = scene.scenes[static_cast<std::size_t>(scene.active_scene)];
    // A root may hang below a node that is not drawn; the new parent is to be its only one.
    const auto is_root = [&](int node) {
        return std::find(active.nodes.begin(), active.nodes.end(), node) != active.nodes.end();
    };
    for (Node& node : scene.nodes) std::erase_if(node.children, is_root);
    Node turn;
    turn.name = "Z up";
    turn.matrix = Mat4{{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}};
    turn.children = std::exchange(active.nodes, {static_cast<int>(scene.nodes.size())});
    scene.nodes.push_back(std::move(turn));
}

}  // namespace tessera::cli
