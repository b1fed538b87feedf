// The reference rasterizer: a z-buffer as the textbooks have it, one triangle after the other, one
// pixel after the other, in exact fixed point. The oracle for every faster rasterizer.
#pragma once

#include "reference/surface_sampler.h"
#include "reference/visibility.h"

namespace tessera {

// Visibility at the position `offset` (0 .. 255 in 1/256 pixel) of every pixel.
Visibility rasterize(const Frame& frame, const ShadingContext& context, SamplePosition offset,
                     const RunControl& control);

}  // namespace tessera
