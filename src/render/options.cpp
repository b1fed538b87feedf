#include "render/options.h"

#include <tessera/error.h>

#include "core/sampling.h"
#include "image/color.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

namespace tessera {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::kUsage, message); }

// 512 transparent layers all over a tile; some hundred MiB of working memory per thread.
constexpr std::size_t kMostFragmentsPerTile = 512 * 64 * 64;

// Depth, triangle and colour of every pixel while it is made, and the finished colour; a wide filter's
// sums and its flag; a stage's numbers; planes of labels, and for motion what is seen at the other shots.
std::uint64_t picture_bytes(const RenderOptions& o) {
    const auto pixels = static_cast<std::uint64_t>(o.width) * static_cast<std::uint64_t>(o.height);
    const auto count = [](std::initializer_list<bool> wanted) {
        return static_cast<std::uint64_t>(std::count(wanted.begin(), wanted.end(), true));
    };
    const std::uint64_t labels =
        4 * count({o.want_alpha, o.want_depth, o.want_primitive, o.want_node, o.want_material}) +
        12 * count({o.want_normal, o.want_shading_normal, o.want_position, o.want_albedo}) + 8 * count({o.want_uv}) +
        36 * count({o.want_motion}) + 16 * count({o.want_linear || o.want_alpha});
    return pixels * (4 + 4 + 16 + 4 + (o.filter == PixelFilter::kBox ? 0 : 16 + 1) +
                     (o.show == Stage::kPicture ? 0 : 4) + labels);
}

void check_stroke(const char* what, float pixels) {
    if (!(pixels >= kLeastStroke && pixels <= kMostStroke)) refuse(std::string(what) + " must be 0.1 to 256 pixels");
}

void check_stage(const RenderOptions& o) {
    if (o.show > Stage::kCost) refuse("unknown stage");
    if (o.show == Stage::kPicture) return;
    if (o.engine != Engine::kRaster) refuse(std::string(name(o.engine)) + " has no tiles: no stage to show");
    if (o.filter != PixelFilter::kBox) refuse("stages are shown with the box filter only");
    if (!o.want_color) refuse("stages are shown in the colour plane, which is not wanted");
}

}  // namespace

const char* name(Engine engine) {
    switch (engine) {
        case Engine::kRaster:
            return "raster";
        case Engine::kTrace:
            return "trace";
        case Engine::kHybrid:
            return "hybrid";
        case Engine::kReferenceRaster:
            return "reference-raster";
        case Engine::kReferenceTrace:
            return "reference-trace";
    }
    return "unknown";
}

void check_options(const RenderOptions& o) {
    if (o.width < 1 || o.height < 1 || o.width > kMaxImageSide || o.height > kMaxImageSide)
        refuse("picture size " + std::to_string(o.width) + "x" + std::to_string(o.height) + ": sides must be 1 to " +
               std::to_string(kMaxImageSide));
    if (o.engine > Engine::kReferenceTrace) refuse("unknown engine");
    if (o.encoding > Encoding::kLinear) refuse("unknown encoding");
    if (o.label_space > LabelSpace::kOpenCvCamera) refuse("unknown space of labels");
    const int side = o.raster.tile_side;
    if (side != 0 && side != 32 && side != 64 && side != 128) refuse("tile sides are 32, 64 or 128 pixels");
    if (o.samples < 1 || o.samples > 256) refuse("samples must be 1 to 256");
    check_stroke("point size", o.point_size);
    check_stroke("line width", o.line_width);
    if (o.exposure_ev && !(std::fabs(*o.exposure_ev) <= 64.0f)) refuse("exposure must be within 64 EV");
    if (o.ambient && !(*o.ambient >= 0.0f && *o.ambient < 1e9f)) refuse("ambient radiance must not be negative");
    if (o.threads < 0) refuse("threads must not be negative");
    if (o.background)
        for (const float c : {o.background->x, o.background->y, o.background->z, o.background->w})
            if (!(c >= 0.0f && c <= 1.0f)) refuse("background components must be 0 to 1");
    if (o.filter > PixelFilter::kMitchell) refuse("unknown filter");
    check_stage(o);
    if (o.shadows > Shadows::kTraced) refuse("unknown kind of shadows");
    if (o.shadows == Shadows::kTraced && o.engine == Engine::kReferenceRaster)
        refuse("reference-raster traces no shadows");
    if (o.max_depth < 0 || o.max_depth > 64) refuse("the depth of traced light must be 0 to 64");
    if (!(o.min_contribution >= 0.0f && o.min_contribution <= 1.0f)) refuse("the least contribution must be 0 to 1");
    resolve_isa(o.isa);
    const auto pixels = static_cast<std::uint64_t>(o.width) * static_cast<std::uint64_t>(o.height);
    if (picture_bytes(o) > o.max_bytes)
        throw Error(ErrorCode::kLimit, "a picture of " + std::to_string(pixels) +
                                           " pixels needs more memory than the limit of " +
                                           std::to_string(o.max_bytes) + " bytes");
}

