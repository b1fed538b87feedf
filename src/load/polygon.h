// Polygons to triangles.
#pragma once

#include <tessera/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Splits the polygon with these corners, in space and about in a plane, into corners.size() - 2 triangles of
// the same winding; appends three numbers of corners for each. Convex ones become a fan; others lose ears
// (Meisters 1975, "Polygons have ears") in the plane that their area vector is nearest to. Polygons
// that cross themselves, and concave ones of many hundred corners that need too many tests, are cut somehow. In double
// and without libm: the same triangles everywhere.
void triangulate_polygon(std::span<const Vec3> corners, std::vector<std::uint32_t>& triangles);

}  // namespace tessera
