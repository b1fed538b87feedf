// The meshes and the texture of the built-in workloads: formulas that benchmarks of other rasterizers use
// too, so that their figures can be compared. Angles and coordinates in double, stored as float;
// counter-clockwise is front.
#pragma once

#include <tessera/scene.h>

namespace tessera::cli {

// Radius 1: 2n x n quads, 4 n^2 triangles.
Primitive sphere_mesh(int n);
// Height field over [-1, 1]^2 with its analytic normals: 2 n^2 triangles.
// y = 0.08 (sin(7x + 0.3) cos(9z) + 0.5 sin(17x + 11z)).
Primitive terrain_mesh(int n);
// `count` separate equilateral triangles that cover `complexity` times width x height pixels in all, seen
// from the origin along -Z with a vertical field of view of 60 degrees, 2 to 6 away; with texture coordinates.
Primitive soup_mesh(int count, double complexity, int width, int height);
// Full-screen layers in clip space with w = 1, depth from -0.9 on, each of one colour, in the order of
// drawing: nearest first or last.
Primitive layer_mesh(int layers, bool front_to_back);
// 1024 x 1024: a checker of 16 texels times a ramp. The values are meant as they are (linear); `srgb` stores
// their sRGB codes, for a texture slot that decodes them.
Image workload_texture(bool srgb);

}  // namespace tessera::cli
