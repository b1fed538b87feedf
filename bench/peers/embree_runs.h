// What the programs that time Embree share: a device with so many threads, scenes as Embree's, packets by width, a loop
// over the tiles of a frame and medians of wall and processor time.
#pragma once

#include "bench/peers/embree_scenes.h"

#include <embree3/rtcore.h>
#include <sys/resource.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <cstring>
#include <type_traits>

namespace peers {

// Embree with `threads` threads, and TBB with no more.
class Device {
  public:
    explicit Device(int threads)
        : limit_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)),
          device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())) {
        check();
    }
    ~Device() { rtcReleaseDevice(device_); }
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    operator RTCDevice() const { return device_; }
    void check() const {
        const RTCError error = rtcGetDeviceError(device_);
        if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree reports error " + std::to_string(error));
    }

  private:
    tbb::global_control limit_;
    RTCDevice device_;
};

// Copies a mesh and adds it to a scene. The caller releases the geometry.
inline RTCGeometry add_geometry(RTCDevice device, RTCScene scene, const Mesh& mesh, RTCBuildQuality quality) {
    static_assert(sizeof(vec3) == 12);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto copy = [geometry](RTCBufferType type, RTCFormat format, std::size_t items, const void* from) {
        std::memcpy(rtcSetNewGeometryBuffer(geometry, type, 0, format, 12, items), from, 12 * items);
    };
    copy(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.positions.size(), mesh.positions.data());
    copy(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles(), mesh.indices.data());
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    return geometry;
}

// Mesh and ground, not yet committed.
inline RTCScene new_scene(const Device& device, const Scene& scene, RTCBuildQuality quality, RTCSceneFlags flags) {
    const RTCScene traced = rtcNewScene(device);
    rtcSetSceneBuildQuality(traced, quality);
    rtcSetSceneFlags(traced, flags);
    for (const Mesh* mesh : {&scene.mesh, &scene.ground})
        if (mesh->triangles() > 0) rtcReleaseGeometry(add_geometry(device, traced, *mesh, quality));
    return traced;
}

inline RTCIntersectContext make_context(bool coherent) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

// --- packets of W rays: valid[i] is -1 for a ray and 0 for none ---------------------------------

template <int W>
using RayPacket = std::conditional_t<W == 4, RTCRay4, std::conditional_t<W == 8, RTCRay8, RTCRay16>>;
template <int W>
using RayHitPacket = std::conditional_t<W == 4, RTCRayHit4, std::conditional_t<W == 8, RTCRayHit8, RTCRayHit16>>;

inline void intersect(const int* valid, RTCScene s, RTCIntersectContext& c, RTCRayHit4& p) {
    rtcIntersect4(valid, s, &c, &p);
}
inline void intersect(const int* valid, RTCScene s, RTCIntersectContext& c, RTCRayHit8& p) {
    rtcIntersect8(valid, s, &c, &p);
}
inline void intersect(const int* valid, RTCScene s, RTCIntersectContext& c, RTCRayHit16& p) {
    rtcIntersect16(valid, s, &c, &p);
}
inline void occluded(const int* valid, RTCScene s, RTCIntersectContext& c, RTCRay4& p) {
    rtcOccluded4(valid, s, &c, &p);
}
inline void occluded(const int* valid, RTCScene s, RTCIntersectContext& c, RTCRay8& p) {
    rtcOccluded8(valid, s, &c, &p);
}
inline void occluded(const int* valid, RTCScene s, RTCIntersectContext& c, RTCRay16& p) {
    rtcOccluded16(valid, s, &c, &p);
}

// W rays from `first` of the tile on; lanes from `count` on are not traced.
template <int W, int N, class Packet>
void load_rays(const Rays<N>& rays, int first, int count, Packet& p, int* valid) {
    const auto copy = [first](float* to, const float* from) { std::memcpy(to, from + first, W * sizeof(float)); };
    copy(p.org_x, rays.org_x), copy(p.org_y, rays.org_y), copy(p.org_z, rays.org_z);
    copy(p.dir_x, rays.dir_x), copy(p.dir_y, rays.dir_y), copy(p.dir_z, rays.dir_z);
    copy(p.tnear, rays.t_near), copy(p.tfar, rays.t_far);
    for (int i = 0; i < W; ++i) {
        valid[i] = first + i < count ? -1 : 0;
        p.time[i] = 0;
        p.mask[i] = ~0u, p.id[i] = 0, p.flags[i] = 0;
    }
}

