// Who shades the samples of a tile where light is traced: with shadows, and with the light that rays find.
#pragma once

#include "tile/tile_data.h"

#include <cstdint>
#include <memory>

namespace tessera {

struct TileTask;

// Samples to shade: a triangle seen at a picture position each. Their arrays may be read kMaxLanes beyond the last,
// whose ordinal is repeated.
struct SampleList {
    const std::int32_t *x, *y;     // 1/256 pixel
    const std::uint32_t* ordinal;  // of the tile's triangles, from 1
    std::uint32_t count;
    const TileTriangle* triangles;  // by ordinal - 1
    const std::uint32_t* seen;      // ordinals of those that have a record, those of an instance together
    std::uint32_t seen_count;
    const float* records;            // surface records
    const std::uint32_t* record_of;  // by ordinal: where in `records`
};

// With scratch memory for one task at a time.
class PointShader {
  public:
    virtual ~PointShader() = default;
    // Writes radiance (red, green, blue) and alpha of every sample. Radiance that an opaque surface sends counts in
    // full; where light passes it to the background its alpha is below 1.
    virtual void shade(const TileTask& task, const SampleList& samples, float* const (&color)[4]) = 0;
};

// Where the tasks of a frame get them from, from any thread.
class PointShaders {
  public:
    virtual ~PointShaders() = default;
    virtual std::unique_ptr<PointShader> take() = 0;
    virtual void give(std::unique_ptr<PointShader> shader) = 0;
};

}  // namespace tessera
