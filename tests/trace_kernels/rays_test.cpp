// Kernels that make rays from surface points, of every instruction set against one lane: rays towards lights, and rays
// that go on.
#include "trace_kernels/wave_arrays.h"

#include <cstring>

namespace tessera {
namespace {

using namespace test;

class RayKernels : public TraceKernelTest {};

void choose_used(GuardedArray<std::uint32_t>& used, Random& random, std::uint32_t pattern) {
    for (std::size_t i = 0; i < used.size(); ++i)
        used[i] = pattern == 0 ? 0u : pattern == 1 || random.below(3) ? ~0u : 0u;
}

std::vector<LightView> all_lights() {
    std::vector<LightView> lights{directional_light({0.6f, 0.8f, 0.0f}, 3), point_light({1, 2, -1}, 20),
                                  point_light({0, 0, 0}, 5), point_light({-1, 0, 1}, 9)};
    lights[2].falloff = LightFalloff::kConstant;
    lights[2].inverse_range = 0.4f;
    lights[3].type = LightType::kSpot;
    set3(lights[3].to_light, {0, 1, 0});
    lights[3].spot_scale = 3, lights[3].spot_offset = -0.5f;
    return lights;
}

TEST_P(RayKernels, SameRaysToLights) {
    const std::vector<LightView> lights = all_lights();
    const ShadingContext context = plain_context(lights);
    Random random(4);
    std::size_t rays = 0;
    for (std::uint32_t round = 0; round < 60; ++round) {
        GuardedWave points(kPointNumbers, kMaxLanes * random.below(5));
        fill_points(points, random, round % 2);
        GuardedArray<std::uint32_t> used(points.count());
        choose_used(used, random, round % 5);
        for (int light = 0; light < context.light_count; ++light) {
            GuardedWave got(6, points), want(6, points);
            GuardedArray<float> far_got(points.count() + kMaxLanes), far_want(points.count() + kMaxLanes);
            GuardedArray<std::uint32_t> of_got(points.count() + kMaxLanes), of_want(points.count() + kMaxLanes);
            ShadowRaysJob job{&context,     light,          points.arrays(), used.data(), points.count(),
                              got.arrays(), far_got.data(), of_got.data(),   99};
            traced().shadow_rays(job);
            const std::uint32_t made = job.made;
            job.rays = want.arrays(), job.t_far = far_want.data(), job.point = of_want.data();
            one_lane().shadow_rays(job);
            ASSERT_EQ(made, job.made) << round;
            ASSERT_TRUE(got.same(want, 6, made)) << round << ", light " << light;
            ASSERT_TRUE(same_floats(far_got.data(), far_want.data(), made));
            ASSERT_EQ(std::memcmp(of_got.data(), of_want.data(), made * sizeof(std::uint32_t)), 0);
            ASSERT_FALSE(got.changed() || far_got.changed() || of_got.changed() || points.changed());
            rays += made;
            if (round % 5 == 0) {
                ASSERT_EQ(made, 0u);
            }
            for (std::uint32_t r = 0; r < made; ++r) {  // each from a point that counts, in their order
                ASSERT_NE(used[of_got[r]], 0u);
                ASSERT_TRUE(r == 0 || of_got[r - 1] < of_got[r]);
            }
            if (round % 2) continue;
            std::uint32_t facing = 0;
            for (std::uint32_t p = 0; p < points.count(); ++p) {
                const LightSample<float> s =
                    sample_light(lights[static_cast<std::size_t>(light)],
                                 Vec3T<float>{points[kPositionX][p], points[kPositionY][p], points[kPositionZ][p]});
                const Vec3T<float> n{points[kNormalX][p], points[kNormalY][p], points[kNormalZ][p]};
                facing += used[p] && s.strength > 0 && dot(n, s.to_light) > 0;
            }
            EXPECT_EQ(made, facing);
        }
    }
    EXPECT_GT(rays, 1000u);
}

TEST_P(RayKernels, SameRaysThatGoOn) {
    Random random(5);
    std::size_t rays = 0;
    for (std::uint32_t round = 0; round < 120; ++round) {
        GuardedWave points(kPointNumbers, kMaxLanes * random.below(5)), shades(kShadeNumbers, points);
        fill_points(points, random, round % 2);
        for (std::uint32_t i = 0; i < shades.count(); ++i)
            for (int n = 0; n < kShadeNumbers; ++n)
                shades[n][i] = round % 2 && random.below(16) == 0 ? odd_number(random)
                               : random.below(4)                  ? random.in(0, 1)
                                                                  : 0.0f;
        GuardedArray<std::uint32_t> used(points.count());
        choose_used(used, random, round % 5);
        for (const SpawnJob::Kind kind :
             {SpawnJob::Kind::kMirrored, SpawnJob::Kind::kRefracted, SpawnJob::Kind::kStraight})
            for (const bool only_count : {false, true}) {
                constexpr std::uint32_t kBefore = 5;
                GuardedWave got(kRayNumbers, points.count() + kBefore), want(kRayNumbers, points.count() + kBefore);
                SpawnJob job{};
                job.kind = kind;
                job.only_count = only_count;
                job.eta = kEtaR + static_cast<int>(round % 3);
                for (float& c : job.channels) c = random.below(3) ? 1.0f : 0.0f;
                job.points = points.arrays(), job.shades = shades.arrays();
                job.used = used.data();
                job.count = points.count();
                job.least = round % 4 ? random.in(0, 0.5f) : 0.0f;
                SpawnJob scalar = job;
                job.rays = got.arrays(), scalar.rays = want.arrays();
                job.made = scalar.made = kBefore, job.faint = scalar.faint = 3;
                traced().spawn(job);
                one_lane().spawn(scalar);
                ASSERT_EQ(job.made, scalar.made) << round;
                ASSERT_EQ(job.faint, scalar.faint) << round;
                ASSERT_TRUE(only_count || got.same(want, kRayNumbers, job.made)) << round;
                ASSERT_FALSE(got.changed() || points.changed() || shades.changed());
                // What was there stays.
                for (int n = 0; n < kRayNumbers; ++n)
                    for (std::uint32_t i = 0; i < kBefore; ++i) ASSERT_EQ(got[n][i], -7.0f);
                if (only_count) continue;
                rays += job.made - kBefore;
                for (std::uint32_t i = kBefore; i < job.made; ++i) {
                    const auto p = std::bit_cast<std::uint32_t>(got[kParent][i]);
                    ASSERT_LT(p, points.count());
                    ASSERT_NE(used[p], 0u);
                    ASSERT_GT(got[kThroughput][i], job.least);
                }
            }
    }
    EXPECT_GT(rays, 3000u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, RayKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
