#include "trace_kernel_wave.h"

#include "geometry/matrix.h"
#include "shading/shape_surface.h"

#include <tessera/error.h>

#include <algorithm>
#include <map>

namespace tessera::bench {
namespace {

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 36;  // bytes for hierarchies

// The workloads are opaque.
std::vector<TraceClass> classes_of(const BenchFrame& frame) {
    std::vector<TraceClass> classes(frame.frame.instances.size());
    for (std::size_t i = 0; i < classes.size(); ++i)
        classes[i].culled = !frame.shading->context().materials[frame.frame.instances[i].material].double_sided;
    return classes;
}

template <class T>
void pad(std::vector<T>& list) {
    list.resize(list.size() + kMaxLanes, list.back());
}

}  // namespace

BenchWave::BenchWave(const Place& place)
    : frame_(BenchFrame::of(place.workload)),
      settings_(frame_.settings(Isa::kScalar)),
      task_(frame_.task(settings_, targets_, frame_.front)),
      kernels_(trace_kernels(Isa::kScalar)),
      scene_(best_isa(), kPlenty),
      x0_(place.x),
      y0_(place.y) {
    scene_.update(frame_.frame, classes_of(frame_), frame_.arena);
    find_samples();
    make_records();
    reset_points();
    kernels_.primary_surfaces(primary_surfaces());
    find_light();
    kernels_.shade(shade());
    mirrored_.reserve_rays(wave_.point_count);
    SpawnJob job = spawn();
    kernels_.spawn(job);
    mirrored_.ray_count = job.made;
    find_hits();
}

float BenchWave::size_of(std::uint32_t i) const { return largest_coordinate(instance(i), *frame_.frame.prepared[i]); }

// --- what is seen -------------------------------------------------------------------------------

PrimaryRaysJob BenchWave::primary_rays(int n, WavePacket& packet) const {
    constexpr int kRow = kSide / 4;
    const ProjectionView& picture = frame_.frame.projection;
    return {PictureRays(picture),
            scene_.trace_from_camera(),
            x0_ + n % kRow * 4,
            y0_ + n / kRow * 4,
            {128, 128},
            4,
            4,
            picture.near,
            distance_of_depth(picture, 0.0f),
            &packet};
}

void BenchWave::find_samples() {
    std::map<std::uint32_t, std::uint32_t> ordinals;
    WavePacket packet(kMeetsAll);
    for (int n = 0; n < kPackets; ++n) {
        const PrimaryRaysJob job = primary_rays(n, packet);
        kernels_.primary_rays(job);
        scene_.nearest(packet.valid, packet.rays, true, true, nullptr, true);
        for (int lane = 0; lane < kPacketWidth; ++lane) {
            const std::uint32_t hit = packet.rays.instance[lane], triangle = packet.rays.triangle[lane];
            if (instance_ == kNoHit) instance_ = hit;
            if (hit == kNoHit || hit != instance_) continue;
            const auto [found, fresh] = ordinals.try_emplace(triangle, triangles() + 1);
            if (fresh) triangles_.push_back(triangle);
            list_.push_back(found->second);
            x_.push_back(256 * (job.x + lane % 4) + 128);
            y_.push_back(256 * (job.y + lane / 4) + 128);
        }
    }
    if (list_.empty()) throw Error(ErrorCode::kInternal, "nothing is seen there");
    pad(x_), pad(y_), pad(list_);
    wave_.point_count = (samples() + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
    wave_.reserve_points(wave_.point_count);
    std::fill_n(wave_.used.data(), wave_.point_count, 0u);
    std::fill_n(wave_.used.data(), samples(), ~0u);
}

void BenchWave::make_records() {
    const std::size_t count = triangles_.size(), floats = static_cast<std::size_t>(surface_floats(layout()));
    records_.resize((count + kMaxLanes) * floats);
    planes_.resize(4 * (count + kMaxLanes));
    for (std::uint32_t ordinal = 0; ordinal <= count; ++ordinal) {
        const std::uint32_t at = ordinal - std::min(ordinal, 1u);
        record_of_.push_back(at * static_cast<std::uint32_t>(floats));
        plane_of_.push_back(4 * at);
    }
    tile_kernels(Isa::kScalar)
        .make_surfaces({&task_.source, instance_, layout(), triangles_.data(), triangles(), records_.data()});
    kernels_.flat_planes(flat_planes());
}

FlatPlanesJob BenchWave::flat_planes() {
    return {&instance(instance_), triangles_.data(), triangles(), planes_.data()};
}

void BenchWave::reset_points() {
    std::fill_n(wave_.points[0], static_cast<std::size_t>(kPointNumbers) * wave_.points.stride, -1.0f);
    const auto set = [&](int number, float value) { std::fill_n(wave_.points[number], wave_.point_count, value); };
    set(kTimes, 1.0f);
    set(kRounding, size_of(instance_));
    for (int number = kEtaR; number <= kEtaB; ++number) set(number, 1.0f);
}

PrimarySurfacesJob BenchWave::primary_surfaces() {
    const ProjectionView& picture = frame_.frame.projection;
    PrimarySurfacesJob job{};
    job.source = &task_.source;
    job.material = &material(instance_);
    job.layout = layout();
    job.records = records_.data();
    job.record_of = record_of_.data();
    job.planes = planes_.data();
    job.plane_of = plane_of_.data();
    job.x = x_.data();
    job.y = y_.data();
    job.list = list_.data();
    job.count = samples();
    job.width_at_one = 2.0f / (picture.height * picture.scale_y);
    job.points = wave_.points;
    return job;
}

// --- light --------------------------------------------------------------------------------------

ShadowRaysJob BenchWave::shadow_rays() {
    const std::size_t stride = wave_.point_count + kMaxLanes;
    shadow_memory_.resize(6 * stride);
    shadow_far_.resize(stride);
    shadow_point_.resize(stride);
    ShadowRaysJob job{};
    job.shading = &frame_.shading->context();
    job.points = wave_.points;
    job.used = wave_.used.data();
    job.count = wave_.point_count;
    job.rays = {shadow_memory_.data(), stride};
    job.t_far = shadow_far_.data();
    job.point = shadow_point_.data();
    return job;
}

PackJob BenchWave::pack_shadow_rays(std::uint32_t first, WavePacket& packet) const {
    const WaveArrays rays{const_cast<float*>(shadow_memory_.data()), wave_.point_count + kMaxLanes};  // only read
    return {rays, scene_.trace_from_camera(), first, shadow_count_, shadow_far_.data(), &packet};
}

// Of all lights; the first one's rays stay.
void BenchWave::find_light() {
    const int lights = frame_.shading->context().light_count;
    const std::size_t stride = wave_.point_count + kMaxLanes;
    arrives_.assign(static_cast<std::size_t>(lights) * stride, 0.0f);
    ShadowRaysJob job = shadow_rays();
    WavePacket packet(kMeetsSolid);
    for (job.light = lights - 1; job.light >= 0; --job.light) {
        kernels_.shadow_rays(job);
        shadow_count_ = job.made;
        for (std::uint32_t first = 0; first < job.made; first += kPacketWidth) {
            kernels_.pack(pack_shadow_rays(first, packet));
            scene_.occluded(packet.valid, packet.rays, true, nullptr, true);
            for (std::uint32_t lane = 0; lane < kPacketWidth && first + lane < job.made; ++lane)
                arrives_[static_cast<std::size_t>(job.light) * stride + shadow_point_[first + lane]] =
                    packet.rays.t_far[lane] < 0.0f ? 0.0f : 1.0f;
        }
    }
}

TracedShadeJob BenchWave::shade() {
    TracedShadeJob job{};
    job.shading = &frame_.shading->context();
    job.material = &material(instance_);
    job.layout = layout();
    job.points = wave_.points;
    job.shades = wave_.shades;
    job.arrival = {arrives_.data(), wave_.point_count + kMaxLanes, 1};
    job.count = samples();
    return job;
}

// --- what goes on -------------------------------------------------------------------------------

SpawnJob BenchWave::spawn() {
    SpawnJob job{};
    job.kind = SpawnJob::Kind::kMirrored;
    job.eta = kEtaG;
    for (float& channel : job.channels) channel = 1.0f;
    job.points = wave_.points;
    job.shades = wave_.shades;
    job.used = wave_.used.data();
    job.count = wave_.point_count;
    job.least = 0.002f;
    job.rays = mirrored_.rays;
    return job;
}

PackJob BenchWave::pack_mirrored_rays(std::uint32_t first, WavePacket& packet) const {
    return {mirrored_.rays, scene_.trace_from_camera(), first, mirrored(), nullptr, &packet};
}

void BenchWave::find_hits() {
    WavePacket packet(kMeetsSolid);
    for (std::uint32_t first = 0; first < mirrored(); first += kPacketWidth) {
        kernels_.pack(pack_mirrored_rays(first, packet));
        scene_.nearest(packet.valid, packet.rays, true, false, nullptr, true);
        for (std::uint32_t lane = 0; lane < kPacketWidth && first + lane < mirrored(); ++lane) {
            const std::uint32_t hit = packet.rays.instance[lane];
            if (hit_instance_ == kNoHit) hit_instance_ = hit;
            if (hit == kNoHit || hit != hit_instance_) continue;
            hit_ray_.push_back(first + lane);
            hit_triangle_.push_back(packet.rays.triangle[lane]);
        }
    }
    mirrored_.reserve_points(hits() + kMaxLanes);
}

RaySurfacesJob BenchWave::ray_surfaces() {
    const ProjectionView& picture = frame_.frame.projection;
    RaySurfacesJob job{};
    job.instance = &instance(hit_instance_);
    job.material = &material(hit_instance_);
    job.layout = hit_layout();
    job.rays = mirrored_.rays;
    job.ray = hit_ray_.data();
    job.triangle = hit_triangle_.data();
    job.count = hits();
    job.spread = 2.0f / (picture.height * picture.scale_y);
    job.footprint_scale = frame_.shading->context().footprint_scale;
    job.instance_size = size_of(hit_instance_);
    job.points = mirrored_.points;
    job.distance = mirrored_.distance.data();
    return job;
}

ShapeSurfacesJob BenchWave::shape_surfaces() {
    const RaySurfacesJob rays = ray_surfaces();
    sphere_ = *rays.instance;
    sphere_.shape.kind = ShapeView::Kind::kSphere;
    sphere_.shape.radius = 1;
    invert_rows(sphere_.object_to_camera, sphere_.shape.camera_to_object);
    names_.assign(rays.count, 0);
    for (std::uint32_t i = 0; i < rays.count; i += 3) names_[i] = kLeavingSphere;
    ShapeSurfacesJob job{};
    job.instance = &sphere_;
    job.material = rays.material;
    job.layout = rays.layout;
    job.projection = &frame_.frame.projection;
    job.rays = rays.rays;
    job.ray = rays.ray;
    job.name = names_.data();
    job.count = rays.count;
    job.first = rays.first;
    job.spread = rays.spread;
    job.footprint_scale = rays.footprint_scale;
    job.instance_size = rays.instance_size;
    job.points = rays.points;
    job.distance = rays.distance;
    return job;
}

}  // namespace tessera::bench
