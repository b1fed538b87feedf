// A reference engine: visibility by rasterization or by ray casting, and the shading of what it found.
// Single-threaded; one object per frame.
#pragma once

#include "reference/light_tracer.h"
#include "reference/rasterizer.h"
#include "reference/raycaster.h"

#include <memory>
#include <optional>

namespace tessera {

// Radiance times alpha, and alpha, of one sample.
struct SampleColor {
    Vec3T<float> premultiplied;
    float alpha;
};

class ReferenceEngine {
  public:
    // Both must outlive the engine.
    ReferenceEngine(const Frame& frame, const ShadingContext& context) : ReferenceEngine(frame, context, false) {}
    // A tracing engine; it builds its hierarchy here. Light is traced where there are settings for it.
    ReferenceEngine(const Frame& frame, const ShadingContext& context,
                    const std::optional<ReferenceTransport>& transport);

    Visibility see(SamplePosition offset, const RunControl& control) const;

    // The colour of a pixel's sample: the opaque surface, and over it the transparent ones from far to
    // near (Porter and Duff 1984, "over"). `transparent` is the pixel's range of Visibility::transparent.
    SampleColor shade_sample(const Visibility& visibility, std::size_t pixel, SamplePosition offset,
                             const Fragment* transparent, const Fragment* transparent_end);

    SurfaceSampler& sampler() { return sampler_; }

  private:
    ReferenceEngine(const Frame& frame, const ShadingContext& context, bool tracing);
    ShadedPoint<float> shade_triangle(std::uint32_t triangle, SamplePosition at);

    const Frame& frame_;
    const ShadingContext& context_;
    SurfaceSampler sampler_;
    std::unique_ptr<Bvh> bvh_;
    std::unique_ptr<LightTracerReference> light_;
};

}  // namespace tessera
