// Rays as packets: through the picture, from a wave, and towards lights; and the rays that go on from surface points.
// Part of a kernel file, once per instruction set.
#pragma once

#include "simd/records.h"
#include "trace/wave_data.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Numbers of a wave by their names.
TESSERA_INLINE Vec3T<Float> load3(const WaveArrays& arrays, int number, std::uint32_t at) {
    return {load<Float>(arrays[number] + at), load<Float>(arrays[number + 1] + at),
            load<Float>(arrays[number + 2] + at)};
}
TESSERA_INLINE void store3(const WaveArrays& arrays, int number, std::uint32_t at, const Vec3T<Float>& v) {
    store(arrays[number] + at, v.x);
    store(arrays[number + 1] + at, v.y);
    store(arrays[number + 2] + at, v.z);
}
// Those of the mask, together.
TESSERA_INLINE void store_some(float* to, Mask mask, Float v) { store(to, compress(v, mask)); }
TESSERA_INLINE void store_some3(const WaveArrays& arrays, int number, std::uint32_t at, Mask mask,
                                const Vec3T<Float>& v) {
    store_some(arrays[number] + at, mask, v.x);
    store_some(arrays[number + 1] + at, mask, v.y);
    store_some(arrays[number + 2] + at, mask, v.z);
}

TESSERA_INLINE void put_ray(WavePacket& packet, int lane, Mask there, const Vec3T<Float>& origin,
                            const Vec3T<Float>& direction, Float t_near, Float t_far) {
    RayPacket<kPacketWidth>& rays = packet.rays;
    store(rays.org_x + lane, origin.x);
    store(rays.org_y + lane, origin.y);
    store(rays.org_z + lane, origin.z);
    store(rays.dir_x + lane, direction.x);
    store(rays.dir_y + lane, direction.y);
    store(rays.dir_z + lane, direction.z);
    store(rays.t_near + lane, t_near);
    store(rays.t_far + lane, t_far);
    const Float length = abs(direction.x) + abs(direction.y) + abs(direction.z);
    const Float size = abs(origin.x) + abs(origin.y) + abs(origin.z) + length;
    const Mask usable = there & (size <= Float(kLargestRayNumber)) & (length > Float(0.0f)) & (t_far >= t_near) &
                        (t_near >= Float(0.0f));
    store(packet.valid + lane, select(usable, Int(-1), Int(0)));
}

// Directions have length 1 along the view axis, so that t is the distance there.
inline void primary_rays(const PrimaryRaysJob& job) {
    constexpr int kSide = 4;
    const float x = static_cast<float>(256 * job.x + job.offset.x), y = static_cast<float>(256 * job.y + job.offset.y);
    const Float zero(0.0f), one(1.0f);
    for (int lane = 0; lane < kPacketWidth; lane += kLanes<Float>) {
        const Int pixel = iota<Int>() + Int(lane), column = pixel & Int(kSide - 1), row = pixel >> 2;
        const EyeDirection<Float> eye(job.rays, to_float(column << 8) + Float(x), to_float(row << 8) + Float(y));
        Vec3T<Float> origin{zero, zero, zero}, direction{-eye.x, -eye.y, -one};
        if (job.rays.orthographic) origin = {-eye.x, -eye.y, zero}, direction = {zero, zero, -one};
        put_ray(*job.packet, lane, (column < Int(job.columns)) & (row < Int(job.rows)),
                transform_point(job.trace_from_camera, origin), transform_direction(job.trace_from_camera, direction),
                Float(job.t_near), Float(job.t_far));
    }
}

inline void find_hits(const WavePacket& packet, PacketHits& hits) {
    constexpr int kWidth = kLanes<Float>, kParts = kPacketWidth / kWidth;
    Uint triangle[kParts], instance[kParts], which[kParts];
    Mask hit[kParts];
    std::uint32_t rest = 0;
    for (int part = 0; part < kParts; ++part) {
        triangle[part] = load<Uint>(packet.rays.triangle + part * kWidth);
        instance[part] = load<Uint>(packet.rays.instance + part * kWidth);
        which[part] = Uint(0u);
        hit[part] = (load<Int>(packet.valid + part * kWidth) != Int(0)) & (instance[part] != Uint(kNoHit));
        rest |= mask_bits(hit[part]) << part * kWidth;
    }
    hits.rays = static_cast<std::uint32_t>(__builtin_popcount(rest));
    hits.count = 0;
    while (rest) {
        const int lane = __builtin_ctz(rest);
        hits.lane[hits.count++] = static_cast<std::uint32_t>(lane);
        const Uint t(packet.rays.triangle[lane]), i(packet.rays.instance[lane]), number(hits.count);
        for (int part = 0; part < kParts; ++part) {
            const Mask same = hit[part] & (triangle[part] == t) & (instance[part] == i);
            rest &= ~(mask_bits(same) << part * kWidth);
            which[part] = select(same, number, which[part]);
        }
    }
    for (int part = 0; part < kParts; ++part) store(hits.which + part * kWidth, which[part]);
}

