// Surfaces with a formula: spheres, discs and planes as primitives of a mesh.
#pragma once

#include <tessera/export.h>
#include <tessera/shading_model.h>
#include <tessera/types.h>

#include <cstdint>

namespace tessera {

// Stands around the origin of its node. The ray tracers draw spheres and discs by their formula, exactly; the
// rasterizer draws the triangles of the primitive, which lie on the shape. Labels count a shape as one primitive.
struct Shape {
    enum class Type : std::uint8_t {
        kSphere,  // u eastwards, 0.5 in +Z, a quarter in -X; v from the north pole (+Y) down
        kDisc,    // in the XZ plane, front +Y; u along x and v along z, 0 to 1 over the square around it
        kPlane    // as kDisc, a rectangle; without end u = x and v = z
    };
    Type type = Type::kSphere;
    float radius = 1;   // of spheres and discs, above 0
    Vec2 size{0, 0};    // of planes, along x and z, above 0; or both 0: without end (as far as any horizon)
    int segments = 96;  // of the tessellation of spheres and discs, around: 8 to 1024
    friend bool operator==(const Shape&, const Shape&) = default;
};

struct Primitive;

// A primitive of triangles that lie on the shape, with normals, tangents, one set of texture coordinates, and the shape
// itself. Throws kUsage for numbers that are out of range or not finite.
TESSERA_API Primitive shape_primitive(const Shape& shape, int material = kNone);

}  // namespace tessera
