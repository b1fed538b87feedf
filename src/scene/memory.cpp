// How much memory a scene holds.
#include <tessera/scene.h>

#include <unordered_set>

namespace tessera {
namespace {

template <class T>
std::uint64_t bytes(const std::vector<T>& v) {
    return std::uint64_t{v.capacity()} * sizeof(T);
}
template <class T>
std::uint64_t bytes(const std::vector<std::vector<T>>& sets) {
    std::uint64_t sum = std::uint64_t{sets.capacity()} * sizeof(std::vector<T>);
    for (const auto& set : sets) sum += bytes(set);
    return sum;
}
// Short strings lie inside the string object, which is counted with its owner.
std::uint64_t bytes(const std::string& s) { return s.capacity() < sizeof(std::string) ? 0 : s.capacity(); }
std::uint64_t bytes(const std::vector<std::string>& strings) {
    std::uint64_t sum = std::uint64_t{strings.capacity()} * sizeof(std::string);
    for (const std::string& s : strings) sum += bytes(s);
    return sum;
}

std::uint64_t bytes(const Primitive& p) {
    std::uint64_t sum = bytes(p.positions) + bytes(p.normals) + bytes(p.tangents) + bytes(p.texcoords) +
                        bytes(p.colors) + bytes(p.joints) + bytes(p.weights) + bytes(p.custom) + bytes(p.targets) +
                        bytes(p.indices) + bytes(p.variants) + bytes(p.extras);
    for (const CustomAttribute& c : p.custom) sum += bytes(c.name) + bytes(c.values);
    for (const MorphTarget& t : p.targets) sum += bytes(t.positions) + bytes(t.normals) + bytes(t.tangents);
    return sum;
}

std::uint64_t bytes(const Mesh& mesh) {
    std::uint64_t sum = bytes(mesh.name) + bytes(mesh.primitives) + bytes(mesh.weights) + bytes(mesh.extras);
    for (const Primitive& p : mesh.primitives) sum += bytes(p);
    return sum;
}

std::uint64_t bytes(const Animation& a) {
    std::uint64_t sum = bytes(a.name) + bytes(a.samplers) + bytes(a.channels) + bytes(a.extras);
    for (const AnimationSampler& s : a.samplers) sum += bytes(s.times) + bytes(s.values);
    return sum;
}

// name and extras: what most things have.
template <class T>
std::uint64_t named(const std::vector<T>& things) {
    std::uint64_t sum = bytes(things);
    for (const T& thing : things) sum += bytes(thing.name) + bytes(thing.extras);
    return sum;
}

}  // namespace

std::uint64_t memory_bytes(const Scene& scene) {
    std::uint64_t sum = sizeof(Scene) + named(scene.nodes) + bytes(scene.meshes) + named(scene.materials) +
                        named(scene.textures) + bytes(scene.samplers) + named(scene.pictures) + named(scene.cameras) +
                        named(scene.lights) + named(scene.skins) + bytes(scene.animations) + named(scene.scenes) +
                        bytes(scene.generator) + bytes(scene.copyright) + bytes(scene.extras) +
                        bytes(scene.extensions_used) + bytes(scene.extensions_required) +
                        bytes(scene.extensions_ignored) + bytes(scene.variants) + bytes(scene.warnings);
    for (const Node& node : scene.nodes) sum += bytes(node.children) + bytes(node.weights) + bytes(node.instances);
    for (const Mesh& mesh : scene.meshes) sum += bytes(mesh);
    for (const Sampler& sampler : scene.samplers) sum += bytes(sampler.name);
    for (const Skin& skin : scene.skins) sum += bytes(skin.joints) + bytes(skin.inverse_bind);
    for (const Animation& animation : scene.animations) sum += bytes(animation);
    for (const SceneRoots& roots : scene.scenes) sum += bytes(roots.nodes);
    // Pixels may be shared between pictures: each set counts once.
    std::unordered_set<const Image*> counted;
    for (const Picture& picture : scene.pictures) {
        sum += bytes(picture.uri);
        if (picture.pixels && counted.insert(picture.pixels.get()).second) sum += picture.pixels->bytes().size();
    }
    return sum;
}

}  // namespace tessera
