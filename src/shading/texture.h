// Texture lookup over the number type: wrap modes, nearest, bilinear and trilinear filters. Texels are
// linear, in 15-bit fixed point (simd/texels.h), and so are positions between texels and mip levels.
// Every level has a border of one texel, the opposite edge's: the four texels of a lookup are always two
// neighbours in each of two rows, one stride apart. Coordinates: u to the right, v down, (0, 0) the top left corner.
#pragma once

#include <tessera/shading_model.h>

#include "shading/vectors.h"
#include "simd/texels.h"

#include <cstdint>

namespace tessera {

inline constexpr int kMaxMipLevels = 15;  // 16384 and down to 1

// Positions within a texture count 1/32768 texel.
inline constexpr std::int32_t kTexelStep = 1 << kWeightBits;

// A texture ready to sample: plain data; the texels belong to somebody else.
struct TextureView {
    const Texel* texels = nullptr;
    // By level. The last level's numbers are repeated behind it, so the next level is always one on.
    std::int32_t offset[kMaxMipLevels + 1] = {};                          // of the border's corner in texels
    std::int32_t stride[kMaxMipLevels + 1] = {};                          // of a row, in texels
    float width[kMaxMipLevels + 1] = {}, height[kMaxMipLevels + 1] = {};  // in 1/32768 texel, without the border
    std::int32_t levels = 0;
    bool mag_linear = true, min_linear = true;
    MipFilter mip = MipFilter::kLinear;
    Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
};

// Brings a coordinate into [0, 1]. NaN becomes 0, and so do infinities unless they are clamped.
template <class F>
TESSERA_INLINE F wrap_coordinate(F t, Wrap mode) {
    const F zero(0.0f);
    if (mode == Wrap::kRepeat) return max(t - floor(t), zero);
    if (mode == Wrap::kMirror) {
        const F twice = t - F(2.0f) * floor(t * F(0.5f));
        return max(min(twice, F(2.0f) - twice), zero);
    }
    return saturate(t);
}

// Where among a level's texels, border included, a coordinate of [0, 1] falls: the first of two
// neighbours, and the weight of the second.
template <class F>
struct TexelPosition {
    IntOf<F> first, weight;
};
// `size` in 1/32768 texel; `linear` are the lanes that are filtered, the others take the texel that
// holds the point.
template <class F>
TESSERA_INLINE TexelPosition<F> texel_position(F t, F size, Wrap mode, bool all_linear, const MaskOf<F>& linear) {
    using I = IntOf<F>;
    const F step(static_cast<float>(kTexelStep));
    const F at = t * size;
    // Texel i lies at i + 1 behind the border, and its centre half a texel further on.
    F middle = at + F(0.5f) * step;
    if (mode != Wrap::kRepeat) middle = min(max(middle, step), size);
    I position = nearest_int(middle);
    if (!all_linear) {
        const I texel = truncate_int(min(at, size - step)) & I(-kTexelStep);
        position = select(linear, position, texel + I(kTexelStep));
    }
    return {position >> kWeightBits, position & I(kTexelStep - 1)};
}

// How a lookup filters within a level.
template <class F>
struct LevelFilter {
    bool all_linear;
    MaskOf<F> linear;
};

// The four texels of a lookup in one level, and their weights.
template <class F>
struct TexelCorners {
    IntOf<F> first, stride, across, down;

