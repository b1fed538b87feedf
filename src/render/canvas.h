// The picture being made: linear radiance summed over the samples, then developed into the result's
// planes; and the label planes.
#pragma once

#include "raster/engine.h"
#include "reference/engine.h"
#include "render/options.h"

#include <vector>

namespace tessera {

class Canvas {
  public:
    explicit Canvas(const RenderOptions& options);

    // Adds one sample's colour to a pixel.
    void add(std::size_t pixel, const Vec3T<float>& premultiplied, float alpha) {
        float* p = sums_.data() + 4 * pixel;
        p[0] += premultiplied.x, p[1] += premultiplied.y, p[2] += premultiplied.z, p[3] += alpha;
        hit_[pixel] = 1;
    }
    // Box-filters, develops and writes the colour and linear planes that are wanted and the count of
    // covered pixels.
    void develop(const FilmView& film, const RasterTargets& targets, RenderStats& stats) const;

  private:
    const RenderOptions& options_;
    std::vector<float> sums_;  // RGBA per pixel, premultiplied
    std::vector<char> hit_;
};

// What the pass of the labels saw, and how many pixels it labelled.
struct LabelCounts {
    VisibilityCounters counters;
    std::uint64_t pixels;
};

// Depth and primitive planes, at the pixel centre, of the nearest surface with alpha of at least one
// half.
LabelCounts take_labels(ReferenceEngine& engine, const RunControl& control, const RasterTargets& targets);

// Adds a pass' counters to the statistics. The culling counters are those of the first pass: the
// others cull the same triangles again.
void add_counters(RenderStats& stats, const VisibilityCounters& counters, bool first);
void add_counters(RenderStats& stats, const RasterCounters& counters);
// Of a picture of labels alone.
void add_counters(RenderStats& stats, const LabelCounts& counts);

// The planes that the options ask for, made where `result` does not have them yet; the others are let go.
RasterTargets make_planes(const RenderOptions& options, RenderResult& result);

}  // namespace tessera
