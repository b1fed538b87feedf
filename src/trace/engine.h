// The ray tracer: hierarchies of the frame, then one task per tile that finds what is visible by rays or takes it from
// the rasterizer, and follows light from there. Bit for bit the reference ray tracer's pictures, but for surfaces that
// lie as close together as rounding.
#pragma once

#include "tile/picture.h"
#include "trace/embree_scene.h"

#include <cstdint>
#include <memory>

namespace tessera {

// Which light is traced.
struct TransportSettings {
    bool shadows = true;              // of the lights
    bool bounces = true;              // mirrored and refracted light
    int max_depth = 8;                // how often light is mirrored or refracted
    float least = 0.002f;             // contribution to a sample below which light is not followed
    float background[3] = {0, 0, 0};  // radiance that light which only passes surfaces comes from
};

struct TransportCounters {
    std::uint64_t shadow_rays = 0, mirrored_rays = 0, refracted_rays = 0, straight_rays = 0;
    std::uint64_t ended_by_depth = 0, ended_by_contribution = 0;  // rays that did not go on
};

struct TraceCounters {
    std::uint64_t primary_rays = 0, hits = 0, pixels_covered = 0;
    int tile_side = 0;
};

// Keeps its memory and hierarchies from frame to frame. One frame at a time.
class LightTracer final : public PointShaders {
  public:
    LightTracer(Isa isa, std::uint64_t max_bytes);
    ~LightTracer() override;

    // Builds or brings up to date what rays of a frame need; the frame must outlive its drawing.
    void begin(const Frame& frame, const ShadingContext& shading, const TransportSettings& settings, Arena& arena);
    const BuildStatistics& build() const;
    TransportCounters counters() const;  // since begin()

    // Draws what rays see of it. Light is traced where the settings name this as their shaders.
    TraceCounters draw(const Frame& frame, const ShadingContext& shading, const PictureSettings& settings,
                       const PictureTargets& targets, Arena& arena);

    std::unique_ptr<PointShader> take() override;
    void give(std::unique_ptr<PointShader> shader) override;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tessera
