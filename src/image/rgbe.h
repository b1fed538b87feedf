// The pixel of Radiance pictures: three mantissas m and a shared exponent e, bytes all; a channel is
// m * 2^(e - 136), and e = 0 is black. (Radiance's own tools add a half to m, since they cut off when
// they write; like most others we do not, so that black is black, and round when we write.)
// By bits and by exact products of powers of two: no function of the C library.
#pragma once

#include <bit>
#include <cstdint>

namespace tessera {

// 2^exponent for -1022 .. 1023.
constexpr double power_of_two(int exponent) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

// `rgba`: exact, alpha 1.
constexpr void rgbe_to_float(const std::uint8_t* rgbe, float* rgba) {
    const double scale = rgbe[3] == 0 ? 0 : power_of_two(rgbe[3] - 136);
    for (int c = 0; c < 3; ++c) rgba[c] = static_cast<float>(rgbe[c] * scale);
    rgba[3] = 1;
}

// The exponent is the least that gives the largest channel a mantissa of at most 255 after rounding;
// halves round up. Negative values and NaN count as 0, values beyond 255 * 2^119 as that, and pixels
// whose largest channel is below 2^-128 are black: mantissas are at least 128, so that no pixel looks like
// a mark of the run-length encodings.
constexpr void float_to_rgbe(const float* rgb, std::uint8_t* rgbe) {
    const double most = 255 * power_of_two(119);
    double channels[3]{}, largest = 0;
    for (int c = 0; c < 3; ++c) {
        channels[c] = rgb[c] > 0 ? (rgb[c] < most ? rgb[c] : most) : 0;
        if (channels[c] > largest) largest = channels[c];
    }
    // largest = f * 2^exponent with f in 1 .. 2, so a shared exponent of `exponent` + 129 gives f * 128.
    const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(largest) >> 52) - 1023;
    int shared = exponent + 129;
    if (shared < 1) {
        for (int c = 0; c < 4; ++c) rgbe[c] = 0;
        return;
    }
    if (largest * power_of_two(136 - shared) + 0.5 >= 256) ++shared;
    for (int c = 0; c < 3; ++c) rgbe[c] = static_cast<std::uint8_t>(channels[c] * power_of_two(136 - shared) + 0.5);
    rgbe[3] = static_cast<std::uint8_t>(shared);
}

}  // namespace tessera
