#include "simd/operations.h"

#include "simd/math.h"
#include "simd/records.h"
#include "simd/vec.h"

namespace tessera::TESSERA_ISA_NAMESPACE {
namespace {

constexpr int kWidth = kLanes<Float>;

template <class T>
TESSERA_INLINE T from_bits(Uint bits) {
    if constexpr (std::is_same_v<T, Float>) {
        return as_float(bits);
    } else if constexpr (std::is_same_v<T, Int>) {
        return as_int(bits);
    } else if constexpr (std::is_same_v<T, Mask>) {
        return (bits & Uint(1u)) != Uint(0u);
    } else {
        return bits;
    }
}
template <class T>
TESSERA_INLINE Uint to_bits(T value) {
    if constexpr (std::is_same_v<T, Mask>) {
        return select(value, Uint(1u), Uint(0u));
    } else {
        return as_uint(value);
    }
}

// Calls `f` on batches of kWidth, the last one incomplete.
template <class R, class... A>
struct Batches;
template <class R, class A>
struct Batches<R, A> {
    template <class F>
    static TESSERA_INLINE R call(F f, Uint a, Uint, Uint) {
        return f(from_bits<A>(a));
    }
};
template <class R, class A, class B>
struct Batches<R, A, B> {
    template <class F>
    static TESSERA_INLINE R call(F f, Uint a, Uint b, Uint) {
        return f(from_bits<A>(a), from_bits<B>(b));
    }
};
template <class R, class A, class B, class C>
struct Batches<R, A, B, C> {
    template <class F>
    static TESSERA_INLINE R call(F f, Uint a, Uint b, Uint c) {
        return f(from_bits<A>(a), from_bits<B>(b), from_bits<C>(c));
    }
};

template <class F, class R, class... A>
constexpr Operation make(const char* name, F, R (F::*)(A...) const) {
    return {name, std::is_same_v<R, Float>,
            [](const std::uint32_t* a, const std::uint32_t* b, const std::uint32_t* c, std::uint32_t* out, int count) {
                const F f{};
                int i = 0;
                for (; i + kWidth <= count; i += kWidth)
                    store(out + i,
                          to_bits(Batches<R, A...>::call(f, load<Uint>(a + i), load<Uint>(b + i), load<Uint>(c + i))));
                if (const int n = count - i; n > 0)
                    store_n(out + i,
                            to_bits(Batches<R, A...>::call(f, load_n<Uint>(a + i, n), load_n<Uint>(b + i, n),
                                                           load_n<Uint>(c + i, n))),
                            n);
            }};
}
template <class F>
constexpr Operation operation(const char* name, F f) {
    return make(name, f, &F::operator());
}

// What works on whole vectors: `f` writes the results of one batch of n lanes itself. It gets the
// three inputs, the output and n, which is below kWidth only at the end.
template <class F>
constexpr Operation batch(const char* name, F) {
    return {name, false,
            [](const std::uint32_t* a, const std::uint32_t* b, const std::uint32_t* c, std::uint32_t* out, int count) {
                for (int i = 0; i < count; i += kWidth)
                    F{}(a + i, b + i, c + i, out + i, count - i < kWidth ? count - i : kWidth, i);
            }};
}
using In = const std::uint32_t*;
using Out = std::uint32_t*;

TESSERA_INLINE Mask only_lane(int i) { return iota<Int>() == Int(i); }
TESSERA_INLINE Mask mask_of(In a, int n) { return from_bits<Mask>(load_n<Uint>(a, n)); }

// Integer operands are shifted down where the result would overflow: that is undefined for one lane.
constexpr Operation kOperations[] = {
    operation("add", [](Float a, Float b) { return a + b; }),
    operation("subtract", [](Float a, Float b) { return a - b; }),
    operation("multiply", [](Float a, Float b) { return a * b; }),
    operation("divide", [](Float a, Float b) { return a / b; }),
    operation("negate", [](Float a) { return -a; }),
    operation("multiply_add", [](Float a, Float b, Float c) { return a * b + c; }),
    operation("multiply_subtract", [](Float a, Float b, Float c) { return a * b - c; }),
    operation("cross", [](Float a, Float b, Float c) { return a * b - b * c; }),
    operation("compound", [](Float a, Float b, Float c) { return a += b, a *= c, a -= b, a /= c, a; }),
    operation("broadcast", [](Float a) { return (2.0f * a + 0.5f) / 3.0f; }),
    operation("less", [](Float a, Float b) { return a < b; }),
    operation("less_equal", [](Float a, Float b) { return a <= b; }),
    operation("greater", [](Float a, Float b) { return a > b; }),
    operation("greater_equal", [](Float a, Float b) { return a >= b; }),
    operation("equal", [](Float a, Float b) { return a == b; }),
    operation("not_equal", [](Float a, Float b) { return a != b; }),
    operation("min", [](Float a, Float b) { return min(a, b); }),
    operation("max", [](Float a, Float b) { return max(a, b); }),
    operation("min_constant", [](Float a) { return min(a, 1.0f); }),
    operation("max_constant", [](Float a) { return max(0.0f, a); }),
    operation("clamp", [](Float a, Float b, Float c) { return clamp(a, b, c); }),
    operation("abs", [](Float a) { return abs(a); }),
    operation("copysign", [](Float a, Float b) { return copysign(a, b); }),
    operation("sqrt", [](Float a) { return sqrt(a); }),
    operation("round_even", [](Float a) { return round_even(a); }),
    operation("floor", [](Float a) { return floor(a); }),
    operation("ceil", [](Float a) { return ceil(a); }),
    operation("trunc", [](Float a) { return trunc(a); }),
    operation("to_int", [](Float a) { return to_int(a); }),
    // Defined for |a| < 2^31.
    operation("nearest_int", [](Float a) { return nearest_int(select(abs(a) < 0x1p31f, a, Float(0.0f))); }),
    operation("truncate_int", [](Float a) { return truncate_int(select(abs(a) < 0x1p31f, a, Float(0.0f))); }),
    operation("select", [](Float a, Float b, Mask c) { return select(c, a, b); }),
    operation("as_int", [](Float a) { return as_int(a); }),
    operation("as_uint", [](Float a) { return as_uint(a) ^ 0x80000000u; }),
    operation("as_float", [](Int a) { return as_float(a); }),

    operation("int_add", [](Int a, Int b) { return (a >> 1) + (b >> 1); }),
    operation("int_subtract", [](Int a, Int b) { return (a >> 1) - (b >> 1); }),
    operation("int_multiply", [](Int a, Int b) { return (a >> 16) * (b >> 16); }),
    operation("int_negate", [](Int a) { return -(a >> 1); }),
    operation("int_abs", [](Int a) { return abs(a); }),
    operation("int_and", [](Int a, Int b) { return a & b; }),
    operation("int_or", [](Int a, Int b) { return a | b; }),
    operation("int_or3", [](Int a, Int b, Int c) { return or3(a, b, c); }),
    operation("int_xor", [](Int a, Int b) { return a ^ b; }),
    operation("int_not", [](Int a) { return ~a; }),
    operation("int_compound", [](Int a, Int b, Int c) { return a &= b, a |= c, a ^= b, a >>= 3, a <<= 2, a; }),
    operation("int_less", [](Int a, Int b) { return a < b; }),
    operation("int_less_equal", [](Int a, Int b) { return a <= b; }),
    operation("int_greater", [](Int a, Int b) { return a > b; }),
    operation("int_greater_equal", [](Int a, Int b) { return a >= b; }),
    operation("int_equal", [](Int a, Int b) { return a == b; }),
    operation("int_not_equal", [](Int a, Int b) { return a != b; }),
    operation("int_min", [](Int a, Int b) { return min(a, b); }),
    operation("int_max", [](Int a, Int b) { return max(a, b); }),
    operation("int_clamp", [](Int a, Int b, Int c) { return clamp(a, b, c); }),
    operation("int_select", [](Int a, Int b, Mask c) { return select(c, a, b); }),
    operation("int_to_float", [](Int a) { return to_float(a); }),
    operation("int_shift_left", [](Int a) { return a << 5; }),
    operation("int_shift_right", [](Int a) { return a >> 31; }),
    operation("int_shift_right_logical", [](Int a) { return shift_right_logical(a, 7); }),
    operation("int_shift_right_arithmetic", [](Int a) { return shift_right_arithmetic(a, 7); }),

    operation("uint_add", [](Uint a, Uint b) { return a + b; }),
    operation("uint_subtract", [](Uint a, Uint b) { return a - b; }),
    operation("uint_multiply", [](Uint a, Uint b) { return a * b; }),
    operation("uint_and", [](Uint a, Uint b) { return a & b; }),
    operation("uint_or", [](Uint a, Uint b) { return a | b; }),
    operation("uint_or3", [](Uint a, Uint b, Uint c) { return or3(a, b, c); }),
    operation("uint_xor", [](Uint a, Uint b) { return a ^ b; }),
    operation("uint_not", [](Uint a) { return ~a; }),
    operation("uint_less", [](Uint a, Uint b) { return a < b; }),
    operation("uint_less_equal", [](Uint a, Uint b) { return a <= b; }),
    operation("uint_greater", [](Uint a, Uint b) { return a > b; }),
    operation("uint_greater_equal", [](Uint a, Uint b) { return a >= b; }),
    operation("uint_equal", [](Uint a, Uint b) { return a == b; }),
    operation("uint_not_equal", [](Uint a, Uint b) { return a != b; }),
    operation("uint_min", [](Uint a, Uint b) { return min(a, b); }),
    operation("uint_max", [](Uint a, Uint b) { return max(a, b); }),
    operation("uint_select", [](Uint a, Uint b, Mask c) { return select(c, a, b); }),
    operation("uint_to_float", [](Uint a) { return to_float(a); }),
    operation("uint_shift_left", [](Uint a) { return a << 31; }),
    operation("uint_shift_right", [](Uint a) { return a >> 9; }),
    operation("uint_shift_right_logical", [](Uint a) { return shift_right_logical(a, 7); }),
    operation("uint_shift_right_arithmetic", [](Uint a) { return shift_right_arithmetic(a, 7); }),

    operation("mask_and", [](Mask a, Mask b) { return Mask(a & b); }),
    operation("mask_or", [](Mask a, Mask b) { return Mask(a | b); }),
    operation("mask_xor", [](Mask a, Mask b) { return Mask(a ^ b); }),
    operation("mask_not", [](Mask a) { return !a; }),
    operation("mask_select", [](Mask a, Mask b, Mask c) { return select(c, a, b); }),
    operation("mask_constant", [](Mask a) { return Mask((a & Mask(true)) | Mask(false)); }),

    // Over whole vectors. any, all and none are asked about one lane at a time.
    batch("mask_bits",
          [](In a, In, In, Out out, int n, int) {
              const std::uint32_t bits = mask_bits(mask_of(a, n));
              for (int i = 0; i < n; ++i) out[i] = (bits >> i) & (n == kWidth && i == n - 1 ? ~0u : 1u);
          }),
    batch("any",
          [](In a, In, In, Out out, int n, int) {
              for (int i = 0; i < n; ++i) out[i] = any(mask_of(a, n) & only_lane(i)) ? 1 : 0;
          }),
    batch("all",
          [](In a, In, In, Out out, int n, int) {
              for (int i = 0; i < n; ++i) out[i] = all(mask_of(a, n) | !only_lane(i)) ? 1 : 0;
          }),
    batch("none",
          [](In a, In, In, Out out, int n, int) {
              for (int i = 0; i < n; ++i) out[i] = none(mask_of(a, n) & only_lane(i)) ? 1 : 0;
          }),
    batch("first_n",
          [](In, In, In, Out out, int n, int) {
              for (int i = 0; i < n; ++i)
                  out[i] = mask_bits(first_n<Float>(i)) == (1u << i) - 1 && all(first_n<Uint>(kWidth)) &&
                           none(first_n<Int>(0));
          }),
    batch("iota",
          [](In, In, In, Out out, int n, int start) {
              const Int sum = to_int(iota<Float>()) + iota<Int>() + as_int(iota<Uint>());
              store_n(out, as_uint(sum + Int(3 * start)), n);
          }),
    batch("lane",
          [](In a, In b, In, Out out, int n, int) {
              const Uint v = load_n<Uint>(a, n) + load_n<Uint>(b, n);
              for (int i = 0; i < n; ++i) out[i] = lane(v, i);
          }),
    batch("load_n_fills_with_zero",
          [](In a, In, In, Out out, int n, int) {
              std::uint32_t all_lanes[kWidth];
              store(all_lanes, load_n<Uint>(a, n));
              for (int i = n; i < kWidth; ++i) all_lanes[0] |= all_lanes[i];
              for (int i = 0; i < n; ++i) out[i] = all_lanes[i];
          }),
    batch("load_store_aligned",
          [](In a, In, In, Out out, int n, int) {
              alignas(64) std::uint32_t buffer[kWidth];
              store_aligned(buffer, load_n<Uint>(a, n));
              store_n(out, load_aligned<Uint>(buffer), n);
          }),
    batch("store_masked",
          [](In a, In b, In c, Out out, int n, int) {
              std::uint32_t buffer[kWidth];
              store(buffer, load_n<Uint>(b, n));
              store_masked(buffer, mask_of(c, n), load_n<Uint>(a, n));
              store_n(out, load<Uint>(buffer), n);
          }),
    batch("gather",
          [](In a, In b, In, Out out, int n, int start) {
              store_n(out, gather(a - start, as_int(load_n<Uint>(b, n) & Uint(kGatherTable - 1u))), n);
          }),
    batch("gather_float",
          [](In a, In b, In, Out out, int n, int start) {
              alignas(64) float table[kGatherTable];
              alignas(64) std::int32_t table_int[kGatherTable];
              for (int i = 0; i < kGatherTable; ++i) {
                  table_int[i] = static_cast<std::int32_t>(a[i - start]);
                  table[i] = as_float(a[i - start]);
              }
              const Int index = as_int(load_n<Uint>(b, n) & Uint(kGatherTable - 1u));
              store_n(out, as_uint(gather(table, index)) ^ as_uint(gather(table_int, index)), n);
          }),

    operation("exp2", [](Float a) { return math::exp2(a); }),
    operation("exp", [](Float a) { return math::exp(a); }),
    operation("log2", [](Float a) { return math::log2(a); }),
    operation("log", [](Float a) { return math::log(a); }),
    operation("pow", [](Float a, Float b) { return math::pow(a, b); }),
    operation("pow_of_magnitude", [](Float a, Float b) { return math::pow(abs(a), b * 0x1p-60f); }),
    operation("rsqrt", [](Float a) { return math::rsqrt(a); }),
    operation("cbrt", [](Float a) { return math::cbrt(a); }),
    operation("sin", [](Float a) { return math::sin(a); }),
    operation("cos", [](Float a) { return math::cos(a); }),
    operation("sincos", [](Float a) { return math::sincos(a).sin - math::sincos(a).cos; }),
    operation("tan", [](Float a) { return math::tan(a); }),
    operation("asin", [](Float a) { return math::asin(a); }),
    operation("acos", [](Float a) { return math::acos(a); }),
    operation("atan", [](Float a) { return math::atan(a); }),
    operation("atan2", [](Float a, Float b) { return math::atan2(a, b); }),
    operation("radians", [](Float a) { return math::radians(a); }),
    operation("degrees", [](Float a) { return math::degrees(a); }),
};

}  // namespace

const OperationTable& operation_table() {
    static constexpr OperationTable kTable{kOperations, kWidth};
    return kTable;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
