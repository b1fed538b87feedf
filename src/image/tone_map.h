// Tone maps: from exposed linear Rec. 709 radiance (0 up, unbounded) to display-linear 0 .. 1, which
// the sRGB encoding then takes. Templates over the number type, three channels in place. Negative
// and NaN channels count as 0, infinite ones as very large; results are always within 0 .. 1.
#pragma once

#include "simd/vec.h"

namespace tessera {

// Large enough to be white in every map, small enough that its square is finite.
inline constexpr float kBrightest = 0x1p40f;

// No map: what is above 1 is cut off, channel by channel.
template <class F>
TESSERA_INLINE void tone_map_none(F& r, F& g, F& b) {
    r = clamp(r, F(0.0f), F(1.0f));
    g = clamp(g, F(0.0f), F(1.0f));
    b = clamp(b, F(0.0f), F(1.0f));
}

// "Khronos PBR Neutral Tone Mapper" (Khronos Group, 3D Commerce, 2024, section "Specification"):
// colours whose largest channel is at most 0.8 keep their base colour (less the 4 % that a dielectric
// reflects); brighter ones are compressed towards white with their hue kept.
template <class F>
TESSERA_INLINE void tone_map_neutral(F& r, F& g, F& b) {
    constexpr float kStart = 0.8f - 0.04f, kRoom = 1 - kStart, kDesaturation = 0.15f;
    const F low(0.0f), high(kBrightest), one(1.0f);
    r = clamp(r, low, high);
    g = clamp(g, low, high);
    b = clamp(b, low, high);

    const F least = min(r, min(g, b));
    const F offset = select(least < F(0.08f), least - F(6.25f) * least * least, F(0.04f));
    r = r - offset;
    g = g - offset;
    b = b - offset;

    const F peak = max(r, max(g, b));
    // A peak below the start divides by itself or more: no lane divides by zero.
    const F bright = max(peak, F(kStart));
    const F new_peak = one - F(kRoom * kRoom) / (bright + F(kRoom - kStart));
    const F scale = new_peak / bright;
    const F white = one - one / (F(kDesaturation) * (bright - new_peak) + one);
    const F colored = scale * (one - white), whitened = new_peak * white;
    const auto keep = peak < F(kStart);
    r = select(keep, r, min(r * colored + whitened, one));
    g = select(keep, g, min(g * colored + whitened, one));
    b = select(keep, b, min(b * colored + whitened, one));
}

// The rational curve of tone_map_aces().
template <class F>
TESSERA_INLINE F hill_curve(F v) {
    return (v * (v + F(0.0245786f)) - F(0.000090537f)) / (v * (F(0.983729f) * v + F(0.4329510f)) + F(0.238081f));
}

// Like ACES: the fit of the reference rendering and sRGB output transforms by Stephen Hill ("BakingLab",
// MJP and Hill, 2016): to the transforms' space, a rational curve per channel, and back. Filmic
// contrast; bright saturated colours shift in hue.
template <class F>
TESSERA_INLINE void tone_map_aces(F& r, F& g, F& b) {
    const F low(0.0f), high(kBrightest), one(1.0f);
    r = clamp(r, low, high);
    g = clamp(g, low, high);
    b = clamp(b, low, high);
    const F x = hill_curve(F(0.59719f) * r + F(0.35458f) * g + F(0.04823f) * b);
    const F y = hill_curve(F(0.07600f) * r + F(0.90834f) * g + F(0.01566f) * b);
    const F z = hill_curve(F(0.02840f) * r + F(0.13383f) * g + F(0.83777f) * b);
    r = clamp(F(1.60475f) * x - F(0.53108f) * y - F(0.07367f) * z, low, one);
    g = clamp(F(-0.10208f) * x + F(1.10813f) * y - F(0.00605f) * z, low, one);
    b = clamp(F(-0.00327f) * x - F(0.07276f) * y + F(1.07602f) * z, low, one);
}

}  // namespace tessera
