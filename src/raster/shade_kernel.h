// Shading of the points of one instance, as many at a time as there are lanes, and the film. The same
// templates as the reference, over vectors. Part of the kernel file, once per instruction set.
#pragma once

#include "raster/setup_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

TESSERA_INLINE Corner<Float> gather_corner(const MeshView& mesh, Int vertex) {
    Corner<Float> c;
    const Float zero(0.0f);
    const Int two = vertex * Int(2), three = vertex * Int(3), four = vertex * Int(4);
    c.position = gather_position(mesh.positions, vertex);
    c.normal = {gather(mesh.normals, three), gather(mesh.normals, three + Int(1)),
                gather(mesh.normals, three + Int(2))};
    c.tangent = c.color = {zero, zero, zero, zero};
    if (mesh.tangents)
        c.tangent = {gather(mesh.tangents, four), gather(mesh.tangents, four + Int(1)),
                     gather(mesh.tangents, four + Int(2)), gather(mesh.tangents, four + Int(3))};
    if (mesh.colors)
        c.color = {gather(mesh.colors, four), gather(mesh.colors, four + Int(1)), gather(mesh.colors, four + Int(2)),
                   gather(mesh.colors, four + Int(3))};
    for (int i = 0; i < kMaxUvSets; ++i) {
        c.uv[i] = {zero, zero};
        if (mesh.uvs[i]) c.uv[i] = {gather(mesh.uvs[i], two), gather(mesh.uvs[i], two + Int(1))};
    }
    return c;
}

// The surface points of triangles of one instance at picture positions.
inline SurfacePoint<Float> gather_surface(const InstanceView& instance, const ShadingContext& context,
                                          const ProjectionView& picture, Int triangle, Float orientation, Int x,
                                          Int y) {
    const auto* indices = reinterpret_cast<const std::int32_t*>(instance.mesh.triangles);
    Corner<Float> corners[3];
    ClipVertex<Float> clip[3];
    for (int k = 0; k < 3; ++k) {
        corners[k] = gather_corner(instance.mesh, gather(indices, triangle * Int(3) + Int(k)));
        clip[k] = to_clip(instance.object_to_clip, corners[k].position);
    }
    const Vec2T<Float> ndc = sample_ndc<Float>(x, y, picture.width, picture.height);
    const Barycentrics<Float> b = barycentrics(clip, ndc, orientation, picture.width, picture.height);
    return surface_point(instance, corners, b, orientation * Float(instance.handedness), context.footprint_scale);
}

inline void shade_points(const ShadeJob& job) {
    constexpr int kWidth = kLanes<Float>;
    const MaterialView& material = job.shading->materials[job.instance->material];
    for (std::uint32_t i = 0; i < job.count; i += kWidth) {
        const SurfacePoint<Float> s =
            gather_surface(*job.instance, *job.shading, job.projection, load<Int>(job.triangle + i),
                           load<Float>(job.orientation + i), load<Int>(job.x + i), load<Int>(job.y + i));
        const ShadedPoint<Float> p =
            shade(*job.shading, material, s, [](int, const LightSample<Float>&) { return Float(1.0f); });
        store(job.r + i, p.radiance.x);
        store(job.g + i, p.radiance.y);
        store(job.b + i, p.radiance.z);
        store(job.alpha + i, p.alpha);
        store(job.distance + i, -s.position.z);
    }
}

inline void develop_row(const DevelopJob& job) {
    constexpr int kWidth = kLanes<Float>;
    for (std::uint32_t i = 0; i < job.count; i += kWidth) {
        const Float weight(job.weight);
        const Vec3T<Float> mean{load<Float>(job.r + i) * weight, load<Float>(job.g + i) * weight,
                                load<Float>(job.b + i) * weight};
        const DisplayPixel<Float> d = develop(job.film, mean, load<Float>(job.alpha + i) * weight);
        const Int packed = d.r | (d.g << 8) | (d.b << 16) | (d.a << 24);
        alignas(64) std::int32_t pixels[kWidth];
        store(pixels, packed);
        const std::uint32_t left = job.count - i;
        __builtin_memcpy(job.rgba + 4 * i, pixels, 4 * (left < kWidth ? left : kWidth));
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
