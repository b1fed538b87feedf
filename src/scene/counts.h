// How many triangles, lines, points or shapes a primitive draws.
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

// Points and lines, too.
constexpr std::uint64_t element_count(PrimitiveMode mode, std::uint64_t vertices) {
    switch (mode) {
        case PrimitiveMode::kPoints:
            return vertices;
        case PrimitiveMode::kLines:
            return vertices / 2;
        case PrimitiveMode::kLineLoop:
            return vertices < 2 ? 0 : vertices;
        case PrimitiveMode::kLineStrip:
            return vertices < 2 ? 0 : vertices - 1;
        default:
            return triangle_count(mode, vertices);
    }
}

// How many vertices it refers to, in order.
inline std::uint64_t vertex_references(const Primitive& primitive) {
    return primitive.indices.empty() ? primitive.positions.size() : primitive.indices.size();
}
inline std::uint64_t triangle_count(const Primitive& primitive) {
    return triangle_count(primitive.mode, vertex_references(primitive));
}
// A shape is one, whatever its triangles.
inline std::uint64_t element_count(const Primitive& primitive) {
    return primitive.shape ? 1 : element_count(primitive.mode, vertex_references(primitive));
}

}  // namespace tessera