template <int W>
void clear_hits(RayHitPacket<W>& p) {
    for (int i = 0; i < W; ++i) p.hit.geomID[i] = p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

inline RTCRay single_ray(vec3 origin, vec3 direction, float near, float far) {
    return {origin.x, origin.y, origin.z, near, direction.x, direction.y, direction.z, 0, far, ~0u, 0, 0};
}

// The nearest hit of a single ray; geomID is RTC_INVALID_GEOMETRY_ID where there is none.
inline RTCRayHit intersect(RTCScene scene, RTCIntersectContext& context, vec3 origin, vec3 direction, float near = 0,
                           float far = kEverything) {
    RTCRayHit query;
    query.ray = single_ray(origin, direction, near, far);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    return query;
}

// The unit normal of a hit, on the side that the ray comes from.
inline vec3 facing_normal(const RTCRayHit& query) {
    const vec3 normal = glm::normalize(vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z));
    const bool behind = glm::dot(normal, vec3(query.ray.dir_x, query.ray.dir_y, query.ray.dir_z)) > 0;
    return behind ? -normal : normal;
}

// --- loops and times ---------------------------------------------------------------------------

struct Totals {
    std::size_t rays = 0, hits = 0;
    double distance = 0;  // sum over the hits

    double mean_distance() const { return hits == 0 ? 0 : distance / static_cast<double>(hits); }
};

// body(tile, rays, totals) for every tile of the frame, in parallel; `rays` is the thread's own room.
template <class Body>
Totals for_tiles(const Frame& frame, const Body& body) {
    tbb::enumerable_thread_specific<Totals> parts;
    const tbb::blocked_range<int> tiles(0, frame.tiles(), 1);
    tbb::parallel_for(
        tiles,
        [&](const tbb::blocked_range<int>& range) {
            static thread_local RayTile rays;
            Totals& part = parts.local();
            for (int tile = range.begin(); tile < range.end(); ++tile) body(tile, rays, part);
        },
        tbb::simple_partitioner());
    Totals all;
    for (const Totals& part : parts) {
        all.rays += part.rays;
        all.hits += part.hits;
        all.distance += part.distance;
    }
    return all;
}

// The hits of the primary rays, where the secondary rays start.
inline void find_points(RTCScene scene, Frame& frame) {
    for_tiles(frame, [&frame, scene](int tile, RayTile& rays, Totals&) {
        RTCIntersectContext context = make_context(false);
        const int count = frame.generate(Kind::kPrimary, tile, rays);
        SurfacePoints& points = frame.points[static_cast<std::size_t>(tile)];
        for (int i = 0; i < count; ++i) {
            const vec3 direction(rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]);
            const RTCRayHit query = intersect(scene, context, frame.camera.eye, direction);
            if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
            const int pixel = tile * frame.tile_side * frame.tile_side + i;
            points.add(frame.camera.eye + query.ray.tfar * direction, facing_normal(query),
                       static_cast<std::uint32_t>(pixel));
        }
    });
}

// Packets run through other code than single rays, so a ray that grazes an edge may be decided the other way; on these
// scenes none is.
inline constexpr double kHitTolerance = 2e-6;       // of the rays
inline constexpr double kDistanceTolerance = 2e-6;  // of the mean distance

// Whether packets found what single rays did: else something is wrong, and their speed says nothing.
inline bool agree(const Totals& packets, const Totals& singles) {
    const double hits = std::abs(static_cast<double>(packets.hits) - static_cast<double>(singles.hits));
    const double distance = std::abs(packets.mean_distance() - singles.mean_distance());
    return packets.rays == singles.rays && hits <= kHitTolerance * static_cast<double>(singles.rays) &&
           distance <= kDistanceTolerance * singles.mean_distance();
}

inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 != 0 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

// Seconds that `run` takes, medians of `repeats`; `prepare` comes before each, untimed. The processor time is that of
// all threads.
struct Times {
    double wall = 0, processor = 0;
};
template <class Prepare, class Run>
Times measure(int repeats, const Prepare& prepare, const Run& run) {
    const auto processor = [] {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        const auto seconds = [](const timeval& t) {
            return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        };
        return seconds(usage.ru_utime) + seconds(usage.ru_stime);
    };
    std::vector<double> wall, cpu;
    for (int k = 0; k < repeats; ++k) {
        prepare();
        const double before = processor();
        const auto start = std::chrono::steady_clock::now();
        run();
        wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        cpu.push_back(processor() - before);
    }
    return {median(wall), median(cpu)};
}

}  // namespace peers
