// What is drawn and how: planes to write, samples, film. Shared by the engines that draw tiles.
#pragma once

#include "tile/point_shader.h"

#include <tessera/isa.h>

#include <functional>
#include <vector>

namespace tessera {

// Where the tiles write: planes of the picture, null where not wanted. Without rgba and linear nothing
// is shaded but what transparent labels need.
struct PictureTargets {
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

struct PictureSettings {
    std::vector<SamplePosition> samples;
    FilmView film;
    Isa isa;
    int tile_side = 0;                       // 32, 64, 128 or 0: chosen by the engine
    std::size_t max_fragments;               // transparent fragments in flight, per tile and sample
    std::function<void(double)> checkpoint;  // from any task; throws to stop
    PointShaders* shaders = nullptr;         // of traced light; null: of the lights alone
};

}  // namespace tessera
