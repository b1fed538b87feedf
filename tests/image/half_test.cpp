// Halves against their definition, and rounding proved over every gap between two of them.
#include "image/half.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tessera {
namespace {

// IEEE 754, table 3.5: sign, 5 bits of exponent with a bias of 15, 10 bits of mantissa.
double defined(std::uint32_t half) {
    const int exponent = static_cast<int>(half >> 10 & 0x1f), mantissa = static_cast<int>(half & 0x3ff);
    const double magnitude = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    return (half & 0x8000) != 0 ? -magnitude : magnitude;
}

TEST(Half, EveryFiniteValueIsAsDefinedAndReturns) {
    for (std::uint32_t half = 0; half < 0x10000; ++half) {
        if ((half & 0x7c00) == 0x7c00) continue;
        const float value = half_to_float(static_cast<std::uint16_t>(half));
        EXPECT_EQ(value, defined(half)) << half;
        EXPECT_EQ(std::signbit(value), (half & 0x8000) != 0);
        EXPECT_EQ(float_to_half(value), half);
    }
}

TEST(Half, InfinityAndNan) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(half_to_float(0x7c00), kInfinity);
    EXPECT_EQ(half_to_float(0xfc00), -kInfinity);
    EXPECT_EQ(float_to_half(kInfinity), 0x7c00);
    EXPECT_EQ(float_to_half(-kInfinity), 0xfc00);
    for (std::uint32_t payload = 1; payload < 0x400; ++payload) {
        EXPECT_TRUE(std::isnan(half_to_float(static_cast<std::uint16_t>(0x7c00 | payload))));
        // A payload in the low bits only must not round to infinity.
        const std::uint16_t half = float_to_half(std::bit_cast<float>(0xff800000u | payload));
        EXPECT_EQ(half & 0xfc00, 0xfc00);
        EXPECT_NE(half & 0x3ff, 0);
    }
}

// Between two neighbours: the middle goes to the even one, and every float beside it to the nearer one.
// 65536, which would follow 65504, stands for infinity.
TEST(Half, RoundsToNearestTiesToEven) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (std::uint32_t low = 0; low < 0x7c00; ++low) {
        const std::uint32_t high = low + 1, even = low % 2 == 0 ? low : high;
        const double above = high == 0x7c00 ? 65536 : defined(high);
        const auto middle = static_cast<float>((defined(low) + above) / 2);
        EXPECT_EQ(float_to_half(middle), even) << low;
        EXPECT_EQ(float_to_half(std::nextafter(middle, 0.0f)), low);
        EXPECT_EQ(float_to_half(std::nextafter(middle, kInfinity)), high);
        EXPECT_EQ(float_to_half(-middle), even | 0x8000);
    }
    EXPECT_EQ(float_to_half(std::numeric_limits<float>::max()), 0x7c00);
    EXPECT_EQ(float_to_half(std::numeric_limits<float>::denorm_min()), 0);
}

}  // namespace
}  // namespace tessera
