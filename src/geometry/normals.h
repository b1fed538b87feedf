// Flat normals, as glTF 2.0 asks for where a primitive has none (section 3.7.2.1): every triangle
// gets its own three vertices with the normal of its plane, and the file's tangents are ignored.
// Computed in double; the same bits on every machine.
#pragma once

#include <tessera/scene.h>

#include <span>

namespace tessera {

// The normal of a triangle without area: something finite that shades.
inline constexpr Vec3 kDegenerateNormal{0, 0, 1};

// Face normals of un-indexed triangles: positions 3i .. 3i+2 are one triangle, and normals 3i .. 3i+2
// receive its unit normal (kDegenerateNormal without area). Both spans have the same length, a
// multiple of 3. Call it again after positions were morphed.
void compute_flat_normals(std::span<const Vec3> positions, std::span<Vec3> normals);

// A triangle list without indices, with flat normals and every other attribute of `primitive`
// duplicated, morph positions included. Tangents, and morph deltas of normals and tangents, are left
// out: they belong to normals that the primitive does not have. Points and lines are returned as
// they are.
Primitive with_flat_normals(const Primitive& primitive);

}  // namespace tessera
