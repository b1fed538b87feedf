#include "image/false_color.h"

#include "simd/math.h"

#include <algorithm>
#include <cstddef>

namespace tessera {

FalseColors false_colors() {
    constexpr double kStart = 2.6, kRotations = 0.8, kHue = 1.4, kTwoPi = 6.283185307179586;
    FalseColors colors{};
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const double x = static_cast<double>(i) / 255;
        const auto [s, c] = math::sincos(kTwoPi * (kStart / 3 + kRotations * x));
        const double amplitude = kHue * x * (1 - x) / 2;
        const double rgb[3] = {x + amplitude * (1.78277 * s - 0.14861 * c), x - amplitude * (0.29227 * c + 0.90649 * s),
                               x + amplitude * 1.97294 * c};
        for (std::size_t k = 0; k < 3; ++k)
            colors[i][k] = static_cast<std::uint8_t>(255 * std::clamp(rgb[k], 0.0, 1.0) + 0.5);
    }
    return colors;
}

}  // namespace tessera
