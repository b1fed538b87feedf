// ANI2, ANI3: samplers against their definitions in long double; moments.
#include "geometry/animation.h"
#include "geometry/animation_definition.h"
#include "geometry/support.h"

#include <tessera/error.h>

#include <array>
#include <cmath>

namespace tessera {
namespace {

using test::definition;
using test::Random;
using test::Real;

AnimationSampler random_sampler(Random& random, Interpolation interpolation, std::size_t components, bool rotation) {
    AnimationSampler sampler;
    sampler.interpolation = interpolation;
    float time = random.in(-1, 1);
    const std::size_t keys = 1 + random.below(6), parts = interpolation == Interpolation::kCubicSpline ? 3 : 1;
    for (std::size_t k = 0; k < keys; ++k) {
        sampler.times.push_back(time);
        time += random.in(0.01f, 2);
        for (std::size_t p = 0; p < parts; ++p) {
            const Quat q = random.rotation();
            const float quaternion[4] = {q.x, q.y, q.z, q.w};
            for (std::size_t i = 0; i < components; ++i)
                sampler.values.push_back(rotation ? quaternion[i] : random.in(-5, 5));
        }
    }
    return sampler;
}

TEST(ANI2_Samplers, FollowTheirDefinition) {
    Random random(21);
    for (int round = 0; round < 3000; ++round) {
        const auto interpolation = static_cast<Interpolation>(round % 3);
        const bool rotation = round % 2 == 0;
        const std::size_t n = rotation ? 4 : 1 + random.below(5);
        const AnimationSampler sampler = random_sampler(random, interpolation, n, rotation);
        for (int i = 0; i < 8; ++i) {
            // Between keys, on them, before and behind all.
            const double time =
                i == 0
                    ? static_cast<double>(sampler.times[random.below(static_cast<std::uint32_t>(sampler.times.size()))])
                : i == 1 ? static_cast<double>(sampler.times[0]) - 3
                : i == 2 ? static_cast<double>(sampler.times.back()) + 3
                         : random.in(sampler.times[0], sampler.times.back() + 0.1f);
            std::vector<double> got(n);
            sample_animation(sampler, time, rotation, got);
            const std::vector<Real> want = definition(sampler, time, n, rotation);
            Real largest = 1;
            for (const Real x : want) largest = std::max(largest, std::fabs(x));
            for (std::size_t c = 0; c < n; ++c)
                ASSERT_NEAR(static_cast<double>(want[c]), got[c], 1e-12 * static_cast<double>(largest))
                    << "round " << round << " time " << time;
        }
    }
}

TEST(ANI3_Slerp, TurnsEvenlyAndTakesTheShorterWay) {
    // A quarter turn about z, the end given with the other sign.
    const double h = std::sqrt(0.5);
    AnimationSampler s;
    s.times = {0, 1};
    s.values = {0, 0, 0, 1, 0, 0, static_cast<float>(-h), static_cast<float>(-h)};
    for (int i = 0; i < 8; ++i) {
        std::array<double, 4> q;
        sample_animation(s, i / 8.0, true, q);
        const double half = i / 8.0 * 3.14159265358979 / 4;
        EXPECT_NEAR(q[2], std::sin(half), 1e-7) << i;
        EXPECT_NEAR(q[3], std::cos(half), 1e-7) << i;
    }
    // The same orientation twice, and zero quaternions, stay finite.
    for (const std::vector<float>& values :
         {std::vector<float>{0, 0, 0, 1, 0, 0, 0, -1}, std::vector<float>(8, 0.0f)}) {
        s.values = values;
        std::array<double, 4> q;
        sample_animation(s, 0.5, true, q);
        EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-12);
    }
}

TEST(Moments, AreCheckedAndChooseAnimations) {
    Scene scene;
    scene.nodes.resize(2);
    scene.scenes.resize(1);
    scene.scenes[0].nodes = {0, 1};
    for (int i = 0; i < 2; ++i) {
        Animation animation;
        animation.samplers.push_back({{0, 2}, {0, 0, 0, 2, 4, 6}, Interpolation::kLinear});
        animation.channels.push_back({0, i, AnimationPath::kTranslation});
        scene.animations.push_back(animation);
    }
    const auto x_of = [&](const Moment& m, int node) {
        return pose_of(scene, m).local[static_cast<std::size_t>(node)][3].x;
    };
    EXPECT_EQ(x_of({}, 0), 0);
    EXPECT_EQ(x_of({0, 1}, 0), 1);
    EXPECT_EQ(x_of({0, 1}, 1), 0);
    EXPECT_EQ(x_of({1, 1}, 1), 1);
    EXPECT_EQ(x_of({kEveryAnimation, 1.5}, 0), 1.5);
    EXPECT_EQ(x_of({kEveryAnimation, 1.5}, 1), 1.5);
    EXPECT_EQ(x_of({0, 99}, 0), 2);
    EXPECT_EQ(duration(scene.animations[0]), 2);
    EXPECT_THROW(pose_of(scene, {2, 0}), Error);
    EXPECT_THROW(pose_of(scene, {-5, 0}), Error);
    EXPECT_THROW(pose_of(scene, {0, std::nan("")}), Error);
}

}  // namespace
}  // namespace tessera
