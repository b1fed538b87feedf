// Meshes, and the nodes that combine them with skins and morph weights.
#include "scene/check.h"
#include "scene/numbers.h"

namespace tessera {
namespace {

// `values` has one entry per vertex, or none at all.
template <class T>
void check_attribute(const std::vector<T>& data, std::size_t vertices, const Place& place, bool values) {
    if (!data.empty() && data.size() != vertices)
        place.fail(std::to_string(data.size()) + " entries for " + std::to_string(vertices) + " vertices");
    if constexpr (sizeof(T) % sizeof(float) == 0 && alignof(T) == alignof(float))
        if (values) place.finite(as_floats(data).data(), as_floats(data).size());
}

void check_primitive(const Scene& scene, const Primitive& p, const Place& place, bool values) {
    const std::size_t n = p.positions.size();
    place.reference(p.material, scene.materials.size(), "material");
    for (std::size_t i = 0; i < p.variants.size(); ++i) {
        const Place variant = place.child("variants", i);
        variant.reference(p.variants[i].variant, scene.variants.size(), "variant");
        variant.reference(p.variants[i].material, scene.materials.size(), "material");
    }
    check_attribute(p.positions, n, place.child("positions"), values);
    check_attribute(p.normals, n, place.child("normals"), values);
    check_attribute(p.tangents, n, place.child("tangents"), values);
    for (std::size_t s = 0; s < p.texcoords.size(); ++s)
        check_attribute(p.texcoords[s], n, place.child("texcoords", s), values);
    for (std::size_t s = 0; s < p.colors.size(); ++s) check_attribute(p.colors[s], n, place.child("colors", s), values);
    if (p.joints.size() != p.weights.size())
        place.child("weights").fail("there must be as many sets of weights as of joints");
    for (std::size_t s = 0; s < p.joints.size(); ++s) {
        check_attribute(p.joints[s], n, place.child("joints", s), values);
        check_attribute(p.weights[s], n, place.child("weights", s), values);
        if (p.joints[s].size() != p.weights[s].size())
            place.child("weights", s).fail("a set of weights must be as long as its joints");
    }
    for (std::size_t c = 0; c < p.custom.size(); ++c) {
        const CustomAttribute& custom = p.custom[c];
        const Place where = place.child("custom", c);
        if (custom.components < 1 || custom.components > 16) where.child("components").fail("must be 1 to 16");
        if (custom.values.size() != n * static_cast<std::size_t>(custom.components))
            where.child("values").fail(std::to_string(custom.values.size()) + " numbers for " + std::to_string(n) +
                                       " vertices");
        if (values) where.child("values").finite(custom.values.data(), custom.values.size());
    }
    for (std::size_t t = 0; t < p.targets.size(); ++t) {
        const Place where = place.child("targets", t);
        check_attribute(p.targets[t].positions, n, where.child("positions"), values);
        check_attribute(p.targets[t].normals, n, where.child("normals"), values);
        check_attribute(p.targets[t].tangents, n, where.child("tangents"), values);
    }
    if (n == 0 && !p.indices.empty()) place.child("indices").fail("there are no vertices");
    if (values && !p.indices.empty() && largest_index(p.indices) >= n)
        place.child("indices").fail("index " + std::to_string(largest_index(p.indices)) + " of " + std::to_string(n) +
                                    " vertices");
    if (p.shape) check_shape(p, place.child("shape"), values);
}

// The number of morph targets, the same for all primitives that hold vertices.
std::size_t check_mesh(const Scene& scene, const Mesh& mesh, const Place& place, bool values) {
    std::size_t targets = Place::kNoIndex;
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
        const Primitive& p = mesh.primitives[i];
        const Place where = place.child("primitives", i);
        check_primitive(scene, p, where, values);
        if (p.positions.empty()) continue;
        if (targets == Place::kNoIndex) targets = p.targets.size();
        if (targets != p.targets.size())
            where.child("targets").fail("all primitives of a mesh must have the same number of morph targets");
    }
    if (targets == Place::kNoIndex) return mesh.weights.size();
    if (!mesh.weights.empty() && mesh.weights.size() != targets)
        place.child("weights").fail(std::to_string(mesh.weights.size()) + " weights for " + std::to_string(targets) +
                                    " morph targets");
    place.child("weights").finite(mesh.weights.data(), mesh.weights.size());
    return targets;
}

// One more than the largest joint that the mesh uses.
std::size_t joints_needed(const Mesh& mesh) {
    std::uint16_t largest = 0;
    bool any = false;
    for (const Primitive& p : mesh.primitives)
        for (const auto& set : p.joints)
            for (const auto& joints : set) {
                any = true;
                for (const std::uint16_t joint : joints) largest = joint > largest ? joint : largest;
            }
    return any ? std::size_t{largest} + 1 : 0;
}

}  // namespace

void check_meshes(const Scene& scene, bool values) {
    std::vector<std::size_t> targets(scene.meshes.size());
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        targets[i] = check_mesh(scene, scene.meshes[i], Place{nullptr, "meshes", i}, values);

    std::vector<std::size_t> needed(scene.meshes.size(), Place::kNoIndex);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        const Place place{nullptr, "nodes", i};
        if (node.mesh == kNone) continue;
        const auto mesh = static_cast<std::size_t>(node.mesh);
        if (!node.weights.empty() && node.weights.size() != targets[mesh])
            place.child("weights").fail(std::to_string(node.weights.size()) + " weights for " +
                                        std::to_string(targets[mesh]) + " morph targets");
        if (node.skin == kNone) continue;
        if (needed[mesh] == Place::kNoIndex) needed[mesh] = joints_needed(scene.meshes[mesh]);
        const std::size_t joints = scene.skins[static_cast<std::size_t>(node.skin)].joints.size();
        if (needed[mesh] > joints)
            place.child("skin").fail("the mesh uses joint " + std::to_string(needed[mesh] - 1) + ", the skin has " +
                                     std::to_string(joints));
    }
}

}  // namespace tessera
