#include "render/labels.h"

#include <tessera/error.h>

#include "geometry/matrix.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

constexpr SamplePosition kCentre{128, 128};

SamplePosition centre_of(std::size_t pixel, int width) {
    const auto w = static_cast<std::size_t>(width);
    return {256 * static_cast<std::int32_t>(pixel % w) + kCentre.x,
            256 * static_cast<std::int32_t>(pixel / w) + kCentre.y};
}

// 1 + number of the triangle that each pixel shows.
std::vector<std::uint32_t> label_triangles(ReferenceEngine& engine, const Visibility& seen) {
    std::vector<std::uint32_t> nearest = seen.triangle;
    // Fragments come far to near: the last one that is solid enough wins.
    for (const Fragment& f : seen.transparent)
        if (engine.sampler().alpha(f.triangle, centre_of(f.pixel, seen.width)) >= 0.5f)
            nearest[f.pixel] = f.triangle + 1;
    return nearest;
}

void store(float* plane, std::size_t pixel, const Vec3T<float>& v) {
    if (!plane) return;
    plane[3 * pixel] = v.x, plane[3 * pixel + 1] = v.y, plane[3 * pixel + 2] = v.z;
}

float distance_at(SurfaceSampler& sampler, std::uint32_t triangle, SamplePosition at, bool euclidean) {
    const float along = sampler.distance(triangle, at);
    if (!euclidean) return along;
    return euclidean_distance(sampler.rays(), along, static_cast<float>(at.x), static_cast<float>(at.y));
}

}  // namespace

void set_label_space(const RenderOptions& options, const Frame& frame, PictureTargets& targets) {
    glm::dmat4 m(1.0);
    if (options.label_space == LabelSpace::kWorld) {
        m = rigid_inverse(frame.world_to_camera);
        if (options.label_from_world) {
            const glm::dmat4 turn = to_dmat4(*options.label_from_world);
            if (!is_finite(turn) || !is_rigid(turn))
                throw Error(ErrorCode::kUsage, "label_from_world must be a rotation and a translation");
            m = turn * m;
        }
    } else if (options.label_space == LabelSpace::kOpenCvCamera) {
        m[1].y = m[2].z = -1;
    }
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) targets.label_from_camera[4 * r + c] = static_cast<float>(m[c][r]);
}

LabelCounts take_labels(ReferenceEngine& engine, const Frame& frame, const RunControl& control,
                        const PictureTargets& targets) {
    const Visibility seen = engine.see(kCentre, control);
    const std::vector<std::uint32_t> nearest = label_triangles(engine, seen);
    const LabelPlanes& planes = targets.labels;
    const SurfaceLabels labels = targets.surface_labels();
    SurfaceSampler surfaces(frame, engine.sampler().context(), labels);
    LabelCounts counts{seen.counters, 0};
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const SamplePosition at = centre_of(i, seen.width);
        const bool hit = nearest[i] != 0;
        const std::uint32_t triangle = nearest[i] - 1;
        counts.pixels += hit;
        if (planes.triangle) planes.triangle[i] = nearest[i];
        if (planes.primitive) planes.primitive[i] = hit ? surfaces.primitive(triangle) + 1 : 0;
        if (planes.node) planes.node[i] = hit ? surfaces.instance(triangle).node + 1 : 0;
        if (planes.material) planes.material[i] = hit ? surfaces.instance(triangle).scene_material + 1 : 0;
        if (planes.distance)
            planes.distance[i] =
                hit ? distance_at(surfaces, triangle, at, targets.euclidean) : std::numeric_limits<float>::infinity();
        if (!labels.any()) continue;
        const LabelPoint<float> p = hit ? surfaces.label(triangle, at, targets.label_from_camera) : LabelPoint<float>{};
        store(planes.normal, i, p.normal);
        store(planes.shading_normal, i, p.shading_normal);
        store(planes.position, i, p.position);
        store(planes.albedo, i, p.albedo);
        if (planes.uv) planes.uv[2 * i] = p.uv.x, planes.uv[2 * i + 1] = p.uv.y;
    }
    return counts;
}

}  // namespace tessera
