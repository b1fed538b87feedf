// The reference ray caster: one primary ray per sample. It decides what is seen by
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

}  // namespace tessera
