// The triangles of a primitive as vertex-index triples, in the order and winding of glTF 2.0
// (section 3.7.2.1): the submission order that primitive numbers count. Triangle lists, strips and
// fans, with or without indices; incomplete trailing vertices give nothing; degenerate triangles are
// kept, so that numbers stay simple. Points and lines have no triangles.
#pragma once

#include <tessera/scene.h>

#include "scene/counts.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Triangle lists, strips and fans; the other modes are drawn as strokes (strokes.h).
constexpr bool has_triangles(PrimitiveMode mode) {
    return mode == PrimitiveMode::kTriangles || mode == PrimitiveMode::kTriangleStrip ||
           mode == PrimitiveMode::kTriangleFan;
}

// The vertices of point `element` (twice the same) or line `element`.
std::array<std::uint32_t, 2> stroke_vertices(const Primitive& primitive, std::uint32_t element);

// How many entries of the index list (or vertices, where there are no indices) belong to complete
// points, lines or triangles: the rest is never drawn.
std::size_t used_index_count(const Primitive& primitive);

// Views the primitive's own indices where they are a triangle list (the primitive must outlive it
// and stay unchanged), else owns its triples. Movable, not copyable.
class TriangleList {
  public:
    explicit TriangleList(const Primitive& primitive);
    TriangleList(TriangleList&&) noexcept = default;
    TriangleList& operator=(TriangleList&&) noexcept = default;
    TriangleList(const TriangleList&) = delete;
    TriangleList& operator=(const TriangleList&) = delete;

    std::size_t count() const { return indices_.size() / 3; }
    bool empty() const { return indices_.empty(); }
    // Three vertex indices per triangle.
    std::span<const std::uint32_t> indices() const { return indices_; }
    std::array<std::uint32_t, 3> operator[](std::size_t triangle) const {
        return {indices_[3 * triangle], indices_[3 * triangle + 1], indices_[3 * triangle + 2]};
    }

  private:
    std::vector<std::uint32_t> owned_;  // moving it keeps its buffer, so indices_ stays valid
    std::span<const std::uint32_t> indices_;
};

}  // namespace tessera
