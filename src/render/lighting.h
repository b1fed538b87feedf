// The lights of a frame in camera space: the scene's own, or the built-in studio; and the exposure
// that suits them.
#pragma once

#include "geometry/frame.h"
#include "shading/shade.h"

#include <vector>

namespace tessera {

// Ambient radiance that a scene with lights of its own gets by default, as a part of exposed white.
inline constexpr double kDefaultAmbient = 0.05;

std::vector<LightView> scene_lights(const Scene& scene, const Frame& frame);

// Key, fill and rim light, directional and fixed to the camera, for an exposure of 1.
std::vector<LightView> studio_lights();
AmbientView studio_ambient();
AmbientView uniform_ambient(Vec3 radiance);

// Incident-light metering: the light that falls on what the camera sees, not what is reflected, so
// that dark things stay dark and the result depends on no engine. Some thousand points of the visible
// triangles, weighted by the solid angle that they fill; three quarters of the weight is at most
// exposed to kExposedWhite, if it were white. 1 when no light falls on anything.
double metered_exposure(const Frame& frame, const ShadingContext& context);

}  // namespace tessera
