// Reconstruction filters: with which weights the samples around a pixel make its colour. A filter is
// the product of one even function in x and the same in y, over distances from the pixel's centre in
// pixels. All pixels have their samples at the same places, so that a weight depends on the sample's
// index and on how many pixels away it is, and one small table serves the whole picture. Made in
// double with simd/math.h: the same bits on every machine (under FpEnvironment).
#pragma once

#include <tessera/render.h>

#include "core/sampling.h"

#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// Half the width of the filter, in pixels: it is 0 from there on (the box: beyond there).
double filter_radius(PixelFilter filter);

// The filter in one dimension at distance x, not normalised:
//   box       1, radius 1/2;
//   tent      1 - |x|, radius 1: Bartlett's window;
//   Gaussian  exp(-x^2 / (2 sigma^2)) less its value at the radius of 1.5, so that it ends without a
//             step (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed. 2023, 8.8.2);
//             sigma 1/2: the sampling frequency, which would show as a ripple over flat colours, passes
//             with exp(-pi^2 / 2) = 0.7 %, and half of it, the finest that pixels can show, with 29 %;
//   Mitchell  the cubic with B = C = 1/3, radius 2, negative beyond 8/7 (Mitchell and Netravali,
//             "Reconstruction Filters in Computer Graphics", 1988, equation 8).
double filter_value(PixelFilter filter, double x);

// The weights of a filter over a sample pattern. Their sum is 1, but for their rounding to float.
class FilterWeights {
  public:
    FilterWeights(PixelFilter filter, std::span<const SampleOffset> samples);

    // How many pixels to each side a pixel's colour comes from.
    int reach() const { return reach_; }
    // Of sample `sample` of the pixel (x + dx, y + dy) in the colour of the pixel (x, y), for dx and dy
    // of -reach() .. reach().
    float weight(std::size_t sample, int dx, int dy) const {
        const int side = 2 * reach_ + 1;
        return weights_[sample * static_cast<std::size_t>(side * side) +
                        static_cast<std::size_t>((dy + reach_) * side + dx + reach_)];
    }
    // The sum of the weights of all samples of so many pixels to each side (0 .. reach()): less than
    // all of them at the border of a picture. Always above 0, as the pixel's own samples are.
    double sum_within(int left, int right, int up, int down) const;

  private:
    int reach_;
    std::size_t samples_;
    std::vector<float> weights_;  // by sample, dy, dx
};

}  // namespace tessera
