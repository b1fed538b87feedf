// Alpha and depth of a triangle at a picture position, and alpha where a ray hits it: for the few surfaces of which
// geometry alone does not say whether they are seen. Scalar; remembers the last triangle, so one for each thread.
#pragma once

#include "geometry/frame.h"
#include "shading/shade.h"
#include "shading/transport.h"
#include "shading/triangle_setup.h"

namespace tessera {

class SheerSurface {
  public:
    // Both must outlive it.
    SheerSurface(const Frame& frame, const ShadingContext& context)
        : frame_(frame), context_(context), rays_(frame.projection) {}

    // Turns to a triangle. False where the camera does not see it: outside, without area, or from its culled back.
    bool select(std::uint32_t instance, std::uint32_t triangle);
    // Of the selected one: the canonical depth, and the material's alpha.
    float depth(SamplePosition at) const;
    float alpha(SamplePosition at);
    // Alpha where a ray hits the triangle, whoever sees it; `width` of the ray's footprint grows by `spread`.
    float alpha(std::uint32_t instance, std::uint32_t triangle, const ConeRay<float>& ray, float spread) const;

    // Where a ray hits the triangle.
    RaySurface<float> hit(std::uint32_t instance, std::uint32_t triangle, const ConeRay<float>& ray,
                          float spread) const;

    // Of such a hit how far the ray came, and whether it left the body: hit()'s distance and side, without the rest.
    struct Crossing {
        float distance;
        bool leaving;
    };
    Crossing crossing(std::uint32_t instance, std::uint32_t triangle, const ConeRay<float>& ray) const;

    const MaterialView& material(std::uint32_t instance) const {
        return context_.materials[frame_.instances[instance].material];
    }

  private:
    RaySurface<float> shape_point(SamplePosition at) const;

    const Frame& frame_;
    const ShadingContext& context_;
    PictureRays rays_;
    std::uint32_t instance_ = 0xffffffffu, triangle_ = 0;
    bool visible_ = false, recorded_ = false;
    TriangleSetup setup_;
    SurfaceLayout layout_;
    float record_[kMaxSurfaceFloats];
};

}  // namespace tessera
