// What a texture lookup reads, from a mip chain and a sampler.
#pragma once

#include "image/mipmap.h"
#include "shading/texture.h"

#include <tessera/material.h>

namespace tessera {

// The first `levels` levels of the chain, which must outlive the view.
TextureView texture_view(const MipChain& chain, const Sampler& sampler, int levels = kMaxMipLevels);

}  // namespace tessera
