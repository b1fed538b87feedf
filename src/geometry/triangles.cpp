#include "geometry/triangles.h"

#include <numeric>

namespace tessera {
namespace {

std::vector<std::uint32_t> first_vertices(std::size_t count) {
    std::vector<std::uint32_t> v(count);
    std::iota(v.begin(), v.end(), 0u);
    return v;
}

// p_i = {v_i, v_{i+(1+i%2)}, v_{i+(2-i%2)}}: every second triangle swaps two corners, which keeps
// the winding.
std::vector<std::uint32_t> strip_triples(std::span<const std::uint32_t> v, std::size_t count) {
    std::vector<std::uint32_t> triples;
    triples.reserve(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t odd = i % 2;
        triples.insert(triples.end(), {v[i], v[i + 1 + odd], v[i + 2 - odd]});
    }
    return triples;
}

// p_i = {v_{i+1}, v_{i+2}, v_0}.
std::vector<std::uint32_t> fan_triples(std::span<const std::uint32_t> v, std::size_t count) {
    std::vector<std::uint32_t> triples;
    triples.reserve(3 * count);
    for (std::size_t i = 0; i < count; ++i) triples.insert(triples.end(), {v[i + 1], v[i + 2], v[0]});
    return triples;
}

}  // namespace

std::array<std::uint32_t, 2> stroke_vertices(const Primitive& primitive, std::uint32_t element) {
    const bool list = primitive.mode == PrimitiveMode::kLines;
    const std::size_t from = list ? 2 * std::size_t{element} : element;
    std::size_t to = primitive.mode == PrimitiveMode::kPoints ? from : from + 1;
    if (to == vertex_references(primitive)) to = 0;  // a loop closes
    if (primitive.indices.empty()) return {static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(to)};
    return {primitive.indices[from], primitive.indices[to]};
}

std::size_t used_index_count(const Primitive& primitive) {
    const std::size_t n = vertex_references(primitive);
    switch (primitive.mode) {
        case PrimitiveMode::kPoints:
            return n;
        case PrimitiveMode::kLines:
            return n - n % 2;
        case PrimitiveMode::kLineLoop:
        case PrimitiveMode::kLineStrip:
            return n < 2 ? 0 : n;
        case PrimitiveMode::kTriangles:
            return n - n % 3;
        case PrimitiveMode::kTriangleStrip:
        case PrimitiveMode::kTriangleFan:
            return n < 3 ? 0 : n;
    }
    return 0;
}

TriangleList::TriangleList(const Primitive& primitive) {
    const std::size_t count = triangle_count(primitive);
    if (count == 0) return;
    const bool list = primitive.mode == PrimitiveMode::kTriangles;
    if (list && !primitive.indices.empty()) {
        indices_ = std::span(primitive.indices).first(3 * count);
        return;
    }
    owned_ = list ? first_vertices(3 * count) : std::vector<std::uint32_t>{};
    if (!list) {
        const std::vector<std::uint32_t> implied =
            primitive.indices.empty() ? first_vertices(primitive.positions.size()) : std::vector<std::uint32_t>{};
        const std::span<const std::uint32_t> v = primitive.indices.empty() ? std::span(implied) : primitive.indices;
        owned_ = primitive.mode == PrimitiveMode::kTriangleStrip ? strip_triples(v, count) : fan_triples(v, count);
    }
    indices_ = owned_;
}

}  // namespace tessera
