// All of shading in one kernel, compiled once per instruction set: clip space, out-codes, snapping,
// depth plane, surface planes, surface point, material with its textures, lights, film; and the surface
// point of a ray's hit. Its results include what lies between, so that a difference names the stage
// where it began.
#pragma once

#include "shading/film.h"
#include "shading/shade.h"
#include "shading/surface_planes.h"
#include "simd/isa.h"

#include <cstdint>
#include <string_view>

namespace tessera {

// One point is a triangle with all attributes of its corners and a picture position. Planes of one
// float per point, in this order.
enum ChainInput : int {
    kChainCorners = 0,
    kChainCornerSize = 3 + 3 + 4 + 4 + 2 * kMaxUvSets,  // position, normal, tangent, colour, uv sets
    kChainSample = 3 * kChainCornerSize,                // x, y: whole numbers, 24.8
    kChainInputs = kChainSample + 2,
};

struct ChainStage {
    const char* name;
    int results;    // planes of 32 bits
    bool is_float;  // NaNs are equal whatever their bits
};
inline constexpr ChainStage kChainStages[] = {
    {"out-codes", 3, false},
    {"snapped vertices", 6, false},
    {"depth plane", 3, true},
    {"surface planes", kMaxSurfaceFloats, true},
    {"position and normals", 9, true},
    {"tangent frame", 6, true},
    {"uv and footprint", 12, true},
    {"lobe parameters", 14, true},
    {"radiance", 3, true},
    {"alpha", 1, true},
    {"film", 12, false},
    {"point of a ray's hit", 19, true},
};
// The first plane of a stage's results; of the end where there is no such stage.
constexpr int chain_plane(std::string_view stage) {
    int plane = 0;
    for (const ChainStage& s : kChainStages) {
        if (stage == s.name) break;
        plane += s.results;
    }
    return plane;
}
inline constexpr int kChainResults = chain_plane("");

// Plane i of point p is planes[i * stride + p], for the inputs and the results alike. `count` is a multiple of the
// lanes.
struct ChainJob {
    const ShadingContext* context;
    const MaterialView* material;
    const InstanceView* instance;
    const FilmView* films;  // one per tone map: 3
    const ProjectionView* projection;
    SurfaceLayout layout;
    const float* planes;
    std::uint32_t* results;
    int stride, count;
};

struct ChainTable {
    void (*run)(const ChainJob& job);
    int lanes;
};
TESSERA_KERNELS(ChainTable, chain_table);

}  // namespace tessera
