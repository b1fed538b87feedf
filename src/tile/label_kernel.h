// Labels of a tile: distances and numbers from its depth and ordinals; normals, positions and the like from the
// surfaces at its pixels' centres. Part of a kernel file, once per instruction set.
#pragma once

#include "tile/point_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Writes a plane of numbers that `number(triangle)` says of what is seen; 0 for a miss.
template <class Number>
TESSERA_INLINE void label_numbers(const LabelJob& job, std::uint32_t* plane, Number&& number) {
    if (!plane) return;
    auto* const first = reinterpret_cast<unsigned char*>(plane);
    if (!job.ordinal) return fill_tile(first, job.window, Uint(0u));
    write_tile(first, job.window, [&](int at) {
        alignas(64) std::uint32_t lanes[kLanes<Float>];
        for (int lane = 0; lane < kLanes<Float>; ++lane) {
            const std::uint32_t o = job.ordinal[at + lane];
            lanes[lane] = o == 0 ? 0 : number(job.triangles[o - 1]) + 1;
        }
        return load<Uint>(lanes);
    });
}

inline void label_tile(const LabelJob& job) {
    const Float infinity = as_float(Uint(0x7f800000u));
    if (auto* const distances = reinterpret_cast<unsigned char*>(job.planes.distance)) {
        const PictureRays rays(job.projection);
        const int blocks = job.window.side / kBlockSide;
        const auto distance = [&](int at) {
            const Float along = distance_of_depth(job.projection, load<Float>(job.depth + at));
            if (!job.euclidean) return along;
            const int block = at / kBlockPixels, in_block = at % kBlockPixels;
            const int column = job.x0 + block % blocks * kBlockSide + in_block % kBlockSide,
                      row = job.y0 + block / blocks * kBlockSide + in_block / kBlockSide;
            return euclidean_distance(rays, along, to_float((lane_column() + Int(column)) << 8) + Float(128.0f),
                                      to_float((lane_row() + Int(row)) << 8) + Float(128.0f));
        };
        if (!job.ordinal)
            fill_tile(distances, job.window, as_uint(infinity));
        else
            write_tile(distances, job.window, [&](int at) {
                const Mask hit = load<Uint>(job.ordinal + at) != Uint(0u);
                if (!any(hit)) return as_uint(infinity);
                return as_uint(select(hit, distance(at), infinity));
            });
    }
    label_numbers(job, job.planes.triangle,
                  [&](const TileTriangle& t) { return job.instances[t.instance].first_triangle + t.triangle; });
    label_numbers(job, job.planes.primitive, [&](const TileTriangle& t) {
        return job.instances[t.instance].first_primitive + job.instances[t.instance].mesh.element_of(t.triangle);
    });
    label_numbers(job, job.planes.node, [&](const TileTriangle& t) { return job.instances[t.instance].node; });
    label_numbers(job, job.planes.material,
                  [&](const TileTriangle& t) { return job.instances[t.instance].scene_material; });
}

// Writes kNumbers numbers for each of the lanes, which are pixels from (column, row) of the tile on.
template <int kNumbers>
TESSERA_INLINE void write_lanes(float* plane, std::size_t picture_width, int column, int row, std::uint32_t lanes,
                                const Float (&values)[kNumbers]) {
    alignas(64) float numbers[kNumbers][kLanes<Float>];
    for (int i = 0; i < kNumbers; ++i) store(numbers[i], values[i]);
    for (; lanes; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        const auto x = static_cast<std::size_t>(column + lane % kBlockSide),
                   y = static_cast<std::size_t>(row + lane / kBlockSide);
        float* const to = plane + kNumbers * (y * picture_width + x);
        for (int i = 0; i < kNumbers; ++i) to[i] = numbers[i][lane];
    }
}

inline void label_surfaces_of(const LabelSurfaceJob& job) {
    const PictureRays rays(job.source->projection);
    const MaterialView material = *job.material;
    const SurfaceLayout layout = job.layout;
    const SurfaceLabels labels = job.labels;
    const LabelPlanes& planes = job.planes;
    const int blocks = job.side / kBlockSide;
    for (int at = 0; at < job.side * job.side; at += kLanes<Float>) {
        const Uint ordinals = load<Uint>(job.ordinal + at);
        const std::uint32_t used = mask_bits(ordinals != Uint(0u));
        if (!used) continue;
        const int block = at / kBlockPixels, in_block = at % kBlockPixels;
        const int column = block % blocks * kBlockSide + in_block % kBlockSide,
                  row = block / blocks * kBlockSide + in_block / kBlockSide;
        const Float x = to_float((lane_column() + Int(job.x0 + column)) << 8) + Float(128.0f),
                    y = to_float((lane_row() + Int(job.y0 + row)) << 8) + Float(128.0f);
        SurfaceSample<Float> sample;
        sample_lanes(job, layout, ordinals, job.ordinal + at, used, x, y, sample);
        SurfacePoint<Float> s = surface_point(layout, rays, sample, x, y, 1.0f);
        s.position = position_of_depth(job.source->projection, rays, load<Float>(job.depth + at), x, y);
        const LabelPoint<Float> p = label_point(labels, layout, material, job.label_from_camera, s);
        const auto write = [&](float* plane, const Vec3T<Float>& v) {
            const Float values[3] = {v.x, v.y, v.z};
            write_lanes(plane, job.picture_width, column, row, used, values);
        };
        if (labels.normal) write(planes.normal, p.normal);
        if (labels.shading_normal) write(planes.shading_normal, p.shading_normal);
        if (labels.position) write(planes.position, p.position);
        if (labels.albedo) write(planes.albedo, p.albedo);
        const Float uv[2] = {p.uv.x, p.uv.y};
        if (labels.uv) write_lanes(planes.uv, job.picture_width, column, row, used, uv);
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
