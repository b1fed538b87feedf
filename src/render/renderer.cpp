// The renderer on one page: scene -> frame -> shading -> visibility and shading -> film. Everything that
// happens to a picture happens here, in this order.
#include <tessera/error.h>
#include <tessera/render.h>

#include "core/fp_environment.h"
#include "core/sampling.h"
#include "raster/engine.h"
#include "reference/engine.h"
#include "render/canvas.h"
#include "render/options.h"
#include "render/shading_scene.h"
#include "render/stopwatch.h"

#include <algorithm>

namespace tessera {
namespace {

// Shades what was seen at one sample position of every pixel and adds it to the picture.
void shade_pass(ReferenceEngine& engine, const Visibility& seen, SamplePosition offset, Canvas& canvas,
                const std::function<void(double)>& checkpoint) {
    const Fragment* transparent = seen.transparent.data();
    const Fragment* const end = transparent + seen.transparent.size();
    for (std::size_t pixel = 0; pixel < seen.depth.size(); ++pixel) {
        if (pixel % static_cast<std::size_t>(seen.width) == 0)
            checkpoint(static_cast<double>(pixel) / static_cast<double>(seen.depth.size()));
        const Fragment* const first = transparent;
        while (transparent != end && transparent->pixel == pixel) ++transparent;
        if (seen.triangle[pixel] == 0 && first == transparent) continue;
        const SampleColor c = engine.shade_sample(seen, pixel, offset, first, transparent);
        canvas.add(pixel, c.premultiplied, c.alpha);
    }
}

// 512 transparent layers all over a tile; some hundred MiB of working memory per thread.
constexpr std::size_t kMostFragmentsPerTile = 512 * kTilePixels;

// The tile rasterizer: visibility, shading and film inside each tile. A filter wider than the pixel has
// the picture drawn once per sample, and the film comes after all of them.
void draw_tiles(const Frame& frame, const ShadingScene& shading, const RenderOptions& options, Arena& arena,
                const Watchdog& watchdog, Stopwatch& watch, RenderResult& result) {
    std::vector<SamplePosition> samples;
    for (int sample = 0; sample < options.samples; ++sample) {
        const SampleOffset s = sample_offset(sample, options.samples);
        samples.push_back({s.x, s.y});
    }
    RasterSettings settings;
    settings.film = shading.film(options);
    settings.isa = resolve_isa(options.isa);
    result.stats.isa = settings.isa;
    result.stats.threads = arena.threads();
    RasterTargets targets = make_planes(options, result);
    const auto draw = [&](std::vector<SamplePosition> positions, const RunControl& control, bool first) {
        settings.samples = std::move(positions);
        settings.max_fragments = std::min(control.max_fragments, kMostFragmentsPerTile);
        settings.checkpoint = control.checkpoint;
        add_counters(result.stats, draw_raster(frame, shading.context(), settings, targets, arena), first);
        watch.phase("tiles");
    };
    if (options.filter == PixelFilter::kBox) return draw(std::move(samples), watchdog.control(0, 1), true);

    FilterPass filter(options, &arena);
    std::vector<float> plane(options.want_linear ? 0 : filter.plane_floats());
    if (!options.want_linear) targets.linear = plane.data();
    for (int sample = 0; sample < options.samples; ++sample) {
        draw({samples[static_cast<std::size_t>(sample)]}, watchdog.control(sample, options.samples), sample == 0);
        targets.distance = nullptr, targets.triangle = nullptr;  // the labels were taken with the first one
        filter.add(sample, targets.linear, watchdog.control(0, 0).checkpoint);
        watch.phase("filter");
    }
    develop_picture(filter.finish(), 1.0f, settings.film, options, &arena, result);
    result.stats.pixels_covered = filter.pixels_covered();
    watch.phase("film");
}

// The reference engines: pass by pass, everything in full.
void draw_reference(const Frame& frame, const ShadingScene& shading, const RenderOptions& options,
                    const Watchdog& watchdog, Stopwatch& watch, RenderResult& result) {
    const bool tracing = options.engine == Engine::kReferenceTrace;
    ReferenceEngine engine(frame, shading.context(), tracing, options.shadows);
    watch.phase("build");

    Canvas canvas(options);
    for (int sample = 0; sample < options.samples; ++sample) {
        const SampleOffset s = sample_offset(sample, options.samples);
        const SamplePosition offset{s.x, s.y};
        const Visibility seen = engine.see(offset, watchdog.control(2 * sample, 2 * options.samples));
        add_counters(result.stats, seen.counters, sample == 0);
        watch.phase("visibility");
        shade_pass(engine, seen, offset, canvas, watchdog.control(2 * sample + 1, 2 * options.samples).checkpoint);
        watch.phase("shading");
        canvas.end_sample(sample, watchdog.control(0, 0).checkpoint);
    }
    if (options.want_depth || options.want_primitive) {
        take_labels(engine, watchdog.control(0, 0), options, result);
        watch.phase("labels");
    }
    canvas.develop(shading.film(options), result);
    watch.phase("film");
}

}  // namespace

RenderResult render(const Scene& scene, const RenderOptions& options) {
    check_options(options);
    validate(scene);
    const FpEnvironment exact;
    RenderResult result;
    Stopwatch watch(result.stats);
    const Watchdog watchdog(options);

    const Frame frame = make_frame(scene, options.view, options.width, options.height);
    result.warnings = frame.warnings;
    watch.phase("evaluate");

    Arena arena(options.threads);
    const ShadingScene shading(scene, frame, options, arena, result.warnings);
    watch.phase("prepare");

    if (options.engine == Engine::kRaster)
        draw_tiles(frame, shading, options, arena, watchdog, watch, result);
    else
        draw_reference(frame, shading, options, watchdog, watch, result);

    result.stats.engine = options.engine;
    result.stats.exposure = shading.exposure();
    result.stats.color_hash = hash_pixels(result.color);
    watch.finish();
    return result;
}

}  // namespace tessera
