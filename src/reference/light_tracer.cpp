#include "reference/light_tracer.h"

#include "shading/shape_surface.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

constexpr int kMostPasses = 64;  // of straight rays

// One surface point as a batch.
struct OnePoint {
    static constexpr int kCount = 1;
    static constexpr bool kColored = true;
    const SurfacePoint<float>& s;
    float index;

    bool used(int) const { return true; }
    Vec3T<float> position(int) const { return s.position; }
    Vec3T<float> normal(int) const { return s.normal; }
    Vec3T<float> view(int) const { return s.view; }
    const SurfacePoint<float>& point(int) const { return s; }
    float eta(int) const { return index; }
    bool inside(int) const { return s.side < 0.0f; }
};

float largest(const Vec3T<float>& v) { return std::max(std::max(v.x, v.y), v.z); }

}  // namespace

LightTracerReference::LightTracerReference(const Frame& frame, const Bvh& bvh, const ShadingContext& context,
                                           const ReferenceTransport& settings)
    : frame_(frame), bvh_(bvh), context_(context), settings_(settings) {
    spread_ = picture_spread(frame.projection);
    for (std::size_t i = 0; i < frame.instances.size(); ++i)
        sizes_.push_back(largest_coordinate(frame.instances[i], *frame.prepared[i]));
}

// The rasterizer's point moved onto the triangle's own plane.
static void move_onto_triangle(const InstanceView& instance, std::uint32_t triangle, SurfacePoint<float>& s) {
    const std::uint32_t* corners = instance.mesh.triangles + 3 * std::size_t{triangle - instance.first_triangle};
    Vec3T<float> p[3];
    for (std::size_t i = 0; i < 3; ++i)
        p[i] = Vec3T<float>::load(instance.mesh.positions + 3 * std::size_t{corners[i]});
    const Vec3T<float> normal = geometric_normal(instance, p[0], p[1], p[2]);
    s.position = onto_plane(s.position, normal, dot(normal, transform_point(instance.object_to_camera, p[0])));
    turn_to_viewer(s, normal);
}

// The first point, of the picture.
ShadedPoint<float> LightTracerReference::shade(std::uint32_t triangle, SamplePosition at, SurfaceSampler& sampler) {
    Point point{sampler.point(triangle, at), triangle, 0, 0, 1};
    SurfacePoint<float>& s = point.surface;
    const InstanceView& instance = frame_.instance_of(triangle);
    if (!instance.shape) move_onto_triangle(instance, triangle, s);
    const ProjectionView& picture = frame_.projection;
    const float pixel = pixel_width(picture);
    point.footprint = picture.orthographic ? pixel - s.position.z * 0.0f : 0.0f - s.position.z * pixel;
    point.size = coordinate_size(s.position, sizes_[static_cast<std::size_t>(&instance - frame_.instances.data())]);
    float alpha = 1;
    const TracedLight found = shade_point(point, Ray{}, true, alpha);
    const bool blends = context_.materials[material_of(triangle)].alpha_mode == AlphaMode::kBlend;
    const float clear = blends ? 0.0f : std::min(std::min({found.passed.x, found.passed.y, found.passed.z}), 1.0f);
    const Vec3T<float> background = Vec3T<float>::load(settings_.background);
    return {found.light + (found.passed - Vec3T<float>::splat(clear)) * background, alpha * (1.0f - clear)};
}

TracedLight LightTracerReference::trace(const Ray& ray) {
    Hit hit;
    if (!nearest(ray, hit)) return miss(ray);
    const RaySurface<float> found = surface_at(hit.triangle, ray.cone, spread_);
    const InstanceView& instance = frame_.instance_of(hit.triangle);
    const float size = sizes_[static_cast<std::size_t>(&instance - frame_.instances.data())];
    Point point{found.point, hit.triangle, found.width, coordinate_size(found.point.position, size), ray.times};
    Vec3T<float> kept = Vec3T<float>::splat(1.0f);
    if (ray.media.count > 0) {
        kept = transmittance(Vec3T<float>::load(context_.materials[ray.media.current(context_.materials)].absorption),
                             found.distance);
        point.times *= largest(kept);
    }
    float alpha = 1;
    const TracedLight light = shade_point(point, ray, false, alpha);
    return {light.light * kept, light.passed * kept};
}

