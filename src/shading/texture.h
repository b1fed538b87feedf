// Texture lookup over the number type: wrap modes, nearest, bilinear and trilinear filters. Texels
// are RGBA8, four bytes a texel, mip levels one after the other; sRGB texels are decoded to linear
// light before they are weighted. Coordinates: u to the right, v down, (0, 0) the top left corner.
#pragma once

#include <tessera/shading_model.h>

#include "shading/vectors.h"
#include "simd/math.h"

#include <cstdint>

namespace tessera {

inline constexpr int kMaxMipLevels = 15;  // 16384 and down to 1

// A texture ready to sample: plain data; the texels belong to somebody else.
struct TextureView {
    const std::uint32_t* texels = nullptr;
    std::int32_t offset[kMaxMipLevels] = {};  // of each level in texels
    std::int32_t width[kMaxMipLevels] = {};
    std::int32_t height[kMaxMipLevels] = {};
    std::int32_t levels = 0;
    bool srgb = false;
    bool mag_linear = true, min_linear = true;
    MipFilter mip = MipFilter::kLinear;
    Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
};

// The sRGB decoding curve for 8-bit texels as a polynomial (no table, so vectors need no gathers):
// exact at 1 and below 0.04045, else a minimax polynomial in c - 1 of degree 6 (Sollya, fpminimax),
// absolute error below 6.1e-6, a fiftieth of the distance between neighbouring codes where they are
// closest.
template <class F>
TESSERA_INLINE F texel_to_linear(F c) {
    const F d = c - F(1.0f);
    F p = F(-5.348674952983856201171875e-2f);
    p = p * d + F(-9.7075544297695159912109375e-2f);
    p = p * d + F(-0.115236751735210418701171875f);
    p = p * d + F(0.15634374320507049560546875f);
    p = p * d + F(1.50344860553741455078125f);
    p = p * d + F(2.2745449542999267578125f);
    return select(c <= F(0.04045f), c * F(1.0f / 12.92f), p * d + F(1.0f));
}

// Brings a coordinate into [0, 1]. What is not finite becomes 0.
template <class F>
TESSERA_INLINE F wrap_coordinate(F t, Wrap mode) {
    t = select(abs(t) < F(1e9f), t, F(0.0f));
    if (mode == Wrap::kRepeat) return t - floor(t);
    if (mode == Wrap::kMirror) {
        const F twice = t - F(2.0f) * floor(t * F(0.5f));
        return select(twice > F(1.0f), F(2.0f) - twice, twice);
    }
    return saturate(t);
}

// Texel index next to the border, -1 .. size, brought into 0 .. size - 1.
template <class I>
TESSERA_INLINE I wrap_index(I i, I size, Wrap mode) {
    const I last = size - I(1);
    if (mode == Wrap::kRepeat) return select(i < I(0), last, select(i > last, I(0), i));
    return min(max(i, I(0)), last);
}

template <class F>
TESSERA_INLINE Vec4T<F> fetch_texel(const TextureView& t, IntOf<F> index) {
    const auto rgba = gather(t.texels, index);
    using U = UintOf<F>;
    const F scale(1.0f / 255.0f);
    Vec4T<F> c{to_float(as_int(rgba & U(255u))) * scale, to_float(as_int((rgba >> 8) & U(255u))) * scale,
               to_float(as_int((rgba >> 16) & U(255u))) * scale, to_float(as_int(rgba >> 24)) * scale};
    if (t.srgb) {
        c.x = texel_to_linear(c.x);
        c.y = texel_to_linear(c.y);
        c.z = texel_to_linear(c.z);
    }
    return c;
}

// Entry `level` of a table by level, which most often is one for all lanes.
template <class F>
TESSERA_INLINE IntOf<F> of_level(const std::int32_t* table, IntOf<F> level, std::int32_t first, bool same) {
    return same ? IntOf<F>(table[first]) : gather(table, level);
}

// One level; u and v already within [0, 1].
template <class F>
TESSERA_INLINE Vec4T<F> sample_level(const TextureView& t, F u, F v, IntOf<F> level, bool linear) {
    using I = IntOf<F>;
    const std::int32_t first = lane(level, 0);
    const bool same = all(level == I(first));
    const I width = of_level<F>(t.width, level, first, same), height = of_level<F>(t.height, level, first, same),
            offset = of_level<F>(t.offset, level, first, same);
    const F x = u * to_float(width), y = v * to_float(height);
    if (!linear) {
        const I xi = wrap_index(truncate_int(floor(x)), width, Wrap::kClamp);
        const I yi = wrap_index(truncate_int(floor(y)), height, Wrap::kClamp);
        return fetch_texel<F>(t, offset + yi * width + xi);
    }
    const F x0 = floor(x - F(0.5f)), y0 = floor(y - F(0.5f));
    const F fx = x - F(0.5f) - x0, fy = y - F(0.5f) - y0;
    const I left = truncate_int(x0), top = truncate_int(y0);
    const I xl = wrap_index(left, width, t.wrap_s), xr = wrap_index(left + I(1), width, t.wrap_s);
    const I row0 = offset + wrap_index(top, height, t.wrap_t) * width;
    const I row1 = offset + wrap_index(top + I(1), height, t.wrap_t) * width;
    const Vec4T<F> a = fetch_texel<F>(t, row0 + xl), b = fetch_texel<F>(t, row0 + xr);
    const Vec4T<F> c = fetch_texel<F>(t, row1 + xl), d = fetch_texel<F>(t, row1 + xr);
    return {mix1(mix1(a.x, b.x, fx), mix1(c.x, d.x, fx), fy), mix1(mix1(a.y, b.y, fx), mix1(c.y, d.y, fx), fy),
            mix1(mix1(a.z, b.z, fx), mix1(c.z, d.z, fx), fy), mix1(mix1(a.w, b.w, fx), mix1(c.w, d.w, fx), fy)};
}

// The footprint of a pixel in uv: change of (u, v) per step right and down.
template <class F>
struct Footprint {
    F ux, vx, uy, vy;
};

// The level of detail: log2 of the footprint's longer side in texels of level 0 (Williams 1983;
// the larger of the two axes as in the OpenGL 4.6 specification, section 8.14.1).
template <class F>
TESSERA_INLINE F level_of_detail(const TextureView& t, const Footprint<F>& d) {
    const F w(static_cast<float>(t.width[0])), h(static_cast<float>(t.height[0]));
    const F xx = d.ux * w, xy = d.vx * h, yx = d.uy * w, yy = d.vy * h;
    const F squared = max(xx * xx + xy * xy, yx * yx + yy * yy);
    return F(0.5f) * math::log2(min(max(squared, F(1e-20f)), F(1e20f)));
}

template <class F>
TESSERA_INLINE Vec4T<F> sample_texture(const TextureView& t, F u, F v, const Footprint<F>& d) {
    using I = IntOf<F>;
    u = wrap_coordinate(u, t.wrap_s);
    v = wrap_coordinate(v, t.wrap_t);
    const F lod = level_of_detail(t, d);
    const auto magnified = lod <= F(0.0f);
    if (t.mip == MipFilter::kNone || t.levels == 1) {
        if (t.mag_linear == t.min_linear) return sample_level(t, u, v, I(0), t.mag_linear);
        const Vec4T<F> a = sample_level(t, u, v, I(0), true), b = sample_level(t, u, v, I(0), false);
        const auto linear = t.mag_linear ? magnified : !magnified;
        return {select(linear, a.x, b.x), select(linear, a.y, b.y), select(linear, a.z, b.z), select(linear, a.w, b.w)};
    }
    const F clamped = min(max(lod, F(0.0f)), F(static_cast<float>(t.levels - 1)));
    Vec4T<F> c;
    if (t.mip == MipFilter::kNearest) {
        c = sample_level(t, u, v, truncate_int(floor(clamped + F(0.5f))), t.min_linear);
    } else {
        const F lower = floor(clamped);
        const I level = truncate_int(lower);
        const I next = min(level + I(1), I(t.levels - 1));
        const Vec4T<F> a = sample_level(t, u, v, level, t.min_linear), b = sample_level(t, u, v, next, t.min_linear);
        const F f = clamped - lower;
        c = {mix1(a.x, b.x, f), mix1(a.y, b.y, f), mix1(a.z, b.z, f), mix1(a.w, b.w, f)};
    }
    if (t.mag_linear != t.min_linear) {
        const Vec4T<F> m = sample_level(t, u, v, I(0), t.mag_linear);
        c = {select(magnified, m.x, c.x), select(magnified, m.y, c.y), select(magnified, m.z, c.z),
             select(magnified, m.w, c.w)};
    }
    return c;
}

}  // namespace tessera
