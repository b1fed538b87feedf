// The rays of a wave through the hierarchies, and the surface points of their hits.
#include "tile/tile.h"
#include "trace/waves.h"

#include <algorithm>

namespace tessera {

// Nothing is there: ambient light, or for light that only passed surfaces the background. What never leaves a medium
// was in no body.
void WaveShader::miss(Wave& wave, std::uint32_t ray) const {
    float light[3] = {0, 0, 0}, passed[3] = {0, 0, 0};
    const RayState state = scene_->simple ? RayState{} : wave.states[ray];
    if (!scene_->simple && state.straight) {
        for (float& part : passed) part = 1.0f;
    } else {
        const Vec3T<float> around = radiance_around(
            *scene_->shading,
            Vec3T<float>{wave.rays[kDirectionX][ray], wave.rays[kDirectionY][ray], wave.rays[kDirectionZ][ray]});
        light[0] = around.x, light[1] = around.y, light[2] = around.z;
    }
    for (std::size_t c = 0; c < 3; ++c) wave.light[c][ray] = light[c], wave.passed[c][ray] = passed[c];
}

// Cut-outs and blended surfaces before what a ray has hit: the nearest one that is there is hit instead.
void WaveShader::see_sheer(Wave& wave, std::uint32_t first, const RayPacket<kPacketWidth>& packet) {
    std::sort(sheer_.begin(), sheer_.end(), [](const SheerHit& a, const SheerHit& b) {
        if (a.lane != b.lane) return a.lane < b.lane;
        if (a.t != b.t) return a.t < b.t;
        return a.instance != b.instance ? a.instance < b.instance : a.triangle < b.triangle;
    });
    std::uint32_t decided = kNoHit;
    for (const SheerHit& hit : sheer_) {
        if (hit.lane == decided || !(hit.t < packet.t_far[hit.lane])) continue;
        const std::uint32_t ray = first + hit.lane;
        const MaterialView& material = sheer_surface_->material(hit.instance);
        if (material.alpha_mode == AlphaMode::kMask &&
            sheer_surface_->alpha(hit.instance, hit.triangle, cone_ray(wave.rays, ray), scene_->spread) <
                material.alpha_cutoff)
            continue;
        wave.instance[ray] = hit.instance;
        wave.triangle[ray] = hit.triangle;
        decided = hit.lane;
    }
}

// The points of one instance that is drawn by its formula; `x` and `y`: picture positions of the camera's rays.
void WaveShader::find_shape_points(const TileTask& task, Wave& wave, const InstanceRun& run, const std::int32_t* x,
                                   const std::int32_t* y) const {
    ShapeSurfacesJob job{};
    job.instance = &task.frame.instances[run.instance];
    job.material = &scene_->shading->materials[job.instance->material];
    job.layout = task.shading_batches.layouts[run.instance];
    job.projection = &task.frame.projection;
    if (x) {
        job.x = x + run.first;
        job.y = y + run.first;
    } else {
        job.rays = wave.rays;
        job.ray = wave.ray.data() + run.first;
        job.distance = wave.distance.data();
    }
    job.name = wave.hit_triangle.data() + run.first;
    job.count = run.count;
    job.first = run.first;
    job.spread = scene_->spread;
    job.footprint_scale = scene_->shading->footprint_scale;
    job.instance_size = scene_->instance_size[run.instance];
    job.points = wave.points;
    scene_->kernels->shape_surfaces(job);
}

void WaveShader::trace(const TileTask& task, Wave& wave) {
    const bool looks = scene_->scene->has_undecided();
    for (std::uint32_t first = 0; first < wave.ray_count; first += kPacketWidth) {
        RayPacket<kPacketWidth>& packet = packet_.rays;
        scene_->kernels->pack(
            {wave.rays, scene_->scene->trace_from_camera(), first, wave.ray_count, nullptr, &packet_});
        sheer_.clear();
        scene_->scene->nearest(packet_.valid, packet, true, false, looks ? &sheer_ : nullptr, true);
        for (std::uint32_t lane = 0; lane < kPacketWidth && first + lane < wave.ray_count; ++lane) {
            wave.instance[first + lane] = packet_.valid[lane] ? packet.instance[lane] : kNoHit;
            wave.triangle[first + lane] = packet.triangle[lane];
        }
        if (!sheer_.empty()) see_sheer(wave, first, packet);
    }
    if (scene_->simple && scene_->shading->ambient.uniform) {
        for (std::size_t c = 0; c < 3; ++c)
            std::fill_n(wave.light[c].data(), wave.ray_count, scene_->shading->ambient.ground[c]);
    } else {
        if (!scene_->simple)
            for (Buffer<float>& kept : wave.kept) std::fill_n(kept.data(), wave.ray_count, 1.0f);
        for (std::uint32_t r = 0; r < wave.ray_count; ++r)
            if (wave.instance[r] == kNoHit) miss(wave, r);
    }
    arrange(task, wave);
    for (const InstanceRun& run : wave.runs) {
        if (task.frame.instances[run.instance].shape) {
            find_shape_points(task, wave, run, nullptr, nullptr);
            continue;
        }
        RaySurfacesJob job{};
        job.instance = &task.frame.instances[run.instance];
        job.material = &scene_->shading->materials[job.instance->material];
        job.layout = task.shading_batches.layouts[run.instance];
        job.rays = wave.rays;
        job.ray = wave.ray.data() + run.first;
        job.triangle = wave.hit_triangle.data() + run.first;
        job.count = run.count;
        job.first = run.first;
        job.spread = scene_->spread;
        job.footprint_scale = scene_->shading->footprint_scale;
        job.instance_size = scene_->instance_size[run.instance];
        job.points = wave.points;
        job.distance = wave.distance.data();
        scene_->kernels->ray_surfaces(job);
    }
}

}  // namespace tessera
