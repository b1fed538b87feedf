// Supersampling with a filter wider than a pixel: the picture is drawn once per sample position, and
// every pixel adds up its own sample and its neighbours', weighted (image/reconstruction_filter.h). In a
// fixed order, sample by sample and then row by row of the neighbours, so that the bits depend on
// neither threads nor instruction set.
//
// Nothing is known beyond the border of the picture: pixels there divide by the weights of what lies
// inside, colour and alpha alike, so that neither a dark nor a transparent rim appears.
// Where a filter's negative lobes carry alpha out of 0 .. 1, the nearer end is taken and the straight
// colour (RGB over alpha) kept; colours may be a little below 0, and the film takes that as 0.
#pragma once

#include "core/parallel.h"
#include "image/reconstruction_filter.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace tessera {

// Calls body(y) for every row, on the arena or, without one, in order on the calling thread.
void for_each_row(int height, Arena* arena, const std::function<void(int)>& body);

class FilterPass {
  public:
    // `arena` runs the rows and must outlive the pass; null: the calling thread does. Ready for the first
    // picture.
    FilterPass(const RenderOptions& options, Arena* arena);

    // Forgets what was added: for the next picture.
    void restart();

    // Floats of a sample's plane, four per pixel.
    std::size_t plane_floats() const { return sums_.size(); }

    // Adds the picture of sample `sample`: premultiplied linear RGBA without NaN. Samples come in their order, each
    // once. `checkpoint` is called from any thread.
    void add(int sample, const float* plane, const std::function<void(double)>& checkpoint);

    // After all samples: the filtered picture, premultiplied linear RGBA.
    const float* finish();
    // Pixels of which at least one sample had an alpha above 0.
    std::uint64_t pixels_covered() const;

  private:
    void add_row(std::size_t sample, int y, const float* plane);
    void finish_row(int y);

    int width_, height_;
    Arena* arena_;
    FilterWeights weights_;
    std::vector<float> sums_;
    std::vector<char> covered_;
};

}  // namespace tessera
