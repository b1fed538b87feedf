// Exponentials, logarithms, powers and roots over a number type F. Maximum errors in units in the
// last place, measured by tests/simd/math_test.cpp, stand at each function as (float, double).
// The polynomials are minimax fits with machine-number coefficients (Sollya's fpminimax; N. Brisebarre
// and S. Chevillard, "Efficient polynomial L-infinity approximations", 2007).
// Results below the smallest normal number are rounded into the denormals, then to 0; results above the
// largest number are infinite. Every function here gives NaN for NaN, but for pow(NaN, 0) and pow(1, NaN).
// exp2, exp, log2, log and cbrt rise, but for single units in the last place.
#pragma once

#include "simd/math_core.h"

namespace tessera::math {

// 2^f for |f| <= 1/2.
template <class F>
TESSERA_INLINE F exp2_fraction(F f) {
    if constexpr (kSingle<F>) {
        return horner(f, 1.0f, 0x1.62e43p-1f, 0x1.ebfbd8p-3f, 0x1.c6af76p-5f, 0x1.3b30ap-7f, 0x1.5f0b82p-10f,
                      0x1.3fa206p-13f);
    } else {
        return horner(f, 1.0, 0x1.62e42fefa39efp-1, 0x1.ebfbdff82c5a6p-3, 0x1.c6b08d704a12cp-5, 0x1.3b2ab6fb9fda6p-7,
                      0x1.5d87fe789e96fp-10, 0x1.4309130f6cbdbp-13, 0x1.ffcbfc6685f06p-17, 0x1.62bfc6596be12p-20,
                      0x1.b52522bc15f8fp-24, 0x1.e61d43321746dp-28, 0x1.e973179a994acp-32);
    }
}

// 2^(high + low), |low| well below 1; `high` may be NaN, `low` must be finite.
template <class F>
TESSERA_INLINE F exp2_wide(F high, F low) {
    // min and max give the second operand for NaN, so that NaN passes.
    high = min(F(pick<F>(130.0f, 1026.0)), max(F(pick<F>(-152.0f, -1078.0)), high));
    const Nearest<F> n = nearest(high);
    return scale(exp2_fraction((high - n.whole) + low), n.integer);
}

// 2^x; exact for whole x. Error (1.1, 1.1).
template <class F>
TESSERA_INLINE F exp2(F x) {
    return exp2_wide(x, F(0.0f));
}

// e^x. Error (1.0, 1.0).
template <class F>
TESSERA_INLINE F exp(F x) {
    x = min(F(pick<F>(90.0f, 711.0)), max(F(pick<F>(-105.0f, -750.0)), x));
    const Nearest<F> n = nearest(x * F(pick<F>(0x1.715476p0f, 0x1.71547652b82fep0)));
    // ln 2 in two parts, the first so short that n times it is exact (Cody and Waite).
    const F r = (x - n.whole * F(pick<F>(0x1.62e4p-1f, 0x1.62e42ffp-1))) -
                n.whole * F(pick<F>(0x1.7f7d1cp-20f, -0x1.718432a1b0e26p-35));
    F p;
    if constexpr (kSingle<F>) {
        p = horner(r, 0x1.fffffcp-2f, 0x1.55549p-3f, 0x1.5558a2p-5f, 0x1.123adp-7f, 0x1.6a5e34p-10f);
    } else {
        p = horner(r, 0x1.000000000000ap-1, 0x1.55555555554fcp-3, 0x1.555555555067bp-5, 0x1.1111111127257p-7,
                   0x1.6c16c1848d831p-10, 0x1.a01a012dd5481p-13, 0x1.a01999128ca8fp-16, 0x1.71df1ce6681ccp-19,
                   0x1.28ae4e475fcb6p-22, 0x1.ad8dcc540e8c5p-26);
    }
    return scale(F(1.0f) + (r + r * r * p), n.integer);
}

// log(1 + f) = f - (h - tail) for sqrt(1/2) <= 1 + f < sqrt(2), with h = f^2/2 and s = f / (2 + f):
// the series of 2 artanh(s) = 2 s + s R(s^2), arranged so that f itself is not rounded.
template <class F>
struct LogParts {
    F f, h, tail;
};
template <class F>
TESSERA_INLINE LogParts<F> log_parts(F mantissa) {
    const F f = mantissa - F(1.0f), h = F(0.5f) * f * f;
    const F s = f / (F(2.0f) + f), z = s * s;
    F r;
    if constexpr (kSingle<F>) {
        r = z * horner(z, 0x1.555554p-1f, 0x1.999bd4p-2f, 0x1.23f1ap-2f, 0x1.ec1e42p-3f);
    } else {
        r = z * horner(z, 0x1.5555555555555p-1, 0x1.9999999999d0cp-2, 0x1.249249243a031p-2, 0x1.c71c724ac13e3p-3,
                       0x1.745ce1fcd8c4cp-3, 0x1.3b201bc748512p-3, 0x1.0f6803214d1bap-3, 0x1.0f0745ab2ac56p-3);
    }
    return {f, h, s * (h + r)};
}
// -infinity at 0, NaN below, infinity at infinity, NaN for NaN; `result` elsewhere.
template <class F>
TESSERA_INLINE F log_specials(F x, F result) {
    const F infinity(kInfinity<F>), zero(LaneOf<F>(0));
    result = select(x < infinity, result, x);
    result = select(x < zero, infinity - infinity, result);
    return select(x == zero, -infinity, result);
}

// The natural logarithm. Error (0.9, 0.9).
template <class F>
TESSERA_INLINE F log(F x) {
    const Fraction<F> parts = fraction(x);
    const LogParts<F> p = log_parts(parts.mantissa);
    const F e = parts.exponent;
    const F low = p.tail + e * F(pick<F>(0x1.7f7d1cp-20f, -0x1.718432a1b0e26p-35));
    return log_specials(x, e * F(pick<F>(0x1.62e4p-1f, 0x1.62e42ffp-1)) - ((p.h - low) - p.f));
}

// The logarithm to base 2; exact for powers of two. Error (0.9, 0.9).
template <class F>
TESSERA_INLINE F log2(F x) {
    const Fraction<F> parts = fraction(x);
    const LogParts<F> p = log_parts(parts.mantissa);
    // log(m) as a short number and a rest, times 1/ln 2 split in the same way.
    const F high = upper_half(p.f - p.h), low = ((p.f - high) - p.h) + p.tail;
    const F c_high(pick<F>(0x1.716p0f, 0x1.7154768p0)), c_low(pick<F>(-0x1.7135a8p-13f, -0x1.6a3e80f444178p-27));
    const DoubleWord<F> sum = fast_two_sum(parts.exponent, high * c_high);
    return log_specials(x, sum.high + (sum.low + ((low + high) * c_low + low * c_high)));
}

// log2(x) to about 2^-36 (2^-66) of itself, for positive finite x: 2/ln 2 artanh(s) with the first two
// terms of the series in double words.
template <class F>
TESSERA_INLINE DoubleWord<F> log2_wide(F x) {
    const Fraction<F> parts = fraction(x);
    const F f = parts.mantissa - F(1.0f);
    const DoubleWord<F> d = fast_two_sum(F(2.0f), f);
    const F s = f / d.high;
    const DoubleWord<F> back = two_product(s, d.high);
    const F s_low = (((f - back.high) - back.low) - s * d.low) / d.high;

    DoubleWord<F> z = two_product(s, s);
    z.low = z.low + F(2.0f) * s * s_low;
    F rest;
    if constexpr (kSingle<F>) {
        rest = horner(z.high, 0x1.27770ep-1f, 0x1.a5bbfep-2f, 0x1.59ed6ep-2f);
    } else {
        rest = horner(z.high, 0x1.2776c50ef9bfcp-1, 0x1.a61762a7aedd2p-2, 0x1.484b13d6adf25p-2, 0x1.0c9a853a63793p-2,
                      0x1.c68ee9b1684ffp-3, 0x1.8a09ab4b7b615p-3, 0x1.58fdca779d653p-3, 0x1.61e8b0092855bp-3);
    }
    DoubleWord<F> c1 = fast_two_sum(F(pick<F>(0x1.ec709ep-1f, 0x1.ec709dc3a03fdp-1)), z.high * rest);
    c1.low = c1.low + F(pick<F>(-0x1.e2fe02p-28f, 0x1.d27f05548af0cp-55));
    DoubleWord<F> t = two_product(z.high, c1.high);
    t.low = t.low + (z.high * c1.low + z.low * c1.high);
    DoubleWord<F> c0 = fast_two_sum(F(pick<F>(0x1.715476p1f, 0x1.71547652b82fep1)), t.high);
    c0.low = c0.low + (t.low + F(pick<F>(0x1.4ae0cp-25f, 0x1.777d0ffda0d24p-55)));
    DoubleWord<F> log2_m = two_product(s, c0.high);
    log2_m.low = log2_m.low + (s * c0.low + s_low * c0.high);

    const DoubleWord<F> sum = fast_two_sum(parts.exponent, log2_m.high);
    return fast_two_sum(sum.high, sum.low + log2_m.low);
}

// x^y with the special cases of IEEE 754 `pow`: pow(x, 0) = pow(1, y) = 1 even for NaN, a negative x
// needs a whole y, zeros and infinities keep the sign of odd powers. Error (1.25, 1.25).
template <class F>
TESSERA_INLINE F pow(F x, std::type_identity_t<F> y) {
    const F zero(LaneOf<F>(0)), one(LaneOf<F>(1)), infinity(kInfinity<F>);
    const F magnitude = abs(x);
    DoubleWord<F> log2_x = log2_wide(magnitude);
    const MaskOf<F> at_zero = magnitude == zero, at_infinity = magnitude == infinity;
    log2_x.high = select(at_zero, -infinity, select(at_infinity, infinity, log2_x.high));
    log2_x.low = select(at_zero | at_infinity, zero, log2_x.low);

    const DoubleWord<F> product = two_product(y, log2_x.high);
    const MaskOf<F> in_range = abs(product.high) < F(pick<F>(200.0f, 1200.0));
    F result = exp2_wide(product.high, select(in_range, product.low + y * log2_x.low, zero));

    const F half = y * F(0.5f);
    const MaskOf<F> whole = floor(y) == y, odd = whole & !(floor(half) == half);
    const UintOf<F> sign = as_uint(x) & as_uint(F(-0.0f));
    result = select(odd, as_float(as_uint(result) | sign), result);
    const MaskOf<F> undefined = (x < zero) & (x > -infinity) & !whole;
    result = select(undefined, infinity - infinity, result);
    result = select((x == x) & (y == y), result, x + y);
    const MaskOf<F> is_one = (x == one) | (y == zero) | ((magnitude == one) & (abs(y) == infinity));
    return select(is_one, one, result);
}

// 1 / sqrt(x), both operations rounded to nearest. Error (1.5, 1.5).
template <class F>
TESSERA_INLINE F rsqrt(F x) {
    return F(1.0f) / sqrt(x);
}

// The cube root, of negative numbers too: Halley's iteration from a guess by the exponent, then one
// Newton step whose residual is computed in double words. Error (0.55, 0.55).
template <class F>
TESSERA_INLINE F cbrt(F x) {
    using L = LaneOf<F>;
    const F magnitude = abs(x);
    // Away from the denormals, so that the parts of products below are exact, and from overflow.
    const F low_end(pick<F>(0x1p-60f, 0x1p-900)), high_end(0x1p100f);
    const MaskOf<F> tiny = magnitude < low_end;
    const MaskOf<F> huge = magnitude > high_end;
    const F scale_in = select(tiny, F(pick<F>(0x1p72f, 0x1p216)), select(huge, F(pick<F>(0x1p-24f, 0x1p-54)), F(1.0f)));
    const F scale_out = select(tiny, F(pick<F>(0x1p-24f, 0x1p-72)), select(huge, F(pick<F>(0x1p8f, 0x1p18)), F(1.0f)));
    const F a = magnitude * scale_in;
    // Dividing the bits of a number by 3 divides its exponent by 3, up to 2/3 of the bias.
    constexpr int kBias = kExponentBias<F>;
    const IntOf<F> offset(IntOf<L>(pick<F>(2.0f / 3, 2.0 / 3) * L(kBias) * L(IntOf<L>{1} << kMantissaBits<F>)));
    F t = as_float(to_int(to_float(as_int(a)) * F(pick<F>(0x1.555556p-2f, 0x1.5555555555555p-2))) + offset);
    for (int i = 0; i < (kSingle<F> ? 2 : 3); ++i) {
        const F cube = t * t * t;
        t = t * ((cube + (a + a)) / ((cube + cube) + a));
    }
    const DoubleWord<F> square = two_product(t, t);
    const DoubleWord<F> cube = two_product(square.high, t);
    const F residual = ((a - cube.high) - cube.low) - square.low * t;
    t = t + residual / (F(3.0f) * square.high);
    const F result = copysign(t * scale_out, x);
    return select((magnitude > F(0.0f)) & (magnitude < F(kInfinity<F>)), result, x);
}

}  // namespace tessera::math
