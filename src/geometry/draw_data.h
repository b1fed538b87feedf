// What a frame hands to the engines: plain data that kernels may read (no containers, no ownership;
// the Frame of frame.h owns it all). Camera space: eye at the origin, looking along -Z, metres.
// Clip space: x, y in -w .. w inside the picture, z reversed (z = w at the near plane, 0 at the far).
#pragma once

#include "simd/vec.h"

#include <cstdint>

namespace tessera {

// uv sets and colours that the engines read; a material that asks for more is refused.
inline constexpr int kMaxUvSets = 4;

// Who owns the samples that lie on an edge: a triangle owns those that it holds once samples are moved by next to
// nothing. To the right, and down by even less, is the top-left rule, which is 0; the bits turn it, for the lines of
// strokes.h.
inline constexpr std::uint8_t kTopLeft = 0, kTieLeft = 1, kTieUp = 2;
inline constexpr std::uint8_t kTieDownFirst = 4;  // down (or up) by more than sideways

// Whether a triangle owns the samples on its edge of direction (dx, dy), which runs clockwise on the screen.
TESSERA_INLINE bool owns_edge(std::int64_t dx, std::int64_t dy, std::uint8_t rule) {
    if (rule == kTopLeft) return dy < 0 || (dy == 0 && dx > 0);
    const std::int64_t right = rule & kTieLeft ? dy : -dy, down = rule & kTieUp ? -dx : dx;
    const std::int64_t first = rule & kTieDownFirst ? down : right, second = rule & kTieDownFirst ? right : down;
    return first > 0 || (first == 0 && second > 0);
}

// One primitive ready to draw: triangles over vertices with normals. Pointers may be null where the
// mesh has no such attribute (never positions and triangles; normals of unlit points and lines).
struct MeshView {
    const float* positions;          // xyz
    const float* normals;            // xyz
    const float* tangents;           // xyzw
    const float* uvs[kMaxUvSets];    // xy
    const float* colors;             // rgba, linear; the first set
    const std::uint32_t* triangles;  // three vertices each
    std::uint32_t triangle_count, vertex_count;
    // Of points and lines: which of the primitive's they are, and how many consecutive triangles each has; null for
    // meshes. Of lines (two triangles each) the rule of their ties, which others have none of: kTopLeft.
    const std::uint32_t* elements = nullptr;
    std::uint32_t triangles_per_element = 1;
    const std::uint8_t* ties = nullptr;
    bool whole = false;  // all triangles are one primitive: the tessellation of a shape

    TESSERA_INLINE bool is_stroke() const { return elements != nullptr; }
    TESSERA_INLINE std::uint8_t tie_rule(std::uint32_t triangle) const { return ties ? ties[triangle >> 1] : kTopLeft; }
    // The number of a triangle's point, line or triangle in the primitive.
    TESSERA_INLINE std::uint32_t element_of(std::uint32_t triangle) const {
        if (whole) return 0;
        return elements ? elements[triangle / triangles_per_element] : triangle;
    }
};

// A shape that is drawn by its formula (shape_surface.h) in place of its triangles: around the object's origin. What is
// seen of it has the names of its first triangles: of a sphere 0 where a ray enters it and 1 where it leaves.
struct ShapeView {
    enum class Kind : std::uint8_t { kTriangles, kSphere, kDisc };  // a disc: in the XZ plane, front +Y
    Kind kind = Kind::kTriangles;
    float radius = 0;
    float camera_to_object[12] = {};  // 3x4 rows

    explicit operator bool() const { return kind != Kind::kTriangles; }
};

// A mesh placed in the frame. Its triangles have the numbers first_triangle .. + triangle_count - 1,
// in the order of submission.
struct InstanceView {
    MeshView mesh;
    float object_to_clip[16];    // rows
    float object_to_camera[12];  // 3x4 rows
    float normal_to_camera[9];   // rows; inverse transpose of the linear part
    float handedness;            // -1 where object_to_camera or the skin mirrors, else 1
    float skin_side = 1;         // -1 where the skin mirrors: its vertices go the other way round
    std::uint32_t first_triangle;
    std::uint32_t material;         // index into the shading materials
    std::uint32_t scene_material;   // index into Scene::materials; their number for the default one
    std::uint32_t node;             // index into Scene::nodes
    std::uint32_t first_primitive;  // as first_triangle, of what labels count: points, lines and triangles, seen or not
    ShapeView shape{};
};

// The picture's projection: camera space to clip space, and pixels.
struct ProjectionView {
    float width, height;  // pixels
    bool orthographic;
    float clip_from_camera[16];  // rows
    float scale_x, scale_y;      // clip_from_camera[0] and [5]
    float near;                  // distance of the near plane
};

// A picture position in 1/256 pixel from the top left corner.
struct SamplePosition {
    std::int32_t x, y;
};

}  // namespace tessera
