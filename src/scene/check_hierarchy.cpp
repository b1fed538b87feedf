// Nodes, skins and scenes.
#include "scene/check.h"

#include <algorithm>

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

// Where each node stands in a depth-first walk of the forest: a node's descendants are those with
// number .. end - 1.
struct Interval {
    std::size_t number = Place::kNoIndex, end = 0;
};

// With at most one parent each, the nodes that no walk from a root reaches lie on cycles.
std::vector<Interval> number_nodes(const Scene& scene, const std::vector<int>& parents) {
    std::vector<Interval> intervals(scene.nodes.size());
    std::vector<std::size_t> stack, order;
    for (std::size_t i = 0; i < parents.size(); ++i)
        if (parents[i] == kNone) stack.push_back(i);
    while (!stack.empty()) {
        const std::size_t node = stack.back();
        stack.pop_back();
        intervals[node] = {order.size(), order.size() + 1};
        order.push_back(node);
        for (const int child : scene.nodes[node].children) stack.push_back(static_cast<std::size_t>(child));
    }
    for (std::size_t i = 0; i < intervals.size(); ++i)
        if (intervals[i].number == Place::kNoIndex) Place{nullptr, "nodes", i}.fail("the node is its own ancestor");
    for (auto node = order.rbegin(); node != order.rend(); ++node) {
        if (parents[*node] == kNone) continue;
        Interval& parent = intervals[static_cast<std::size_t>(parents[*node])];
        parent.end = std::max(parent.end, intervals[*node].end);
    }
    return intervals;
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
    static_assert(sizeof(MeshInstance) == 10 * sizeof(float));
    place.child("instances").finite(reinterpret_cast<const float*>(node.instances.data()), 10 * node.instances.size());
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

// A root may have a parent (which the scene then does not draw), but no scene may list a node twice,
// nor a node and one of its descendants.
void check_roots(const Scene& scene, const std::vector<Interval>& intervals) {
    for (std::size_t i = 0; i < scene.scenes.size(); ++i) {
        const Place place{nullptr, "scenes", i};
        const std::vector<int>& roots = scene.scenes[i].nodes;
        for (std::size_t r = 0; r < roots.size(); ++r)
            if (roots[r] < 0 || static_cast<std::size_t>(roots[r]) >= scene.nodes.size())
                place.child("nodes", r).fail("there is no node " + std::to_string(roots[r]));
        std::vector<int> sorted = roots;
        const auto interval = [&](int root) { return intervals[static_cast<std::size_t>(root)]; };
        std::sort(sorted.begin(), sorted.end(), [&](int a, int b) { return interval(a).number < interval(b).number; });
        for (std::size_t r = 1; r < sorted.size(); ++r)
            if (interval(sorted[r]).number < interval(sorted[r - 1]).end)
                place.child("nodes").fail("node " + std::to_string(sorted[r]) + " would be drawn twice");
    }
    // A scene without any SceneRoots may keep the default, 0: nothing is drawn.
    if (!scene.scenes.empty() || scene.active_scene != 0)
        Place{nullptr, "", Place::kNoIndex}.reference(scene.active_scene, scene.scenes.size(), "active_scene");
}

}  // namespace

void check_hierarchy(const Scene& scene) {
    const std::vector<int> parents = parents_of(scene);
    const std::vector<Interval> intervals = number_nodes(scene, parents);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) check_node(scene, scene.nodes[i], Place{nullptr, "nodes", i});
    check_skins(scene);
    check_roots(scene, intervals);
}

}  // namespace tessera
