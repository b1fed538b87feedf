// Rays as kernels make them and Embree takes them: packets of 16, 8, 4 or single rays, one array per number. Plain data
// in the very layout of Embree's RTCRayHitN (embree_scene.cpp checks that), so that nothing is copied on the way.
#pragma once

#include <cstdint>

namespace tessera {

inline constexpr int kPacketWidth = 16;

// What is not hit, and lanes that hit nothing.
inline constexpr std::uint32_t kNoHit = 0xffffffffu;

// Which surfaces a ray meets: bits of RayPacket::mask, one per kind of instance.
inline constexpr std::uint32_t kMeetsSolid = 1;  // opaque: stops light
inline constexpr std::uint32_t kMeetsSheer = 2;  // lets some light through: cut-outs, blended and transmissive surfaces
inline constexpr std::uint32_t kMeetsStroke = 4;  // points and lines, which only the camera sees
inline constexpr std::uint32_t kMeetsAll = kMeetsSolid | kMeetsSheer | kMeetsStroke;

// `kWidth` rays in the space of the EmbreeScene, and what they hit. A direction may have any length; t counts in it.
template <int kWidth>
struct alignas(4 * kWidth < 16 ? 16 : 4 * kWidth) RayPacket {
    float org_x[kWidth], org_y[kWidth], org_z[kWidth], t_near[kWidth];
    float dir_x[kWidth], dir_y[kWidth], dir_z[kWidth], time[kWidth];
    float t_far[kWidth];  // after a hit: its t; after occluded(): minus infinity where something is in the way
    std::uint32_t mask[kWidth], id[kWidth], flags[kWidth];
    float ng_x[kWidth], ng_y[kWidth], ng_z[kWidth], u[kWidth], v[kWidth];
    std::uint32_t triangle[kWidth];  // within its instance
    std::uint32_t geometry[kWidth];  // Embree's own
    std::uint32_t instance[kWidth];  // index into Frame::instances, or kNoHit
};

// A packet that kernels write rays to again and again, with the lanes that can be traced (-1). A ray is usable where
// its numbers are finite and far below where squares overflow, and it goes somewhere.
inline constexpr float kLargestRayNumber = 1e18f;
struct WavePacket {
    alignas(64) int valid[kPacketWidth];
    RayPacket<kPacketWidth> rays;

    explicit WavePacket(std::uint32_t mask) : valid{}, rays{} {
        for (std::uint32_t lane = 0; lane < kPacketWidth; ++lane) rays.id[lane] = lane, rays.mask[lane] = mask;
    }
};

}  // namespace tessera
