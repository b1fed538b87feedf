// The ray tracer's shading: the samples of a tile, and wave after wave of the rays that they send on. waves.cpp is the
// ray tracer on one page.
#pragma once

#include "trace/engine.h"
#include "trace/kernels.h"
#include "trace/sheer_surface.h"
#include "trace/wave.h"

#include "tile/point_shader.h"

#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

namespace tessera {

// What all tasks of a frame share.
struct TransportScene {
    const EmbreeScene* scene;
    const Frame* frame;
    const ShadingContext* shading;
    const TraceKernels* kernels;
    std::vector<float> instance_size;  // by instance: its largest coordinate in camera space
    // By instance: what straight light leaves of itself in it, where that is the same everywhere.
    std::vector<std::optional<Vec3T<float>>> even_transmittance;
    bool simple;            // nothing lets light through
    bool shadows, bounces;  // whether they are wanted
    int max_depth;
    float least;          // contribution
    float spread;         // of the cones of rays, per metre
    float background[3];  // radiance, where a picture has one
};

class WaveShader final : public PointShader {
  public:
    // Before a frame.
    void begin(const TransportScene& scene);
    void shade(const TileTask& task, const SampleList& samples, float* const (&color)[4]) override;

    TransportCounters counters;

  private:
    // waves.cpp
    void shade_part(const TileTask& task, const SampleList& samples, std::uint32_t first, std::uint32_t count,
                    float* const (&color)[4]);
    bool shade_samples(const TileTask& task, const SampleList& samples, std::uint32_t first, std::uint32_t count,
                       float* const (&color)[4]);
    void shade_points(const TileTask& task, Wave& wave, bool camera);
    bool send_on(const TileTask& task, Wave& from, Wave& to, int depth);
    void count_ended(SpawnJob job, const std::uint32_t* used, std::initializer_list<SpawnJob::Kind> kinds);
    void gather(const Wave& from, Wave& to) const;
    void write(std::uint32_t first, float* const (&color)[4]) const;
    // first_wave.cpp
    void take_samples(const TileTask& task, const SampleList& samples, std::uint32_t first, std::uint32_t count);
    void find_picture_points(const TileTask& task, const SampleList& samples, const std::int32_t* x,
                             const std::int32_t* y, const std::uint32_t* ordinal);
    // arrange.cpp
    void arrange(const TileTask& task, Wave& wave);
    void arrange_one(Wave& wave, std::uint32_t instance, bool named);
    void find_planes(const TileTask& task, const SampleList& samples);
    // trace_wave.cpp
    void trace(const TileTask& task, Wave& wave);
    void find_shape_points(const TileTask& task, Wave& wave, const InstanceRun& run, const std::int32_t* x,
                           const std::int32_t* y) const;
    void see_sheer(Wave& wave, std::uint32_t first, const RayPacket<kPacketWidth>& packet);
    void miss(Wave& wave, std::uint32_t ray) const;
    // light.cpp
    void find_light(Wave& wave);
    void attenuate(RayPacket<kPacketWidth>& packet, const int* valid, std::uint32_t first, float* arrived,
                   const Wave& wave);
    // media.cpp
    void cross(const TileTask& task, Wave& wave);
    void choose_rays(const TileTask& task, Wave& wave, bool camera);
    void absorb(Wave& wave) const;
    RayState next_state(const TileTask& task, const Wave& from, std::uint32_t point, const SpawnJob& job) const;

    const TransportScene* scene_ = nullptr;
    std::optional<SheerSurface> sheer_surface_;
    std::vector<std::unique_ptr<Wave>> waves_;
    WavePacket packet_{kMeetsSolid | kMeetsSheer}, shadow_packet_{kMeetsSolid};
    // arrange.cpp
    Buffer<std::uint32_t> plane_of_;              // by ordinal: where in planes_
    Buffer<float> planes_;                        // of triangles
    std::vector<std::uint32_t> plane_triangles_;  // of an instance
    std::vector<std::uint32_t> slot_of_instance_, instances_, counts_;
    Buffer<std::int32_t> x_, y_;
    Buffer<std::uint32_t> ordinal_;
    // light.cpp
    WaveArrays shadow_rays_;
    Buffer<float> shadow_memory_, shadow_far_, arrival_memory_;
    Buffer<std::uint32_t> shadow_point_, lit_;
    LightArrival arrival_{};
    std::vector<SheerHit> sheer_;
    // media.cpp
    Buffer<std::uint32_t> clear_;  // by point: it is no boundary of what fills the space
    // By point: which rays it may send; all bits or none.
    Buffer<std::uint32_t> bounding_, stopped_, whole_, dispersed_, blended_;
    bool has_dispersed_ = false, has_blended_ = false;
};

}  // namespace tessera
