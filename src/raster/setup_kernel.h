// Set-up of as many triangles at a time as there are lanes: transform, out-codes, snapping, facing,
// culling, depth planes. Part of the kernel file, once per instruction set.
#pragma once

#include "raster/raster_data.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Triangles whose box is smaller than 64 pixels have areas that are exact in 32 bits.
inline constexpr std::int32_t kSmall = 64 * 256;

TESSERA_INLINE Vec3T<Float> gather_position(const float* positions, Int vertex) {
    const Int at = vertex * Int(3);
    return {gather(positions, at), gather(positions, at + Int(1)), gather(positions, at + Int(2))};
}

// Whether a sample lies between two coordinates (inclusive) and within 0 .. limit pixels.
TESSERA_INLINE Mask reaches_sample(Int low, Int high, std::int32_t offset, float limit) {
    const Int first = max((low - Int(offset) + Int(255)) >> 8, Int(0));
    const Int last = min((high - Int(offset)) >> 8, Int(static_cast<std::int32_t>(limit) - 1));
    return !(first > last);
}

TESSERA_INLINE void count_lanes(std::uint64_t& counter, Mask m) {
    counter += static_cast<std::uint64_t>(__builtin_popcount(mask_bits(m)));
}

inline void setup(SetupJob& job) {
    constexpr int kWidth = kLanes<Float>;
    const InstanceView& instance = *job.instance;
    const float width = job.projection.width, height = job.projection.height;
    const auto* indices = reinterpret_cast<const std::int32_t*>(instance.mesh.triangles);
    job.record_count = job.slow_count = 0;
    alignas(64) std::int32_t sx[3][kWidth], sy[3][kWidth], anchor_x[kWidth], anchor_y[kWidth];
    alignas(64) float plane[5][kWidth], orientation[kWidth];
    for (std::uint32_t t = 0; t < job.count; t += kWidth) {
        const std::uint32_t left = job.count - t;
        const Mask valid = first_n<Float>(left < kWidth ? static_cast<int>(left) : kWidth);
        // Lanes beyond the end repeat the last triangle.
        const Int number =
            min(iota<Int>() + Int(static_cast<std::int32_t>(t)), Int(static_cast<std::int32_t>(job.count) - 1));
        const Int corner = (number + Int(static_cast<std::int32_t>(job.first))) * Int(3);
        ClipVertex<Float> clip[3];
        Uint all(~0u), some(0u);
        Mask finite = valid;
        for (int k = 0; k < 3; ++k) {
            clip[k] = to_clip(instance.object_to_clip,
                              gather_position(instance.mesh.positions, gather(indices, corner + Int(k))));
            const Uint code = out_code(clip[k]);
            all &= code;
            some |= code;
            const Float largest(kLargestCoordinate);
            finite &= (abs(clip[k].x) < largest) & (abs(clip[k].y) < largest) & (abs(clip[k].z) < largest) &
                      (abs(clip[k].w) < largest);
        }
        const Mask outside = finite & ((all & Uint(~static_cast<std::uint32_t>(kOutGuard))) != Uint(0u));
        const Mask clipped = finite & !outside & ((some & Uint(kMustClip)) != Uint(0u));
        const Mask inside = finite & !outside & !clipped;

        PictureVertex<Float> p[3];
        Float z[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = to_picture(clip[k], width, height);
            // Lanes that are out anyway must not overflow.
            p[k].snapped_x = select(inside, p[k].snapped_x, Int(0));
            p[k].snapped_y = select(inside, p[k].snapped_y, Int(0));
            z[k] = clip[k].z / clip[k].w;
        }
        const Int low_x = min(min(p[0].snapped_x, p[1].snapped_x), p[2].snapped_x);
        const Int high_x = max(max(p[0].snapped_x, p[1].snapped_x), p[2].snapped_x);
        const Int low_y = min(min(p[0].snapped_y, p[1].snapped_y), p[2].snapped_y);
        const Int high_y = max(max(p[0].snapped_y, p[1].snapped_y), p[2].snapped_y);
        const Mask small = inside & (high_x - low_x < Int(kSmall)) & (high_y - low_y < Int(kSmall));
        const Int dx1 = select(small, p[1].snapped_x - p[0].snapped_x, Int(0)),
                  dy1 = select(small, p[1].snapped_y - p[0].snapped_y, Int(0));
        const Int dx2 = select(small, p[2].snapped_x - p[0].snapped_x, Int(0)),
                  dy2 = select(small, p[2].snapped_y - p[0].snapped_y, Int(0));
        const Int area = dx1 * dy2 - dx2 * dy1;
        const Mask flat = small & (area == Int(0));
        const Mask counter_clockwise = area < Int(0);
        const Mask front = instance.handedness > 0 ? counter_clockwise : !counter_clockwise;
        const Mask facing = job.double_sided ? small : small & front;
        Mask keep = facing & !flat;
        if (job.one_sample)
            keep &= reaches_sample(low_x, high_x, job.sample.x, width) &
                    reaches_sample(low_y, high_y, job.sample.y, height);

        count_lanes(job.counters.frustum, outside);
        count_lanes(job.counters.degenerate, (valid & !finite) | flat);
        count_lanes(job.counters.backface, small & !flat & !facing);

        const std::uint32_t slow = mask_bits(clipped | (inside & !small));
        for (std::uint32_t bits = slow; bits; bits &= bits - 1)
            job.slow[job.slow_count++] = job.first + t + static_cast<std::uint32_t>(__builtin_ctz(bits));
        std::uint32_t kept = mask_bits(keep);
        if (!kept) continue;
        const DepthPlane<Float> depth = depth_plane(p, z);
        for (int k = 0; k < 3; ++k) {
            store(sx[k], p[k].snapped_x);
            store(sy[k], p[k].snapped_y);
        }
        store(anchor_x, depth.anchor_x);
        store(anchor_y, depth.anchor_y);
        const Float values[5] = {depth.depth, depth.ddx, depth.ddy, depth.lowest, depth.highest};
        for (int k = 0; k < 5; ++k) store(plane[k], values[k]);
        store(orientation, select(counter_clockwise, Float(1.0f), Float(-1.0f)));
        for (; kept; kept &= kept - 1) {
            const int i = __builtin_ctz(kept);
            TriangleRecord& r = job.records[job.record_count++];
            // Counter-clockwise ones are turned, so that all run clockwise on the screen.
            const int b = orientation[i] > 0 ? 2 : 1, c = 3 - b;
            r.v[0] = {sx[0][i], sy[0][i]};
            r.v[1] = {sx[b][i], sy[b][i]};
            r.v[2] = {sx[c][i], sy[c][i]};
            r.depth.anchor_x = anchor_x[i];
            r.depth.anchor_y = anchor_y[i];
            r.depth.depth = plane[0][i];
            r.depth.ddx = plane[1][i];
            r.depth.ddy = plane[2][i];
            r.depth.lowest = plane[3][i];
            r.depth.highest = plane[4][i];
            r.triangle = job.first + t + static_cast<std::uint32_t>(i);
            r.instance = job.instance_index;
            r.orientation = orientation[i];
        }
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
