// What arrives of every light at the points of a wave: rays towards it, and surfaces that let a part of it through.
#include "trace/waves.h"

#include <algorithm>

namespace tessera {

void WaveShader::find_light(Wave& wave) {
    const bool colored = scene_->shadows && scene_->scene->has_sheer();
    arrival_.channels = colored ? 3 : 1;
    arrival_.stride = wave.point_count + kMaxLanes;
    const auto arrays = static_cast<std::size_t>(scene_->shading->light_count * arrival_.channels);
    float* const arrives = arrival_memory_.reserve(arrays * arrival_.stride);
    arrival_.arrives = arrives;
    std::fill_n(arrives, arrays * arrival_.stride, scene_->shadows ? 0.0f : 1.0f);
    if (!scene_->shadows) return;

    shadow_rays_.stride = wave.point_count + kMaxLanes;
    shadow_rays_.base = shadow_memory_.reserve(6 * shadow_rays_.stride);
    ShadowRaysJob job{};
    job.shading = scene_->shading;
    job.points = wave.points;
    // Unlit surfaces ask for no light.
    std::uint32_t* const lit = lit_.reserve(wave.point_count + kMaxLanes);
    std::copy_n(wave.used.data(), wave.point_count, lit);
    for (const PointBatch& b : wave.batches)
        if (scene_->shading->materials[scene_->frame->instances[b.instance].material].model == ShadingModel::kUnlit)
            std::fill_n(lit + b.first, b.count, 0u);
    job.used = lit;
    job.count = wave.point_count;
    job.rays = shadow_rays_;
    job.t_far = shadow_far_.reserve(shadow_rays_.stride);
    job.point = shadow_point_.reserve(shadow_rays_.stride);
    std::fill_n(shadow_packet_.rays.mask, kPacketWidth, colored ? kMeetsSolid | kMeetsSheer : kMeetsSolid);
    for (int light = 0; light < scene_->shading->light_count; ++light) {
        job.light = light;
        scene_->kernels->shadow_rays(job);
        counters.shadow_rays += job.made;
        for (std::uint32_t first = 0; first < job.made; first += kPacketWidth) {
            RayPacket<kPacketWidth>& packet = shadow_packet_.rays;
            const int* const valid = shadow_packet_.valid;
            scene_->kernels->pack(
                {shadow_rays_, scene_->scene->trace_from_camera(), first, job.made, job.t_far, &shadow_packet_});
            sheer_.clear();
            scene_->scene->occluded(valid, packet, true, colored ? &sheer_ : nullptr, true);
            float* const arrived = arrives + static_cast<std::size_t>(light * arrival_.channels) * arrival_.stride;
            if (colored) {
                attenuate(packet, valid, first, arrived, wave);
                continue;
            }
            const std::uint32_t* const point = shadow_point_.data() + first;
            if (first + kPacketWidth <= job.made && point[kPacketWidth - 1] - point[0] == kPacketWidth - 1) {
                // Points rise, so these follow each other.
                float* const to = arrived + point[0];
                for (std::uint32_t lane = 0; lane < kPacketWidth; ++lane)
                    to[lane] = packet.t_far[lane] < 0.0f ? 0.0f : 1.0f;
                continue;
            }
            for (std::uint32_t lane = 0; lane < kPacketWidth && first + lane < job.made; ++lane)
                arrived[point[lane]] = packet.t_far[lane] < 0.0f ? 0.0f : 1.0f;
        }
    }
}

// What the sheer surfaces on the way leave of the light, of every ray that nothing solid stops.
void WaveShader::attenuate(RayPacket<kPacketWidth>& packet, const int* valid, std::uint32_t first, float* arrived,
                           const Wave& wave) {
    alignas(64) int free[kPacketWidth];
    float left[kPacketWidth][3];
    StraightAbsorption taken[kPacketWidth];
    bool takes[kPacketWidth] = {};
    for (std::uint32_t lane = 0; lane < kPacketWidth; ++lane) {
        free[lane] = valid[lane] && !(packet.t_far[lane] < 0.0f) ? -1 : 0;
        for (float& channel : left[lane]) channel = free[lane] ? 1.0f : 0.0f;
    }
    // Products of many factors depend on their order.
    sort_by_triangle(sheer_);
    for (const SheerHit& hit : sheer_) {
        if (!free[hit.lane]) continue;
        const MaterialView& material = sheer_surface_->material(hit.instance);
        const auto& even = scene_->even_transmittance[hit.instance];
        const auto take = [&left = left[hit.lane]](const Vec3T<float>& part) {
            left[0] *= part.x, left[1] *= part.y, left[2] *= part.z;
        };
        if (even) take(*even);
        if (even && !absorbs(material)) continue;
        const std::uint32_t ray = first + hit.lane;
        const WaveArrays& r = shadow_rays_;
        const ConeRay<float> cone{{r[kOriginX][ray], r[kOriginY][ray], r[kOriginZ][ray]},
                                  {r[kDirectionX][ray], r[kDirectionY][ray], r[kDirectionZ][ray]},
                                  wave.points[kFootprint][shadow_point_[ray]]};
        if (!even) take(straight_through(material, sheer_surface_->hit(hit.instance, hit.triangle, cone, 0.0f).point));
        if (!absorbs(material)) continue;
        const SheerSurface::Crossing at = sheer_surface_->crossing(hit.instance, hit.triangle, cone);
        taken[hit.lane].cross(material, at.leaving, at.distance);
        takes[hit.lane] = true;
    }
    for (std::uint32_t lane = 0; lane < kPacketWidth; ++lane) {
        if (!takes[lane]) continue;
        const Vec3T<float> part = taken[lane].left(shadow_far_[first + lane]);
        left[lane][0] *= part.x, left[lane][1] *= part.y, left[lane][2] *= part.z;
    }
    for (std::uint32_t lane = 0; lane < kPacketWidth; ++lane)
        for (std::size_t c = 0; valid[lane] && c < 3; ++c)
            arrived[c * arrival_.stride + shadow_point_[first + lane]] = left[lane][c];
}

}  // namespace tessera
