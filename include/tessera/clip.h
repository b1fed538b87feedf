// Clipping in homogeneous space: out-codes (Cohen-Sutherland, three dimensions) and polygon clipping
// (Sutherland and Hodgman, "Reentrant polygon clipping", 1974; in homogeneous coordinates after
// Blinn and Newell 1978). The view volume is -w <= x <= w, -w <= y <= w, 0 <= z <= w (reversed depth:
// z = w is the near plane, z = 0 the far plane).
#pragma once

#include <tessera/export.h>
#include <tessera/types.h>

#include <cstdint>
#include <vector>

namespace tessera {

// A bit per plane of the view volume.
enum ClipPlane : std::uint32_t {
    kClipLeft = 1,
    kClipRight = 2,
    kClipBottom = 4,
    kClipTop = 8,
    kClipNear = 16,
    kClipFar = 32,
    kClipAll = 63,
};

// The planes that the point lies outside of: 0 inside the volume. Both ends' codes ANDed tell a
// segment that can be rejected, ORed to 0 one that can be accepted.
TESSERA_API std::uint32_t out_code(Vec4 clip_position);

// A closed polygon with `attributes_per_vertex` floats per vertex, interpolated linearly in
// homogeneous space (which is perspective-correct).
struct ClipPolygon {
    std::vector<Vec4> positions;
    std::vector<float> attributes;
    int attributes_per_vertex = 0;
};

// The part inside the given planes. Vertices on a plane are inside. A concave polygon may come back
// with coincident edges along a plane, as the algorithm defines: its filled area is right. Empty
// when nothing is left. Throws kUsage when the attributes do not match the vertices.
TESSERA_API ClipPolygon clip_polygon(const ClipPolygon& polygon, std::uint32_t planes = kClipAll);

}  // namespace tessera
