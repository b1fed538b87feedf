// Mip chains of textures: linear texels in 15-bit fixed point, all levels in one array, each level half
// the one before (rounded down) to 1 x 1. Filtered in linear light, from floats that are rounded only for
// storing, by the exact box filter, also for odd sizes. Colours are averaged without regard to alpha: glTF
// stores straight alpha, the level then does not depend on the alpha mode, and data textures are not colours.
// Around each level lies a border of one texel, which repeats the opposite edge, so that two neighbours in a
// row or a column never need wrapping.
#pragma once

#include <tessera/image.h>

#include "simd/texels.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

struct MipLevel {
    std::size_t offset = 0;     // of its border's top left corner
    int width = 0, height = 0;  // without the border

    int stride() const { return width + 2; }  // from row to row
    // Of texel x, y of the level, from -1 (the border) to width, height.
    std::size_t index(int x, int y) const {
        return offset + static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride()) +
               static_cast<std::size_t>(x + 1);
    }
};

struct MipChain {
    std::vector<Texel> texels;     // row by row from the top left
    std::vector<MipLevel> levels;  // the first one is the image itself
};

// All levels of a chain, of zeros.
MipChain empty_mip_chain(int width, int height);
// Makes the border of a level from its texels.
void wrap_border(const MipLevel& level, std::span<Texel> texels);

// From kRgba8 or kRgba16 (kUsage otherwise). `srgb`: the colour channels are sRGB-encoded; alpha, and every
// channel of data textures, is linear.
MipChain make_mip_chain(const Image& image, bool srgb);

// One step of the chain: `width` x `height` pixels of four floats to max(1, width / 2) x
// max(1, height / 2). Every input pixel has the same weight in total, so the mean is kept.
std::vector<float> halve(std::span<const float> pixels, int width, int height);

}  // namespace tessera
