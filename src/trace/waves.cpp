// The ray tracer on one page: the samples of a part of a tile are the first wave. Every wave is shaded, with rays
// towards the lights, and sends on the rays of the next one; when none are left, what they found flows back. That is
// the recursion of Whitted 1980, "An improved illumination model for shaded display", breadth first.
#include "trace/waves.h"

#include <tessera/error.h>

#include "tile/tile.h"

#include <algorithm>
#include <bit>

namespace tessera {
namespace {

constexpr std::uint32_t kSamplesAtOnce = 1024;  // whose waves stay in the second-level cache
// Glass doubles its rays at every step. Samples whose waves would have more points than that (some 120 MB) are taken
// fewer at a time.
constexpr std::uint32_t kMostPoints = 1u << 18;

// The point that a ray started from.
std::uint32_t point_of(const Wave& wave, std::uint32_t ray) {
    return std::bit_cast<std::uint32_t>(wave.rays[kParent][ray]);
}

}  // namespace

void WaveShader::begin(const TransportScene& scene) {
    scene_ = &scene;
    sheer_surface_.emplace(*scene.frame, *scene.shading);
    counters = {};
}

void WaveShader::shade(const TileTask& task, const SampleList& samples, float* const (&color)[4]) {
    find_planes(task, samples);
    for (std::uint32_t first = 0; first < samples.count; first += kSamplesAtOnce)
        shade_part(task, samples, first, std::min(kSamplesAtOnce, samples.count - first), color);
}

void WaveShader::shade_part(const TileTask& task, const SampleList& samples, std::uint32_t first, std::uint32_t count,
                            float* const (&color)[4]) {
    task.settings.checkpoint(0.0);
    const TransportCounters before = counters;
    if (shade_samples(task, samples, first, count, color)) return;
    counters = before;
    if (count == 1)
        throw Error(ErrorCode::kLimit,
                    "the rays of a single sample need more memory than a thread is given: let them go "
                    "on less often (max_depth), or not where they count for little (min_contribution)");
    shade_part(task, samples, first, count / 2, color);
    shade_part(task, samples, first + count / 2, count - count / 2, color);
}

// False where there are too many rays.
bool WaveShader::shade_samples(const TileTask& task, const SampleList& samples, std::uint32_t first,
                               std::uint32_t count, float* const (&color)[4]) {
    const auto wave = [this](std::size_t n) -> Wave& {
        while (waves_.size() <= n) waves_.push_back(std::make_unique<Wave>());
        return *waves_[n];
    };
    take_samples(task, samples, first, count);
    shade_points(task, wave(0), true);
    std::size_t last = 0, points = wave(0).point_count;
    while (send_on(task, wave(last), wave(last + 1), static_cast<int>(last))) {
        ++last;
        points += wave(last).ray_count;
        if (points > kMostPoints) return false;
        task.settings.checkpoint(0.0);
        trace(task, wave(last));
        shade_points(task, wave(last), false);
    }
    for (; last > 0; --last) gather(wave(last), wave(last - 1));
    write(first, color);
    return true;
}

// Light from the lights and all around, and what goes on.
void WaveShader::shade_points(const TileTask& task, Wave& wave, bool camera) {
    if (!scene_->simple) cross(task, wave);
    find_light(wave);
    for (const PointBatch& b : wave.batches) {
        TracedShadeJob job{};
        job.shading = scene_->shading;
        job.material = &scene_->shading->materials[task.frame.instances[b.instance].material];
        job.layout = task.shading_batches.layouts[b.instance];
        job.points = wave.points;
        job.shades = wave.shades;
        job.arrival = arrival_;
        job.first = b.first;
        job.count = b.count;
        scene_->kernels->shade(job);
    }
    if (!scene_->simple) choose_rays(task, wave, camera);
    const float* const radiance[3] = {wave.shades[kRadianceR], wave.shades[kRadianceG], wave.shades[kRadianceB]};
    if (wave.direct) {
        for (std::size_t c = 0; c < 3; ++c) std::copy_n(radiance[c], wave.ray_count, wave.light[c].data());
    } else {
        float* const light[3] = {wave.light[0].data(), wave.light[1].data(), wave.light[2].data()};
        for (const PointBatch& b : wave.batches)  // without what pads them
            for (std::uint32_t p = b.first; p < b.first + b.count; ++p) {
                const std::uint32_t ray = wave.ray[p];
                light[0][ray] = radiance[0][p], light[1][ray] = radiance[1][p], light[2][ray] = radiance[2][p];
            }
    }
    if (scene_->simple) return;
    for (Buffer<float>& passed : wave.passed)
        for (std::uint32_t p = 0; p < wave.point_count; ++p) passed[wave.ray[p]] = 0.0f;
    if (!camera) absorb(wave);
}

// Makes the rays that the points of a wave send on. False where there are none.
bool WaveShader::send_on(const TileTask& task, Wave& from, Wave& to, int depth) {
    to.ray_count = 0;
    if (!scene_->bounces || from.point_count == 0) return false;
    to.reserve_rays(5 * from.point_count);
    SpawnJob job{};
    job.points = from.points;
    job.shades = from.shades;
    job.count = from.point_count;
    job.least = scene_->least;
    job.rays = to.rays;
    const auto spawn = [&](SpawnJob::Kind kind, const std::uint32_t* used, int eta, float r, float g, float b) {
        job.kind = kind;
        job.used = used;
        job.eta = eta;
        job.channels[0] = r, job.channels[1] = g, job.channels[2] = b;
        const std::uint32_t before = job.made;
        scene_->kernels->spawn(job);
        if (!scene_->simple) {
            to.states.resize(job.made);
            for (std::uint32_t i = before; i < job.made; ++i)
                to.states[i] = next_state(task, from, point_of(to, i), job);
        }
        return job.made - before;
    };
    using enum SpawnJob::Kind;
    if (scene_->simple) {
        if (depth < scene_->max_depth)
            counters.mirrored_rays += spawn(kMirrored, from.used.data(), kEtaG, 1, 1, 1);
        else
            count_ended(job, from.used.data(), {kMirrored});
    } else {
        count_ended(job, stopped_.data(), {kMirrored, kRefracted});
        counters.mirrored_rays += spawn(kMirrored, bounding_.data(), kEtaG, 1, 1, 1);
        counters.refracted_rays += spawn(kRefracted, whole_.data(), kEtaG, 1, 1, 1);
        if (has_dispersed_) {
            counters.refracted_rays += spawn(kRefracted, dispersed_.data(), kEtaR, 1, 0, 0);
            counters.refracted_rays += spawn(kRefracted, dispersed_.data(), kEtaG, 0, 1, 0);
            counters.refracted_rays += spawn(kRefracted, dispersed_.data(), kEtaB, 0, 0, 1);
        }
        if (has_blended_) counters.straight_rays += spawn(kStraight, blended_.data(), kEtaG, 1, 1, 1);
    }
    counters.ended_by_contribution += job.faint;
    to.ray_count = job.made;
    return job.made > 0;
}

// Rays that would go on but for the depth.
void WaveShader::count_ended(SpawnJob job, const std::uint32_t* used, std::initializer_list<SpawnJob::Kind> kinds) {
    job.only_count = true;
    job.used = used;
    for (float& channel : job.channels) channel = 1.0f;
    for (const SpawnJob::Kind kind : kinds) {
        job.kind = kind;
        scene_->kernels->spawn(job);
    }
    counters.ended_by_depth += job.made;
}

// What came along the rays of a wave, to the points that they left: in their order, so mirrored light first.
void WaveShader::gather(const Wave& from, Wave& to) const {
    if (scene_->simple) {
        const float *const wr = from.rays[kWeightR], *const wg = from.rays[kWeightG], *const wb = from.rays[kWeightB];
        const float *const r = from.light[0].data(), *const g = from.light[1].data(), *const b = from.light[2].data();
        float *const sum_r = to.light[0].data(), *const sum_g = to.light[1].data(), *const sum_b = to.light[2].data();
        for (std::uint32_t i = 0; i < from.ray_count; ++i) {
            const std::uint32_t point = point_of(from, i), ray = to.direct ? point : to.ray[point];
            sum_r[ray] += wr[i] * r[i], sum_g[ray] += wg[i] * g[i], sum_b[ray] += wb[i] * b[i];
        }
        return;
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const float* const weight = from.rays[kWeightR + static_cast<int>(c)];
        const float* const light = from.light[c].data();
        float* const sum = to.light[c].data();
        for (std::uint32_t r = 0; r < from.ray_count; ++r) {
            const std::uint32_t ray = to.ray[point_of(from, r)];
            sum[ray] += weight[r] * (light[r] * from.kept[c][r]);
            to.passed[c][ray] += weight[r] * (from.passed[c][r] * from.kept[c][r]);
        }
    }
}

// Light that passes to the background makes the sample transparent by what passes in every channel; the rest of it is
// the background's light, coloured. The alpha of a blended surface is its own.
void WaveShader::write(std::uint32_t first, float* const (&color)[4]) const {
    const Wave& wave = *waves_[0];
    const auto blends = [this](std::uint32_t instance) {
        return scene_->shading->materials[scene_->frame->instances[instance].material].alpha_mode == AlphaMode::kBlend;
    };
    if (scene_->simple) {
        for (std::size_t c = 0; c < 3; ++c) std::copy_n(wave.light[c].data(), wave.ray_count, color[c] + first);
        std::fill_n(color[3] + first, wave.ray_count, 1.0f);
        return;
    }
    for (std::uint32_t p = 0; p < wave.point_count; ++p) {
        if (!wave.used[p]) continue;
        const std::uint32_t ray = wave.ray[p];
        const float least = std::min({wave.passed[0][ray], wave.passed[1][ray], wave.passed[2][ray]});
        const float clear = blends(wave.instance[ray]) ? 0.0f : std::min(least, 1.0f);
        for (std::size_t c = 0; c < 3; ++c)
            color[c][first + ray] = wave.light[c][ray] + (wave.passed[c][ray] - clear) * scene_->background[c];
        color[3][first + ray] = wave.shades[kAlpha][p] * (1.0f - clear);
    }
}

}  // namespace tessera
