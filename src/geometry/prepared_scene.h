// What of a scene is the same in every frame: where its nodes stand, and its meshes prepared for drawing
// (triangles, normals, tangents, bounds). Made once, then read by every frame that is drawn of it.
#pragma once

#include "geometry/camera.h"
#include "geometry/draw_data.h"
#include "geometry/triangles.h"

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace tessera {

// One primitive of a mesh, prepared once for all of its instances.
struct PreparedMesh {
    PreparedMesh(Primitive&& made, const Primitive& source);
    PreparedMesh(const PreparedMesh&) = delete;
    PreparedMesh& operator=(const PreparedMesh&) = delete;

    const Primitive& primitive() const { return made.positions.empty() ? *source : made; }

    Primitive made;           // with normals and tangents, where the source lacked them; else empty
    const Primitive* source;  // the scene's
    TriangleList triangles;   // of primitive()
    Bounds3 bounds;           // object space
    MeshView view{};
    std::uint32_t lowest_vertex = 0, highest_vertex = 0;  // that a triangle names
};

// A mesh at a node.
struct Placement {
    const PreparedMesh* mesh;
    std::uint32_t material;  // index into the scene's materials; one past them for none
};

// What a node of the active scene carries.
struct PreparedNode {
    int node, light;                     // indices; light may be kNone
    bool has_mesh;                       // even if nothing of it is drawn
    bool has_undrawn;                    // points or lines
    std::uint32_t first, placement_end;  // range of PreparedScene::placements
};

class PreparedScene {
  public:
    // The scene must be valid, and outlive this unchanged.
    explicit PreparedScene(const Scene& scene);
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

    const Scene& scene() const { return scene_; }
    const glm::dmat4& world(int node) const { return transforms_.world[static_cast<std::size_t>(node)]; }
    const std::vector<PreparedNode>& nodes() const { return nodes_; }  // in submission order
    // Without exact duplicates of opaque ones.
    const std::vector<Placement>& placements() const { return placements_; }
    // Per material of the scene, and one past them for the default: whether anything that may be drawn has it.
    std::vector<bool> used_materials() const;

    // choose_camera() for this scene. The latest answer is remembered.
    const PlacedCamera& camera(const View& view, double aspect);

  private:
    const PreparedMesh& prepare(const Primitive& primitive);
    // Calls `visit` with every vertex that is drawn, in world space.
    void visit_points(const PointVisitor& visit) const;

    struct ChosenCamera {
        View view;
        double aspect;
        PlacedCamera camera;
    };

    const Scene& scene_;
    NodeTransforms transforms_;
    std::vector<PreparedNode> nodes_;
    std::vector<Placement> placements_;
    std::vector<std::unique_ptr<PreparedMesh>> meshes_;
    std::map<const Primitive*, const PreparedMesh*> prepared_;
    std::optional<ChosenCamera> chosen_;
};

}  // namespace tessera
