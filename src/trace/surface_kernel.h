// Surface points of a wave: of samples of the picture through the records that the rasterizer has, and of rays
// anywhere. Part of a kernel file, once per instruction set.
#pragma once

#include "tile/point_kernel.h"
#include "trace/ray_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

inline void flat_planes(const FlatPlanesJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    const InstanceView& instance = *job.instance;
    const MeshView& mesh = instance.mesh;
    const RecordArray<3> positions(mesh.positions, mesh.vertex_count);
    for (std::uint32_t t = 0; t < job.count; t += kWidth) {
        Vec3T<Float> p[3];
        for (std::uint32_t k = 0; k < 3; ++k) {
            Float unused;
            load_records(
                [&](int lane) {
                    const std::uint32_t n = t + static_cast<std::uint32_t>(lane);
                    return positions.at(
                        mesh.triangles[3 * std::size_t{job.triangles[n < job.count ? n : job.count - 1]} + k]);
                },
                p[k].x, p[k].y, p[k].z, unused);
        }
        const Vec3T<Float> n = geometric_normal(instance, p[0], p[1], p[2]);
        const Float on_plane = dot(n, transform_point(instance.object_to_camera, p[0]));
        store_records([&](int lane) { return job.planes + 4 * (t + static_cast<std::uint32_t>(lane)); }, n.x, n.y, n.z,
                      on_plane);
    }
}

// What shading reads of a surface point.
TESSERA_INLINE void store_point(const WaveArrays& points, const SurfaceLayout& l, std::uint32_t at,
                                const SurfacePoint<Float>& s) {
    store3(points, kPositionX, at, s.position);
    store3(points, kViewX, at, s.view);
    store3(points, kNormalX, at, s.normal);
    store3(points, kFlatX, at, s.geometric_normal);
    store(points[kFacing] + at, s.side);
    if (l.color >= 0) {
        store3(points, kColorR, at, s.color.xyz());
        store(points[kColorA] + at, s.color.w);
    }
    for (int set = 0; set < kMaxUvSets; ++set) {
        if (l.uv[set] < 0) continue;
        const int n = kUv + 6 * set;
        store(points[n] + at, s.uv[set].x), store(points[n + 1] + at, s.uv[set].y);
        store(points[n + 2] + at, s.footprint[set].ux), store(points[n + 3] + at, s.footprint[set].vx);
        store(points[n + 4] + at, s.footprint[set].uy), store(points[n + 5] + at, s.footprint[set].vy);
    }
}

// The same surface function as the rasterizer's; then the position is moved onto the triangle's own plane, as rays
// start from it.
template <class Kind>
inline void primary_surfaces_as(const PrimarySurfacesJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    const SurfaceLayout layout = Kind::layout(job);
    const MaterialView material = *job.material;
    const PictureRays rays(job.source->projection);
    const float footprint_scale = job.source->shading->footprint_scale;
    for (std::uint32_t i = 0; i < job.count; i += kWidth) {
        const std::uint32_t left = job.count - i, used = left < kWidth ? (1u << left) - 1 : kAllLanes;
        const Float x = to_float(load<Int>(job.x + i)), y = to_float(load<Int>(job.y + i));
        SurfaceSample<Float> sample;
        sample_lanes(job, layout, load<Uint>(job.list + i), job.list + i, used, x, y, sample);
        SurfacePoint<Float> s = surface_point(layout, rays, sample, x, y, footprint_scale);
        s.side = sample.side;
        if (layout.tangent >= 0) s.normal = shading_normal(material, s);
        Vec3T<Float> front;
        Float on_plane;
        load_records(
            [&](int lane) { return job.planes + job.plane_of[job.list[i + static_cast<std::uint32_t>(lane)]]; },
            front.x, front.y, front.z, on_plane);
        s.position = onto_plane(s.position, front, on_plane);
        turn_to_viewer(s, front);
        const std::uint32_t at = job.first + i;
        store_point(job.points, layout, at, s);
        store(job.points[kFootprint] + at, Float(job.width) - s.position.z * Float(job.width_at_one));
        const Float size = load<Float>(job.points[kRounding] + at);
        store(job.points[kRounding] + at, coordinate_size(s.position, size));
    }
}

