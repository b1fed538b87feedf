// Where the nodes of a scene stand: world matrices in double, in the order in which everything is
// submitted: depth first from the roots of the active scene, children in their listed order. The
// traversal keeps its own stack, so chains of any depth are safe. The scene must be valid (a forest).
#pragma once

#include <tessera/scene.h>

#include <glm/mat4x4.hpp>
#include <vector>

namespace tessera {

struct NodeTransforms {
    std::vector<int> order;         // the visited nodes, in submission order
    std::vector<glm::dmat4> world;  // per node of the scene: node to world; identity if not visited
    std::vector<char> visited;      // per node of the scene: 1 if reachable from the active scene
};

// The node's own matrix, or translation * rotation * scale.
glm::dmat4 local_matrix(const Node& node);

// Of an instance to its node.
glm::dmat4 instance_matrix(const MeshInstance& instance);

// Matrices may be non-finite where scales multiply beyond the range of double.
NodeTransforms node_transforms(const Scene& scene);
// With these matrices to the parents, by node, in place of the scene's.
NodeTransforms node_transforms(const Scene& scene, const std::vector<glm::dmat4>& local);

}  // namespace tessera
