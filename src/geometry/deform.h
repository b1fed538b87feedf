// Meshes that change their shape: morph targets, then skins (glTF 2.0, sections 3.7.2.2 and 3.7.3). A
// DeformedMesh is a prepared mesh of its own, at one node; its vertices are written over as the scene
// moves. One thread at a time.
#pragma once

#include <tessera/isa.h>

#include "core/parallel.h"
#include "geometry/prepared_mesh.h"

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

namespace tessera {

// Whether a primitive at a node follows that node's skin, or has a shape of its own by its weights.
bool is_skinned(const Scene& scene, const Node& node, const Primitive& primitive);
inline bool is_morphed(const Primitive& primitive) { return !primitive.targets.empty(); }

// Where the joints of a skin are. The node of the mesh does not count; vertices are relative to the first
// joint's place, so that models far from the origin stay precise.
struct JointMatrices {
    glm::dmat4 object_to_world{1.0};  // of the skinned vertices: a translation
    bool mirrored = false;            // the joints mirror, so that triangles change their winding
    std::vector<float> rows;          // 3x4 by joint
};
// `world` by node.
JointMatrices joint_matrices(const Skin& skin, const std::vector<glm::dmat4>& world);

class DeformedMesh {
  public:
    // `rest` is prepared, with every attribute that drawing needs, and outlives this; `source` is the scene's
    // primitive that it was made of.
    DeformedMesh(const PreparedMesh& rest, const Primitive& source);

    // Makes the vertices for these weights, and joints (null: not skinned). Returns false when nothing of
    // them has changed since the last call. Without an arena: on this thread. The same bits for every instruction set
    // and number of threads.
    bool update(std::span<const float> weights, const JointMatrices* joints, Isa isa, Arena* arena);
    const PreparedMesh& mesh() const { return mesh_; }

  private:
    void morph(std::span<const float> weights);
    void skin(const JointMatrices& joints, Isa isa, Arena* arena);
    void set_influences();

    const Primitive& rest_;
    bool flat_;  // normals belong to faces, and are made anew
    PreparedMesh mesh_;
    bool made_ = false;
    std::vector<float> weights_, rows_;      // of the last update
    std::vector<Vec3> positions_, normals_;  // between morphs and skin
    std::vector<Vec4> tangents_;
    std::vector<std::uint32_t> joints_;  // as SkinJob has them
    std::vector<float> influences_;
};

}  // namespace tessera
