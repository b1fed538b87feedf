// Surface points of spheres and discs by their formula. Part of a kernel file, once per instruction set.
#pragma once

#include "shading/shape_surface.h"
#include "trace/surface_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

inline void shape_surfaces(const ShapeSurfacesJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    const SurfaceLayout layout = job.layout;
    const MaterialView material = *job.material;
    const InstanceView& instance = *job.instance;
    const PictureRays picture(*job.projection);
    const float width_at_one = picture.orthographic ? 0.0f : job.spread,
                width = picture.orthographic ? pixel_width(*job.projection) : 0.0f;
    const bool camera = job.rays.base == nullptr;
    for (std::uint32_t i = 0; i < job.count; i += kWidth) {
        alignas(64) std::uint32_t name[kLanes<Float>];
        alignas(64) std::int32_t ray[kLanes<Float>];
        for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
            const std::uint32_t n = i + lane < job.count ? i + lane : job.count - 1;
            name[lane] = job.name[n];
            ray[lane] = camera ? 0 : static_cast<std::int32_t>(job.ray[n]);
        }
        const RayNumbers number(job.rays, ray);
        ConeRay<Float> cone;
        if (camera)
            cone =
                picture_ray(*job.projection, picture, to_float(load<Int>(job.x + i)), to_float(load<Int>(job.y + i)));
        else
            cone = number.cone();
        RaySurface<Float> hit =
            shape_surface(instance, cone, load<Uint>(name) == Uint(kLeavingSphere), job.spread, job.footprint_scale);
        SurfacePoint<Float>& s = hit.point;
        if (layout.tangent >= 0) s.normal = shading_normal(material, s);
        const std::uint32_t at = job.first + i;
        store_point(job.points, layout, at, s);
        if (camera) hit.width = Float(width) - s.position.z * Float(width_at_one);
        store(job.points[kFootprint] + at, hit.width);
        store(job.points[kRounding] + at, coordinate_size(s.position, Float(job.instance_size)));
        store(job.points[kTimes] + at, camera ? Float(1.0f) : number(kThroughput));
        if (job.distance) store(job.distance + at, hit.distance);
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
