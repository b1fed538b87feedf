#include "geometry/node_transforms.h"

#include "core/fp_environment.h"
#include "geometry/matrix.h"

#include <cstddef>

namespace tessera {

glm::dmat4 local_matrix(const Node& node) {
    return node.matrix ? to_dmat4(*node.matrix) : compose_matrix(node.translation, node.rotation, node.scale);
}

glm::dmat4 instance_matrix(const MeshInstance& i) { return compose_matrix(i.translation, i.rotation, i.scale); }

NodeTransforms node_transforms(const Scene& scene) {
    std::vector<glm::dmat4> local;
    local.reserve(scene.nodes.size());
    for (const Node& node : scene.nodes) local.push_back(local_matrix(node));
    return node_transforms(scene, local);
}

NodeTransforms node_transforms(const Scene& scene, const std::vector<glm::dmat4>& local_matrices) {
    const FpEnvironment exact;
    NodeTransforms result;
    result.world.assign(scene.nodes.size(), glm::dmat4(1));
    result.visited.assign(scene.nodes.size(), 0);
    if (scene.active_scene == kNone || scene.scenes.empty()) return result;

    struct Pending {
        int node, parent;
    };
    std::vector<Pending> stack;
    // Pushed in reverse, so that the first child is taken off, with all below it, before the second.
    const auto push = [&stack](const std::vector<int>& nodes, int parent) {
        for (std::size_t i = nodes.size(); i-- > 0;) stack.push_back({nodes[i], parent});
    };
    push(scene.scenes[static_cast<std::size_t>(scene.active_scene)].nodes, kNone);
    while (!stack.empty()) {
        const Pending next = stack.back();
        stack.pop_back();
        const auto i = static_cast<std::size_t>(next.node);
        const glm::dmat4& local = local_matrices[i];
        result.world[i] = next.parent == kNone ? local : result.world[static_cast<std::size_t>(next.parent)] * local;
        result.visited[i] = 1;
        result.order.push_back(next.node);
        push(scene.nodes[i].children, next.node);
    }
    return result;
}

}  // namespace tessera
