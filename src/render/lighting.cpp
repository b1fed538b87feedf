#include "render/lighting.h"

#include "image/srgb.h"
#include "shading/triangle_setup.h"
#include "simd/math.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr float kExposedWhite = 0.7f;
constexpr std::uint32_t kMeterPoints = 4096;

LightView directional(Vec3 to_light, Vec3 irradiance) {
    LightView l{};
    l.type = LightType::kDirectional;
    const Vec3 d = normalize(to_light);
    l.to_light[0] = d.x, l.to_light[1] = d.y, l.to_light[2] = d.z;
    l.intensity[0] = irradiance.x, l.intensity[1] = irradiance.y, l.intensity[2] = irradiance.z;
    return l;
}

void spot_cone(const Light& light, LightView& v) {
    const double outer = math::cos(static_cast<double>(light.outer_cone));
    const double inner =
        light.spot_profile == SpotProfile::kAxis ? 1.0 : math::cos(static_cast<double>(light.inner_cone));
    // The floor is that of KHR_lights_punctual, whose cones may be equal; an axis profile needs none but
    // against zero.
    const double scale = 1.0 / std::max(light.spot_profile == SpotProfile::kAxis ? 1e-9 : 1e-3, inner - outer);
    v.spot_scale = static_cast<float>(scale);
    v.spot_offset = static_cast<float>(-outer * scale);
}

// Light that arrives at a point of a surface, as luminance of the irradiance.
float irradiance(const ShadingContext& context, const Vec3T<float>& at, const Vec3T<float>& normal) {
    float sum = 0;
    for (int i = 0; i < context.light_count; ++i) {
        const LightSample<float> s = sample_light(context.lights[i], at);
        sum += luminance(s.irradiance.x, s.irradiance.y, s.irradiance.z) * std::max(dot(normal, s.to_light), 0.0f);
    }
    return sum;
}

struct MeterPoint {
    float value, weight;
};

// Adds `count` points spread over one triangle that lie within the picture.
void meter_triangle(const Frame& frame, const ShadingContext& context, const InstanceView& instance,
                    std::uint32_t triangle, int count, TriangleSetup& setup, std::vector<MeterPoint>& points) {
    setup_triangle(instance, triangle, frame.projection, setup);
    if (!setup.visible()) return;
    const bool front = setup.front(instance);
    if (!front && !context.materials[instance.material].double_sided) return;
    Vec3T<float> p[3];
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t v = instance.mesh.triangles[3 * std::size_t{triangle} + i];
        p[i] = transform_point(instance.object_to_camera,
                               Vec3T<float>::load(instance.mesh.positions + 3 * std::size_t{v}));
    }
    const Vec3T<float> twice_area = cross(p[1] - p[0], p[2] - p[0]);
    const Vec3T<float> unit = normalize_or(twice_area, {0, 0, 0});
    const Vec3T<float> normal = unit * (setup.orientation);  // towards the viewer
    for (int k = 0; k < count; ++k) {
        // A rank-1 lattice over the unit square (the generalised golden ratio), folded to the triangle.
        float u = 0.5f + 0.7548776662f * static_cast<float>(k), v = 0.5f + 0.5698402910f * static_cast<float>(k);
        u -= std::floor(u);
        v -= std::floor(v);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const Vec3T<float> at = p[0] * (1 - u - v) + p[1] * u + p[2] * v;
        const ClipVertex<float> clip = to_clip(frame.projection.clip_from_camera, at);
        if (out_code(clip) & ~static_cast<std::uint32_t>(kOutGuard | kOutFar)) continue;
        const float squared = std::max(dot(at, at), 1e-20f);
        const float facing = frame.projection.orthographic
                                 ? std::fabs(twice_area.z)
                                 : std::fabs(dot(twice_area, at)) / (squared * std::sqrt(squared));
        const MeterPoint point{irradiance(context, at, normal), facing / static_cast<float>(count)};
        if (point.value > 0 && point.weight > 0 && point.value < 1e30f && point.weight < 1e30f) points.push_back(point);
    }
}

