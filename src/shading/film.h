// The film: from a pixel's linear radiance to display values. Exposure, tone map, background, encoding.
#pragma once

#include <tessera/shading_model.h>

#include "image/srgb.h"
#include "image/tone_map.h"
#include "shading/vectors.h"

#include <cstdint>

namespace tessera {

struct FilmView {
    float exposure;  // factor on radiance
    ToneMap tone_map;
    float background[4];  // display-linear RGB, alpha; alpha 0: transparent
    Encoding encoding = Encoding::kSrgb;
};

// 8 bits per channel with straight alpha, one channel per number.
template <class F>
struct DisplayPixel {
    IntOf<F> r, g, b, a;
};

// The 8-bit code nearest to a value of 0 .. 1.
template <class F>
TESSERA_INLINE IntOf<F> linear8_from_linear(F x) {
    return truncate_int(x * F(255.0f) + F(0.5f));
}

// `premultiplied` is radiance times coverage, the mean over the samples of a pixel; `coverage` the
// mean of their alpha. Tone-mapped before it is laid over the background, so that edges against a
// bright surface stay smooth and the background keeps its exact colour.
template <class F>
TESSERA_INLINE DisplayPixel<F> develop(const FilmView& film, const Vec3T<F>& premultiplied, F coverage) {
    const F zero(0.0f), one(1.0f);
    const F a = saturate(coverage);
    // Where every pixel is wholly covered, what follows but the tone map changes nothing.
    const bool whole = all(a == one);
    const auto covered = a > zero;
    F scale(film.exposure);
    if (!whole) scale = select(covered, scale / select(covered, a, one), zero);
    F r = premultiplied.x * scale, g = premultiplied.y * scale, b = premultiplied.z * scale;
    switch (film.tone_map) {
        case ToneMap::kNone:
            tone_map_none(r, g, b);
            break;
        case ToneMap::kNeutral:
            tone_map_neutral(r, g, b);
            break;
        case ToneMap::kAces:
            tone_map_aces(r, g, b);
            break;
    }
    F alpha = one;
    if (!whole) {
        const F behind = F(film.background[3]) * (one - a);
        alpha = a + behind;
        const F inverse = one / select(alpha > zero, alpha, one);
        r = (r * a + F(film.background[0]) * behind) * inverse;
        g = (g * a + F(film.background[1]) * behind) * inverse;
        b = (b * a + F(film.background[2]) * behind) * inverse;
        r = saturate(r), g = saturate(g), b = saturate(b);
    }
    const IntOf<F> a8 = linear8_from_linear(alpha);
    if (film.encoding == Encoding::kLinear)
        return {linear8_from_linear(r), linear8_from_linear(g), linear8_from_linear(b), a8};
    return {srgb8_from_linear(r), srgb8_from_linear(g), srgb8_from_linear(b), a8};
}

}  // namespace tessera
