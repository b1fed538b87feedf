// A primitive ready for drawing: triangles, normals, tangents, bounds.
#pragma once

#include "geometry/draw_data.h"
#include "geometry/triangles.h"

#include <cstdint>

namespace tessera {

struct PreparedMesh;

// What engines draw.
struct DrawnMesh {
    const PreparedMesh* stroke_of = nullptr;  // set where it is made of another mesh's points or lines
    MeshView view{};
    Bounds3 bounds;                                       // of all vertices, in the view's space
    std::uint32_t lowest_vertex = 0, highest_vertex = 0;  // that a triangle names
};

// One primitive of a mesh, prepared once for all of its instances. Points and lines have no triangles here: what is
// drawn of them is made for each frame (strokes.h).
struct PreparedMesh : DrawnMesh {
    PreparedMesh(Primitive&& made, const Primitive& source);
    PreparedMesh(const PreparedMesh&) = delete;
    PreparedMesh& operator=(const PreparedMesh&) = delete;

    const Primitive& primitive() const { return made.positions.empty() ? *source : made; }
    void measure();  // the bounds of the positions, after they were written over

    Primitive made;           // with normals and tangents, where the source lacked them; else empty
    const Primitive* source;  // the scene's
    TriangleList triangles;   // of primitive()
    bool deformed = false;    // its vertices are written over as the scene moves
};

// The scene's mesh that is drawn.
inline const PreparedMesh& prepared_mesh(const DrawnMesh& mesh) {
    return mesh.stroke_of ? *mesh.stroke_of : static_cast<const PreparedMesh&>(mesh);
}

// With the normals and tangents that drawing with this material (null: none) needs and the file lacks.
PreparedMesh prepare_mesh(const Primitive& primitive, const Material* material);

}  // namespace tessera
