// The renderer on one page: scene -> frame -> shading -> visibility and shading -> film. Everything that
// happens to a picture happens here, in this order.
#include <tessera/error.h>
#include <tessera/renderer.h>

#include "core/fp_environment.h"
#include "raster/engine.h"
#include "reference/engine.h"
#include "render/canvas.h"
#include "render/labels.h"
#include "render/motion.h"
#include "render/options.h"
#include "render/shading_scene.h"
#include "render/stage_picture.h"
#include "render/stopwatch.h"
#include "trace/engine.h"

#include <optional>

namespace tessera {

// Everything that outlives a frame.
struct Renderer::Impl {
    Impl(const Scene& s, const RenderOptions& o)
        : scene(s),
          options(o),
          arena(o.threads),
          prepared(s, &arena, is_parallel(o.engine) ? resolve_isa(o.isa) : Isa::kScalar),
          shading(s, prepared.used_materials(), arena, warnings) {
        warn_of_transmission();
        const bool wide = o.filter != PixelFilter::kBox && (o.want_color || o.want_linear || o.want_alpha);
        if (!is_parallel(o.engine) || !wide) return;
        filter.emplace(o, &arena);
        sample_plane.resize(filter->plane_floats());
    }

    void warn_of_transmission();
    void draw(const Shot& now, const Shot& before, const Shot& after, RenderResult& result);
    PictureTargets make_targets(RenderResult& result);
    void see_other(const Shot& shot, const Watchdog& watchdog, OtherShot& other);
    void draw_tiles(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result);
    void draw_reference(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result);

