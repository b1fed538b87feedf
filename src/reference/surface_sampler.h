// The surface seen at a picture position: fetches a triangle's corners and applies the surface
// function. One for each engine run; not shared between threads (it remembers the last triangle).
#pragma once

#include "geometry/frame.h"
#include "shading/label_point.h"
#include "shading/shade.h"
#include "shading/triangle_setup.h"

#include <optional>

namespace tessera {

class SurfaceSampler {
  public:
    // Both must outlive the sampler.
    SurfaceSampler(const Frame& frame, const ShadingContext& context)
        : frame_(frame), context_(context), rays_(frame.projection) {}
    // For labels of the surface: with the planes that they need.
    SurfaceSampler(const Frame& frame, const ShadingContext& context, const SurfaceLabels& labels)
        : SurfaceSampler(frame, context) {
        labels_ = labels;
    }

    // `triangle` is a number in the frame (0-based); `at` a position inside its picture.
    SurfacePoint<float> point(std::uint32_t triangle, SamplePosition at);
    // Labels there, of a sampler that was made for them. `label_from_camera`: 3x4 rows.
    LabelPoint<float> label(std::uint32_t triangle, SamplePosition at, const float* label_from_camera);
    // Canonical depth (reversed) of the triangle at a position.
    float depth(std::uint32_t triangle, SamplePosition at);
    // Whether the camera sees the triangle at all, and its front there.
    bool visible(std::uint32_t triangle) { return instance(triangle).shape || setup(triangle).visible(); }
    bool front(std::uint32_t triangle, SamplePosition at);
    // Distance along the view axis there, from the canonical depth.
    float distance(std::uint32_t triangle, SamplePosition at) {
        return distance_of_depth(frame_.projection, depth(triangle, at));
    }
    // Alpha of the material there, before the alpha mode looks at it.
    float alpha(std::uint32_t triangle, SamplePosition at);
    // The same for a ray's hit anywhere on the triangle, from the texture's finest level.
    float alpha(std::uint32_t triangle, const double (&barycentric)[3]);

    const PictureRays& rays() const { return rays_; }
    const TriangleSetup& setup(std::uint32_t triangle);
    const InstanceView& instance(std::uint32_t triangle);
    // What labels call the point, line or triangle that it belongs to, 0-based.
    std::uint32_t primitive(std::uint32_t triangle) {
        const InstanceView& i = instance(triangle);
        return i.first_primitive + i.mesh.element_of(triangle - i.first_triangle);
    }
    const MaterialView& material(std::uint32_t triangle) { return context_.materials[instance(triangle).material]; }
    const ShadingContext& context() const { return context_; }

  private:
    void select(std::uint32_t triangle);
    void fetch_planes(std::uint32_t triangle);
    SurfacePoint<float> shape_point(std::uint32_t triangle, SamplePosition at, float footprint_scale);
    SurfacePoint<float> sample(std::uint32_t triangle, SamplePosition at, float footprint_scale);
    Corner<float> corner(std::uint32_t index, int i) const;

    const Frame& frame_;
    const ShadingContext& context_;
    static constexpr std::uint32_t kNothing = 0xffffffffu;
    std::uint32_t selected_ = kNothing, planes_of_ = kNothing;
    const InstanceView* instance_ = nullptr;
    PictureRays rays_;
    std::optional<SurfaceLabels> labels_;
    TriangleSetup setup_;
    SurfaceLayout layout_;  // of planes_of_, like what follows
    float record_[kMaxSurfaceFloats];
    Vec3T<float> geometric_normal_;
};

}  // namespace tessera
