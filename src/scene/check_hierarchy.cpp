// Nodes, skins and scenes.
#include "scene/check.h"

namespace tessera {
namespace {

// Every node's parent, kNone for roots; fails when a node has two.
std::vector<int> parents_of(const Scene& scene) {
    std::vector<int> parents(scene.nodes.size(), kNone);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Place place{nullptr, "nodes", i};
        const std::vector<int>& children = scene.nodes[i].children;
        for (std::size_t c = 0; c < children.size(); ++c) {
            const Place link = place.child("children", c);
            if (children[c] < 0 || static_cast<std::size_t>(children[c]) >= scene.nodes.size())
                link.fail("there is no node " + std::to_string(children[c]));
            int& parent = parents[static_cast<std::size_t>(children[c])];
            if (parent != kNone)
                link.fail("node " + std::to_string(children[c]) + " has two parents, " + std::to_string(parent) +
                          " and " + std::to_string(i));
            parent = static_cast<int>(i);
        }
    }
    return parents;
}

// With at most one parent each, the nodes that no walk from a root reaches lie on cycles.
void check_no_cycle(const Scene& scene, const std::vector<int>& parents) {
    std::vector<char> reached(scene.nodes.size(), 0);
    std::vector<int> stack;
    for (std::size_t i = 0; i < parents.size(); ++i)
        if (parents[i] == kNone) stack.push_back(static_cast<int>(i));
    while (!stack.empty()) {
        const auto node = static_cast<std::size_t>(stack.back());
        stack.pop_back();
        reached[node] = 1;
        for (const int child : scene.nodes[node].children) stack.push_back(child);
    }
    for (std::size_t i = 0; i < reached.size(); ++i)
        if (!reached[i]) Place{nullptr, "nodes", i}.fail("the node is its own ancestor");
}

void check_node(const Scene& scene, const Node& node, const Place& place) {
    place.reference(node.mesh, scene.meshes.size(), "mesh");
    place.reference(node.camera, scene.cameras.size(), "camera");
    place.reference(node.light, scene.lights.size(), "light");
    place.reference(node.skin, scene.skins.size(), "skin");
    if (node.matrix) place.child("matrix").finite(node.matrix->m.data(), 16);
    place.child("translation").finite(&node.translation.x, 3);
    place.child("rotation").finite(&node.rotation.x, 4);
    place.child("scale").finite(&node.scale.x, 3);
    place.child("weights").finite(node.weights.data(), node.weights.size());
}

void check_skins(const Scene& scene) {
    for (std::size_t i = 0; i < scene.skins.size(); ++i) {
        const Skin& skin = scene.skins[i];
        const Place place{nullptr, "skins", i};
        if (skin.joints.empty()) place.child("joints").fail("a skin needs at least one joint");
        for (std::size_t j = 0; j < skin.joints.size(); ++j)
            if (skin.joints[j] < 0 || static_cast<std::size_t>(skin.joints[j]) >= scene.nodes.size())
                place.child("joints", j).fail("there is no node " + std::to_string(skin.joints[j]));
        place.reference(skin.skeleton, scene.nodes.size(), "skeleton");
        if (!skin.inverse_bind.empty() && skin.inverse_bind.size() != skin.joints.size())
            place.child("inverse_bind")
                .fail(std::to_string(skin.inverse_bind.size()) + " matrices for " + std::to_string(skin.joints.size()) +
                      " joints");
        place.child("inverse_bind")
            .finite(reinterpret_cast<const float*>(skin.inverse_bind.data()), skin.inverse_bind.size() * 16);
    }
}

void check_roots(const Scene& scene, const std::vector<int>& parents) {
    std::vector<std::size_t> listed_by(scene.nodes.size(), Place::kNoIndex);
    for (std::size_t i = 0; i < scene.scenes.size(); ++i) {
        const Place place{nullptr, "scenes", i};
        for (std::size_t r = 0; r < scene.scenes[i].nodes.size(); ++r) {
            const int root = scene.scenes[i].nodes[r];
            const Place link = place.child("nodes", r);
            if (root < 0 || static_cast<std::size_t>(root) >= scene.nodes.size())
                link.fail("there is no node " + std::to_string(root));
            const auto node = static_cast<std::size_t>(root);
            if (parents[node] != kNone)
                link.fail("node " + std::to_string(root) + " is no root, its parent is " +
                          std::to_string(parents[node]));
            if (listed_by[node] == i) link.fail("node " + std::to_string(root) + " is listed twice");
            listed_by[node] = i;
        }
    }
    // A scene without any SceneRoots may keep the default, 0: nothing is drawn.
    if (!scene.scenes.empty() || scene.active_scene != 0)
        Place{nullptr, "", Place::kNoIndex}.reference(scene.active_scene, scene.scenes.size(), "active_scene");
}

}  // namespace

void check_hierarchy(const Scene& scene) {
    const std::vector<int> parents = parents_of(scene);
    check_no_cycle(scene, parents);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) check_node(scene, scene.nodes[i], Place{nullptr, "nodes", i});
    check_skins(scene);
    check_roots(scene, parents);
}

}  // namespace tessera
