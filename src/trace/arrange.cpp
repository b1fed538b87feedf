// Points in the order of shading: those of one material and layout together, each batch from a boundary of vectors on.
#include "tile/tile.h"
#include "trace/waves.h"

#include <algorithm>

namespace tessera {

// The planes of all triangles that the samples may show.
void WaveShader::find_planes(const TileTask& task, const SampleList& samples) {
    const std::uint32_t* const seen = samples.seen;
    const std::uint32_t count = samples.seen_count;
    if (count == 0) return;
    float* const planes = planes_.reserve(4 * (std::size_t{count} + kMaxLanes));
    std::uint32_t* const plane_of = plane_of_.reserve(std::size_t{seen[count - 1]} + 1);  // ordinals rise
    for (std::uint32_t first = 0; first < count;) {
        const std::uint32_t instance = samples.triangles[seen[first] - 1].instance;
        plane_triangles_.clear();
        std::uint32_t end = first;
        for (; end < count && samples.triangles[seen[end] - 1].instance == instance; ++end) {
            plane_triangles_.push_back(samples.triangles[seen[end] - 1].triangle);
            plane_of[seen[end]] = 4 * end;
        }
        FlatPlanesJob job{};
        job.instance = &task.frame.instances[instance];
        job.triangles = plane_triangles_.data();
        job.count = end - first;
        job.planes = planes + 4 * std::size_t{first};
        scene_->kernels->flat_planes(job);
        first = end;
    }
}

// All rays hit one instance: points in the order of the rays. `named`: the rays have their triangles.
void WaveShader::arrange_one(Wave& wave, std::uint32_t instance, bool named) {
    const std::uint32_t count = wave.ray_count, padded = (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
    wave.direct = true;
    wave.point_count = padded;
    wave.reserve_points(padded);
    wave.batches.assign(1, {instance, 0, count});
    wave.runs.assign(1, {instance, 0, count});
    std::uint32_t* const ray = wave.ray.data();
    for (std::uint32_t p = 0; p < count; ++p) ray[p] = p;
    std::fill_n(wave.used.data(), count, ~0u);
    std::fill_n(ray + count, padded - count, count - 1);
    std::fill_n(wave.used.data() + count, padded - count, 0u);
    if (!named) return;
    std::copy_n(wave.triangle.data(), count, wave.hit_triangle.data());
    std::fill_n(wave.hit_triangle.data() + count, padded - count, wave.triangle[count - 1]);
}

// A counting sort of the rays that hit something by instance; instances in the order of their batches.
void WaveShader::arrange(const TileTask& task, Wave& wave) {
    constexpr std::uint32_t kUnknown = 0xffffffffu;
    const std::vector<std::uint32_t>& batch_of = task.shading_batches.batch_of;
    slot_of_instance_.resize(batch_of.size(), kUnknown);
    instances_.clear();
    counts_.clear();
    // Neighbours mostly hit the same instance.
    const std::uint32_t* const hit = wave.instance.data();
    for (std::uint32_t r = 0; r < wave.ray_count;) {
        const std::uint32_t i = hit[r], first = r;
        while (r < wave.ray_count && hit[r] == i) ++r;
        if (i == kNoHit) continue;
        if (slot_of_instance_[i] == kUnknown) {
            slot_of_instance_[i] = static_cast<std::uint32_t>(instances_.size());
            instances_.push_back(i);
            counts_.push_back(0);
        }
        counts_[slot_of_instance_[i]] += r - first;
    }
    if (instances_.size() == 1 && counts_[0] == wave.ray_count) {
        slot_of_instance_[instances_[0]] = kUnknown;
        return arrange_one(wave, instances_[0], true);
    }
    wave.direct = false;
    wave.batches.clear();
    wave.runs.clear();
    std::uint32_t at = 0;
    if (instances_.size() > 1) {
        std::sort(instances_.begin(), instances_.end(), [&](std::uint32_t a, std::uint32_t b) {
            return batch_of[a] != batch_of[b] ? batch_of[a] < batch_of[b] : a < b;
        });
    }
    const auto pad = [&at] { at = (at + kMaxLanes - 1) / kMaxLanes * kMaxLanes; };
    for (const std::uint32_t i : instances_) {
        const std::uint32_t count = counts_[slot_of_instance_[i]];
        if (wave.batches.empty() || batch_of[wave.batches.back().instance] != batch_of[i]) {
            pad();
            wave.batches.push_back({i, at, 0});
        }
        wave.runs.push_back({i, at, count});
        wave.batches.back().count += count;
        at += count;
    }
    pad();
    wave.point_count = at;
    wave.reserve_points(at);
    for (const InstanceRun& run : wave.runs) counts_[slot_of_instance_[run.instance]] = run.first;
    std::fill_n(wave.used.data(), at, ~0u);
    std::uint32_t* const ray = wave.ray.data();
    std::uint32_t* const hit_triangle = wave.hit_triangle.data();
    const std::uint32_t* const triangle = wave.triangle.data();
    for (std::uint32_t r = 0; r < wave.ray_count;) {
        const std::uint32_t i = hit[r], first = r;
        while (r < wave.ray_count && hit[r] == i) ++r;
        if (i == kNoHit) continue;
        std::uint32_t& to = counts_[slot_of_instance_[i]];
        for (std::uint32_t k = first; k < r; ++k) ray[to + k - first] = k;
        std::copy_n(triangle + first, r - first, hit_triangle + to);
        to += r - first;
    }
    // What pads a batch repeats its last point, and counts for nothing.
    for (const PointBatch& b : wave.batches)
        for (std::uint32_t p = b.first + b.count; p % kMaxLanes != 0; ++p) {
            wave.ray[p] = wave.ray[p - 1];
            wave.hit_triangle[p] = wave.hit_triangle[p - 1];
            wave.used[p] = 0;
        }
    for (const std::uint32_t i : instances_) slot_of_instance_[i] = kUnknown;
}

}  // namespace tessera
