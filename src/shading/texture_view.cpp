#include "shading/texture_view.h"

#include <algorithm>

namespace tessera {

TextureView texture_view(const MipChain& chain, const Sampler& sampler, int levels) {
    TextureView v{};
    v.texels = chain.texels.data();
    v.levels = std::min(levels, static_cast<int>(chain.levels.size()));
    for (int i = 0; i <= kMaxMipLevels; ++i) {
        const MipLevel& level = chain.levels[static_cast<std::size_t>(std::min(i, v.levels - 1))];
        v.offset[i] = static_cast<std::int32_t>(level.offset);
        v.stride[i] = level.stride();
        v.width[i] = static_cast<float>(level.width * kTexelStep);
        v.height[i] = static_cast<float>(level.height * kTexelStep);
    }
    v.mag_linear = sampler.mag_filter == Filter::kLinear;
    v.min_linear = sampler.min_filter == Filter::kLinear;
    v.mip = sampler.mip_filter;
    v.wrap_s = sampler.wrap_s;
    v.wrap_t = sampler.wrap_t;
    return v;
}

}  // namespace tessera
