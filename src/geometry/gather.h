// Rebuilding a primitive from chosen vertices: the one place that knows every vertex attribute, used
// where vertices are duplicated (flat normals) or split (tangents).
#pragma once

#include <tessera/scene.h>

#include <cstdint>
#include <span>

namespace tessera {

// A triangle list whose vertex k is a copy of vertex sources[k] of `primitive`, with every attribute:
// normals, tangents, uv sets, colours, joints, weights, custom ones and morph deltas. Material and
// extras are kept; the result has no indices. Sources must be in range.
Primitive gather_vertices(const Primitive& primitive, std::span<const std::uint32_t> sources);

}  // namespace tessera