FilmView film_view(const RenderOptions& options, double exposure) {
    FilmView film{};
    film.exposure = static_cast<float>(exposure);
    film.tone_map = options.tone_map;
    film.encoding = options.encoding;
    if (options.background) {
        const Vec4& b = *options.background;
        const float stored[3] = {b.x, b.y, b.z};
        for (int i = 0; i < 3; ++i)
            film.background[i] = options.encoding == Encoding::kLinear
                                     ? stored[i]
                                     : static_cast<float>(linear_from_srgb(static_cast<double>(stored[i])));
        film.background[3] = b.w;
    }
    return film;
}

StrokeStyle stroke_style(const RenderOptions& options) {
    // For motion there are three frames at a time.
    const std::uint64_t bytes = options.max_bytes - picture_bytes(options);
    return {options.point_size, options.line_width, options.want_motion ? bytes / 3 : bytes};
}

std::vector<SamplePosition> sample_positions(const RenderOptions& options) {
    std::vector<SamplePosition> positions;
    for (int sample = 0; sample < options.samples; ++sample) {
        const SampleOffset s = sample_offset(sample, options.samples);
        positions.push_back({s.x, s.y});
    }
    return positions;
}

bool is_parallel(Engine engine) { return engine < Engine::kReferenceRaster; }

bool traces_shadows(const RenderOptions& o) {
    if (o.shadows == Shadows::kAuto) return o.engine != Engine::kRaster && o.engine != Engine::kReferenceRaster;
    return o.shadows == Shadows::kTraced;
}

bool traces_bounces(const RenderOptions& o) {
    return o.max_depth > 0 && o.engine != Engine::kRaster && o.engine != Engine::kReferenceRaster;
}

TransportSettings transport_settings(const RenderOptions& options, const FilmView& film) {
    TransportSettings settings;
    settings.shadows = traces_shadows(options);
    settings.bounces = traces_bounces(options);
    settings.max_depth = options.max_depth;
    settings.least = options.min_contribution;
    // The film lays the background below what is developed: as radiance it is that over the exposure.
    for (int i = 0; i < 3; ++i) settings.background[i] = film.background[i] * film.background[3] / film.exposure;
    return settings;
}

std::optional<ReferenceTransport> reference_transport(const RenderOptions& options, const FilmView& film,
                                                      const Frame& frame) {
    if (!traces_shadows(options) && !traces_bounces(options) && !frame.has_exact_shapes) return std::nullopt;
    const TransportSettings s = transport_settings(options, film);
    ReferenceTransport t{s.shadows, s.bounces, s.max_depth, s.least, {}};
    std::copy_n(s.background, 3, t.background);
    return t;
}

RasterSettings raster_settings(const RenderOptions& options, const FilmView& film, const RunControl& control) {
    RasterSettings settings;
    settings.samples = sample_positions(options);
    settings.film = film;
    settings.isa = resolve_isa(options.isa);
    settings.tile_side = options.raster.tile_side;
    settings.hierarchical_z = options.raster.hierarchical_z;
    settings.count = options.raster.count_samples;
    settings.max_fragments = std::min(control.max_fragments, kMostFragmentsPerTile);
    settings.checkpoint = control.checkpoint;
    return settings;
}

RunControl Watchdog::control(int step, int steps) const {
    RunControl control;
    control.max_fragments = static_cast<std::size_t>((options_.max_bytes - picture_bytes(options_)) / sizeof(Fragment));
    control.checkpoint = [this, step, steps](double part) {
        if (!options_.cancel && !options_.progress) return;
        const std::lock_guard lock(mutex_);
        if (options_.cancel && options_.cancel()) throw Error(ErrorCode::kCancelled, "cancelled");
        const double done = steps > 0 ? (step + std::min(part, 1.0)) / steps : -1.0;
        if (options_.progress && done > reported_) options_.progress(reported_ = done);
    };
    return control;
}

}  // namespace tessera