// Of an exact shape, which has a number or two, those of its tessellation.
std::uint32_t metered_triangles(const Frame& frame, std::size_t instance) {
    return frame.instances[instance].shape ? frame.prepared[instance]->view.triangle_count
                                           : frame.instances[instance].mesh.triangle_count;
}

}  // namespace

std::vector<LightView> scene_lights(const Scene& scene, const Frame& frame) {
    std::vector<LightView> lights;
    for (const PlacedLight& placed : frame.lights) {
        const Light& light = scene.lights[static_cast<std::size_t>(placed.light)];
        const glm::dmat4& m = placed.light_to_camera;
        // Against the axis: the light shines along its own -Z.
        const Vec3 back =
            normalize(Vec3{static_cast<float>(m[2].x), static_cast<float>(m[2].y), static_cast<float>(m[2].z)});
        LightView v = directional(back, light.color * light.intensity);
        v.type = light.type;
        v.falloff = light.falloff;
        v.profile = light.spot_profile;
        for (int i = 0; i < 3; ++i) v.position[i] = static_cast<float>(m[3][i]);
        v.inverse_range = light.range && *light.range > 0 ? 1.0f / *light.range : 0.0f;
        if (light.type == LightType::kSpot) spot_cone(light, v);
        lights.push_back(v);
    }
    return lights;
}

std::vector<LightView> studio_lights() {
    return {directional({-0.45f, 0.65f, 0.62f}, {2.35f, 2.3f, 2.2f}),
            directional({0.80f, 0.10f, 0.59f}, {0.65f, 0.68f, 0.75f}),
            directional({0.35f, 0.55f, -0.76f}, {0.9f, 0.92f, 1.0f})};
}

AmbientView studio_ambient() { return {{0.50f, 0.52f, 0.56f}, {0.17f, 0.165f, 0.16f}, {0, 1, 0}}; }

AmbientView uniform_ambient(Vec3 radiance) {
    const Vec3& r = radiance;
    return {{r.x, r.y, r.z}, {r.x, r.y, r.z}, {0, 1, 0}, true};
}

double metered_exposure(const Frame& frame, const ShadingContext& context) {
    // Points and lines say little of the light, and count only where there is nothing else.
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < frame.instances.size(); ++i)
        count += frame.instances[i].mesh.is_stroke() ? 0 : metered_triangles(frame, i);
    const bool strokes = count == 0;
    if (strokes) count = frame.triangle_count;
    if (count == 0) return 1.0;
    const std::uint64_t step = (count + kMeterPoints - 1) / kMeterPoints;
    const int per_triangle = static_cast<int>(std::clamp<std::uint64_t>(kMeterPoints / count, 1, 64));
    std::vector<MeterPoint> points;
    TriangleSetup setup;
    std::uint64_t next = step / 2, passed_by = 0;
    for (std::size_t i = 0; i < frame.instances.size(); ++i) {
        const InstanceView& instance = frame.instances[i];
        if (instance.mesh.is_stroke() && !strokes) continue;
        const std::uint32_t triangles = metered_triangles(frame, i);
        for (; next < passed_by + triangles; next += step)
            meter_triangle(frame, context, instance, static_cast<std::uint32_t>(next - passed_by), per_triangle, setup,
                           points);
        passed_by += triangles;
    }
    if (points.empty()) return 1.0;
    std::stable_sort(points.begin(), points.end(),
                     [](const MeterPoint& a, const MeterPoint& b) { return a.value < b.value; });
    double total = 0, passed = 0;
    for (const MeterPoint& p : points) total += static_cast<double>(p.weight);
    for (const MeterPoint& p : points) {
        passed += static_cast<double>(p.weight);
        if (passed >= 0.75 * total) return static_cast<double>(kExposedWhite * kPi) / static_cast<double>(p.value);
    }
    return 1.0;
}

}  // namespace tessera
