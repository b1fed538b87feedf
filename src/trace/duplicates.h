// Triangles in exactly the same place. A ray may hit any of them, where the rasterizer shows the one with the lowest
// number; so those that others hide from every ray are found here and left out of the hierarchies.
#pragma once

#include "core/parallel.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Triangles of one kind. Rays come in up to eight kinds; bit i of a side says whether those of kind i see it.
struct TriangleSet {
    const float* positions;          // xyz
    const std::uint32_t* triangles;  // three vertices each
    std::uint32_t vertex_count, triangle_count;
    std::uint8_t front = 0, back = 0;  // the side that is seen counter-clockwise, and the other; both 0: hides nothing
};

// By set, ascending: the triangles at whose place, for every kind of ray and side that sees them, one of an earlier
// set, or of a lower number in the same, is seen as well. Places are equal when their three corners are, in any order
// (0 and -0 are the same). Empty when there are none. About 10 ns per triangle.
std::vector<std::vector<std::uint32_t>> find_duplicates(std::span<const TriangleSet> sets, Arena& arena);

}  // namespace tessera
