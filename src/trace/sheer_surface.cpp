#include "trace/sheer_surface.h"

#include "shading/shape_surface.h"
#include "shading/traced_shade.h"

#include <algorithm>

namespace tessera {

bool SheerSurface::select(std::uint32_t instance, std::uint32_t triangle) {
    if (instance == instance_ && triangle == triangle_) return visible_;
    instance_ = instance;
    triangle_ = triangle;
    recorded_ = false;
    const InstanceView& view = frame_.instances[instance];
    if (view.shape) return visible_ = true;  // rays know
    setup_triangle(view, triangle, frame_.projection, setup_);
    visible_ = setup_.visible() && (setup_.front(view) || material(instance).double_sided);
    return visible_;
}

// The camera's hit on the selected shape.
RaySurface<float> SheerSurface::shape_point(SamplePosition at) const {
    const ConeRay<float> ray =
        picture_ray(frame_.projection, rays_, static_cast<float>(at.x), static_cast<float>(at.y));
    return shape_surface<float>(frame_.instances[instance_], ray, triangle_ == kLeavingSphere,
                                picture_spread(frame_.projection), context_.footprint_scale);
}

float SheerSurface::depth(SamplePosition at) const {
    if (frame_.instances[instance_].shape) return depth_of(frame_.projection, shape_point(at).point.position);
    // Rays may meet what the rasterizer does not see: everywhere its first corner (triangle_setup.h).
    const ClipVertex<float>& corner = setup_.vertices[0];
    if (!setup_.visible()) return corner.w > 0 ? std::min(corner.z / corner.w, 1.0f) : 0.0f;
    return setup_.depth.at(at.x, at.y);
}

float SheerSurface::alpha(SamplePosition at) {
    const InstanceView& view = frame_.instances[instance_];
    if (view.shape) return base_color(material(instance_), shape_point(at).point).w;
    if (!recorded_) {
        layout_ = surface_layout(view.mesh, material(instance_), frame_.projection.orthographic);
        make_surface_record(view, triangle_, setup_, frame_.projection, layout_, record_);
        recorded_ = true;
    }
    const float x = static_cast<float>(at.x), y = static_cast<float>(at.y);
    SurfaceSample<float> sample;
    sample_planes(
        layout_, x, y, [this](int i) { return record_[i]; }, sample);
    return base_color(material(instance_), surface_point(layout_, rays_, sample, x, y, context_.footprint_scale)).w;
}

RaySurface<float> SheerSurface::hit(std::uint32_t instance, std::uint32_t triangle, const ConeRay<float>& ray,
                                    float spread) const {
    const InstanceView& view = frame_.instances[instance];
    if (view.shape)
        return shape_surface<float>(view, ray, triangle == kLeavingSphere, spread, context_.footprint_scale);
    Corner<float> corners[3];
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = fetch_corner(view.mesh, view.mesh.triangles[3 * std::size_t{triangle} + i]);
    return ray_surface(view, corners, ray, spread, context_.footprint_scale);
}

float SheerSurface::alpha(std::uint32_t instance, std::uint32_t triangle, const ConeRay<float>& ray,
                          float spread) const {
    return base_color(material(instance), hit(instance, triangle, ray, spread).point).w;
}

SheerSurface::Crossing SheerSurface::crossing(std::uint32_t instance, std::uint32_t triangle,
                                              const ConeRay<float>& ray) const {
    const InstanceView& view = frame_.instances[instance];
    if (view.shape) {
        const RaySurface<float> at = hit(instance, triangle, ray, 0.0f);
        return {at.distance, at.point.side < 0.0f};
    }
    const std::uint32_t* const corners = view.mesh.triangles + 3 * std::size_t{triangle};
    Vec3T<float> p[3], v[3];
    for (std::size_t i = 0; i < 3; ++i) {
        p[i] = Vec3T<float>::load(view.mesh.positions + 3 * std::size_t{corners[i]});
        v[i] = transform_point(view.object_to_camera, p[i]);
    }
    const Vec3T<float> ng = geometric_normal(view, p[0], p[1], p[2]);
    return {ray_point(ray, v, ng, 0.0f).distance, dot(ng, ray.direction) > 0.0f};
}

}  // namespace tessera
