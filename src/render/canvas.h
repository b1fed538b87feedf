// The picture being made: linear radiance gathered over the samples, then developed into the result's
// planes; and the label planes.
#pragma once

#include "raster/engine.h"
#include "reference/engine.h"
#include "render/filter_pass.h"
#include "render/options.h"

#include <optional>
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

    // Ends sample `sample` of every pixel: a wide filter takes it here.
    void end_sample(int sample, const std::function<void(double)>& checkpoint);

    // Filters, develops and writes result.color, result.linear and the count of covered pixels.
    void develop(const FilmView& film, RenderResult& result);

  private:
    const RenderOptions& options_;
    std::vector<float> sums_;  // RGBA per pixel, premultiplied; with a wide filter of one sample
    std::vector<char> hit_;
    std::optional<FilterPass> filter_;
};

// Allocates result.color and, where wanted, result.linear.
void make_color_planes(const RenderOptions& options, RenderResult& result);

// Develops `sums` (RGBA per pixel, premultiplied) times `weight` into the planes of make_color_planes().
// `arena` runs the rows; null: the calling thread.
void develop_picture(const float* sums, float weight, const FilmView& film, const RenderOptions& options, Arena* arena,
                     RenderResult& result);

// Depth and primitive planes, at the pixel centre, of the nearest surface with alpha of at least one
// half.
void take_labels(ReferenceEngine& engine, const RunControl& control, const RenderOptions& options,
                 RenderResult& result);

// Adds a pass' counters to the statistics. The culling counters are those of the first pass: the
// others cull the same triangles again.
void add_counters(RenderStats& stats, const VisibilityCounters& counters, bool first);
void add_counters(RenderStats& stats, const RasterCounters& counters, bool first);

// Allocates the planes that the options ask for, for an engine that writes them itself.
RasterTargets make_planes(const RenderOptions& options, RenderResult& result);

}  // namespace tessera
