// Vertex normals from the triangles around a vertex.
#pragma once

#include <tessera/types.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// The mean of the triangles' normals, weighted by the angle at the vertex (Thuermer and Wuethrich 1998,
// "Computing vertex normals from polygonal facets"), so that it does not depend on how a face is cut
// into triangles. `positions[corners[i]]` is where corner i stands, three corners to a triangle;
// `groups[i]` (below `count`) says which normal it contributes to. Unit length; (0, 0, 1) where nothing
// says a direction. Computed in double; the same bits on every machine.
std::vector<Vec3> angle_weighted_normals(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                                         std::span<const std::uint32_t> groups, std::size_t count);

// Groups for it where nothing says which edges are sharp: the triangles around a position fall apart where
// neighbouring directions differ by more than 60 degrees. Numbered from 0; returns one for each corner and sets
// `count`. Positions with more than 64 triangles stay whole.
std::vector<std::uint32_t> crease_groups(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                                         std::size_t& count);

}  // namespace tessera
