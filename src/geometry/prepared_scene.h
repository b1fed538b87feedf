// What of a scene is the same in every frame: its meshes prepared for drawing (triangles, normals, tangents,
// bounds); and where its nodes stand at a moment, with the meshes that change their shape. Made once,
// then read by every frame that is drawn of it.
#pragma once

#include "core/parallel.h"
#include "geometry/camera.h"
#include "geometry/deform.h"
#include "geometry/prepared_mesh.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace tessera {

// Shading has each material of the scene, the default one after them, then all of these once more without lighting,
// for points and lines that have no normals, and last the ink of those that have no colour either.
inline std::size_t lit_materials(const Scene& scene) { return scene.materials.size() + 1; }
inline std::size_t ink_material(const Scene& scene) { return 2 * lit_materials(scene); }

// A mesh at a node.
struct Placement {
    const PreparedMesh* mesh;
    std::uint32_t material;  // as lit_materials() says
    // The number of its first point, line or triangle, of all of the scene in the order of submission: duplicates that
    // are not placed count, so that numbers are the same at every moment.
    std::uint32_t first_primitive;
};

// What a node of the active scene carries. A node whose mesh is skinned in part comes twice.
struct PreparedNode {
    int node, light;                     // indices; light may be kNone
    bool has_mesh;                       // even if nothing of it is drawn
    std::uint32_t first, placement_end;  // range of PreparedScene::placements
    glm::dmat4 world;                    // object to world, for its meshes
    bool mirrored = false;               // the skin mirrors, which `world` does not say
};

class PreparedScene {
  public:
    // The scene must be valid, and outlive this unchanged; so must the arena, which deforms meshes (null: this
    // thread does). Stands as the scene does. `isa` must be resolved.
    explicit PreparedScene(const Scene& scene, Arena* arena = nullptr, Isa isa = Isa::kScalar);
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

    // Goes to a moment: moves nodes, deforms meshes. Throws kUsage for an animation that does not exist.
    void move_to(const Moment& moment);

    const Scene& scene() const { return scene_; }
    Arena* arena() const { return arena_; }
    const std::vector<PreparedNode>& nodes() const { return nodes_; }  // in submission order
    // Without exact duplicates of opaque ones.
    const std::vector<Placement>& placements() const { return placements_; }
    // Per material, as Placement counts them: whether anything that may be drawn has it.
    std::vector<bool> used_materials() const;

    // choose_camera() for this scene at its moment. The latest answer is remembered.
    const PlacedCamera& camera(const View& view, double aspect);
    // Calls `visit` with every vertex that is drawn, in world space; not with those of planes without end.
    void visit_points(const PointVisitor& visit) const;

  private:
    const PreparedMesh& prepare(const Primitive& primitive);
    const PreparedMesh& deform(int node, const Primitive& primitive, const JointMatrices* joints);
    void place_nodes();
    void place(const Primitive& primitive, const PreparedMesh& mesh, std::uint64_t first_primitive);
    void visit_animation(const PointVisitor& visit);
    const PlacedCamera& standing_camera(const View& view, double aspect);

    struct ChosenCamera {
        View view;
        double aspect;
        PlacedCamera camera;
        int framed;  // the animation whose extent it frames; kUnframed: it depends on the moment
    };
    static constexpr int kUnframed = -3;

    const Scene& scene_;
    Arena* arena_;
    Isa isa_;
    Moment moment_;
    std::vector<std::vector<float>> weights_;  // of morph targets, by node
    NodeTransforms transforms_;
    std::vector<PreparedNode> nodes_;
    std::vector<Placement> placements_;
    std::vector<std::unique_ptr<PreparedMesh>> meshes_;
    std::map<const Primitive*, const PreparedMesh*> prepared_;
    std::map<std::pair<int, const Primitive*>, std::unique_ptr<DeformedMesh>> deformed_;
    std::optional<ChosenCamera> chosen_;
    PlacedCamera turned_;
};

}  // namespace tessera
