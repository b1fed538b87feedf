// Trigonometric functions and their inverses over a number type F, in radians. Maximum errors in
// units in the last place, measured by tests/simd/math_test.cpp, stand at each function as (float,
// double). sin, cos and tan reduce every finite argument exactly enough for these errors: up to 2^16
// (double: 2^20) quarter turns in the number type, beyond by math_reduce.h lane by lane, slowly.
#pragma once

#include "simd/math_core.h"
#include "simd/math_reduce.h"

namespace tessera::math {

template <class F>
inline constexpr LaneOf<F> kPi = static_cast<LaneOf<F>>(0x1.921fb54442d18p1);

template <class F>
TESSERA_INLINE F radians(F degrees) {
    return degrees * F(pick<F>(0x1.1df46ap-6f, 0x1.1df46a2529d39p-6));
}
template <class F>
TESSERA_INLINE F degrees(F radians) {
    return radians * F(pick<F>(0x1.ca5dc2p5f, 0x1.ca5dc1a63c1f8p5));
}

// --- argument reduction ---------------------------------------------------------------------

// x = quadrant * pi/2 + r, |r| <= pi/4 or a little more; the quadrant counts modulo 4.
template <class F>
struct Reduced {
    DoubleWord<F> r;
    UintOf<F> quadrant;
};

// The arguments beyond the range of reduce() below, one at a time.
template <class F>
TESSERA_INLINE void reduce_large(F x, MaskOf<F> large, Reduced<F>& reduced) {
    LaneOf<F> xs[kLanes<F>], high[kLanes<F>], low[kLanes<F>];
    LaneOf<UintOf<F>> quadrant[kLanes<F>];
    store(xs, x);
    store(high, reduced.r.high);
    store(low, reduced.r.low);
    store(quadrant, reduced.quadrant);
    const std::uint32_t lanes = mask_bits(large);
    for (int i = 0; i < kLanes<F>; ++i) {
        if (((lanes >> i) & 1) == 0) continue;
        const ReducedAngle angle = reduce_angle(static_cast<double>(xs[i]));
        high[i] = static_cast<LaneOf<F>>(angle.high);
        low[i] = static_cast<LaneOf<F>>((angle.high - static_cast<double>(high[i])) + angle.low);
        quadrant[i] = static_cast<LaneOf<UintOf<F>>>(angle.quadrant);
    }
    reduced = {{load<F>(high), load<F>(low)}, load<UintOf<F>>(quadrant)};
}

// After Cody and Waite: pi/2 in parts that are so short (9 bits in float, 33 in double) that the
// product with the quadrant is exact; what the differences lose is kept in a second word.
template <class F>
TESSERA_INLINE Reduced<F> reduce(F x) {
    const F limit(pick<F>(0x1.921fb4p16f, 0x1.921fb4p20));
    const Nearest<F> n = nearest(x * F(pick<F>(0x1.45f306p-1f, 0x1.45f306dc9c883p-1)));
    const F k = n.whole;
    DoubleWord<F> r;
    if constexpr (kSingle<F>) {
        const F exact = ((x - k * F(0x1.92p0f)) - k * F(0x1p-11f)) - k * F(-0x1.28p-18f);
        r = two_sum(exact, k * F(0x1.78p-25f));
        const DoubleWord<F> r1 = two_sum(r.high, k * F(-0x1.08p-34f));
        const DoubleWord<F> r2 = two_sum(r1.high, k * F(-0x1.a4p-41f));
        r = {r2.high, ((r.low + r1.low) + r2.low) + k * F(0x1.ee59dap-50f)};
    } else {
        r = two_sum(x - k * F(0x1.921fb544p0), k * F(-0x1.0b4611a6p-34));
        const DoubleWord<F> r1 = two_sum(r.high, k * F(-0x1.3198a2ep-69));
        r = {r1.high, (r.low + r1.low) - k * F(0x1.b839a252049c1p-104)};
    }
    Reduced<F> reduced{fast_two_sum(r.high, r.low), as_uint(n.integer)};
    const MaskOf<F> large = abs(x) > limit;
    if (any(large)) [[unlikely]]
        reduce_large(x, large, reduced);
    return reduced;
}

// --- sine, cosine, tangent ------------------------------------------------------------------

template <class T>
struct SinCos {
    T sin, cos;
};

// Sine and cosine of the reduced angle h + l itself, with what rounding them to F loses. l only shifts
// the result by its derivative.
template <class F>
TESSERA_INLINE SinCos<DoubleWord<F>> sincos_kernel(DoubleWord<F> r) {
    const F h = r.high, l = r.low, z = h * h;
    F s, c;
    if constexpr (kSingle<F>) {
        s = horner(z, -0x1.555546p-3f, 0x1.110778p-7f, -0x1.9953fep-13f);
        c = horner(z, 0x1.55554ap-5f, -0x1.6c0c2ap-10f, 0x1.99e91p-16f);
    } else {
        s = horner(z, -0x1.5555555555548p-3, 0x1.111111110f75dp-7, -0x1.a01a019bf222ep-13, 0x1.71de355f05599p-19,
                   -0x1.ae5e5471f55p-26, 0x1.5d8e3511cda67p-33);
        c = horner(z, 0x1.555555555554bp-5, -0x1.6c16c16c15016p-10, 0x1.a01a019c8f3eep-16, -0x1.27e4f7f19d4b2p-22,
                   0x1.1ee9dbd0d86a6p-29, -0x1.8fa681e385241p-37);
    }
    const F half_z = F(0.5f) * z, one(1.0f), w = one - half_z;
    return {fast_two_sum(h, h * z * s + (l - half_z * l)), fast_two_sum(w, ((one - w) - half_z) + (z * z * c - h * l))};
}

template <class F>
TESSERA_INLINE F flip_sign(F x, UintOf<F> bit_1) {
    return as_float(as_uint(x) ^ shift_left(bit_1 & UintOf<F>(2u), 8 * int(sizeof(LaneOf<F>)) - 2));
}

// Both at once. sin(-0) is -0; NaN for infinities. Error of both (0.85, 0.85).
template <class F>
TESSERA_INLINE SinCos<F> sincos(F x) {
    const Reduced<F> reduced = reduce(x);
    const SinCos<DoubleWord<F>> kernel = sincos_kernel(reduced.r);
    const UintOf<F> q = reduced.quadrant;
    const MaskOf<F> swap = (q & UintOf<F>(1u)) != UintOf<F>(0u);
    const F s = flip_sign(select(swap, kernel.cos.high, kernel.sin.high), q);
    const F c = flip_sign(select(swap, kernel.sin.high, kernel.cos.high), q + UintOf<F>(1u));
    return {select(abs(x) < F(pick<F>(0x1p-13f, 0x1p-27)), x, s), c};
}
template <class F>
TESSERA_INLINE F sin(F x) {
    return sincos(x).sin;
}
template <class F>
TESSERA_INLINE F cos(F x) {
    return sincos(x).cos;
}
// Error (1.1, 1.1).
template <class F>
TESSERA_INLINE F tan(F x) {
    const Reduced<F> reduced = reduce(x);
    const SinCos<DoubleWord<F>> kernel = sincos_kernel(reduced.r);
    const MaskOf<F> odd = (reduced.quadrant & UintOf<F>(1u)) != UintOf<F>(0u);
    // sin / cos, or -cos / sin, corrected by what the quotient of the high words leaves.
    const F a = select(odd, -kernel.cos.high, kernel.sin.high), b = select(odd, kernel.sin.high, kernel.cos.high);
    const F a_low = select(odd, -kernel.cos.low, kernel.sin.low), b_low = select(odd, kernel.sin.low, kernel.cos.low);
    const F quotient = a / b;
    const DoubleWord<F> back = two_product(quotient, b);
    const F t = quotient + ((((a - back.high) - back.low) + a_low) - quotient * b_low) / b;
    return select(abs(x) < F(pick<F>(0x1p-13f, 0x1p-27)), x, t);
}

// --- inverse functions ----------------------------------------------------------------------

// The angle of the point (x, y), x and y >= 0 and not NaN, or of (-x, y) where `mirror`: a ratio of at
// most tan(pi/8) gives the distance from the nearest multiple of pi/4.
template <class F>
TESSERA_INLINE F first_quadrant_angle(F y, F x, MaskOf<F> mirror) {
    const F a = min(x, y), b = max(x, y);
    const MaskOf<F> steep = y > x, middle = a > b * F(pick<F>(0x1.a8279ap-2f, 0x1.a827999fcef32p-2));
    const F t = select(middle, a - b, a) / select(middle, a + b, b);
    const F z = t * t;
    F p;
    if constexpr (kSingle<F>) {
        p = horner(z, -0x1.55554ap-2f, 0x1.9991e4p-3f, -0x1.23b9dp-3f, 0x1.b226f2p-4f, -0x1.f2f1b6p-5f);
    } else {
        p = horner(z, -0x1.5555555555554p-2, 0x1.99999999995bep-3, -0x1.24924924720fep-3, 0x1.c71c71b5f20a3p-4,
                   -0x1.745d14907df9ep-4, 0x1.3b136b01edb28p-4, -0x1.110c494894a3p-4, 0x1.e16f24c99bc62p-5,
                   -0x1.ab6cc8065162ap-5, 0x1.70aee49c1d36bp-5, -0x1.11b1742cdd64cp-5, 0x1.efed15962cc89p-7);
    }
    // The multiple of pi/4, in two parts of which the first is short enough to be exact four times.
    F eighths = select(middle, F(1.0f), F(0.0f));
    eighths = select(steep, F(2.0f) - eighths, eighths);
    eighths = select(mirror, F(4.0f) - eighths, eighths);
    const UintOf<F> sign =
        select(steep, as_uint(F(-0.0f)), UintOf<F>(0u)) ^ select(mirror, as_uint(F(-0.0f)), UintOf<F>(0u));
    const F signed_t = as_float(as_uint(t) ^ sign), signed_rest = as_float(as_uint(t * z * p) ^ sign);
    const F high = eighths * F(pick<F>(0x1.921fbp-1f, 0x1.921fb54442d18p-1));
    const F low = eighths * F(pick<F>(0x1.5110b4p-23f, 0x1.1a62633145c07p-55));
    return high + (signed_t + (signed_rest + low));
}

// Error (1.9, 1.9).
template <class F>
TESSERA_INLINE F atan(F x) {
    const F angle = first_quadrant_angle(abs(x), F(1.0f), F(1.0f) < F(0.0f));
    return select(x == x, copysign(angle, x), x);
}

// The angle of the point (x, y), -pi .. pi, with the special cases of IEEE 754 `atan2`. Error (1.9, 1.9).
template <class F>
TESSERA_INLINE F atan2(F y, std::type_identity_t<F> x) {
    const F zero(0.0f), one(1.0f), infinity(kInfinity<F>);
    F a = abs(y), b = abs(x);
    // Infinite coordinates count as 1 against 0; large ones are halved twice so that x + y is finite.
    const MaskOf<F> infinite = (a == infinity) | (b == infinity);
    const F a_infinite = select(a == infinity, one, zero), b_infinite = select(b == infinity, one, zero);
    const F factor = select(max(a, b) > F(pick<F>(0x1p125f, 0x1p1021)), F(0.25f), one);
    a = select(infinite, a_infinite, a * factor);
    b = select(infinite, b_infinite, b * factor);
    b = select((a == zero) & (b == zero), one, b);
    const F angle = copysign(first_quadrant_angle(a, b, copysign(one, x) < zero), y);
    return select((x == x) & (y == y), angle, x + y);
}

// asin(s) = s + s z P(z) for z = s^2 <= 1/4.
template <class F>
TESSERA_INLINE F asin_rest(F s, F z) {
    F p;
    if constexpr (kSingle<F>) {
        p = horner(z, 0x1.55554cp-3f, 0x1.33389ep-4f, 0x1.6caab6p-5f, 0x1.04af34p-5f, 0x1.d7924cp-7f, 0x1.33d432p-5f);
    } else {
        p = horner(z, 0x1.5555555555577p-3, 0x1.333333332e133p-4, 0x1.6db6db721247bp-5, 0x1.f1c71a95002f6p-6,
                   0x1.6e8bdedebfb72p-6, 0x1.1c49f077d2818p-6, 0x1.ca1f8af264013p-7, 0x1.75859da822552p-7,
                   0x1.613c1e9096db8p-7, 0x1.e5fbe63872ca6p-9, 0x1.639a8a1bbdd02p-6, -0x1.57fad21f83513p-6,
                   0x1.0b45ea63b1699p-5);
    }
    return s * (z * p);
}

// NaN outside -1 .. 1, as acos. Beyond 1/2: asin(x) = pi/2 - 2 asin(sqrt((1 - x) / 2)). Error (1.65, 1.65).
template <class F>
TESSERA_INLINE F asin(F x) {
    const F a = abs(x), half(0.5f);
    const MaskOf<F> steep = a > half;
    const F z = select(steep, (F(1.0f) - a) * half, a * a), s = select(steep, sqrt(z), a);
    const F rest = asin_rest(s, z);
    const F beyond = F(pick<F>(0x1.921fb6p0f, 0x1.921fb54442d18p0)) -
                     F(2.0f) * (s + (rest + F(pick<F>(0x1.777a5cp-26f, -0x1.1a62633145c07p-55))));
    return copysign(select(steep, beyond, s + rest), x);
}
// Error (1.15, 1.15).
template <class F>
TESSERA_INLINE F acos(F x) {
    const F a = abs(x), half(0.5f);
    const F half_pi(pick<F>(0x1.921fb6p0f, 0x1.921fb54442d18p0));
    const F half_pi_low(pick<F>(-0x1.777a5cp-25f, 0x1.1a62633145c07p-54));
    const MaskOf<F> steep = a > half;
    const F z = select(steep, (F(1.0f) - a) * half, a * a), s = select(steep, sqrt(z), x);
    const F rest = asin_rest(s, z);
    const F near_one = F(2.0f) * (s + rest), near_minus_one = F(2.0f) * (half_pi - (s + (rest - half_pi_low)));
    const F inside = half_pi - (s + (rest - half_pi_low));
    return select(steep, select(x > F(0.0f), near_one, near_minus_one), inside);
}

}  // namespace tessera::math
