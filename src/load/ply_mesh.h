// What of a PLY file is used, and how it becomes primitives: polygons to triangles, normals where a file
// has none, vertices with several texture coordinates to several vertices.
#pragma once

#include "load/context.h"

#include <tessera/scene.h>

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

// What a corner of a face has of its own.
struct PlyWedge {
    Vec2 uv{0, 0};
    int texture = kNone;  // number of the picture
};

struct PlyMesh {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> colors;
    std::vector<Vec2> texcoords;
    // Faces and edges: the vertices of all, and how many each has; -1 ends a strip.
    std::vector<std::int64_t> corners, strip;
    std::vector<PlyWedge> wedges;  // of the corners, or none
    std::vector<std::uint32_t> sizes;
    std::vector<std::int64_t> edges;
};

// Triangles as numbers of vertices and, where the mesh has wedges, of the corners among those of the faces;
// kNoCorner where they come from a strip.
struct PlyTriangles {
    static constexpr std::uint32_t kNoCorner = 0xffffffff;
    std::vector<std::uint32_t> vertices, corners;
};

// A primitive and the number of its picture, or kNone. The primitive has no material yet.
struct PlyPart {
    int texture = kNone;
    Primitive primitive;
};

// The triangles of faces and strips. Throws kInput for vertices that are not there.
PlyTriangles triangulate(LoadContext& context, const PlyMesh& mesh);
// Smooth normals but for sharp edges, where vertices become several.
void make_normals(LoadContext& context, PlyMesh& mesh, PlyTriangles& triangles);
// Turns the triangles that the normals see from behind.
void turn_to_normals(const PlyMesh& mesh, PlyTriangles& triangles);

// The mesh by the pictures, of which there are `textures`, that its triangles name: all of it is one part where
// corners have nothing of their own. A vertex becomes as many as it has texture coordinates.
std::vector<PlyPart> split_by_texture(LoadContext& context, PlyMesh&& mesh, PlyTriangles&& triangles, int textures);
// The mesh as its edges, or its vertices where it has none.
std::vector<PlyPart> lines_or_points(LoadContext& context, PlyMesh&& mesh);

}  // namespace tessera
