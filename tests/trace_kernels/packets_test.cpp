// Kernels that make rays, of every instruction set against one lane, and what they mean: rays of the camera, packets,
// rays towards lights, and rays that go on.
#include "trace_kernels/wave_arrays.h"

#include <cmath>
#include <cstring>

namespace tessera {
namespace {

using namespace test;

class PacketKernels : public TraceKernelTest {};

// What kernels write of a packet's first lanes.
bool same_packets(const WavePacket& a, const WavePacket& b, int lanes = kPacketWidth) {
    using Rays = RayPacket<kPacketWidth>;
    bool same = std::memcmp(a.valid, b.valid, static_cast<std::size_t>(kPacketWidth) * sizeof(int)) == 0;
    for (const auto numbers : {&Rays::org_x, &Rays::org_y, &Rays::org_z, &Rays::dir_x, &Rays::dir_y, &Rays::dir_z,
                               &Rays::t_near, &Rays::t_far})
        same = same && same_floats(a.rays.*numbers, b.rays.*numbers, static_cast<std::size_t>(lanes));
    return same;
}
// Whether it may be traced: by its header a ray of finite numbers, far below where squares overflow, that goes
// somewhere.
bool usable(const RayPacket<kPacketWidth>& r, int lane) {
    double size = 0, length = 0;
    for (const float* p : {r.org_x, r.org_y, r.org_z}) size += std::fabs(static_cast<double>(p[lane]));
    for (const float* p : {r.dir_x, r.dir_y, r.dir_z}) length += std::fabs(static_cast<double>(p[lane]));
    return size + length <= 1.00001 * static_cast<double>(kLargestRayNumber) && length > 0 && r.t_near[lane] >= 0 &&
           r.t_far[lane] >= r.t_near[lane];
}

ProjectionView lens(Random& random, bool orthographic) {
    ProjectionView p{};
    p.width = 640, p.height = 480;
    p.orthographic = orthographic;
    p.clip_from_camera[0] = random.in(0.1f, 3), p.clip_from_camera[5] = random.in(0.1f, 3);
    p.clip_from_camera[orthographic ? 3 : 2] = random.in(-0.5f, 0.5f);
    p.clip_from_camera[orthographic ? 7 : 6] = random.in(-0.5f, 0.5f);
    return p;
}

TEST_P(PacketKernels, SameRaysOfTheCamera) {
    Random random(1);
    for (int i = 0; i < 400; ++i) {
        GuardedArray<float> rows(12);
        for (std::size_t k = 0; k < 12; ++k)
            rows[k] = i % 4 == 3 && random.below(4) == 0 ? odd_number(random) : random.in(-3, 3);
        WavePacket got(kMeetsAll), want(kMeetsAll);
        const int columns = 1 + static_cast<int>(random.below(4)), lines = 1 + static_cast<int>(random.below(4));
        PrimaryRaysJob job{PictureRays(lens(random, i % 2)),
                           rows.data(),
                           4 * static_cast<int>(random.below(160)),
                           4 * static_cast<int>(random.below(120)),
                           {static_cast<std::int32_t>(random.below(256)), static_cast<std::int32_t>(random.below(256))},
                           columns,
                           lines,
                           0.125f,
                           i % 3 ? 100.0f : std::numeric_limits<float>::infinity(),
                           &got};
        traced().primary_rays(job);
        job.packet = &want;
        one_lane().primary_rays(job);
        ASSERT_TRUE(same_packets(got, want)) << i;
        for (int lane = 0; lane < kPacketWidth; ++lane)
            EXPECT_EQ(got.valid[lane], lane % 4 < columns && lane / 4 < lines && usable(got.rays, lane) ? -1 : 0);
    }
}

// The projection of every point of a ray is the picture position that it was made for; its t is the distance.
TEST_P(PacketKernels, RaysOfTheCameraArePicturePositions) {
    Random random(2);
    const float rows[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    for (int i = 0; i < 100; ++i) {
        const ProjectionView p = lens(random, i % 2);
        const float* m = p.clip_from_camera;
        WavePacket wave(kMeetsAll);
        const RayPacket<kPacketWidth>& packet = wave.rays;
        const int x = 4 * static_cast<int>(random.below(160)), y = 4 * static_cast<int>(random.below(120));
        const SamplePosition offset{static_cast<std::int32_t>(random.below(256)), 77};
        traced().primary_rays({PictureRays(p), rows, x, y, offset, 4, 4, 0.1f, 9.0f, &wave});
        for (int lane = 0; lane < kPacketWidth; ++lane) {
            EXPECT_EQ(packet.dir_z[lane], -1);
            EXPECT_EQ(packet.org_z[lane], 0);
            EXPECT_EQ(packet.t_near[lane], 0.1f);
            EXPECT_EQ(packet.t_far[lane], 9.0f);
            const double t = 3,
                         cx = static_cast<double>(packet.org_x[lane]) + t * static_cast<double>(packet.dir_x[lane]),
                         cy = static_cast<double>(packet.org_y[lane]) + t * static_cast<double>(packet.dir_y[lane]);
            const double w = i % 2 ? 1 : t;
            const auto clip = [&](double c, int scale, int by_z, int constant) {
                return (static_cast<double>(m[scale]) * c - static_cast<double>(m[by_z]) * t +
                        static_cast<double>(m[constant])) /
                       w;
            };
            EXPECT_NEAR((clip(cx, 0, 2, 3) + 1) * 320, x + lane % 4 + offset.x / 256.0, 1e-3);
            EXPECT_NEAR((1 - clip(cy, 5, 6, 7)) * 240, y + lane / 4 + 77 / 256.0, 1e-3);
        }
    }
}

TEST_P(PacketKernels, SamePackets) {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        GuardedWave rays(6, 1 + random.below(60));
        for (std::uint32_t r = 0; r < rays.count(); ++r)
            for (int n = 0; n < 6; ++n) rays[n][r] = random.below(8) ? random.in(-4, 4) : odd_number(random);
        GuardedArray<float> rows(12);
        for (std::size_t k = 0; k < 12; ++k) rows[k] = random.below(20) ? random.in(-3, 3) : odd_number(random);
        GuardedArray<float> far(rays.count() + kMaxLanes);
        for (std::size_t r = 0; r < far.size(); ++r) far[r] = random.below(8) ? random.in(0, 9) : odd_number(random);
        const std::uint32_t first = random.below(rays.count()) / kPacketWidth * kPacketWidth;
        WavePacket got(kMeetsSolid), want(kMeetsSolid);
        const PackJob job{rays.arrays(), rows.data(), first, rays.count(), i % 2 ? far.data() : nullptr, &got};
        PackJob scalar = job;
        scalar.packet = &want;
        traced().pack(job);
        one_lane().pack(scalar);
        const int used = static_cast<int>(std::min<std::uint32_t>(rays.count() - first, kPacketWidth));
        ASSERT_TRUE(same_packets(got, want, used)) << i;
        for (int lane = 0; lane < kPacketWidth; ++lane) {
            EXPECT_EQ(got.valid[lane], lane < used && usable(got.rays, lane) ? -1 : 0) << i << ", " << lane;
            EXPECT_EQ(got.rays.mask[lane], kMeetsSolid);
            if (lane >= used) continue;
            EXPECT_EQ(got.rays.t_near[lane], 0);
            const float end = i % 2 ? far[first + static_cast<std::uint32_t>(lane)] : 3e38f;
            EXPECT_TRUE(same_floats(&got.rays.t_far[lane], &end, 1));
        }
        ASSERT_FALSE(rays.changed() || far.changed());
    }
}

INSTANTIATE_TEST_SUITE_P(Kernels, PacketKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
