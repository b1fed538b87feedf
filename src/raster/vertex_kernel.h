// Vertices into the picture, as many at a time as there are lanes. Part of the kernel file, once per
// instruction set.
#pragma once

#include "raster/raster_data.h"
#include "simd/records.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

inline void index_range(const std::uint32_t* indices, std::uint32_t count, std::uint32_t& low, std::uint32_t& high) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    std::uint32_t least = indices[0], most = indices[0], i = 0;
    if (count >= kWidth) {
        // Indices are below 2^31.
        Int a = as_int(load<Uint>(indices)), b = a;
        for (; i + kWidth <= count; i += kWidth) {
            const Int v = as_int(load<Uint>(indices + i));
            a = min(a, v);
            b = max(b, v);
        }
        std::int32_t lanes[2][kWidth];
        store(lanes[0], a);
        store(lanes[1], b);
        for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
            const auto x = static_cast<std::uint32_t>(lanes[0][lane]), y = static_cast<std::uint32_t>(lanes[1][lane]);
            if (x < least) least = x;
            if (y > most) most = y;
        }
    }
    for (; i < count; ++i) {
        if (indices[i] < least) least = indices[i];
        if (indices[i] > most) most = indices[i];
    }
    low = least;
    high = most;
}

// An array of records of `stride` floats that may be read four floats at a time: the last record, after
// which memory may end, is read from a copy.
template <int kNumbers>
struct RecordArray {
    const float* base = nullptr;
    std::uint32_t last = 0;
    float tail[4] = {0, 0, 0, 0};

    TESSERA_INLINE RecordArray() = default;
    TESSERA_INLINE RecordArray(const float* array, std::uint32_t count) : base(array), last(count - 1) {
        if (array)
            for (int i = 0; i < kNumbers; ++i) tail[i] = array[std::size_t{last} * kNumbers + i];
    }
    TESSERA_INLINE const float* at(std::uint32_t i) const {
        return i == last ? tail : base + std::size_t{i} * kNumbers;
    }
};

TESSERA_INLINE void store_transformed(const VertexJob& job, const Vec3T<Float>& position, TransformedVertex* out) {
    const ClipVertex<Float> clip = to_clip(job.instance->object_to_clip, position);
    const Float largest(kLargestCoordinate);
    const Mask usable =
        (abs(clip.x) < largest) & (abs(clip.y) < largest) & (abs(clip.z) < largest) & (abs(clip.w) < largest);
    const Uint code = select(usable, out_code(clip), Uint(kUnusable));
    const Mask plain = (code & Uint(kMustClip | kUnusable)) == Uint(0u);
    const PictureVertex<Float> p = to_picture(clip, job.width, job.height);
    const Float zero(0.0f);
    store_records([&](int i) { return out[i].numbers; }, select(plain, p.x, zero), select(plain, p.y, zero),
                  select(plain, clip.z / clip.w, zero), as_float(code));
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