// Those that most scenes have are constants of the code.
inline void primary_surfaces(const PrimarySurfacesJob& job) {
    if (job.layout == NormalOnly::kLayout) return primary_surfaces_as<NormalOnly>(job);
    if (job.layout == NormalAndUv::kLayout) return primary_surfaces_as<NormalAndUv>(job);
    primary_surfaces_as<AnyLayout>(job);
}

// Numbers of the rays that a vector of points belongs to, which mostly follow each other.
class RayNumbers {
  public:
    TESSERA_INLINE RayNumbers(const WaveArrays& rays, const std::int32_t* ray)
        : rays_(rays), from_(load<Int>(ray)), first_(ray[0]) {
        follow_ = mask_bits(from_ != iota<Int>() + Int(first_)) == 0;
    }
    TESSERA_INLINE Float operator()(int n) const {
        return follow_ ? load<Float>(rays_[n] + first_) : gather(rays_[n], from_);
    }
    TESSERA_INLINE ConeRay<Float> cone() const {
        const auto& number = *this;
        return {{number(kOriginX), number(kOriginY), number(kOriginZ)},
                {number(kDirectionX), number(kDirectionY), number(kDirectionZ)},
                number(kConeWidth)};
    }

  private:
    WaveArrays rays_;
    Int from_;
    std::int32_t first_;
    bool follow_;
};

// Asks for what the hits from `first` on will be made of, which is seldom in a cache: indices two vectors ahead,
// vertices one.
TESSERA_INLINE void prefetch_hits(const RaySurfacesJob& job, const MeshView& mesh, std::uint32_t first) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    for (std::uint32_t n = first + kWidth; n < first + 2 * kWidth && n < job.count; ++n)
        __builtin_prefetch(mesh.triangles + 3 * std::size_t{job.triangle[n]});
    for (std::uint32_t n = first; n < first + kWidth && n < job.count; ++n) {
        const std::uint32_t* const corners = mesh.triangles + 3 * std::size_t{job.triangle[n]};
        for (int k = 0; k < 3; k += 2) {
            __builtin_prefetch(mesh.positions + 3 * std::size_t{corners[k]});
            if (mesh.normals) __builtin_prefetch(mesh.normals + 3 * std::size_t{corners[k]});
        }
    }
}

template <class Kind>
inline void ray_surfaces_as(const RaySurfacesJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    const SurfaceLayout layout = Kind::layout(job);
    const MaterialView material = *job.material;
    const InstanceView& instance = *job.instance;
    const MeshView& mesh = instance.mesh;
    const CornerArrays arrays(mesh, layout);
    for (std::uint32_t i = 0; i < job.count; i += kWidth) {
        prefetch_hits(job, mesh, i + kWidth);
        std::uint32_t vertices[3][kMaxLanes];
        alignas(64) std::int32_t ray[kLanes<Float>];
        for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
            const std::uint32_t n = i + lane < job.count ? i + lane : job.count - 1;
            const std::uint32_t* const corners = mesh.triangles + 3 * std::size_t{job.triangle[n]};
            for (int k = 0; k < 3; ++k) vertices[k][lane] = corners[k];
            ray[lane] = static_cast<std::int32_t>(job.ray[n]);
        }
        Corner<Float> c[3];
        for (int k = 0; k < 3; ++k) {
            arrays.load_corner(layout, vertices[k], c[k]);
            if (layout.depth < 0) arrays.load_position(vertices[k], c[k].position);
        }
        const RayNumbers number(job.rays, ray);
        const ConeRay<Float> cone = number.cone();
        RaySurface<Float> hit = ray_surface(instance, c, cone, job.spread, job.footprint_scale);
        if (layout.tangent >= 0) hit.point.normal = shading_normal(material, hit.point);
        const std::uint32_t at = job.first + i;
        store_point(job.points, layout, at, hit.point);
        store(job.points[kFootprint] + at, hit.width);
        store(job.distance + at, hit.distance);
        store(job.points[kRounding] + at, coordinate_size(hit.point.position, Float(job.instance_size)));
        store(job.points[kTimes] + at, number(kThroughput));
    }
}

inline void ray_surfaces(const RaySurfacesJob& job) {
    if (job.layout == NormalOnly::kLayout) return ray_surfaces_as<NormalOnly>(job);
    if (job.layout == NormalAndUv::kLayout) return ray_surfaces_as<NormalAndUv>(job);
    ray_surfaces_as<AnyLayout>(job);
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
