// Linear blend skinning of vertices by joint matrices (Magnenat-Thalmann, Laperriere and Thalmann 1988), in
// lanes: one vertex each. Plain data; the arrays are the caller's.
#pragma once

#include <cstdint>

namespace tessera {

struct SkinJob {
    const float* matrices;  // of the joints: 12 floats each, three rows of 3x4
    // `influences` per vertex, a multiple of 4, four by four: those of set s and vertex v at 4 (s * count + v).
    const std::uint32_t* joints;
    const float* weights;  // of a vertex they sum to 1
    std::uint32_t sets;    // influences / 4
    std::uint32_t count;   // vertices
    // xyz, xyz, xyzw by vertex; normals and tangents may be null. Out: normals and tangents of unit length.
    const float *positions, *normals, *tangents;
    float *out_positions, *out_normals, *out_tangents;
    std::uint32_t first, end;  // the vertices to do
};

struct SkinKernels {
    void (*skin)(const SkinJob& job);
};

}  // namespace tessera
