#include "reference/raycaster.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {

CastRay primary_ray(const ProjectionView& projection, SamplePosition at) {
    const Vec2T<float> ndc = sample_ndc<float>(at.x, at.y, projection.width, projection.height);
    // Where the axis meets the picture: clip x = m[0] x + m[2] z + m[3], and w is -z or 1.
    const float* m = projection.clip_from_camera;
    const double middle_x = projection.orthographic ? m[3] : -m[2], middle_y = projection.orthographic ? m[7] : -m[6];
    const double x = (static_cast<double>(ndc.x) - middle_x) / projection.scale_x,
                 y = (static_cast<double>(ndc.y) - middle_y) / projection.scale_y;
    if (projection.orthographic) return {{x, y, 0}, {0, 0, -1}};
    return {{0, 0, 0}, {x, y, -1}};
}

Visibility cast_rays(const Frame& frame, const Bvh& bvh, const ShadingContext& context, SamplePosition offset,
                     const RunControl& control) {
    Visibility out;
    out.width = static_cast<int>(frame.projection.width);
    out.height = static_cast<int>(frame.projection.height);
    const auto pixels = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
    out.depth.assign(pixels, 0.0f);
    out.triangle.assign(pixels, 0u);
    out.counters.triangles = frame.triangle_count;
    SurfaceSampler sampler(frame, context);

    for (int y = 0; y < out.height; ++y) {
        control.checkpoint(static_cast<double>(y) / out.height);
        for (int x = 0; x < out.width; ++x) {
            const auto pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x);
            const SamplePosition at{256 * x + offset.x, 256 * y + offset.y};
            float& nearest = out.depth[pixel];
            std::uint32_t& triangle = out.triangle[pixel];
            const auto visit = [&](const RayHit& hit, double t_max) {
                const MaterialView& material = sampler.material(hit.triangle);
                if (!sampler.visible(hit.triangle) || !(material.double_sided || sampler.front(hit.triangle, at)))
                    return t_max;
                // Which one is in front is decided by the canonical depth, as everywhere.
                const float z = sampler.depth(hit.triangle, at);
                if (!(z > 0.0f) || z < nearest) return t_max;
                if (z == nearest && triangle != 0 && triangle <= hit.triangle + 1) return t_max;
                if (material.alpha_mode == AlphaMode::kBlend) {
                    add_fragment(out, {static_cast<std::uint32_t>(pixel), hit.triangle, z}, control);
                    return t_max;
                }
                if (material.alpha_mode == AlphaMode::kMask && sampler.alpha(hit.triangle, at) < material.alpha_cutoff)
                    return t_max;
                nearest = z;
                triangle = hit.triangle + 1;
                // A little farther than the hit, for surfaces that canonical depth may put in front.
                return std::min(t_max, hit.t * (1 + 1e-6));
            };
            bvh.traverse(primary_ray(frame.projection, at), static_cast<double>(frame.projection.near),
                         std::numeric_limits<double>::max(), visit);
            if (triangle != 0) ++out.counters.fragments_passed;
        }
    }
    sort_transparent(out);
    return out;
}

}  // namespace tessera