TracedLight LightTracerReference::shade_point(const Point& point, const Ray& from, bool camera, float& alpha) {
    const SurfacePoint<float>& s = point.surface;
    const std::uint32_t m = material_of(point.triangle);
    const MaterialView& material = context_.materials[m];
    const bool transmits = may_transmit(material), blends = material.alpha_mode == AlphaMode::kBlend && !camera;
    Boundary here;
    if (transmits) here = boundary(from.media, m, s.side > 0.0f, from.channel, context_.materials);
    TracedShade<float> shaded = shade_here(point, here);
    const Vec3T<float> none = Vec3T<float>::splat(0.0f);
    if (here.clear) shaded = {none, 1.0f, none, Vec3T<float>::splat(1.0f)};
    alpha = shaded.alpha;
    if (blends && !here.clear) {
        shaded.radiance = shaded.radiance * alpha;
        shaded.reflected = shaded.reflected * alpha;
        shaded.entering = shaded.entering * alpha;
    }
    TracedLight sum{shaded.radiance, none};
    if (!settings_.bounces) return sum;

    // What comes along a ray, where it counts for enough.
    const auto follow = [&](const Vec3T<float>& weight, const Vec3T<float>& direction, Ray next) {
        next.times = point.times * largest(weight);
        if (!(next.times > settings_.least)) return;
        next.cone = {ray_origin(s.position, s.geometric_normal, direction, point.size), direction, point.footprint};
        const TracedLight found = trace(next);
        sum.light = sum.light + weight * found.light;
        sum.passed = sum.passed + weight * found.passed;
    };
    const bool may_turn = from.depth < settings_.max_depth, may_pass = from.passes < kMostPasses;
    if (may_turn) {
        Ray next = from;
        ++next.depth;
        next.straight = false;
        follow(shaded.reflected, normalize_or(mirrored(s.view, s.normal, s.geometric_normal), s.normal), next);
    }
    if (transmits && (here.clear ? may_pass : may_turn)) {
        Ray next = from;
        ++(here.clear ? next.passes : next.depth);
        if (!material.thin) next.media = from.media.beyond(m, s.side > 0.0f);
        const auto enter = [&](float eta, const Vec3T<float>& channels, int channel) {
            Vec3T<float> direction = -s.view;
            if (!here.clear && !material.thin && eta != 1.0f)
                direction = refracted(s.view, s.normal, s.geometric_normal, eta).direction;
            next.channel = channel;
            follow(shaded.entering * channels, direction, next);
        };
        if (material.ior[0] != material.ior[2] && !material.thin && from.channel == 0 && !here.clear) {
            enter(here.eta[0], {1, 0, 0}, 1);
            enter(here.eta[1], {0, 1, 0}, 2);
            enter(here.eta[2], {0, 0, 1}, 3);
        } else {
            enter(here.eta[1], {1, 1, 1}, from.channel);
        }
    }
    if (blends && may_pass) {
        Ray next = from;
        ++next.passes;
        if (transmits && !material.thin) next.media = from.media.beyond(m, s.side > 0.0f);
        follow(Vec3T<float>::splat(1.0f - alpha), -s.view, next);
    }
    return sum;
}

TracedShade<float> LightTracerReference::shade_here(const Point& point, const Boundary& here) {
    const MaterialView& material = context_.materials[material_of(point.triangle)];
    const OnePoint one{point.surface, here.eta[1]};
    const auto visible = [&](int, const LightSample<float>& light, int) { return arriving(point, light); };
    TracedShade<float> shaded;
    switch (family_of(material.model)) {
        case ShadingFamily::kUnlit:
            shade_traced<ShadingFamily::kUnlit, kMaxUvSets>(context_, material, one, visible, &shaded);
            break;
        case ShadingFamily::kTextbook:
            shade_traced<ShadingFamily::kTextbook, kMaxUvSets>(context_, material, one, visible, &shaded);
            break;
        case ShadingFamily::kMicrofacet:
            shade_traced<ShadingFamily::kMicrofacet, kMaxUvSets>(context_, material, one, visible, &shaded);
            break;
    }
    return shaded;
}

// Ambient light, or for light that only passed surfaces the background. What never leaves a medium was in no body.
TracedLight LightTracerReference::miss(const Ray& ray) const {
    const Vec3T<float> none = Vec3T<float>::splat(0.0f);
    if (ray.straight) return {none, Vec3T<float>::splat(1.0f)};
    return {radiance_around(context_, ray.cone.direction), none};
}

