// The reference ray caster: one primary ray per sample, hard shadow rays. It decides what is seen by
// geometry alone (its own intersection test, its own hierarchy) and hands the same record to the same
// surface function as the rasterizer. Single-threaded.
#pragma once

#include "reference/bvh.h"
#include "reference/surface_sampler.h"
#include "reference/visibility.h"

namespace tessera {

// The ray through a picture position: perspective rays start at the eye with direction z = -1, so that
// t is the distance along the view axis; orthographic rays start in the plane of the camera.
CastRay primary_ray(const ProjectionView& projection, SamplePosition at);

// Visibility at the position `offset` of every pixel.
Visibility cast_rays(const Frame& frame, const Bvh& bvh, const ShadingContext& context, SamplePosition offset,
                     const RunControl& control);

// Hard shadows: whether anything opaque stands between a surface point and a light.
class ShadowCaster {
  public:
    ShadowCaster(const Frame& frame, const Bvh& bvh, const ShadingContext& context)
        : bvh_(bvh), sampler_(frame, context) {}

    // 1 where the light arrives, 0 where it does not. `triangle` is the one that the point lies on.
    float visible(const SurfacePoint<float>& point, std::uint32_t triangle, const LightSample<float>& light);

  private:
    const Bvh& bvh_;
    SurfaceSampler sampler_;
};

}  // namespace tessera
