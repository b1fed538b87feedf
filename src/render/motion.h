// Motion vectors: where the surface that a pixel shows is at another shot, and whether it is to be seen there. From
// the plane of triangles alone, whichever engine made it: barycentric coordinates of the pixel's centre in double
// from the triangle's homogeneous edges (Olano and Greer 1997), the same point of the moved triangle, projected.
#pragma once

#include "core/parallel.h"
#include "geometry/frame.h"
#include "shading/material.h"

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace tessera {

// The scene at another shot: what its own frame must keep once the scene has moved on.
struct OtherShot {
    Frame frame;                      // with its nodes kept
    std::vector<std::uint32_t> seen;  // 1 + number of the triangle that each pixel's centre shows; 0: none

    // Copies the positions of meshes that change their shape, which the scene will write over.
    void keep_positions();
    const float* positions_of(const PreparedMesh& mesh) const;

  private:
    std::map<const PreparedMesh*, std::vector<float>> positions_;
};

// The planes of RenderResult::motion and motion_seen.
struct MotionPlanes {
    float* vectors;       // four a pixel: after x, y, before x, y
    std::uint32_t* seen;  // a bit each
};

// `triangles` has 1 + number of the triangle in `now`, whose nodes are kept. Null: the same shot as `now`.
void measure_motion(const Frame& now, const std::uint32_t* triangles, const MaterialView* materials,
                    const OtherShot* after, const OtherShot* before, Arena& arena, const MotionPlanes& planes);

}  // namespace tessera
