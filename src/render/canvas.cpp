#include "render/canvas.h"

#include <algorithm>

namespace tessera {
namespace {

// The one NaN that may be: a file with broken numbers gives the same bits everywhere.
float without_nan(float value) { return value == value ? value : 0.0f; }

// The plane's pixels, with the memory that it has when size and format are right; null when not wanted.
template <class T>
T* make_plane(bool wanted, const RenderOptions& options, PixelFormat format, Image& plane) {
    const bool fits = plane.width() == options.width && plane.height() == options.height && plane.format() == format;
    if (!wanted)
        plane = {};
    else if (plane.empty() || !fits)
        plane = Image(options.width, options.height, format);
    return wanted ? plane.data<T>() : nullptr;
}

}  // namespace

Canvas::Canvas(const RenderOptions& options) : options_(options) {
    const auto pixels = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
    sums_.assign(4 * pixels, 0.0f);
    hit_.assign(pixels, 0);
    if (options.filter != PixelFilter::kBox) filter_.emplace(options, nullptr);
}

void Canvas::take_sample(int sample, ReferenceEngine& engine, const Visibility& seen, SamplePosition offset,
                         const std::function<void(double)>& checkpoint) {
    const Fragment* transparent = seen.transparent.data();
    const Fragment* const end = transparent + seen.transparent.size();
    for (std::size_t pixel = 0; pixel < seen.depth.size(); ++pixel) {
        if (pixel % static_cast<std::size_t>(seen.width) == 0)
            checkpoint(static_cast<double>(pixel) / static_cast<double>(seen.depth.size()));
        const Fragment* const first = transparent;
        while (transparent != end && transparent->pixel == pixel) ++transparent;
        if (seen.triangle[pixel] == 0 && first == transparent) continue;
        hit_[pixel] = 1;
        add(pixel, engine.shade_sample(seen, pixel, offset, first, transparent));
    }
    if (!filter_) return;
    for (float& value : sums_) value = without_nan(value);
    filter_->add(sample, sums_.data(), checkpoint);
    std::fill(sums_.begin(), sums_.end(), 0.0f);
}

void Canvas::develop(const FilmView& film, const PictureTargets& targets, RenderStats& stats) {
    if (filter_) {
        develop_picture(filter_->finish(), 1.0f, film, options_, nullptr, targets);
        stats.pixels_covered = filter_->pixels_covered();
        return;
    }
    for (const char hit : hit_) stats.pixels_covered += hit != 0;
    develop_picture(sums_.data(), 1.0f / static_cast<float>(options_.samples), film, options_, nullptr, targets);
}

void develop_picture(const float* sums, float weight, const FilmView& film, const RenderOptions& options, Arena* arena,
                     const PictureTargets& targets) {
    for_each_row(options.height, arena, [&](int y) {
        const auto width = static_cast<std::size_t>(options.width), row = static_cast<std::size_t>(y) * width;
        for (std::size_t pixel = row; pixel < row + width; ++pixel) {
            const float* sum = sums + 4 * pixel;
            const Vec3T<float> mean{sum[0] * weight, sum[1] * weight, sum[2] * weight};
            const float alpha = sum[3] * weight;
            if (targets.rgba) {
                const DisplayPixel<float> d = develop(film, mean, alpha);
                targets.rgba[4 * pixel + 0] = static_cast<std::uint8_t>(d.r);
                targets.rgba[4 * pixel + 1] = static_cast<std::uint8_t>(d.g);
                targets.rgba[4 * pixel + 2] = static_cast<std::uint8_t>(d.b);
                targets.rgba[4 * pixel + 3] = static_cast<std::uint8_t>(d.a);
            }
            if (!targets.linear) continue;
            const float values[4] = {mean.x, mean.y, mean.z, alpha};
            for (std::size_t i = 0; i < 4; ++i) targets.linear[4 * pixel + i] = without_nan(values[i]);
        }
    });
}

void add_counters(RenderStats& stats, const VisibilityCounters& counters, bool first) {
    stats.fragments_passed += counters.fragments_passed;
    if (!first) return;
    stats.triangles = counters.triangles;
    stats.culled_frustum = counters.culled_frustum;
    stats.culled_backface = counters.culled_backface;
    stats.culled_degenerate = counters.culled_degenerate;
    stats.clipped = counters.clipped;
}

void add_counters(RenderStats& stats, const RasterCounters& counters, bool first) {
    stats.samples_tested += counters.tiles.samples_covered;
    stats.fragments_passed += counters.tiles.fragments_passed;
    stats.blocks_drawn += counters.tiles.blocks_drawn;
    stats.blocks_hidden += counters.tiles.blocks_hidden;
    if (!first) return;
    stats.triangles = counters.triangles;
    stats.culled_frustum = counters.front.frustum;
    stats.culled_backface = counters.front.backface;
    stats.culled_degenerate = counters.front.degenerate;
    stats.clipped = counters.front.clipped;
    stats.culled_no_sample = counters.front.no_sample;
    stats.small_triangles = counters.front.small;
    stats.large_triangles = counters.front.large;
    stats.pixels_covered = counters.pixels_covered;
    stats.tile_side = counters.tile_side;
}

void add_counters(RenderStats& stats, const TraceCounters& counters, bool first) {
    stats.primary_rays += counters.primary_rays;
    stats.fragments_passed += counters.hits;
    if (!first) return;
    stats.pixels_covered = counters.pixels_covered;
    stats.tile_side = counters.tile_side;
}

void add_counters(RenderStats& stats, const LightTracer& tracer) {
    const TransportCounters c = tracer.counters();
    stats.shadow_rays = c.shadow_rays;
    stats.mirrored_rays = c.mirrored_rays;
    stats.refracted_rays = c.refracted_rays;
    stats.straight_rays = c.straight_rays;
    stats.ended_by_depth = c.ended_by_depth;
    stats.ended_by_contribution = c.ended_by_contribution;
    const BuildStatistics& b = tracer.build();
    stats.hierarchies = b.groups;
    stats.hierarchies_built = b.built;
    stats.hierarchies_refitted = b.refitted;
    stats.hierarchy_bytes = b.bytes;
}

PictureTargets make_planes(const RenderOptions& o, RenderResult& result) {
    PictureTargets targets;
    targets.rgba = make_plane<std::uint8_t>(o.want_color, o, PixelFormat::kRgba8, result.color);
    // Alpha is taken from it.
    targets.linear = make_plane<float>(o.want_linear || o.want_alpha, o, PixelFormat::kRgba32f, result.linear);
    make_plane<float>(o.want_alpha, o, PixelFormat::kF32, result.alpha);
    LabelPlanes& labels = targets.labels;
    labels.distance = make_plane<float>(o.want_depth, o, PixelFormat::kF32, result.depth);
    labels.primitive = make_plane<std::uint32_t>(o.want_primitive, o, PixelFormat::kU32, result.primitive);
    labels.node = make_plane<std::uint32_t>(o.want_node, o, PixelFormat::kU32, result.node);
    labels.material = make_plane<std::uint32_t>(o.want_material, o, PixelFormat::kU32, result.material);
    labels.normal = make_plane<float>(o.want_normal, o, PixelFormat::kRgb32f, result.normal);
    labels.shading_normal = make_plane<float>(o.want_shading_normal, o, PixelFormat::kRgb32f, result.shading_normal);
    labels.position = make_plane<float>(o.want_position, o, PixelFormat::kRgb32f, result.position);
    labels.albedo = make_plane<float>(o.want_albedo, o, PixelFormat::kRgb32f, result.albedo);
    labels.uv = make_plane<float>(o.want_uv, o, PixelFormat::kRg32f, result.uv);
    make_plane<float>(o.want_motion, o, PixelFormat::kRgba32f, result.motion);
    make_plane<std::uint32_t>(o.want_motion, o, PixelFormat::kU32, result.motion_seen);
    targets.euclidean = o.euclidean_depth;
    return targets;
}

void finish_planes(const RenderOptions& options, RenderResult& result) {
    if (options.want_alpha) {
        const float* const linear = result.linear.data<float>();
        float* const alpha = result.alpha.data<float>();
        const auto pixels = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
        for (std::size_t i = 0; i < pixels; ++i) alpha[i] = linear[4 * i + 3];
    }
    if (!options.want_linear) result.linear = {};
}

}  // namespace tessera
