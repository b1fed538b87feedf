// The renderer on one page: scene -> frame -> shading -> visibility and shading -> film. Everything that
// happens to a picture happens here, in this order.
#include <tessera/error.h>
#include <tessera/renderer.h>

#include "core/fp_environment.h"
#include "raster/engine.h"
#include "reference/engine.h"
#include "render/canvas.h"
#include "render/options.h"
#include "render/shading_scene.h"
#include "render/stage_picture.h"
#include "render/stopwatch.h"

namespace tessera {

// Everything that outlives a frame.
struct Renderer::Impl {
    Impl(const Scene& s, const RenderOptions& o)
        : scene(s),
          options(o),
          arena(o.threads),
          prepared(s, &arena, o.engine == Engine::kRaster ? resolve_isa(o.isa) : Isa::kScalar),
          shading(s, prepared.used_materials(), arena, warnings) {
        const bool wide = o.filter != PixelFilter::kBox && (o.want_color || o.want_linear);
        if (o.engine != Engine::kRaster || !wide) return;
        filter.emplace(o, &arena);
        sample_plane.resize(filter->plane_floats());
    }

    void draw(const View& view, const Moment& moment, RenderResult& result);
    void draw_tiles(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result);
    void draw_reference(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result);

    const Scene& scene;
    const RenderOptions options;
    std::vector<std::string> warnings;  // of the materials
    Arena arena;
    PreparedScene prepared;
    ShadingScene shading;
    Frame frame;  // the latest
    RasterEngine raster;
    // Of filters wider than the pixel: the sums, and the picture of one sample, linear RGBA.
    std::optional<FilterPass> filter;
    std::vector<float> sample_plane;
};

Renderer::Renderer(const Scene& scene, const RenderOptions& options) {
    check_options(options);
    validate(scene);
    const FpEnvironment exact;
    impl_ = std::make_unique<Impl>(scene, options);
}

void Renderer::Impl::draw(const View& view, const Moment& moment, RenderResult& result) {
    const FpEnvironment exact;
    result.stats = {};
    Stopwatch watch(result.stats);
    const Watchdog watchdog(options);

    prepared.move_to(moment);
    make_frame(prepared, view, options.width, options.height, frame);
    shading.light(scene, frame, options);
    watch.phase("evaluate");

    if (options.engine == Engine::kRaster)
        draw_tiles(watchdog, watch, result);
    else
        draw_reference(watchdog, watch, result);

    result.warnings = frame.warnings;
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
    result.stats.engine = options.engine;
    result.stats.exposure = shading.exposure();
    watch.finish();
}

// The tile rasterizer: visibility, shading and film inside each tile. With a filter that is wider than
// the pixel, linear pictures of one sample each, and the film after the last of them.
void Renderer::Impl::draw_tiles(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result) {
    const RasterTargets targets = make_planes(options, result);
    RasterSettings settings = raster_settings(options, shading.film(options), watchdog.control(0, 1));
    result.stats.isa = settings.isa;
    result.stats.threads = arena.threads();
    const auto draw = [&](const RasterTargets& to, bool first) {
        add_counters(result.stats, raster.draw(frame, shading.context(), settings, to, arena), first);
        watch.phase("tiles");
    };
    settings.inspection = make_stage_plane(options, result);
    if (!filter) {
        draw(targets, true);
        if (options.show != Stage::kPicture) paint_stage(options.show, result.stats.tile_side, result);
        return;
    }

    filter->restart();
    const std::vector<SamplePosition> positions = std::move(settings.samples);
    RasterTargets sample_targets = targets;
    sample_targets.rgba = nullptr;
    sample_targets.linear = sample_plane.data();
    for (int sample = 0; sample < options.samples; ++sample) {
        settings.samples.assign(1, positions[static_cast<std::size_t>(sample)]);
        settings.checkpoint = watchdog.control(sample, options.samples).checkpoint;
        draw(sample_targets, sample == 0);
        sample_targets.distance = nullptr, sample_targets.triangle = nullptr;  // done with the first one
        filter->add(sample, sample_plane.data(), watchdog.control(0, 0).checkpoint);
        watch.phase("filter");
    }
    develop_picture(filter->finish(), 1.0f, settings.film, options, &arena, targets);
    result.stats.pixels_covered = filter->pixels_covered();
    watch.phase("film");
}

// The reference engines: pass by pass, everything in full.
void Renderer::Impl::draw_reference(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result) {
    const bool tracing = options.engine == Engine::kReferenceTrace;
    if (tracing && !is_centred(frame.projection))
        throw Error(ErrorCode::kUsage, "reference-trace needs a picture that is centred on the camera's axis");
    ReferenceEngine engine(frame, shading.context(), tracing, options.shadows);
    const RasterTargets targets = make_planes(options, result);
    watch.phase("build");

    if (targets.colors()) {
        Canvas canvas(options);
        const std::vector<SamplePosition> positions = sample_positions(options);
        for (int sample = 0; sample < options.samples; ++sample) {
            const SamplePosition offset = positions[static_cast<std::size_t>(sample)];
            const Visibility seen = engine.see(offset, watchdog.control(2 * sample, 2 * options.samples));
            add_counters(result.stats, seen.counters, sample == 0);
            watch.phase("visibility");
            canvas.take_sample(sample, engine, seen, offset,
                               watchdog.control(2 * sample + 1, 2 * options.samples).checkpoint);
            watch.phase("shading");
        }
        canvas.develop(shading.film(options), targets, result.stats);
        watch.phase("film");
    }
    if (targets.labels()) {
        const LabelCounts labels = take_labels(engine, watchdog.control(0, targets.colors() ? 0 : 1), targets);
        if (!targets.colors()) add_counters(result.stats, labels);
        watch.phase("labels");
    }
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::draw(RenderResult& result) { draw(impl_->options.view, result); }
void Renderer::draw(const View& view, RenderResult& result) { draw(view, impl_->options.moment, result); }
void Renderer::draw(const View& view, const Moment& moment, RenderResult& result) { impl_->draw(view, moment, result); }
const RenderOptions& Renderer::options() const { return impl_->options; }

RenderResult render(const Scene& scene, const RenderOptions& options) {
    RenderStats whole;
    Stopwatch watch(whole);
    Renderer renderer(scene, options);
    watch.phase("prepare");
    RenderResult result;
    renderer.draw(result);
    if (options.want_color) result.stats.color_hash = hash_pixels(result.color);
    watch.finish();
    auto& phases = result.stats.phases_ms;
    phases.insert(phases.begin(), whole.phases_ms.front());
    result.stats.frame_ms = whole.frame_ms;
    result.stats.cpu_ms = whole.cpu_ms;
    return result;
}

}  // namespace tessera