inline void pack(const PackJob& job) {
    constexpr float kFar = 3e38f;  // beyond any scene
    for (int lane = 0; lane < kPacketWidth; lane += kLanes<Float>) {
        const std::uint32_t at = job.first + static_cast<std::uint32_t>(lane);
        const Mask there = iota<Int>() + Int(static_cast<std::int32_t>(at)) < Int(static_cast<std::int32_t>(job.count));
        put_ray(*job.packet, lane, there, transform_point(job.trace_from_camera, load3(job.rays, kOriginX, at)),
                transform_direction(job.trace_from_camera, load3(job.rays, kDirectionX, at)), Float(0.0f),
                job.t_far ? load<Float>(job.t_far + at) : Float(kFar));
    }
}

// A light reaches a point that faces it; the way there ends a little before it.
inline void shadow_rays(ShadowRaysJob& job) {
    constexpr float kNearly = 1.0f - 1e-5f;
    const LightView light = job.shading->lights[job.light];
    std::uint32_t made = 0;
    for (std::uint32_t at = 0; at < job.count; at += kLanes<Float>) {
        const Vec3T<Float> p = load3(job.points, kPositionX, at), ng = load3(job.points, kFlatX, at);
        const LightSample<Float> sample = sample_light(light, p);
        const Mask some = (load<Uint>(job.used + at) != Uint(0u)) & (sample.strength > Float(0.0f)) &
                          (dot(load3(job.points, kNormalX, at), sample.to_light) > Float(0.0f));
        const std::uint32_t bits = mask_bits(some);
        if (!bits) continue;
        const Vec3T<Float> origin = ray_origin(p, ng, sample.to_light, load<Float>(job.points[kRounding] + at));
        store_some3(job.rays, kOriginX, made, some, origin);
        store_some3(job.rays, kDirectionX, made, some, sample.to_light);
        store_some(job.t_far + made, some, sample.distance * Float(kNearly));
        alignas(64) float index[kLanes<Float>];
        store(index, compress(as_float(as_uint(iota<Int>() + Int(static_cast<std::int32_t>(at)))), some));
        __builtin_memcpy(job.point + made, index, sizeof index);
        made += static_cast<std::uint32_t>(__builtin_popcount(bits));
    }
    job.made = made;
}

inline void spawn(SpawnJob& job) {
    std::uint32_t made = job.made;
    for (std::uint32_t at = 0; at < job.count; at += kLanes<Float>) {
        Vec3T<Float> weight;
        if (job.kind == SpawnJob::Kind::kStraight) {
            // What a surface lets through for its alpha.
            weight = Vec3T<Float>::splat(Float(1.0f) - load<Float>(job.shades[kAlpha] + at));
        } else {
            weight = load3(job.shades, job.kind == SpawnJob::Kind::kMirrored ? kReflectedR : kEnteringR, at);
            weight = weight * Vec3T<Float>::load(job.channels);
        }
        const Float times = load<Float>(job.points[kTimes] + at) * max(max(weight.x, weight.y), weight.z);
        const Mask used = load<Uint>(job.used + at) != Uint(0u), some = used & (times > Float(job.least));
        const std::uint32_t bits = mask_bits(some);
        const std::uint32_t faint = mask_bits(used & (times > Float(0.0f))) & ~bits;
        job.faint += static_cast<std::uint32_t>(__builtin_popcount(faint));
        if (job.only_count) made += static_cast<std::uint32_t>(__builtin_popcount(bits));
        if (!bits || job.only_count) continue;
        const Vec3T<Float> p = load3(job.points, kPositionX, at), view = load3(job.points, kViewX, at),
                           normal = load3(job.points, kNormalX, at), ng = load3(job.points, kFlatX, at);
        Vec3T<Float> direction = -view;
        if (job.kind == SpawnJob::Kind::kMirrored)
            direction = normalize_or(mirrored(view, normal, ng), normal);
        else if (job.kind == SpawnJob::Kind::kRefracted) {
            const Float eta = load<Float>(job.points[job.eta] + at);
            direction = select3(eta == Float(1.0f), direction, refracted(view, normal, ng, eta).direction);
        }
        store_some3(job.rays, kOriginX, made, some,
                    ray_origin(p, ng, direction, load<Float>(job.points[kRounding] + at)));
        store_some3(job.rays, kDirectionX, made, some, direction);
        store_some3(job.rays, kWeightR, made, some, weight);
        store_some(job.rays[kConeWidth] + made, some, load<Float>(job.points[kFootprint] + at));
        store_some(job.rays[kThroughput] + made, some, times);
        store_some(job.rays[kParent] + made, some, as_float(as_uint(iota<Int>() + Int(static_cast<std::int32_t>(at)))));
        made += static_cast<std::uint32_t>(__builtin_popcount(bits));
    }
    job.made = made;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
