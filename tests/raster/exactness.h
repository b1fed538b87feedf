// Shared by the tests of the exactness contract: the tile rasterizer's planes are those of the reference
// rasterizer, byte for byte.
#pragma once

#include <tessera/tessera.h>

#include "render/scenes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tessera::test {

std::vector<Isa> all_isas();  // of this processor

// How many pixels differ; all of them where size or format do.
std::uint64_t differing(const Image& a, const Image& b);
// Of the planes that the second one has.
void expect_equal_planes(const RenderResult& reference, const RenderResult& r, const std::string& what);
// Planes, and the counters that both engines have.
void expect_equal(const RenderResult& reference, const RenderResult& r, const std::string& what);

void want_labels(RenderOptions& options, bool wanted);  // all but motion
RenderOptions all_planes(int width, int height, int samples);
// The reference's picture against the rasterizer's on every instruction set, threads and tiles in turn.
void expect_exact(const Scene& scene, RenderOptions options, const std::string& what);

// The scene's triangles in the opposite order: nodes, and the triangles of each mesh.
Scene reversed(Scene scene);

// Triangles of every size and place around the camera: behind it, through the near plane, beyond the guard
// band, thin ones; all three alpha modes, one mirrored instance.
Scene triangles_around_the_camera(unsigned seed);

// A level grid of n x n quads over [-side, side]^2 that faces +Z.
Primitive level_grid(int n, float side, float z, int material);

inline View look_from(Vec3 eye, Vec3 target) {
    View view;
    view.eye = eye;
    view.target = target;
    view.yfov = 1.0471975512f;
    return view;
}

}  // namespace tessera::test
