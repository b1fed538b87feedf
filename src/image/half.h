// 16-bit floating point (IEEE 754 binary16: sign, 5 bits of exponent, 10 of mantissa), to and from float
// by bits alone: the same everywhere, whatever the processor and its rounding mode.
#pragma once

#include <bit>
#include <cstdint>

namespace tessera {

// Exact. NaN keeps the upper bits of its payload.
constexpr float half_to_float(std::uint16_t half) {
    const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000) << 16;
    const std::uint32_t exponent = half >> 10 & 0x1f, mantissa = half & 0x3ff;
    if (exponent == 0x1f) return std::bit_cast<float>(sign | 0x7f800000u | mantissa << 13);
    if (exponent != 0) return std::bit_cast<float>(sign | (exponent + 112) << 23 | mantissa << 13);
    if (mantissa == 0) return std::bit_cast<float>(sign);
    // Subnormal: mantissa * 2^-24; the leading one moves to its place in a float.
    const auto top = static_cast<std::uint32_t>(std::bit_width(mantissa) - 1);
    return std::bit_cast<float>(sign | (top + 103) << 23 | (mantissa << (23 - top) & 0x7fffff));
}

// Rounds to nearest, ties to even; from 65520 on the result is infinite. NaN stays NaN.
constexpr std::uint16_t float_to_half(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = bits >> 16 & 0x8000, magnitude = bits & 0x7fffffff;
    if (magnitude > 0x7f800000) return static_cast<std::uint16_t>(sign | 0x7e00 | (magnitude >> 13 & 0x1ff));
    if (magnitude >= 0x477ff000) return static_cast<std::uint16_t>(sign | 0x7c00);
    // `kept` is the result before rounding, `rest` what falls off, in units of 2^-drop of its last place.
    std::uint32_t kept = 0, rest = 0, drop = 13;
    if (magnitude >= 0x38800000) {  // 2^-14: normal
        kept = (magnitude - 0x38000000) >> 13;
        rest = magnitude & 0x1fff;
    } else {
        const std::uint32_t exponent = magnitude >> 23;
        if (exponent < 102) return static_cast<std::uint16_t>(sign);  // below half of the smallest
        const std::uint32_t mantissa = (magnitude & 0x7fffff) | 0x800000;
        drop = 126 - exponent;
        kept = mantissa >> drop;
        rest = mantissa & ((1u << drop) - 1);
    }
    const std::uint32_t tie = 1u << (drop - 1);
    if (rest > tie || (rest == tie && (kept & 1) != 0)) ++kept;
    return static_cast<std::uint16_t>(sign | kept);
}

}  // namespace tessera
