// The scale of false colours: its brightness is the number, all the way from black to white.
#include <gtest/gtest.h>

#include "core/fp_environment.h"
#include "image/false_color.h"

namespace tessera {
namespace {

TEST(FalseColor, BrightnessIsTheFraction) {
    const FpEnvironment exact;
    const FalseColors colors = false_colors();
    double last = -1;
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const auto [r, g, b] = colors[i];
        const double brightness = 0.30 * r + 0.59 * g + 0.11 * b;
        // Each channel is rounded to within 1/2; the sum of the published coefficients is off by 4e-7.
        EXPECT_NEAR(brightness, static_cast<double>(i), 0.501) << i;
        EXPECT_GT(brightness, last) << i;
        last = brightness;
    }
    EXPECT_EQ(colors.front(), (std::array<std::uint8_t, 3>{0, 0, 0}));
    EXPECT_EQ(colors.back(), (std::array<std::uint8_t, 3>{255, 255, 255}));
}

}  // namespace
}  // namespace tessera
