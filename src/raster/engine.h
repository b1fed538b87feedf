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
    LabelPlanes labels{};          // at the pixel centre
    bool euclidean = false;        // their distances are those to the eye
    // 3x4 rows: where their positions and normals live.
    float label_from_camera[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

    bool colors() const { return rgba || linear; }
    SurfaceLabels surface_labels() const {
        const LabelPlanes& p = labels;
        return {p.normal != nullptr, p.shading_normal != nullptr, p.uv != nullptr, p.position != nullptr,
                p.albedo != nullptr};
    }
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
