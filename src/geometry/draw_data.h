// What a frame hands to the engines: plain data that kernels may read (no containers, no ownership;
// the Frame of frame.h owns it all). Camera space: eye at the origin, looking along -Z, metres.
// Clip space: x, y in -w .. w inside the picture, z reversed (z = w at the near plane, 0 at the far).
#pragma once

#include <cstdint>

namespace tessera {

// uv sets and colours that the engines read; a material that asks for more is refused.
inline constexpr int kMaxUvSets = 4;

// One primitive ready to draw: triangles over vertices with normals. Pointers may be null where the
// mesh has no such attribute (never positions, normals, triangles).
struct MeshView {
    const float* positions;          // xyz
    const float* normals;            // xyz
    const float* tangents;           // xyzw
    const float* uvs[kMaxUvSets];    // xy
    const float* colors;             // rgba, linear; the first set
    const std::uint32_t* triangles;  // three vertices each
    std::uint32_t triangle_count, vertex_count;
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
    std::uint32_t material;  // index into the shading materials
    std::uint32_t node;      // index into Scene::nodes
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
