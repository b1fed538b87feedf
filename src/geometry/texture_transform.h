// KHR_texture_transform as a matrix on texture coordinates: what shading samples with, and what the
// tangents of a normal texture are made for.
#pragma once

#include <tessera/material.h>

#include "simd/math.h"

namespace tessera {

// Rows of the 2x3 matrix on (u, v, 1): uv' = translate(offset) * rotate(rotation) * scale(scale) * uv,
// where a positive rotation turns the texture counter-clockwise with v pointing down.
inline void texture_transform(const TextureRef& ref, float (&rows)[6]) {
    const auto angle = static_cast<double>(ref.rotation);
    const double c = math::cos(angle), s = math::sin(angle);
    rows[0] = static_cast<float>(c * static_cast<double>(ref.scale.x));
    rows[1] = static_cast<float>(s * static_cast<double>(ref.scale.y));
    rows[2] = ref.offset.x;
    rows[3] = static_cast<float>(-s * static_cast<double>(ref.scale.x));
    rows[4] = static_cast<float>(c * static_cast<double>(ref.scale.y));
    rows[5] = ref.offset.y;
}

}  // namespace tessera