    const Scene& scene;
    const RenderOptions options;
    std::vector<std::string> warnings;  // of the materials
    Arena arena;
    PreparedScene prepared;
    ShadingScene shading;
    Frame frame;                           // the latest
    OtherShot before, after;               // that motion is measured to
    std::vector<std::uint32_t> triangles;  // for motion: 1 + number of the one that each pixel shows
    RasterEngine raster;
    std::optional<LightTracer> tracer;  // where anything is traced
    // Of filters wider than the pixel: the sums, and the picture of one sample, linear RGBA.
    std::optional<FilterPass> filter;
    std::vector<float> sample_plane;
};

// What the picture lacks where no light is traced.
void Renderer::Impl::warn_of_transmission() {
    if (traces_bounces(options)) return;
    const std::vector<bool> used = prepared.used_materials();
    for (std::size_t m = 0; m < scene.materials.size(); ++m)
        if (used[m] && scene.materials[m].transmission > 0)
            return warnings.push_back(
                "material " + std::to_string(m) +
                " lets light through, and is drawn as opaque: that takes --engine trace or hybrid "
                "and a depth of traced light above 0");
}

Renderer::Renderer(const Scene& scene, const RenderOptions& options) {
    check_options(options);
    validate(scene);
    const FpEnvironment exact;
    impl_ = std::make_unique<Impl>(scene, options);
}

void Renderer::Impl::draw(const Shot& now, const Shot& earlier, const Shot& later, RenderResult& result) {
    const FpEnvironment exact;
    result.stats = {};
    Stopwatch watch(result.stats);
    const Watchdog watchdog(options);
    const bool from = options.want_motion && earlier != now, to = options.want_motion && later != now;
    if (from) see_other(earlier, watchdog, before);
    if (to) see_other(later, watchdog, after);
    if (from || to) watch.phase("other shots");

    prepared.move_to(now.moment);
    frame.keep_nodes = options.want_motion;
    frame.exact_shapes = options.engine == Engine::kTrace || options.engine == Engine::kReferenceTrace;
    make_frame(prepared, now.view, options.width, options.height, stroke_style(options), frame);
    if ((options.engine == Engine::kTrace || options.engine == Engine::kReferenceTrace) && !is_square(frame.projection))
        throw Error(ErrorCode::kUsage,
                    std::string(name(options.engine)) + " needs a picture that is square to the camera's axes");
    shading.light(scene, frame, options);
    watch.phase("evaluate");

    if (is_parallel(options.engine))
        draw_tiles(watchdog, watch, result);
    else
        draw_reference(watchdog, watch, result);
    if (options.want_motion) {
        measure_motion(frame, triangles.data(), shading.context().materials, to ? &after : nullptr,
                       from ? &before : nullptr, arena,
                       {result.motion.data<float>(), result.motion_seen.data<std::uint32_t>()});
        watch.phase("motion");
    }
    finish_planes(options, result);

    result.warnings = frame.warnings;
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
    result.stats.engine = options.engine;
    result.stats.exposure = shading.exposure();
    result.stats.points = frame.points;
    result.stats.lines = frame.lines;
    watch.finish();
}

PictureTargets Renderer::Impl::make_targets(RenderResult& result) {
    PictureTargets targets = make_planes(options, result);
    set_label_space(options, frame, targets);
    if (options.want_motion) {
        triangles.resize(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
        targets.labels.triangle = triangles.data();
    }
    return targets;
}

// What is to be seen at another shot.
void Renderer::Impl::see_other(const Shot& shot, const Watchdog& watchdog, OtherShot& other) {
    prepared.move_to(shot.moment);
    other.frame.keep_nodes = true;
    make_frame(prepared, shot.view, options.width, options.height, stroke_style(options), other.frame);
    other.keep_positions();
    shading.light(scene, other.frame, options);
    other.seen.resize(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
    PictureTargets targets;
    targets.labels.triangle = other.seen.data();
    if (is_parallel(options.engine)) {
        raster.draw(other.frame, shading.context(),
                    raster_settings(options, shading.film(options), watchdog.control(0, 0)), targets, arena);
        return;
    }
    ReferenceEngine engine = options.engine == Engine::kReferenceTrace
                                 ? ReferenceEngine(other.frame, shading.context(), std::nullopt)
                                 : ReferenceEngine(other.frame, shading.context());
    take_labels(engine, other.frame, watchdog.control(0, 0), targets);
}

// The engines of tiles: visibility, shading and film inside each tile, light by rays where it is traced. With a filter
// that is wider than the pixel, linear pictures of one sample each, and the film after the last of them.
void Renderer::Impl::draw_tiles(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result) {
    const PictureTargets targets = make_targets(result);
    RasterSettings settings = raster_settings(options, shading.film(options), watchdog.control(0, 1));
    result.stats.isa = settings.isa;
    result.stats.threads = arena.threads();
    // Tiles know triangles; what is drawn by its formula is shaded by the ray tracer.
    const bool traced = traces_shadows(options) || traces_bounces(options) || frame.has_exact_shapes;
    if (traced || options.engine == Engine::kTrace) {
        if (!tracer) tracer.emplace(settings.isa, options.max_bytes);
        tracer->begin(frame, shading.context(), transport_settings(options, settings.film), arena);
        if (traced) settings.shaders = &*tracer;
        watch.phase("build");
    }
    const auto draw = [&](const PictureTargets& to, bool first) {
        if (options.engine == Engine::kTrace)
            add_counters(result.stats, tracer->draw(frame, shading.context(), settings, to, arena), first);
        else
            add_counters(result.stats, raster.draw(frame, shading.context(), settings, to, arena), first);
        watch.phase("tiles");
    };
    settings.inspection = make_stage_plane(options, result);
    if (!filter) {
        draw(targets, true);
        if (tracer) add_counters(result.stats, *tracer);
        if (options.show != Stage::kPicture) paint_stage(options.show, result.stats.tile_side, result);
        return;
    }

    filter->restart();
    const std::vector<SamplePosition> positions = std::move(settings.samples);
    PictureTargets sample_targets = targets;
    sample_targets.rgba = nullptr;
    sample_targets.linear = sample_plane.data();
    for (int sample = 0; sample < options.samples; ++sample) {
        settings.samples.assign(1, positions[static_cast<std::size_t>(sample)]);
        settings.checkpoint = watchdog.control(sample, options.samples).checkpoint;
        draw(sample_targets, sample == 0);
        sample_targets.labels = {};  // done with the first one
        filter->add(sample, sample_plane.data(), watchdog.control(0, 0).checkpoint);
        watch.phase("filter");
    }
    develop_picture(filter->finish(), 1.0f, settings.film, options, &arena, targets);
    if (tracer) add_counters(result.stats, *tracer);
    result.stats.pixels_covered = filter->pixels_covered();
    watch.phase("film");
}

// The reference engines: pass by pass, everything in full.
void Renderer::Impl::draw_reference(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result) {
    const bool tracing = options.engine == Engine::kReferenceTrace;
    ReferenceEngine engine =
        tracing ? ReferenceEngine(frame, shading.context(), reference_transport(options, shading.film(options), frame))
                : ReferenceEngine(frame, shading.context());
    const PictureTargets targets = make_targets(result);
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
    if (targets.labels.any()) {
        const LabelCounts labels = take_labels(engine, frame, watchdog.control(0, targets.colors() ? 0 : 1), targets);
        if (!targets.colors()) {
            add_counters(result.stats, labels.counters, true);
            result.stats.pixels_covered = labels.pixels;
        }
        watch.phase("labels");
    }
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::draw(RenderResult& result) { draw(impl_->options.view, result); }
void Renderer::draw(const View& view, RenderResult& result) { draw(view, impl_->options.moment, result); }
void Renderer::draw(const View& view, const Moment& moment, RenderResult& result) {
    const Shot now{view, moment};
    draw(now, options().motion_before.value_or(now), options().motion_after.value_or(now), result);
}
void Renderer::draw(const Shot& now, const Shot& before, const Shot& after, RenderResult& result) {
    impl_->draw(now, before, after, result);
}
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
