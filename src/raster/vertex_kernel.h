// Vertices into the picture, as many at a time as there are lanes. Part of the kernel file, once per
// instruction set.
#pragma once

#include "raster/raster_data.h"
#include "simd/records.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// What says why a vertex is not plain (see transform()).
TESSERA_INLINE Uint codes_of(const ClipVertex<Float>& clip) {
    const Float largest(kLargestCoordinate);
    const Mask usable =
        (abs(clip.x) < largest) & (abs(clip.y) < largest) & (abs(clip.z) < largest) & (abs(clip.w) < largest);
    return select(usable, out_code(clip), Uint(kUnusable));
}

// A plain vertex is usable and within the near plane and the guard band; w > 0 but for matrices beyond reason,
// whose triangles may as well take the scalar path.
TESSERA_INLINE void store_transformed(const VertexJob& job, const Vec3T<Float>& position, TransformedVertex* out) {
    const ClipVertex<Float> clip = to_clip(job.instance->object_to_clip, position);
    const Float zero(0.0f), largest(kLargestCoordinate), guard = clip.w * Float(kGuardBand);
    const Float x = abs(clip.x), y = abs(clip.y);
    const Mask plain = (clip.w > zero) & (clip.w < largest) & (clip.z <= clip.w) & (abs(clip.z) < largest) &
                       (x <= guard) & (y <= guard) & (x < largest) & (y < largest);
    const PictureVertex<Float> p = to_picture(clip, job.width, job.height);
    Float numbers[4] = {p.x, p.y, clip.z / clip.w, Float(1.0f) / clip.w};
    if (!all(plain)) {
        numbers[0] = select(plain, numbers[0], zero);
        numbers[1] = select(plain, numbers[1], zero);
        numbers[2] = select(plain, numbers[2], as_float(codes_of(clip)));
        numbers[3] = select(plain, numbers[3], zero);
    }
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
