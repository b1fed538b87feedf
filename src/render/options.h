// What render options mean to the stages: checks, the film's parameters, progress and cancelling.
#pragma once

#include <tessera/render.h>

#include "geometry/strokes.h"
#include "raster/engine.h"
#include "reference/light_tracer.h"
#include "reference/visibility.h"
#include "shading/film.h"
#include "trace/engine.h"

#include <mutex>
#include <optional>
#include <vector>

namespace tessera {

// Throws kUsage for options that make no sense and kLimit for pictures beyond the memory limit.
void check_options(const RenderOptions& options);

FilmView film_view(const RenderOptions& options, double exposure);

// How points and lines are drawn, in the memory that the picture leaves.
StrokeStyle stroke_style(const RenderOptions& options);

// Where a pixel's samples lie.
std::vector<SamplePosition> sample_positions(const RenderOptions& options);

// Whether an engine draws tiles on all threads.
bool is_parallel(Engine engine);
// Whether rays go towards lights, and along mirrored and refracted directions.
bool traces_shadows(const RenderOptions& options);
bool traces_bounces(const RenderOptions& options);
TransportSettings transport_settings(const RenderOptions& options, const FilmView& film);
// Nothing where no light is traced.
std::optional<ReferenceTransport> reference_transport(const RenderOptions& options, const FilmView& film,
                                                      const Frame& frame);

// The tile rasterizer's settings for all samples, under `control`.
RasterSettings raster_settings(const RenderOptions& options, const FilmView& film, const RunControl& control);

// Turns the stages' checkpoints, which come from any thread, into calls of the caller's progress and
// cancel callbacks: one at a time, with rising progress.
class Watchdog {
  public:
    explicit Watchdog(const RenderOptions& options) : options_(options) {}
    // For stage `step` of `steps`; 0 of 0 reports no progress.
    RunControl control(int step, int steps) const;

  private:
    const RenderOptions& options_;
    mutable std::mutex mutex_;
    mutable double reported_ = -1;
};

}  // namespace tessera
