// Vertices into the picture, as many at a time as there are lanes. Part of the kernel file, once per
// instruction set.
#pragma once

#include "raster/raster_data.h"
#include "simd/records.h"
#include "tile/transformed_vertex.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

TESSERA_INLINE void store_transformed(const VertexJob& job, const Vec3T<Float>& position, TransformedVertex* out) {
    Float numbers[4];
    transform_vertex(to_clip(job.instance->object_to_clip, position), job.width, job.height, numbers);
    store_records([&](int i) { return out[i].numbers; }, numbers[0], numbers[1], numbers[2], numbers[3]);
}

inline void transform(const VertexJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    const MeshView& mesh = job.instance->mesh;
    Vec3T<Float> p;
    if (job.indices) {
        const RecordArray<3> positions(mesh.positions, mesh.vertex_count);
        for (std::uint32_t i = 0; i < job.count; i += kWidth) {
            Float unused;
            load_records(
                [&](int lane) {
                    const std::uint32_t k = i + static_cast<std::uint32_t>(lane);
                    return positions.at(job.indices[k < job.count ? k : job.count - 1]);
                },
                p.x, p.y, p.z, unused);
            store_transformed(job, p, job.out + i);
        }
        return;
    }
    const float* positions = mesh.positions + 3 * std::size_t{job.first};
    std::uint32_t i = 0;
    for (; i + kWidth <= job.count; i += kWidth) {
        load_triples(positions + 3 * std::size_t{i}, p.x, p.y, p.z);
        store_transformed(job, p, job.out + i);
    }
    if (i == job.count) return;
    float rest[3 * kWidth] = {};
    __builtin_memcpy(rest, positions + 3 * std::size_t{i}, (job.count - i) * 3 * sizeof(float));
    load_triples(rest, p.x, p.y, p.z);
    store_transformed(job, p, job.out + i);
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
