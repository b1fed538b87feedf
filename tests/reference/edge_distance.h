// How far a sample is from the edges of a triangle's picture.
#pragma once

#include "shading/triangle_setup.h"

#include <algorithm>
#include <cmath>

namespace tessera::test {

// Distance in pixels from a sample to the nearest edge of a triangle's picture.
inline double edge_distance(const TriangleSetup& t, SamplePosition at) {
    double nearest = 1e30;
    for (int i = 0; i < t.vertex_count; ++i) {
        const SnappedVertex a = t.polygon[i], b = t.polygon[(i + 1) % t.vertex_count];
        const double dx = b.x - a.x, dy = b.y - a.y, px = at.x - a.x, py = at.y - a.y;
        const double squared = dx * dx + dy * dy;
        const double s = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0.0;
        nearest = std::min(nearest, std::hypot(px - s * dx, py - s * dy) / 256.0);
    }
    return nearest;
}

// Of two surfaces of these canonical depths none is in front, by rounding alone.
inline bool coincident(float depth, float other) {
    return std::fabs(depth - other) <= 4 * 1.2e-7f * std::max(depth, other);
}

}  // namespace tessera::test
