// A fast Deflate (RFC 1951) for filtered picture rows. It knows one kind of match, with the pixel before
// (flat and evenly shaded regions), and codes the rest by Huffman's method: several times as fast as the
// fast levels of general libraries at about their size on rendered pictures. The bytes are a function
// of the input alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Appends `in` to `out` as blocks without the final mark, ending at a byte border, so that the results
// of several calls join to one stream. Matches reach back `pixel_bytes` (1 .. 8).
void deflate_fast(std::span<const std::uint8_t> in, std::size_t pixel_bytes, std::vector<std::uint8_t>& out);

// The same without compression.
void deflate_stored(std::span<const std::uint8_t> in, std::vector<std::uint8_t>& out);

// Appends the empty final block that ends a stream.
void deflate_end(std::vector<std::uint8_t>& out);

}  // namespace tessera
