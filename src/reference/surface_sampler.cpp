#include "reference/surface_sampler.h"

namespace tessera {
namespace {

Corner<float> fetch_corner(const MeshView& mesh, std::uint32_t vertex) {
    const std::size_t v = vertex;
    Corner<float> c{};
    c.position = Vec3T<float>::load(mesh.positions + 3 * v);
    c.normal = Vec3T<float>::load(mesh.normals + 3 * v);
    if (mesh.tangents) {
        const float* t = mesh.tangents + 4 * v;
        c.tangent = {t[0], t[1], t[2], t[3]};
    }
    if (mesh.colors) {
        const float* k = mesh.colors + 4 * v;
        c.color = {k[0], k[1], k[2], k[3]};
    }
    for (int i = 0; i < kMaxUvSets; ++i)
        if (mesh.uvs[i]) c.uv[i] = {mesh.uvs[i][2 * v], mesh.uvs[i][2 * v + 1]};
    return c;
}

}  // namespace

void SurfaceSampler::select(std::uint32_t triangle) {
    if (triangle == selected_) return;
    instance_ = &frame_.instance_of(triangle);
    setup_triangle(*instance_, triangle - instance_->first_triangle, frame_.projection, setup_);
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
    return setup_.depth.at(at.x, at.y);
}

SurfacePoint<float> SurfaceSampler::point(std::uint32_t triangle, SamplePosition at) {
    select(triangle);
    const ProjectionView& picture = frame_.projection;
    const Vec2T<float> ndc = sample_ndc<float>(at.x, at.y, picture.width, picture.height);
    return point(triangle, barycentrics(setup_.vertices, ndc, setup_.orientation, picture.width, picture.height));
}

SurfacePoint<float> SurfaceSampler::point(std::uint32_t triangle, const Barycentrics<float>& b) {
    if (corners_of_ != triangle) {
        const std::uint32_t* v = instance_->mesh.triangles + 3 * std::size_t{triangle - instance_->first_triangle};
        for (int i = 0; i < 3; ++i) corners_[i] = fetch_corner(instance_->mesh, v[i]);
        corners_of_ = triangle;
    }
    return surface_point(*instance_, corners_, b, setup_.front(*instance_) ? 1.0f : -1.0f, context_.footprint_scale);
}

float SurfaceSampler::alpha(std::uint32_t triangle, const double (&barycentric)[3]) {
    select(triangle);
    Barycentrics<float> b{};
    for (int i = 0; i < 3; ++i) b.b[i] = static_cast<float>(barycentric[i]);
    return base_color(material(triangle), point(triangle, b)).w;
}

float SurfaceSampler::alpha(std::uint32_t triangle, SamplePosition at) {
    const SurfacePoint<float> p = point(triangle, at);
    return base_color(material(triangle), p).w;
}

}  // namespace tessera
