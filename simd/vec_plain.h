// The one-lane back end of vec.h: the lane types are float, double, int32_t, uint32_t, int64_t,
// uint64_t and bool themselves, and this file adds the functions that the operators do not cover.
// It is also the definition of what every function means; the vectors are tested against it.
#pragma once

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace tessera {

template <class FloatT, class IntT, class UintT>
struct PlainTraits {
    using Float = FloatT;
    using Int = IntT;
    using Uint = UintT;
    using Mask = bool;
    static constexpr int kLanes = 1;
};
struct Plain32 : PlainTraits<float, std::int32_t, std::uint32_t> {};
struct Plain64 : PlainTraits<double, std::int64_t, std::uint64_t> {};
// clang-format off
template <> struct NumberTraits<float> : Plain32 { using Lane = float; };
template <> struct NumberTraits<std::int32_t> : Plain32 { using Lane = std::int32_t; };
template <> struct NumberTraits<std::uint32_t> : Plain32 { using Lane = std::uint32_t; };
template <> struct NumberTraits<double> : Plain64 { using Lane = double; };
template <> struct NumberTraits<std::int64_t> : Plain64 { using Lane = std::int64_t; };
template <> struct NumberTraits<std::uint64_t> : Plain64 { using Lane = std::uint64_t; };
// clang-format on

template <class T>
concept PlainFloat = std::is_same_v<T, float> || std::is_same_v<T, double>;
template <class T>
concept PlainInteger = std::is_same_v<T, std::int32_t> || std::is_same_v<T, std::uint32_t> ||
    std::is_same_v<T, std::int64_t> || std::is_same_v<T, std::uint64_t>;
template <class T>
concept PlainNumber = PlainFloat<T> || PlainInteger<T>;

// --- bits and masks -------------------------------------------------------------------------

// The bits of a number as another type of the same width.
template <PlainNumber T>
TESSERA_INLINE IntOf<T> as_int(T a) {
    return __builtin_bit_cast(IntOf<T>, a);
}
template <PlainNumber T>
TESSERA_INLINE UintOf<T> as_uint(T a) {
    return __builtin_bit_cast(UintOf<T>, a);
}
template <PlainNumber T>
TESSERA_INLINE FloatOf<T> as_float(T a) {
    return __builtin_bit_cast(FloatOf<T>, a);
}

// mask ? a : b, lane by lane. Both sides are evaluated.
template <class T>
requires PlainNumber<T> || std::is_same_v<T, bool> TESSERA_INLINE T select(bool mask, T a, T b) { return mask ? a : b; }
TESSERA_INLINE bool any(bool mask) { return mask; }
TESSERA_INLINE bool all(bool mask) { return mask; }
TESSERA_INLINE bool none(bool mask) { return !mask; }
// Bit i is lane i.
TESSERA_INLINE std::uint32_t mask_bits(bool mask) { return mask ? 1 : 0; }
// The mask whose lane i is set for i < n.
template <PlainNumber T>
TESSERA_INLINE bool first_n(int n) {
    return n > 0;
}

// --- arithmetic -----------------------------------------------------------------------------

// a < b ? a : b and a > b ? a : b: the second when either is NaN, or for zeros of either sign.
template <PlainNumber T>
TESSERA_INLINE T min(T a, T b) {
    return a < b ? a : b;
}
template <PlainNumber T>
TESSERA_INLINE T max(T a, T b) {
    return a > b ? a : b;
}
// min(max(x, low), high): NaN becomes `low`.
template <PlainNumber T>
TESSERA_INLINE T clamp(T x, T low, T high) {
    return min(max(x, low), high);
}

template <PlainFloat T>
inline constexpr UintOf<T> kSignBit = UintOf<T>{1} << (8 * sizeof(T) - 1);

template <PlainFloat T>
TESSERA_INLINE T abs(T a) {
    return as_float(as_uint(a) & ~kSignBit<T>);
}
// |i|; the lowest integer stays itself.
template <PlainInteger T>
TESSERA_INLINE T abs(T a) {
    return a < 0 ? static_cast<T>(UintOf<T>{0} - as_uint(a)) : a;
}
// The magnitude of a with the sign of b.
template <PlainFloat T>
TESSERA_INLINE T copysign(T a, T b) {
    return as_float((as_uint(a) & ~kSignBit<T>) | (as_uint(b) & kSignBit<T>));
}

// IEEE square roots, rounded to nearest. (The built-in would call libm to set errno.)
TESSERA_INLINE float sqrt(float a) {
#if defined(__SSE2__)
    return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(a)));
#else
    return __builtin_sqrtf(a);
#endif
}
TESSERA_INLINE double sqrt(double a) {
#if defined(__SSE2__)
    const __m128d v = _mm_set_sd(a);
    return _mm_cvtsd_f64(_mm_sqrt_sd(v, v));
#else
    return __builtin_sqrt(a);
#endif
}

// --- rounding to integers in the number type, exact for every input; the sign of zero is kept ----

