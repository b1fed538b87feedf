// The tile rasterizer: front end, then one task per tile that finds what is visible, shades it and
// develops it. Bit for bit the reference rasterizer's pictures.
#pragma once

#include "raster/front_end.h"

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace tessera {

// Where the tiles write: planes of the picture, null where not wanted. Without rgba and linear nothing
// is shaded but what transparent labels need.
struct RasterTargets {
    std::uint8_t* rgba = nullptr;  // display pixels
    float* linear = nullptr;       // mean of the samples, premultiplied RGBA
    float* distance = nullptr;     // labels at the pixel centre
    std::uint32_t* triangle = nullptr;

    bool colors() const { return rgba || linear; }
    bool labels() const { return distance || triangle; }
};

// The stages of a picture with colours, drawn: planes of one number per pixel, null where not wanted.
struct RasterInspection {
    std::uint32_t* bins = nullptr;      // triangles of the pixel's tile
    std::uint32_t* overdraw = nullptr;  // samples tested for depth
    float* floor = nullptr;             // hierarchical Z of the pixel's block, after the last sample
    std::uint32_t* cost = nullptr;      // estimated cycles of the pixel's tile (tile_inspection.cpp)
};

struct RasterSettings {
    std::vector<SamplePosition> samples;
    FilmView film;
    Isa isa;
    int tile_side = 0;  // 32, 64, 128 or 0: chosen by the picture and the threads
    bool hierarchical_z = true;
    bool count = true;                       // fragments: samples_covered, fragments_passed
    std::size_t max_fragments;               // transparent fragments in flight, per tile and sample
    std::function<void(double)> checkpoint;  // from any task; throws to stop
    RasterInspection inspection;
};

struct RasterCounters {
    FrontCounters front;
    TileCounters tiles;
    std::uint64_t triangles = 0, pixels_covered = 0;
    int tile_side = 0;
};

class Tile;

// Keeps its memory from frame to frame. One frame at a time.
class RasterEngine {
  public:
    RasterEngine();
    ~RasterEngine();
    RasterEngine(RasterEngine&&) noexcept;
    RasterEngine& operator=(RasterEngine&&) noexcept;

    RasterCounters draw(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
                        const RasterTargets& targets, Arena& arena);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tessera
