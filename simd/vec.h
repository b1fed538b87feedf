// The number types of kernels and shading: one number per lane, written in operator notation.
//
// Template code over a number type F (float, double, or a vector `Float`) uses the traits below and
// the free functions of vec_plain.h, which every F has with the same meaning and the same bits per
// lane: + - * / sqrt are IEEE operations rounded to nearest, nothing is fused or estimated. Bits are
// equal for every input, 0, -0, denormals and infinities included; a NaN is a NaN everywhere, but its
// sign and payload are not specified. Integer rules: Int must not overflow (Uint wraps), shift counts
// are 0 .. 31 (63 for double's integers), masks are inverted by `!`.
//
// In a *.simd.cpp (see cmake/TesseraKernels.cmake) namespace tessera::TESSERA_ISA_NAMESPACE also has
// Float, Int, Uint and Mask: plain types for `scalar`, vectors of 4, 8 or 16 lanes of 32 bits for
// `sse4`, `avx2` and `avx512` (vec_highway.h). Other files see the plain types only.
#pragma once

#include <cstdint>
#include <type_traits>

// For every function that several instruction sets may instantiate: an inlined function leaves no
// symbol that the linker could share between them.
#define TESSERA_INLINE inline __attribute__((always_inline))
// For what is rare, in functions over the number type only (see above).
#define TESSERA_COLD __attribute__((noinline, cold))
// Before a short loop whose variables are to stay in registers.
#define TESSERA_PRAGMA(text) _Pragma(#text)
#if defined(__clang__)
#define TESSERA_UNROLL(times) TESSERA_PRAGMA(unroll times)
#else
#define TESSERA_UNROLL(times) TESSERA_PRAGMA(GCC unroll times)
#endif
// TESSERA_INLINE for a lambda, between its parameters and its body.
#define TESSERA_INLINE_LAMBDA __attribute__((always_inline))

namespace tessera {

// Lane, Mask, Int, Uint, Float and kLanes of a number type; specialised for each of them.
template <class T>
struct NumberTraits;

template <class F>
using LaneOf = typename NumberTraits<F>::Lane;  // float, double, int32_t, ...
template <class F>
using MaskOf = typename NumberTraits<F>::Mask;  // what a comparison gives
template <class F>
using IntOf = typename NumberTraits<F>::Int;  // signed integers, as many and as wide
template <class F>
using UintOf = typename NumberTraits<F>::Uint;
template <class F>
using FloatOf = typename NumberTraits<F>::Float;
template <class F>
inline constexpr int kLanes = NumberTraits<F>::kLanes;

}  // namespace tessera

#include "simd/vec_plain.h"

#if defined(TESSERA_ISA_NAMESPACE) && TESSERA_SIMD_LANES > 1
#include "simd/vec_highway.h"
#elif defined(TESSERA_ISA_NAMESPACE)
namespace tessera::TESSERA_ISA_NAMESPACE {
using Float = float;
using Int = std::int32_t;
using Uint = std::uint32_t;
using Mask = bool;
}  // namespace tessera::TESSERA_ISA_NAMESPACE
#endif
