// What the ray tracer and its kernels hand to each other: plain data. A wave is all rays of one depth that a part of a
// tile casts, and then the surface points that they hit; it has an array for every number. docs/raytracer.md explains
// the way of a wave.
#pragma once

#include "shading/traced_shade.h"
#include "tile/tile_data.h"
#include "trace/ray_packet.h"

#include <cstddef>
#include <cstdint>

namespace tessera {

// Arrays of a wave, one after the other; each may be read and written kMaxLanes beyond its end.
struct WaveArrays {
    float* base = nullptr;
    std::size_t stride = 0;

    TESSERA_INLINE float* operator[](int number) const { return base + static_cast<std::size_t>(number) * stride; }
};

// A ray, in camera space.
enum RayNumber : int {
    kOriginX,
    kOriginY,
    kOriginZ,
    kDirectionX,  // unit
    kDirectionY,
    kDirectionZ,
    kConeWidth,  // of its footprint at the origin
    kWeightR,    // what its light counts for the point that it starts from
    kWeightG,
    kWeightB,
    kThroughput,  // what it can count for the picture at most
    kParent,      // bits of that point's number
    kRayNumbers
};

inline ConeRay<float> cone_ray(const WaveArrays& rays, std::uint32_t i) {
    return {{rays[kOriginX][i], rays[kOriginY][i], rays[kOriginZ][i]},
            {rays[kDirectionX][i], rays[kDirectionY][i], rays[kDirectionZ][i]},
            rays[kConeWidth][i]};
}

// A surface point.
enum PointNumber : int {
    kPositionX,
    kPositionY,
    kPositionZ,
    kViewX,  // unit, against the ray
    kViewY,
    kViewZ,
    kNormalX,  // unit, on the viewer's side, bent by the normal map
    kNormalY,
    kNormalZ,
    kFlatX,  // the triangle's own, on the viewer's side
    kFlatY,
    kFlatZ,
    kFacing,     // +1 front, -1 back
    kFootprint,  // width of the ray's cone
    kRounding,   // size of the coordinates that the position is made of
    kEtaR,       // indices of refraction: viewer's side over the other
    kEtaG,
    kEtaB,
    kTimes,  // what the light that it sends back counts for the picture at most
    kColorR,
    kColorG,
    kColorB,
    kColorA,
    kUv,  // u, v, and the footprint's ux, vx, uy, vy; for every set
    kPointNumbers = kUv + 6 * kMaxUvSets
};

// What shading says of it.
enum ShadeNumber : int {
    kRadianceR,
    kRadianceG,
    kRadianceB,
    kAlpha,
    kReflectedR,
    kReflectedG,
    kReflectedB,
    kEnteringR,
    kEnteringG,
    kEnteringB,
    kShadeNumbers
};

// Rays of the camera through 4x4 pixels, row after row, in the space of the hierarchies.
struct PrimaryRaysJob {
    PictureRays rays;
    const float* trace_from_camera;  // 3x4 rows
    int x, y;                        // first pixel
    SamplePosition offset;
    int columns, rows;  // of those, in the picture
    float t_near, t_far;
    WavePacket* packet;
};

// The triangles that a packet's rays hit, each once, in the order of their first lanes.
struct PacketHits {
    std::uint32_t count, rays;                      // rays: that hit something
    std::uint32_t lane[kPacketWidth];               // of each the first
    alignas(64) std::uint32_t which[kPacketWidth];  // by lane: 1 + number of its triangle among them; 0: no hit
};

// Up to kPacketWidth rays of a wave, from `first` on.
struct PackJob {
    WaveArrays rays;
    const float* trace_from_camera;
    std::uint32_t first, count;  // of the wave's rays; count: all
    const float* t_far;          // by ray; null: without end
    WavePacket* packet;
};

// The planes that triangles of an instance lie in, in camera space: unit normal of the front, and its product with
// every point of the plane.
struct FlatPlanesJob {
    const InstanceView* instance;
    const std::uint32_t* triangles;  // within the instance
    std::uint32_t count;
    float* planes;  // four numbers a triangle, padded by kMaxLanes triangles
};

// Surface points of samples of the picture, of one material and layout, to the wave's points from `first` on.
struct PrimarySurfacesJob {
    const SurfaceSource* source;
    const MaterialView* material;
    SurfaceLayout layout;
    const float* records;
    const std::uint32_t* record_of;  // by ordinal: where in `records`
    const float* planes;
    const std::uint32_t* plane_of;  // by ordinal: where in `planes`
    const std::int32_t *x, *y;      // picture positions
    const std::uint32_t* list;      // ordinals
    std::uint32_t count, first;
    float width_at_one, width;  // of the cone at distance 1 along the view axis, or everywhere
    WaveArrays points;
};

// Surface points of hits of rays, all on one instance.
struct RaySurfacesJob {
    const InstanceView* instance;
    const MaterialView* material;
    SurfaceLayout layout;
    WaveArrays rays;
    const std::uint32_t *ray, *triangle;  // by point: which ray, and what it hit
    std::uint32_t count, first;
    float spread, footprint_scale;
    float instance_size;  // its largest coordinate in camera space
    WaveArrays points;
    float* distance;  // by point: how far the ray came
};

// Surface points of hits on an instance's shape (shape_surface.h): of rays, or of the camera's through picture
// positions.
struct ShapeSurfacesJob {
    const InstanceView* instance;
    const MaterialView* material;
    SurfaceLayout layout;
    const ProjectionView* projection;
    WaveArrays rays;            // none: the camera's
    const std::uint32_t* ray;   // by point: which
    const std::int32_t *x, *y;  // or the picture position
    const std::uint32_t* name;  // by point: as ShapeView says
    std::uint32_t count, first;
    float spread, footprint_scale;
    float instance_size;  // its largest coordinate in camera space
    WaveArrays points;
    float* distance;  // by point: how far the ray came; null for the camera's
};

// The rays from all points of a wave to one light, of those that it may reach, one after the other.
struct ShadowRaysJob {
    const ShadingContext* shading;
    int light;
    WaveArrays points;
    const std::uint32_t* used;  // by point: all bits or none
    std::uint32_t count;        // of points, a multiple of kMaxLanes
    WaveArrays rays;            // out: origins and directions, in camera space
    float* t_far;
    std::uint32_t* point;  // which one it starts from
    std::uint32_t made;    // out
};

// How much of every light arrives at the points: of light i in channel c from
// arrives + (i * channels + c) * stride on.
struct LightArrival {
    const float* arrives;
    std::size_t stride;
    int channels;  // 1 or 3
};

struct TracedShadeJob {
    const ShadingContext* shading;
    const MaterialView* material;
    SurfaceLayout layout;
    WaveArrays points, shades;
    LightArrival arrival;
    std::uint32_t first, count;
};

// The rays that points send on, those that may count for more than `least`.
struct SpawnJob {
    enum class Kind { kMirrored, kRefracted, kStraight };
    Kind kind;
    bool only_count;    // what it would make
    int eta;            // which of kEtaR .. kEtaB
    float channels[3];  // factors on the weights
    WaveArrays points, shades;
    const std::uint32_t* used;
    std::uint32_t count;
    float least;
    WaveArrays rays;      // out, from `made` on
    std::uint32_t made;   // in and out
    std::uint32_t faint;  // in and out: those that count for less
};

struct TraceKernels {
    void (*primary_rays)(const PrimaryRaysJob& job);
    void (*find_hits)(const WavePacket& packet, PacketHits& hits);
    void (*pack)(const PackJob& job);
    void (*flat_planes)(const FlatPlanesJob& job);
    void (*primary_surfaces)(const PrimarySurfacesJob& job);
    void (*ray_surfaces)(const RaySurfacesJob& job);
    void (*shape_surfaces)(const ShapeSurfacesJob& job);
    void (*shadow_rays)(ShadowRaysJob& job);
    void (*shade)(const TracedShadeJob& job);
    void (*spawn)(SpawnJob& job);
};

}  // namespace tessera
