// Mip chains of textures: RGBA8 texels of all levels in one array, each level half the one before
// (rounded down) to 1 x 1. Filtered in linear light, from floats that are not rounded in between, by
// the exact box filter, also for odd sizes. Colours are averaged without regard to alpha: glTF stores
// straight alpha, the level then does not depend on the alpha mode, and data textures are not colours.
#pragma once

#include <tessera/image.h>

#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct MipLevel {
    std::size_t offset = 0;  // of its first texel
    int width = 0, height = 0;
};

struct MipChain {
    std::vector<std::uint32_t> texels;  // R in the low byte, then G, B, A; row by row from the top left
    std::vector<MipLevel> levels;       // the first one is the image itself
};

// From kRgba8 or kRgba16 (kUsage otherwise). `srgb`: the colour channels are sRGB-encoded, and stay so
// in every level; alpha, and every channel of data textures, is linear.
MipChain make_mip_chain(const Image& image, bool srgb);

// One step of the chain: `width` x `height` pixels of four floats to max(1, width / 2) x
// max(1, height / 2). Every input pixel has the same weight in total, so the mean is kept.
std::vector<float> halve(std::span<const float> pixels, int width, int height);

}  // namespace tessera