RaySurface<float> LightTracerReference::surface_at(std::uint32_t triangle, const ConeRay<float>& ray, float spread) {
    const InstanceView& instance = frame_.instance_of(triangle);
    RaySurface<float> hit;
    if (instance.shape) {
        hit = shape_surface<float>(instance, ray, triangle - instance.first_triangle == kLeavingSphere, spread,
                                   context_.footprint_scale);
    } else {
        const std::uint32_t* vertices = instance.mesh.triangles + 3 * std::size_t{triangle - instance.first_triangle};
        const Corner<float> corners[3] = {fetch_corner(instance.mesh, vertices[0]),
                                          fetch_corner(instance.mesh, vertices[1]),
                                          fetch_corner(instance.mesh, vertices[2])};
        hit = ray_surface(instance, corners, ray, spread, context_.footprint_scale);
    }
    const MaterialView& material = context_.materials[instance.material];
    if (surface_layout(instance.mesh, material, frame_.projection.orthographic).tangent >= 0)
        hit.point.normal = shading_normal(material, hit.point);
    return hit;
}

bool LightTracerReference::nearest(const Ray& ray, Hit& hit) {
    const auto wide = [](const Vec3T<float>& v) {
        return Vec3d{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    };
    const CastRay cast{wide(ray.cone.origin), wide(ray.cone.direction)};
    bool found = false;
    bvh_.traverse(cast, 0.0, std::numeric_limits<double>::max(), [&](const RayHit& candidate, double t_max) {
        const InstanceView& instance = frame_.instance_of(candidate.triangle);
        const MaterialView& material = context_.materials[instance.material];
        if (instance.mesh.is_stroke()) return t_max;
        if (found && candidate.t == hit.t && candidate.triangle > hit.triangle) return t_max;
        const bool inside_counts = may_transmit(material) && !material.thin;
        if (instance.shape && !material.double_sided && !inside_counts) {
            if (surface_at(candidate.triangle, ray.cone, spread_).point.side < 0.0f) return t_max;
        } else if (!material.double_sided && !inside_counts) {
            const std::uint32_t* v =
                instance.mesh.triangles + 3 * std::size_t{candidate.triangle - instance.first_triangle};
            const auto at = [&](std::size_t i) {
                return Vec3T<float>::load(instance.mesh.positions + 3 * std::size_t{v[i]});
            };
            if (!(dot(geometric_normal(instance, at(0), at(1), at(2)), ray.cone.direction) < 0.0f)) return t_max;
        }
        if (material.alpha_mode == AlphaMode::kMask &&
            base_color(material, surface_at(candidate.triangle, ray.cone, spread_).point).w < material.alpha_cutoff)
            return t_max;
        found = true;
        hit = {candidate.triangle, candidate.t};
        return candidate.t;
    });
    return found;
}

// What arrives of a light: all, nothing behind a solid surface, and less behind sheer ones.
Vec3T<float> LightTracerReference::arriving(const Point& point, const LightSample<float>& light) {
    constexpr float kNearly = 1.0f - 1e-5f;
    const SurfacePoint<float>& s = point.surface;
    Vec3T<float> left = Vec3T<float>::splat(1.0f);
    if (!settings_.shadows) return left;
    const Vec3T<float> none = Vec3T<float>::splat(0.0f);
    if (!(light.strength > 0.0f && dot(s.normal, light.to_light) > 0.0f)) return none;
    const Vec3T<float> origin = ray_origin(s.position, s.geometric_normal, light.to_light, point.size);
    const ConeRay<float> ray{origin, light.to_light, point.footprint};
    const CastRay cast{{static_cast<double>(origin.x), static_cast<double>(origin.y), static_cast<double>(origin.z)},
                       {static_cast<double>(light.to_light.x), static_cast<double>(light.to_light.y),
                        static_cast<double>(light.to_light.z)}};
    std::vector<std::uint32_t> sheer;
    bool blocked = false;
    const double far = static_cast<double>(light.distance * kNearly);
    bvh_.traverse(cast, 0.0, far, [&](const RayHit& hit, double t_max) {
        const InstanceView& instance = frame_.instance_of(hit.triangle);
        const MaterialView& material = context_.materials[instance.material];
        if (instance.mesh.is_stroke()) return t_max;
        if (material.alpha_mode != AlphaMode::kOpaque || may_transmit(material)) {
            sheer.push_back(hit.triangle);
            return t_max;
        }
        blocked = true;
        return -1.0;
    });
    if (blocked) return none;
    std::sort(sheer.begin(), sheer.end());
    StraightAbsorption taken;
    for (const std::uint32_t triangle : sheer) {
        const MaterialView& material = context_.materials[material_of(triangle)];
        const RaySurface<float> hit = surface_at(triangle, ray, 0.0f);
        left = left * straight_through(material, hit.point);
        if (absorbs(material)) taken.cross(material, hit.point.side < 0.0f, hit.distance);
    }
    return left * taken.left(light.distance * kNearly);
}

}  // namespace tessera