    // A Texel of each lane.
    TESSERA_INLINE auto load(const Texel* texels) const { return load_bilinear(texels, first, stride, across, down); }
};
// u and v already within [0, 1].
template <class F>
TESSERA_INLINE TexelCorners<F> texel_corners(const TextureView& t, F u, F v, const IntOf<F>& level,
                                             const LevelFilter<F>& filter) {
    const TexelPosition<F> x =
        texel_position<F>(u, lookup16(t.width, level), t.wrap_s, filter.all_linear, filter.linear);
    const TexelPosition<F> y =
        texel_position<F>(v, lookup16(t.height, level), t.wrap_t, filter.all_linear, filter.linear);
    const IntOf<F> stride = lookup16(t.stride, level);
    return {lookup16(t.offset, level) + y.first * stride + x.first, stride, x.weight, y.weight};
}

// The footprint of a pixel in uv: change of (u, v) per step right and down.
template <class F>
struct Footprint {
    F ux, vx, uy, vy;
};

// Square of the footprint's longer side in texels of level 0 (Williams 1983; the larger of the two axes
// as in the OpenGL 4.6 specification, section 8.14.1).
template <class F>
TESSERA_INLINE F squared_footprint(const TextureView& t, const Footprint<F>& d) {
    const F w(t.width[0] / static_cast<float>(kTexelStep)), h(t.height[0] / static_cast<float>(kTexelStep));
    const F xx = d.ux * w, xy = d.vx * h, yx = d.uy * w, yy = d.vy * h;
    return max(xx * xx + xy * xy, yx * yx + yy * yy);
}

// The level of detail, log2 of the footprint's longer side within 0 .. levels - 1.
template <class F>
struct LevelOfDetail {
    UintOf<F> squared;  // bits of 2^(2 lod), from those of 1 on
    // The level next to it.
    TESSERA_INLINE IntOf<F> nearest() const { return as_int((squared + UintOf<F>(1u << 23)) >> 24); }
    // The level at or below it.
    TESSERA_INLINE IntOf<F> floor() const { return as_int(squared >> 24); }
    // The weight of the level above that. The exponent's last bit and the mantissa m of 1 + m are twice the
    // fraction of the level but for log2(1 + m) - m, here m (1 - m) q(m) with a minimax q of degree 3 (Remez):
    // exact at powers of two, else within 1.6e-5, a quarter of a step of the weight.
    TESSERA_INLINE IntOf<F> fraction() const {
        using I = IntOf<F>;
        const I bits = as_int(squared);
        const F m = as_float((bits & I(0x7fffff)) | I(0x3f800000)) - F(1.0f);
        F q = F(-0x1.71dc72p-5f);
        q = q * m + F(0x1.2ffa54p-3f);
        q = q * m + F(-0x1.11977cp-2f);
        q = q * m + F(0x1.c485e6p-2f);
        const F twice = to_float(bits & I(0xffffff)) * F(0x1p-23f) + m * (F(1.0f) - m) * q;
        return min(nearest_int(twice * F(0.5f * static_cast<float>(kTexelStep))), I(kTexelStep - 1));
    }
};
template <class F>
TESSERA_INLINE LevelOfDetail<F> level_of_detail(F squared, std::int32_t levels) {
    // max gives the second operand for NaN.
    const F within = min(max(squared, F(1.0f)), F(static_cast<float>(1 << 2 * (levels - 1))));
    return {as_uint(within) - UintOf<F>(0x3f800000u)};
}

template <class F>
TESSERA_INLINE Vec4T<F> sample_texture(const TextureView& t, F u, F v, const Footprint<F>& d) {
    using I = IntOf<F>;
    u = wrap_coordinate(u, t.wrap_s);
    v = wrap_coordinate(v, t.wrap_t);
    const F squared = squared_footprint(t, d);
    const auto minified = squared > F(1.0f);
    LevelFilter<F> filter{t.mag_linear && t.min_linear, MaskOf<F>(true)};
    if (!filter.all_linear) filter.linear = select(minified, MaskOf<F>(t.min_linear), MaskOf<F>(t.mag_linear));

    // All positions before the first load, so that the loads of both levels need not wait for each other.
    I weight(0);
    TexelCorners<F> lower, upper;
    if (t.mip == MipFilter::kNone || t.levels == 1) {
        lower = texel_corners(t, u, v, I(0), filter);
    } else {
        const LevelOfDetail<F> lod = level_of_detail(squared, t.levels);
        if (t.mip == MipFilter::kNearest) {
            lower = texel_corners(t, u, v, lod.nearest(), filter);
        } else {
            const I level = lod.floor();
            lower = texel_corners(t, u, v, level, filter);
            upper = texel_corners(t, u, v, level + I(1), filter);
            weight = lod.fraction();
        }
    }
    auto texel = lower.load(t.texels);
    if (any(weight != I(0))) texel = mix_texels(texel, upper.load(t.texels), weight);
    Vec4T<F> c;
    channels(texel, c.x, c.y, c.z, c.w);
    return c;
}

}  // namespace tessera
