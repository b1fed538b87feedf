// World-space bounds of what is drawn: exact over the transformed vertices that a drawn primitive
// refers to, not boxes of boxes. Computed in double, rounded to float at the end. The bounds of a
// whole scene are visible_bounds() of render.h.
#pragma once

#include <tessera/scene.h>

#include <glm/mat4x4.hpp>
#include <vector>

namespace tessera {

// The positions that complete points, lines or triangles of the primitive use, each once, in vertex
// order. None of a plane without end: where it stops means nothing.
std::vector<Vec3> used_positions(const Primitive& primitive);

// The box of the primitive's used positions under an affine matrix. Points that are not finite after
// it are left out.
Bounds3 transformed_bounds(const Primitive& primitive, const glm::dmat4& to_world);

}  // namespace tessera
