// What tessera_trace_kernel_bench measures: a wave of the ray tracer as it occurs in the frames of the built-in
// workloads, and the rays that it sends on. Made by the scalar kernels; jobs point into it. One thread.
#pragma once

#include "raster_kernel_cases.h"

#include "trace/embree_scene.h"
#include "trace/kernels.h"
#include "trace/wave.h"

#include <vector>

namespace tessera::bench {

// Where in a workload's picture: the first pixel of a square.
struct Place {
    const char* workload;
    int x, y;
};
inline constexpr Place kSphere{"whitted_sphere100k", 960, 640}, kTerrain{"whitted_heightfield1m", 960, 640};
inline constexpr Place kStudio{"studio_sphere100k", 960, 540}, kSoup{"soup20k", 960, 540};  // these mirror nothing

// The samples of a square of pixels that show the same instance as the first of them that shows anything.
class BenchWave {
  public:
    static constexpr int kSide = 32;
    static constexpr int kPackets = kSide * kSide / kPacketWidth;

    explicit BenchWave(const Place& place);
    BenchWave(const BenchWave&) = delete;
    BenchWave& operator=(const BenchWave&) = delete;

    // Camera rays through the 4x4 pixels that packet `n` of the square has.
    PrimaryRaysJob primary_rays(int n, WavePacket& packet) const;
    FlatPlanesJob flat_planes();
    PrimarySurfacesJob primary_surfaces();
    // Towards the first light; `used` is all points.
    ShadowRaysJob shadow_rays();
    PackJob pack_shadow_rays(std::uint32_t first, WavePacket& packet) const;
    PackJob pack_mirrored_rays(std::uint32_t first, WavePacket& packet) const;
    TracedShadeJob shade();
    SpawnJob spawn();  // mirrored rays
    RaySurfacesJob ray_surfaces();
    // The same rays on a sphere, wherever they go.
    ShapeSurfacesJob shape_surfaces();
    const EmbreeScene& scene() const { return scene_; }

    std::uint32_t samples() const { return static_cast<std::uint32_t>(list_.size() - kMaxLanes); }
    std::uint32_t triangles() const { return static_cast<std::uint32_t>(triangles_.size()); }
    std::uint32_t shadows() const { return shadow_count_; }
    std::uint32_t mirrored() const { return mirrored_.ray_count; }
    std::uint32_t hits() const { return static_cast<std::uint32_t>(hit_ray_.size()); }  // of those, on one instance
    const SurfaceLayout& layout() const { return layout_of(instance_); }
    const SurfaceLayout& hit_layout() const { return layout_of(hit_instance_); }
    // Numbers that primary_surfaces reads and writes, as they were before it.
    void reset_points();

  private:
    const InstanceView& instance(std::uint32_t i) const { return frame_.frame.instances[i]; }
    const MaterialView& material(std::uint32_t i) const {
        return frame_.shading->context().materials[instance(i).material];
    }
    const SurfaceLayout& layout_of(std::uint32_t i) const { return task_.shading_batches.layouts[i]; }
    float size_of(std::uint32_t i) const;
    void find_samples();
    void make_records();
    void find_light();
    void find_hits();

    BenchFrame& frame_;
    const RasterSettings settings_;
    const PictureTargets targets_;
    const TileTask task_;
    const TraceKernels& kernels_;
    EmbreeScene scene_;
    InstanceView sphere_{};
    std::vector<std::uint32_t> names_;
    const int x0_, y0_;

    std::uint32_t instance_ = kNoHit, hit_instance_ = kNoHit;
    std::vector<std::int32_t> x_, y_;       // samples, in 1/256 pixel
    std::vector<std::uint32_t> list_;       // their ordinals, padded
    std::vector<std::uint32_t> triangles_;  // by ordinal - 1
    std::vector<std::uint32_t> record_of_, plane_of_;
    std::vector<float> records_, planes_;
    Wave wave_, mirrored_;
    std::vector<float> shadow_memory_, shadow_far_, arrives_;
    std::vector<std::uint32_t> shadow_point_;
    std::uint32_t shadow_count_ = 0;
    std::vector<std::uint32_t> hit_ray_, hit_triangle_;
};

// A wave and one of its jobs.
template <class Job>
struct WaveJob {
    BenchWave wave;
    Job job;

    WaveJob(const Place& place, Job (BenchWave::*make)()) : wave(place), job((wave.*make)()) {}
};

}  // namespace tessera::bench
