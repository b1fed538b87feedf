// The picture being made: linear radiance gathered over the samples, then developed into the result's
// planes.
#pragma once

#include "raster/engine.h"
#include "reference/engine.h"
#include "render/filter_pass.h"
#include "render/options.h"
#include "trace/engine.h"

#include <functional>
#include <optional>
#include <vector>

namespace tessera {

class Canvas {
  public:
    explicit Canvas(const RenderOptions& options);

    // Takes sample `sample` of every pixel: shades what was seen at `offset` and adds it to the picture.
    void take_sample(int sample, ReferenceEngine& engine, const Visibility& seen, SamplePosition offset,
                     const std::function<void(double)>& checkpoint);

    // Filters, develops and writes the colour and linear planes that are wanted and the count of covered
    // pixels.
    void develop(const FilmView& film, const PictureTargets& targets, RenderStats& stats);

  private:
    // Adds one sample's colour to a pixel.
    void add(std::size_t pixel, const SampleColor& color) {
        float* p = sums_.data() + 4 * pixel;
        p[0] += color.premultiplied.x, p[1] += color.premultiplied.y, p[2] += color.premultiplied.z;
        p[3] += color.alpha;
    }

    const RenderOptions& options_;
    std::vector<float> sums_;  // RGBA per pixel, premultiplied; with a wide filter of one sample
    std::vector<char> hit_;
    std::optional<FilterPass> filter_;
};

// Develops `sums` (RGBA per pixel, premultiplied) times `weight` into the colour and linear planes that
// are wanted. `arena` runs the rows; null: the calling thread.
void develop_picture(const float* sums, float weight, const FilmView& film, const RenderOptions& options, Arena* arena,
                     const PictureTargets& targets);

// Adds a pass' counters to the statistics. The culling counters are those of the first pass: the
// others cull the same triangles again.
void add_counters(RenderStats& stats, const VisibilityCounters& counters, bool first);
void add_counters(RenderStats& stats, const RasterCounters& counters, bool first);
void add_counters(RenderStats& stats, const TraceCounters& counters, bool first);
// Of traced light and the hierarchies that it took.
void add_counters(RenderStats& stats, const LightTracer& tracer);

// The planes that the options ask for and those that they are made of, made where `result` does not have them yet; the
// others are let go.
PictureTargets make_planes(const RenderOptions& options, RenderResult& result);
// Afterwards: fills the planes that are made of others, and lets go of those.
void finish_planes(const RenderOptions& options, RenderResult& result);

}  // namespace tessera
