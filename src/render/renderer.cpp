// The renderer on one page: scene -> frame -> shading -> visibility and shading -> film. Everything that
// happens to a picture happens here, in this order.
#include <tessera/error.h>
#include <tessera/renderer.h>

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
constexpr std::size_t kMostFragmentsPerTile = 512 * 64 * 64;

}  // namespace

// Everything that outlives a frame.
struct Renderer::Impl {
    Impl(const Scene& s, const RenderOptions& o)
        : scene(s), options(o), arena(o.threads), prepared(s), shading(s, prepared.used_materials(), arena, warnings) {}

    void draw(const View& view, RenderResult& result);
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
};

Renderer::Renderer(const Scene& scene, const RenderOptions& options) {
    check_options(options);
    validate(scene);
    const FpEnvironment exact;
    impl_ = std::make_unique<Impl>(scene, options);
}

void Renderer::Impl::draw(const View& view, RenderResult& result) {
    const FpEnvironment exact;
    result.stats = {};
    Stopwatch watch(result.stats);
    const Watchdog watchdog(options);

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

// The tile rasterizer: visibility, shading and film inside each tile.
void Renderer::Impl::draw_tiles(const Watchdog& watchdog, Stopwatch& watch, RenderResult& result) {
    RasterSettings settings;
    for (int sample = 0; sample < options.samples; ++sample) {
        const SampleOffset s = sample_offset(sample, options.samples);
        settings.samples.push_back({s.x, s.y});
    }
    const RunControl control = watchdog.control(0, 1);
    settings.film = shading.film(options);
    settings.isa = resolve_isa(options.isa);
    settings.max_fragments = std::min(control.max_fragments, kMostFragmentsPerTile);
    settings.checkpoint = control.checkpoint;
    settings.tile_side = options.raster.tile_side;
    settings.hierarchical_z = options.raster.hierarchical_z;
    settings.count = options.raster.count_samples;
    const RasterTargets targets = make_planes(options, result);
    add_counters(result.stats, raster.draw(frame, shading.context(), settings, targets, arena));
    watch.phase("tiles");
    result.stats.isa = settings.isa;
    result.stats.threads = arena.threads();
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
        for (int sample = 0; sample < options.samples; ++sample) {
            const SampleOffset s = sample_offset(sample, options.samples);
            const SamplePosition offset{s.x, s.y};
            const Visibility seen = engine.see(offset, watchdog.control(2 * sample, 2 * options.samples));
            add_counters(result.stats, seen.counters, sample == 0);
            watch.phase("visibility");
            shade_pass(engine, seen, offset, canvas, watchdog.control(2 * sample + 1, 2 * options.samples).checkpoint);
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

void Renderer::draw(RenderResult& result) { impl_->draw(impl_->options.view, result); }
void Renderer::draw(const View& view, RenderResult& result) { impl_->draw(view, result); }
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
