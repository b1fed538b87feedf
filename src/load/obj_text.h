// The text of a Wavefront OBJ file as arrays: vertices, and faces, lines and points over them, by object
// and material. Numbers are checked, references are resolved to positions in the arrays.
#pragma once

#include "load/context.h"

#include <tessera/scene.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// A corner of a face: positions in the arrays; texcoord and normal may be absent (-1).
struct ObjCorner {
    std::int32_t position, texcoord, normal;
};

inline constexpr std::uint32_t kUnsaid = 0xffffffff;

// What one statement `f`, `l` or `p` names.
struct ObjElement {
    std::uint32_t first_corner, corner_count;
    std::uint32_t part;
    std::uint32_t smoothing;  // group; 0 is off, kUnsaid: the file says nothing of it
    std::uint32_t line;       // of the text
};

// Elements of one kind that become one primitive.
struct ObjPart {
    std::uint32_t object;
    std::int32_t material;  // index into ObjText::materials, or -1
    PrimitiveMode mode;     // kTriangles, kLines or kPoints
    std::uint32_t elements = 0;
    bool operator==(const ObjPart& o) const { return object == o.object && material == o.material && mode == o.mode; }
};

struct ObjText {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> colors;  // linear; as long as positions, or empty
    std::vector<Vec2> texcoords;
    std::vector<ObjCorner> corners;
    std::vector<ObjElement> elements;
    std::vector<ObjPart> parts;
    std::vector<std::string> objects;    // names
    std::vector<std::string> materials;  // names, as `usemtl` has them
    std::vector<std::string> libraries;  // files, as `mtllib` has them
};

// Whether a text without a name that says so may be OBJ: its first statement is one.
bool looks_like_obj(std::string_view text);
// Throws kInput for a damaged text.
ObjText read_obj_text(LoadContext& context, std::string_view text);

}  // namespace tessera
