#include "reference/surface_sampler.h"

#include "shading/shape_surface.h"

namespace tessera {

void SurfaceSampler::select(std::uint32_t triangle) {
    if (triangle == selected_) return;
    instance_ = &frame_.instance_of(triangle);
    if (!instance_->shape) setup_triangle(*instance_, triangle - instance_->first_triangle, frame_.projection, setup_);
    selected_ = triangle;
}

const TriangleSetup& SurfaceSampler::setup(std::uint32_t triangle) {
    select(triangle);
    return setup_;
}

const InstanceView& SurfaceSampler::instance(std::uint32_t triangle) {
    select(triangle);
    return *instance_;
}

float SurfaceSampler::depth(std::uint32_t triangle, SamplePosition at) {
    select(triangle);
    if (instance_->shape) return depth_of(frame_.projection, shape_point(triangle, at, 1.0f).position);
    return setup_.depth.at(at.x, at.y);
}

bool SurfaceSampler::front(std::uint32_t triangle, SamplePosition at) {
    select(triangle);
    return instance_->shape ? shape_point(triangle, at, 1.0f).side > 0.0f : setup_.front(*instance_);
}

// What the camera sees of a shape.
SurfacePoint<float> SurfaceSampler::shape_point(std::uint32_t triangle, SamplePosition at, float footprint_scale) {
    const ConeRay<float> ray =
        picture_ray(frame_.projection, rays_, static_cast<float>(at.x), static_cast<float>(at.y));
    return shape_surface<float>(*instance_, ray, triangle - instance_->first_triangle == kLeavingSphere,
                                picture_spread(frame_.projection), footprint_scale)
        .point;
}

void SurfaceSampler::fetch_planes(std::uint32_t triangle) {
    select(triangle);
    if (planes_of_ == triangle) return;
    const std::uint32_t index = triangle - instance_->first_triangle;
    const bool orthographic = frame_.projection.orthographic;
    layout_ = labels_ ? label_layout(instance_->mesh, material(triangle), *labels_, orthographic)
                      : surface_layout(instance_->mesh, material(triangle), orthographic);
    planes_of_ = triangle;
    if (instance_->shape) return;
    make_surface_record(*instance_, index, setup_, frame_.projection, layout_, record_);
    const Corner<float> c[3] = {corner(index, 0), corner(index, 1), corner(index, 2)};
    geometric_normal_ = geometric_normal(*instance_, c[0].position, c[1].position, c[2].position);
}

Corner<float> SurfaceSampler::corner(std::uint32_t index, int i) const {
    return fetch_corner(instance_->mesh,
                        instance_->mesh.triangles[3 * std::size_t{index} + static_cast<std::size_t>(i)]);
}

SurfacePoint<float> SurfaceSampler::sample(std::uint32_t triangle, SamplePosition at, float footprint_scale) {
    fetch_planes(triangle);
    if (instance_->shape) return shape_point(triangle, at, footprint_scale);
    const float x = static_cast<float>(at.x), y = static_cast<float>(at.y);
    SurfaceSample<float> sample;
    sample_planes(
        layout_, x, y, [this](int i) { return record_[i]; }, sample);
    return surface_point(layout_, rays_, sample, x, y, footprint_scale);
}

LabelPoint<float> SurfaceSampler::label(std::uint32_t triangle, SamplePosition at, const float* label_from_camera) {
    SurfacePoint<float> s = sample(triangle, at, 1.0f);
    s.position = position_of_depth(frame_.projection, rays_, depth(triangle, at), static_cast<float>(at.x),
                                   static_cast<float>(at.y));
    return label_point(*labels_, layout_, material(triangle), label_from_camera, s);
}

SurfacePoint<float> SurfaceSampler::point(std::uint32_t triangle, SamplePosition at) {
    SurfacePoint<float> s = sample(triangle, at, context_.footprint_scale);
    if (!instance_->shape) s.geometric_normal = geometric_normal_ * s.side;
    if (layout_.tangent >= 0) s.normal = shading_normal(material(triangle), s);
    return s;
}

float SurfaceSampler::alpha(std::uint32_t triangle, const double (&barycentric)[3]) {
    select(triangle);
    const std::uint32_t index = triangle - instance_->first_triangle;
    const Corner<float> corners[3] = {corner(index, 0), corner(index, 1), corner(index, 2)};
    Barycentrics<float> b{};
    for (int i = 0; i < 3; ++i) b.b[i] = static_cast<float>(barycentric[i]);
    return base_color(material(triangle),
                      surface_point(*instance_, corners, b, {0, 0, 1}, 1.0f, context_.footprint_scale))
        .w;
}

float SurfaceSampler::alpha(std::uint32_t triangle, SamplePosition at) {
    const SurfacePoint<float> p = point(triangle, at);
    return base_color(material(triangle), p).w;
}

}  // namespace tessera
