// Numbers as colours: a scale from black over blue, magenta and orange to white, whose brightness
// rises evenly, so that what is larger looks brighter, in print and to every eye. 8-bit display codes.
#pragma once

#include <array>
#include <cstdint>

namespace tessera {

// Colours of the fractions 0, 1/255, .. 1. D. A. Green, "A colour scheme for the display of astronomical
// intensity images" (2011), which is called cubehelix: start 2.6, 0.8 rotations, hue 1.4, gamma 1. Green's
// brightness, 0.30 R + 0.59 G + 0.11 B, is the fraction itself. Under FpEnvironment.
using FalseColors = std::array<std::array<std::uint8_t, 3>, 256>;
FalseColors false_colors();

}  // namespace tessera
