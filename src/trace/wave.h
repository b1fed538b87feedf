// One wave of a part of a tile: its rays, the surface points that they hit, arranged by material, and what these send
// back. Memory only; waves.cpp says what happens to it.
#pragma once

#include "shading/media.h"
#include "tile/buffer.h"
#include "trace/wave_data.h"

#include <cstdint>
#include <vector>

namespace tessera {

// What a ray carries besides its numbers where surfaces let light through.
struct RayState {
    Media media;
    std::uint8_t depth = 0;    // how often its light was mirrored or refracted
    std::uint8_t passes = 0;   // how often it went straight on
    std::uint8_t channel = 0;  // 1 red, 2 green, 3 blue: it was dispersed; 0: all three
    bool straight = true;      // it was never mirrored: beyond all surfaces it sees the background
};

// Points of one material and layout: a multiple of kMaxLanes of them, of which `count` are used.
struct PointBatch {
    std::uint32_t instance, first, count;  // instance: the first of those that share the batch
};
// Those of one instance among them.
struct InstanceRun {
    std::uint32_t instance, first, count;
};

struct Wave {
    std::uint32_t ray_count = 0, point_count = 0;  // point_count: padding included
    bool direct = false;  // points have the numbers of their rays: all of these hit one instance

    // By ray.
    WaveArrays rays;
    std::vector<RayState> states;              // where they are needed
    Buffer<std::uint32_t> instance, triangle;  // that it hit; kNoHit
    Buffer<float> light[3], passed[3];         // what came along it; what of the background is seen along it
    Buffer<float> kept[3];                     // what the medium leaves of both
    // By point.
    WaveArrays points, shades;
    Buffer<std::uint32_t> ray, hit_triangle, used;  // ray: that hit there (of the first wave: the sample)
    Buffer<float> distance;
    std::vector<PointBatch> batches;
    std::vector<InstanceRun> runs;

    void reserve_rays(std::uint32_t count) {
        rays = arrays(ray_memory_, kRayNumbers, count);
        for (Buffer<std::uint32_t>* b : {&instance, &triangle}) b->reserve(count + kMaxLanes);
        for (int c = 0; c < 3; ++c)
            for (Buffer<float>* b : {&light[c], &passed[c], &kept[c]}) b->reserve(count + kMaxLanes);
    }
    void reserve_points(std::uint32_t count) {
        points = arrays(point_memory_, kPointNumbers, count);
        shades = arrays(shade_memory_, kShadeNumbers, count);
        for (Buffer<std::uint32_t>* b : {&ray, &hit_triangle, &used}) b->reserve(count + kMaxLanes);
        distance.reserve(count + kMaxLanes);
    }

  private:
    static WaveArrays arrays(Buffer<float>& memory, int numbers, std::uint32_t count) {
        // Not a power of two: those would fall on the same lines of the cache.
        const std::size_t stride = (std::size_t{count} / kMaxLanes + 2) * kMaxLanes | kMaxLanes;
        return {memory.reserve(static_cast<std::size_t>(numbers) * stride + kMaxLanes), stride};
    }
    Buffer<float> ray_memory_, point_memory_, shade_memory_;
};

}  // namespace tessera
