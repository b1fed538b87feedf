// The pieces that math_exp.h and math_trig.h share: constants by lane type, polynomials, scaling by
// powers of two, and double-word numbers (the unevaluated sum of two, T. J. Dekker, "A floating-point
// technique for extending the available precision", 1971). Only exact operations of vec.h are used,
// and no fused ones, so every result has the same bits on every machine.
#pragma once

#include "simd/vec.h"

namespace tessera::math {

template <class F>
inline constexpr bool kSingle = sizeof(LaneOf<F>) == 4;
template <class F>
inline constexpr int kMantissaBits = kSingle<F> ? 23 : 52;
template <class F>
inline constexpr int kExponentBias = kSingle<F> ? 127 : 1023;
template <class F>
inline constexpr LaneOf<F> kInfinity = static_cast<LaneOf<F>>(__builtin_inf());
template <class F>
inline constexpr LaneOf<F> kSmallestNormal = static_cast<LaneOf<F>>(kSingle<F> ? 0x1p-126 : 0x1p-1022);

// A constant given for each lane type.
template <class F>
TESSERA_INLINE constexpr LaneOf<F> pick(float single, double twice) {
    if constexpr (kSingle<F>) {
        return single;
    } else {
        return twice;
    }
}

template <class F>
TESSERA_INLINE F horner(F, LaneOf<F> last) {
    return F(last);
}
// c0 + c1 x + c2 x^2 + ..., from the highest power down.
template <class F, class... C>
TESSERA_INLINE F horner(F x, LaneOf<F> c0, C... rest) {
    return horner(x, rest...) * x + F(c0);
}

// --- integers and powers of two -------------------------------------------------------------

template <class F>
struct Nearest {
    F whole;           // x rounded to the nearest integer
    IntOf<F> integer;  // the same
};
// For |x| < 2^21; other numbers and NaN give some integer without trapping.
template <class F>
TESSERA_INLINE Nearest<F> nearest(F x) {
    const F magic(pick<F>(0x1.8p23f, 0x1.8p52));
    const F shifted = x + magic;
    return {shifted - magic, as_int(as_uint(shifted) - as_uint(magic))};
}

template <class F>
TESSERA_INLINE F power_of_two(UintOf<F> exponent) {
    return as_float(shift_left(exponent + UintOf<F>(kExponentBias<F>), kMantissaBits<F>));
}
// x * 2^n, rounded once, for x in [0.5, 2] and n from twice the lowest to twice the highest exponent.
template <class F>
TESSERA_INLINE F scale(F x, IntOf<F> n) {
    const UintOf<F> half = as_uint(shift_right_arithmetic(n, 1));
    return x * power_of_two<F>(half) * power_of_two<F>(as_uint(n) - half);
}

template <class F>
struct Fraction {
    F mantissa;  // sqrt(1/2) <= m < sqrt(2)
    F exponent;  // x = m * 2^e
};
// For positive finite x; others give finite nonsense.
template <class F>
TESSERA_INLINE Fraction<F> fraction(F x) {
    const MaskOf<F> tiny = x < F(kSmallestNormal<F>);
    x = select(tiny, x * F(pick<F>(0x1p24f, 0x1p54)), x);
    const UintOf<F> base = as_uint(F(pick<F>(0x1.6a09e6p-1f, 0x1.6a09e667f3bcdp-1)));
    const UintOf<F> offset = as_uint(x) - base;
    const F exponent = to_float(shift_right_arithmetic(as_int(offset), kMantissaBits<F>));
    const UintOf<F> mantissa_mask((UintOf<LaneOf<F>>{1} << kMantissaBits<F>)-1);
    return {as_float((offset & mantissa_mask) + base), exponent - select(tiny, F(pick<F>(24.0f, 54.0)), F(0.0f))};
}

// --- double words ---------------------------------------------------------------------------

template <class F>
struct DoubleWord {
    F high, low;
};

// a + b exactly, when |a| >= |b| or a is 0.
template <class F>
TESSERA_INLINE DoubleWord<F> fast_two_sum(F a, F b) {
    const F sum = a + b;
    return {sum, b - (sum - a)};
}
// a + b exactly (D. E. Knuth, The Art of Computer Programming 2, 4.2.2).
template <class F>
TESSERA_INLINE DoubleWord<F> two_sum(F a, F b) {
    const F sum = a + b, b_part = sum - a;
    return {sum, (a - (sum - b_part)) + (b - b_part)};
}
// The upper half of the mantissa of a; the rest has at most as many bits (one more for double).
template <class F>
TESSERA_INLINE F upper_half(F a) {
    constexpr auto kLow = (UintOf<LaneOf<F>>{1} << (kSingle<F> ? 12 : 27)) - 1;
    return as_float(as_uint(a) & UintOf<F>(~kLow));
}
// a * b, exactly for float and to about 2^-105 for double, unless a part underflows or overflows.
template <class F>
TESSERA_INLINE DoubleWord<F> two_product(F a, F b) {
    const F product = a * b;
    const F a1 = upper_half(a), a2 = a - a1, b1 = upper_half(b), b2 = b - b1;
    return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

}  // namespace tessera::math
