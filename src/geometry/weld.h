// Finding vertices that are equal: the first step of the tangent standard. Bits decide, with -0 equal
// to 0. Hashing spreads the vertices, sorting inside a bucket keeps the worst case at n log n.
#pragma once

#include <tessera/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// For every vertex the lowest vertex with the same position, normal and uv. `normals` has the length
// of `positions`; so has `uv`, or it is empty. Fewer than 2^32 vertices.
std::vector<std::uint32_t> weld_vertices(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                         std::span<const Vec2> uv);

}  // namespace tessera
