// Tangents as the MikkTSpace standard makes them, which glTF 2.0 (section 3.7.2.1) names for
// primitives without their own. Source: M. S. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited"
// (2008), chapters 2 and 3: vertices that are equal in position, normal and uv are one; the triangles
// around a vertex are grouped by shared edges and by the orientation of their uv; a group's tangent is
// the angle-weighted mean of its triangles' tangents in the vertex' plane. Written from that
// description; triangles only, the standard's default angular threshold (180 degrees).
//
// Conventions of glTF: v points down the picture and the green of a normal map up, so the bitangent
// w * cross(normal, tangent) points against v. Computed in double without libm; the result does not
// depend on the order of anything but the input, and is finite for every finite input.
#pragma once

#include <tessera/scene.h>

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// One tangent per corner of `triangles` (three vertex indices each): xyz of unit length and
// perpendicular to the normal, w = +1 or -1. `normals` has the length of `positions`; so has `uv`, or
// it is empty (no mapping). Corners that no triangle with a mapping reaches get some perpendicular
// unit vector and w = 1. Takes time near linear in the corners, whatever their arrangement.
std::vector<Vec4> corner_tangents(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                  std::span<const Vec2> uv, std::span<const std::uint32_t> triangles);

// The primitive as a triangle list with tangents for uv set `uv_set` (a missing set counts as no
// mapping). A vertex whose corners differ is split: it keeps the tangent of its first corner, copies
// for the others are appended, so vertex numbers stay valid. Morph deltas of tangents are kept where
// present. A primitive without normals or without triangles is returned unchanged.
Primitive with_tangents(const Primitive& primitive, int uv_set);

}  // namespace tessera
