#include "render/canvas.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

// The one NaN that may be: a file with broken numbers gives the same bits everywhere.
float without_nan(float value) { return value == value ? value : 0.0f; }

}  // namespace

Canvas::Canvas(const RenderOptions& options) : options_(options) {
    const auto pixels = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
    sums_.assign(4 * pixels, 0.0f);
    hit_.assign(pixels, 0);
    if (options.filter != PixelFilter::kBox) filter_.emplace(options, nullptr);
}

void Canvas::end_sample(int sample, const std::function<void(double)>& checkpoint) {
    if (!filter_) return;
    for (float& value : sums_) value = without_nan(value);
    filter_->add(sample, sums_.data(), checkpoint);
    std::fill(sums_.begin(), sums_.end(), 0.0f);
}

void Canvas::develop(const FilmView& film, RenderResult& result) {
    if (filter_) std::vector<float>().swap(sums_);  // the filter has its own
    make_color_planes(options_, result);
    if (filter_) {
        develop_picture(filter_->finish(), 1.0f, film, options_, nullptr, result);
        result.stats.pixels_covered = filter_->pixels_covered();
        return;
    }
    develop_picture(sums_.data(), 1.0f / static_cast<float>(options_.samples), film, options_, nullptr, result);
    for (const char hit : hit_) result.stats.pixels_covered += hit != 0;
}

void make_color_planes(const RenderOptions& options, RenderResult& result) {
    result.color = Image(options.width, options.height, PixelFormat::kRgba8);
    if (options.want_linear) result.linear = Image(options.width, options.height, PixelFormat::kRgba32f);
}

void develop_picture(const float* sums, float weight, const FilmView& film, const RenderOptions& options, Arena* arena,
                     RenderResult& result) {
    auto* color = result.color.data<std::uint8_t>();
    float* linear = options.want_linear ? result.linear.data<float>() : nullptr;
    for_each_row(options.height, arena, [&](int y) {
        const auto width = static_cast<std::size_t>(options.width), row = static_cast<std::size_t>(y) * width;
        for (std::size_t pixel = row; pixel < row + width; ++pixel) {
            const float* sum = sums + 4 * pixel;
            const Vec3T<float> mean{sum[0] * weight, sum[1] * weight, sum[2] * weight};
            const float alpha = sum[3] * weight;
            const DisplayPixel<float> d = develop(film, mean, alpha);
            color[4 * pixel + 0] = static_cast<std::uint8_t>(d.r);
            color[4 * pixel + 1] = static_cast<std::uint8_t>(d.g);
            color[4 * pixel + 2] = static_cast<std::uint8_t>(d.b);
            color[4 * pixel + 3] = static_cast<std::uint8_t>(d.a);
            if (!linear) continue;
            const float values[4] = {mean.x, mean.y, mean.z, alpha};
            for (std::size_t i = 0; i < 4; ++i) linear[4 * pixel + i] = without_nan(values[i]);
        }
    });
}

void take_labels(ReferenceEngine& engine, const RunControl& control, const RenderOptions& options,
                 RenderResult& result) {
    const SamplePosition centre{128, 128};
    const Visibility seen = engine.see(centre, control);
    std::vector<std::uint32_t> nearest = seen.triangle;
    // Fragments come far to near: the last one that is solid enough wins.
    for (const Fragment& f : seen.transparent) {
        const auto width = static_cast<std::uint32_t>(seen.width);
        const SamplePosition at{256 * static_cast<std::int32_t>(f.pixel % width) + centre.x,
                                256 * static_cast<std::int32_t>(f.pixel / width) + centre.y};
        if (engine.sampler().alpha(f.triangle, at) >= 0.5f) nearest[f.pixel] = f.triangle + 1;
    }
    if (options.want_primitive) {
        result.primitive = Image(options.width, options.height, PixelFormat::kU32);
        auto* out = result.primitive.data<std::uint32_t>();
        for (std::size_t i = 0; i < nearest.size(); ++i) out[i] = nearest[i];
    }
    if (!options.want_depth) return;
    result.depth = Image(options.width, options.height, PixelFormat::kF32);
    float* out = result.depth.data<float>();
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const auto width = static_cast<std::size_t>(seen.width);
        const SamplePosition at{256 * static_cast<std::int32_t>(i % width) + centre.x,
                                256 * static_cast<std::int32_t>(i / width) + centre.y};
        out[i] = nearest[i] == 0 ? std::numeric_limits<float>::infinity()
                                 : -engine.sampler().point(nearest[i] - 1, at).position.z;
    }
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
    stats.fragments_passed += counters.fragments_passed;
    if (!first) return;
    stats.triangles = counters.triangles;
    stats.culled_frustum = counters.front.frustum;
    stats.culled_backface = counters.front.backface;
    stats.culled_degenerate = counters.front.degenerate;
    stats.clipped = counters.front.clipped;
    stats.pixels_covered = counters.pixels_covered;
}

RasterTargets make_planes(const RenderOptions& options, RenderResult& result) {
    RasterTargets targets;
    const int w = options.width, h = options.height;
    make_color_planes(options, result);
    targets.rgba = result.color.data<std::uint8_t>();
    if (options.want_linear) targets.linear = result.linear.data<float>();
    if (options.want_depth) {
        result.depth = Image(w, h, PixelFormat::kF32);
        targets.distance = result.depth.data<float>();
    }
    if (options.want_primitive) {
        result.primitive = Image(w, h, PixelFormat::kU32);
        targets.triangle = result.primitive.data<std::uint32_t>();
    }
    return targets;
}

}  // namespace tessera
