#include "reference/engine.h"

namespace tessera {
namespace {

// Below this many triangles a hierarchy is not worth its building.
constexpr std::uint32_t kBruteForce = 32;

SamplePosition position(const Visibility& v, std::size_t pixel, SamplePosition offset) {
    const auto width = static_cast<std::size_t>(v.width);
    return {256 * static_cast<std::int32_t>(pixel % width) + offset.x,
            256 * static_cast<std::int32_t>(pixel / width) + offset.y};
}

}  // namespace

ReferenceEngine::ReferenceEngine(const Frame& frame, const ShadingContext& context, bool tracing)
    : frame_(frame), context_(context), sampler_(frame, context) {
    if (tracing) bvh_ = std::make_unique<Bvh>(frame, frame.triangle_count <= kBruteForce);
}

ReferenceEngine::ReferenceEngine(const Frame& frame, const ShadingContext& context,
                                 const std::optional<ReferenceTransport>& transport)
    : ReferenceEngine(frame, context, true) {
    if (transport) light_ = std::make_unique<LightTracerReference>(frame, *bvh_, context, *transport);
}

Visibility ReferenceEngine::see(SamplePosition offset, const RunControl& control) const {
    return bvh_ ? cast_rays(frame_, *bvh_, context_, offset, control) : rasterize(frame_, context_, offset, control);
}

ShadedPoint<float> ReferenceEngine::shade_triangle(std::uint32_t triangle, SamplePosition at) {
    if (light_) return light_->shade(triangle, at, sampler_);
    const SurfacePoint<float> point = sampler_.point(triangle, at);
    return shade(context_, sampler_.material(triangle), point,
                 [](int, const LightSample<float>&) { return Unshadowed{}; });
}

SampleColor ReferenceEngine::shade_sample(const Visibility& visibility, std::size_t pixel, SamplePosition offset,
                                          const Fragment* transparent, const Fragment* transparent_end) {
    const SamplePosition at = position(visibility, pixel, offset);
    SampleColor c{{0, 0, 0}, 0};
    if (const std::uint32_t triangle = visibility.triangle[pixel]; triangle != 0) {
        const ShadedPoint<float> s = shade_triangle(triangle - 1, at);
        c = {s.radiance, light_ ? s.alpha : 1.0f};
    }
    for (; transparent != transparent_end; ++transparent) {
        const ShadedPoint<float> s = shade_triangle(transparent->triangle, at);
        c.premultiplied = s.radiance * s.alpha + c.premultiplied * (1.0f - s.alpha);
        c.alpha = s.alpha + c.alpha * (1.0f - s.alpha);
    }
    return c;
}

}  // namespace tessera
