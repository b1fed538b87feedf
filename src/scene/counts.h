// How many triangles a primitive draws.
#pragma once

#include <tessera/scene.h>

#include <cstdint>

namespace tessera {

// `vertices`: the number of indices, or of positions when there are none. Incomplete triangles at the
// end of a list are not drawn (glTF 2.0, section 3.7.2.1).
constexpr std::uint64_t triangle_count(PrimitiveMode mode, std::uint64_t vertices) {
    switch (mode) {
        case PrimitiveMode::kTriangles:
            return vertices / 3;
        case PrimitiveMode::kTriangleStrip:
        case PrimitiveMode::kTriangleFan:
            return vertices < 3 ? 0 : vertices - 2;
        default:
            return 0;
    }
}

inline std::uint64_t triangle_count(const Primitive& primitive) {
    return triangle_count(primitive.mode,
                          primitive.indices.empty() ? primitive.positions.size() : primitive.indices.size());
}

}  // namespace tessera
