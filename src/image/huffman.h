// Length-limited Huffman codes in the canonical form of Deflate (RFC 1951, section 3.2.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// A code per symbol: `length` bits (0: the symbol does not occur), to be written lowest bit first.
struct HuffmanCode {
    std::vector<std::uint16_t> bits;
    std::vector<std::uint8_t> length;
};

// A code for symbols that occur `counts` times, with at most `max_length` bits each. At least two symbols
// get a code, so that it is complete. The result depends on the counts alone.
HuffmanCode make_huffman_code(std::span<const std::uint32_t> counts, int max_length);

}  // namespace tessera
