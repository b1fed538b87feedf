// Sample positions within a pixel: Hammersley's point set (van der Corput radical inverse in base 2
// against the index), on the grid of 1/256 pixel that vertices snap to. One sample is the centre.
#pragma once

#include <cstdint>

namespace tessera {

struct SampleOffset {
    std::int32_t x, y;  // 0 .. 255
};

// Sample `index` of `count` (1 .. 256).
constexpr SampleOffset sample_offset(int index, int count) {
    int bits = 0;
    while ((1 << bits) < count) ++bits;
    std::uint32_t inverse = 0;  // `bits` bits of the radical inverse
    for (int b = 0; b < bits; ++b) inverse |= ((static_cast<std::uint32_t>(index) >> b) & 1u) << (bits - 1 - b);
    return {(2 * index + 1) * 128 / count, static_cast<std::int32_t>((2 * inverse + 1) * 128 / (1u << bits))};
}

}  // namespace tessera
