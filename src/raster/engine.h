// The tile rasterizer: front end, then one task per tile that finds what is visible, shades it and
// develops it. Bit for bit the reference rasterizer's pictures.
#pragma once

#include "raster/front_end.h"

#include <functional>
#include <vector>

namespace tessera {

// Where the tiles write: planes of the picture, null where not wanted.
struct RasterTargets {
    std::uint8_t* rgba = nullptr;  // display pixels
    float* linear = nullptr;       // mean of the samples, premultiplied RGBA
    float* distance = nullptr;     // labels at the pixel centre
    std::uint32_t* triangle = nullptr;
};

struct RasterSettings {
    std::vector<SamplePosition> samples;
    FilmView film;
    Isa isa;
    std::size_t max_fragments;               // transparent fragments in flight, per tile and sample
    std::function<void(double)> checkpoint;  // from any task; throws to stop
};

struct RasterCounters {
    FrontCounters front;
    std::uint64_t triangles = 0, fragments_passed = 0, pixels_covered = 0;
};

RasterCounters draw_raster(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
                           const RasterTargets& targets, Arena& arena);

}  // namespace tessera