// Nearest, halves to even. Adding and taking away 2^23 (2^52) rounds there; larger numbers are whole.
template <PlainFloat T>
TESSERA_INLINE T round_even(T a) {
    constexpr T kWhole = sizeof(T) == 4 ? T(0x1p23) : T(0x1p52);
    const T magnitude = abs(a);
    const T rounded = (magnitude + kWhole) - kWhole;
    return magnitude < kWhole ? copysign(rounded, a) : a;
}
template <PlainFloat T>
TESSERA_INLINE T floor(T a) {
    const T rounded = round_even(a);
    return rounded > a ? rounded - T(1) : rounded;
}
template <PlainFloat T>
TESSERA_INLINE T ceil(T a) {
    const T rounded = round_even(a);
    return rounded < a ? copysign(rounded + T(1), a) : rounded;
}
// Towards zero.
template <PlainFloat T>
TESSERA_INLINE T trunc(T a) {
    return copysign(floor(abs(a)), a);
}

// --- conversions ----------------------------------------------------------------------------

// Truncates; what is out of range becomes the nearest integer of the type, NaN becomes 0.
TESSERA_INLINE std::int32_t to_int(float a) {
    if (a >= 0x1p31f) return INT32_MAX;
    if (a < -0x1p31f) return INT32_MIN;
    return a == a ? static_cast<std::int32_t>(a) : 0;
}
TESSERA_INLINE std::int64_t to_int(double a) {
    if (a >= 0x1p63) return INT64_MAX;
    if (a < -0x1p63) return INT64_MIN;
    return a == a ? static_cast<std::int64_t>(a) : 0;
}
// The nearest integer, ties to even, and the integer towards zero, of numbers below 2^31 in magnitude:
// one instruction. Others give any integer.
#if defined(__SSE2__)
TESSERA_INLINE std::int32_t nearest_int(float a) { return _mm_cvtss_si32(_mm_set_ss(a)); }
TESSERA_INLINE std::int32_t truncate_int(float a) { return _mm_cvttss_si32(_mm_set_ss(a)); }
#else
TESSERA_INLINE std::int32_t nearest_int(float a) { return to_int(round_even(a)); }
TESSERA_INLINE std::int32_t truncate_int(float a) { return to_int(a); }
#endif
// The nearest number, ties to even.
template <PlainInteger T>
TESSERA_INLINE FloatOf<T> to_float(T a) {
    return static_cast<FloatOf<T>>(a);
}

// --- shifts by the same count in every lane (operators << and >> do the same) ---------------------

template <PlainInteger T>
TESSERA_INLINE T shift_left(T a, int count) {
    return static_cast<T>(as_uint(a) << count);
}
// Zeros come in from the left, whatever the type.
template <PlainInteger T>
TESSERA_INLINE T shift_right_logical(T a, int count) {
    return static_cast<T>(as_uint(a) >> count);
}
// Copies of the sign bit come in, whatever the type.
template <PlainInteger T>
TESSERA_INLINE T shift_right_arithmetic(T a, int count) {
    return static_cast<T>(as_int(a) >> count);
}

// --- memory ---------------------------------------------------------------------------------
// load<T>(p) reads kLanes<T> consecutive lanes, `_aligned` from an address that is a multiple of the
// vector's size, `_n` only the first n (0 .. kLanes; the other lanes are 0). Stores mirror them.

template <PlainNumber T>
TESSERA_INLINE T load(const T* p) {
    return *p;
}
template <PlainNumber T>
TESSERA_INLINE T load_aligned(const T* p) {
    return *p;
}
template <PlainNumber T>
TESSERA_INLINE T load_n(const T* p, int n) {
    return n > 0 ? *p : T{};
}
template <PlainNumber T>
TESSERA_INLINE void store(T* p, T v) {
    *p = v;
}
template <PlainNumber T>
TESSERA_INLINE void store_aligned(T* p, T v) {
    *p = v;
}
template <PlainNumber T>
TESSERA_INLINE void store_n(T* p, T v, int n) {
    if (n > 0) *p = v;
}
// Writes the lanes of the mask and leaves the others as they are; all of them must be accessible, by
// this task alone (load, select, store: masked stores are slower on most processors).
template <PlainNumber T>
TESSERA_INLINE void store_masked(T* p, bool mask, T v) {
    *p = mask ? v : *p;
}
// base[index] per lane; every index must be in range (masked-off lanes too).
template <PlainNumber T>
TESSERA_INLINE T gather(const T* base, std::int32_t index) {
    return base[index];
}
template <PlainNumber T>
TESSERA_INLINE T gather(const T* base, std::int64_t index) {
    return base[index];
}
// 0, 1, 2, ... from the first lane on.
template <PlainNumber T>
TESSERA_INLINE T iota() {
    return T{};
}
// The number in lane i: for rare paths, it goes through memory.
template <PlainNumber T>
TESSERA_INLINE T lane(T v, int) {
    return v;
}

}  // namespace tessera
