// LIT1 (without area lights): what arrives from every light, against the formulas of
// KHR_lights_punctual and of the textbooks in long double, and photometric units.
#include "shading/light.h"

#include "render/lighting.h"
#include "shading/support.h"

#include <tessera/scene.h>

#include <gtest/gtest.h>

#include <cmath>

namespace tessera {
namespace {

using test::Real;
using test::Real3;

constexpr Real kUlp = 0x1p-24L;

Real relative(float got, Real want) { return std::fabs(static_cast<Real>(got) - want) / std::fabs(want); }

TEST(LIT1_Light, DirectionalArrivesUndiminishedFromOneDirection) {
    const LightView l = test::directional_light({0.6f, 0.8f, 0}, 7);
    for (const Vec3T<float> at : {Vec3T<float>{0, 0, 0}, {1e6f, -3, 2}, {-1e-20f, 0, -1e12f}}) {
        const LightSample<float> s = sample_light<float>(l, at);
        EXPECT_EQ(s.irradiance.x, 7);
        EXPECT_EQ(s.to_light.x, 0.6f);
        EXPECT_EQ(s.to_light.y, 0.8f);
        EXPECT_GT(s.distance, 1e37f);
    }
}

TEST(LIT1_Light, PointFallsWithTheInverseSquare) {
    test::Random random(1);
    for (int i = 0; i < 20000; ++i) {
        LightView l = test::point_light(random.box(10), random.in(0.1f, 1000));
        const Vec3T<float> at = random.box(10);
        const LightSample<float> s = sample_light<float>(l, at);
        const Real3 d = Real3(Vec3T<float>::load(l.position)) - Real3(at);
        if (norm(d) < 1e-2L) continue;  // the difference of the positions itself is rounded
        EXPECT_LT(relative(s.irradiance.y, l.intensity[1] / inner(d, d)), 16 * kUlp * 10 / norm(d));
        EXPECT_LT(relative(s.distance, norm(d)), 16 * kUlp * 10 / norm(d));
        EXPECT_LT(distance(s.to_light, unit(d)), 16 * kUlp * 10 / norm(d));
    }
}

// The window of the extension: max(min(1 - (d / range)^4, 1), 0) / d^2.
TEST(LIT1_Light, RangeWindow) {
    LightView l = test::point_light({0, 0, 0}, 5);
    l.inverse_range = 0.25f;
    for (int i = 1; i <= 80; ++i) {
        const float d = 0.0625f * static_cast<float>(i);
        const Real r = d / 4.0L, window = std::fmax(std::fmin(1 - r * r * r * r, 1.0L), 0.0L);
        EXPECT_NEAR(static_cast<double>(sample_light<float>(l, {0, -d, 0}).irradiance.x),
                    static_cast<double>(5 * window / (static_cast<Real>(d) * d)), 3e-7 * 5 / (d * d));
    }
    EXPECT_EQ(sample_light<float>(l, {4, 0, 0}).irradiance.x, 0);
    EXPECT_EQ(sample_light<float>(l, {40, 0, 0}).irradiance.x, 0);
}

TEST(LIT1_Light, ConstantFalloffOfTheTextbooksArrivesAsTheIntensity) {
    for (const LightType type : {LightType::kDirectional, LightType::kPoint}) {
        LightView l = test::point_light({0, 0, 0}, 2);
        l.type = type;
        l.falloff = LightFalloff::kConstant;
        test::set3(l.to_light, {0, 0, 1});
        for (const float d : {1e-3f, 1.0f, 57.0f, 1e6f}) {
            // I_l = irradiance / pi.
            EXPECT_LT(relative(sample_light<float>(l, {0, 0, -d}).irradiance.x, 2 * test::kRealPi), 4 * kUlp);
            EXPECT_NEAR(sample_light<float>(l, {0, 0, -d}).to_light.z, 1, 1e-6);
        }
    }
}

TEST(LIT1_Light, NothingBreaksAtTheLightItselfOrFarAway) {
    LightView l = test::point_light({1, 2, 3}, 100);
    l.inverse_range = 0.5f;
    for (const Vec3T<float> at : {Vec3T<float>{1, 2, 3}, {1, 2, 3.0000002f}, {1e15f, 0, 0}, {3e19f, 3e19f, 3e19f}}) {
        const LightSample<float> s = sample_light<float>(l, at);
        for (const float v : {s.irradiance.x, s.to_light.x, s.to_light.y, s.to_light.z}) EXPECT_TRUE(std::isfinite(v));
        EXPECT_GE(s.irradiance.x, 0);
    }
}

// --- spots ----------------------------------------------------------------------------------

// A scene with one light on a node, seen by a camera that sits at the world's origin.
class SpotScene {
  public:
    explicit SpotScene(const Light& light) {
        scene_.lights.push_back(light);
        frame_.lights.push_back({0, glm::dmat4(1.0)});
    }
    LightView view() const { return scene_lights(scene_, frame_).at(0); }

  private:
    Scene scene_;
    Frame frame_;
};

Light spot(float inner, float outer) {
    Light l;
    l.type = LightType::kSpot;
    l.intensity = 3;
    l.color = {1, 0.5f, 0.25f};
    l.inner_cone = inner;
    l.outer_cone = outer;
    return l;
}

// At distance 2 from the spot, `angle` off its axis (-Z).
Vec3T<float> off_axis(Real angle) { return test::to_vec(Real3{2 * std::sin(angle), 0, -2 * std::cos(angle)}); }

TEST(LIT1_Spot, FullInsideTheInnerConeNothingOutsideTheOuterSquaredBetween) {
    for (const auto& [inner, outer] : {std::pair{0.2f, 0.7f}, {0.0f, 0.785398f}, {0.5f, 0.6f}, {0.0f, 1.5f}}) {
        const LightView l = SpotScene(spot(inner, outer)).view();
        const Real ci = std::cos(static_cast<Real>(inner)), co = std::cos(static_cast<Real>(outer));
        for (int i = 0; i <= 1000; ++i) {
            const Real angle = i * 0.0016L;
            const LightSample<float> s = sample_light<float>(l, off_axis(angle));
            const Real c = std::cos(angle), t = std::fmin(std::fmax((c - co) / (ci - co), 0.0L), 1.0L);
            const Real tolerance = 3e-7L + 2 * 4 * kUlp / (ci - co);
            EXPECT_NEAR(static_cast<double>(s.irradiance.x), static_cast<double>(3.0L / 4 * t * t),
                        static_cast<double>(tolerance));
            EXPECT_NEAR(static_cast<double>(s.irradiance.z), static_cast<double>(0.75L / 4 * t * t),
                        static_cast<double>(tolerance));
            if (angle > static_cast<Real>(outer) + 1e-3L) {
                EXPECT_EQ(s.irradiance.x, 0) << static_cast<double>(angle);
            } else if (angle < static_cast<Real>(inner) - 1e-3L) {
                EXPECT_NEAR(s.irradiance.x, 0.75f, 3e-7);
            }
        }
        EXPECT_EQ(sample_light<float>(l, {0, 0, 2}).irradiance.x, 0);  // behind
    }
}

// The textbooks' spot: from 1 on the axis linearly in the cosine to 0 at the outer angle.
TEST(LIT1_Spot, AxisProfileFadesFromTheAxisToZeroAtTheta) {
    for (const float theta : {0.3f, 0.785398f, 1.5f}) {
        Light light = spot(0.25f, theta);
        light.spot_profile = SpotProfile::kAxis;
        light.falloff = LightFalloff::kConstant;
        const LightView l = SpotScene(light).view();
        const Real co = std::cos(static_cast<Real>(theta));
        for (int i = 0; i <= 500; ++i) {
            const Real angle = i * 0.0032L;
            const Real t = std::fmax((std::cos(angle) - co) / (1 - co), 0.0L);
            EXPECT_NEAR(static_cast<double>(sample_light<float>(l, off_axis(angle)).irradiance.x),
                        static_cast<double>(3 * test::kRealPi * t), static_cast<double>(3e-6L + 40 * kUlp / (1 - co)));
        }
        EXPECT_NEAR(sample_light<float>(l, off_axis(0)).irradiance.x, 3 * kPi,
                    3e-6 + 3e-6 / static_cast<double>(1 - co));
    }
}

TEST(LIT1_Spot, RangeAndDistanceCountToo) {
    Light light = spot(0.2f, 0.7f);
    light.range = 4.0f;
    const LightView l = SpotScene(light).view();
    const Real window = 1 - std::pow(0.5L, 4);
    EXPECT_LT(relative(sample_light<float>(l, {0, 0, -2}).irradiance.x, 3.0L / 4 * window), 8 * kUlp);
    EXPECT_EQ(sample_light<float>(l, {0, 0, -4}).irradiance.x, 0);
}

// --- ambient --------------------------------------------------------------------------------

TEST(LIT1_Ambient, UniformIsTheSameFromEveryDirection) {
    const AmbientView ambient = test::even_ambient(0.37f);
    test::Random random(2);
    for (int i = 0; i < 1000; ++i)
        for (const float softness : {0.0f, 0.3f, 1.0f})
            EXPECT_EQ(ambient_radiance(ambient, random.unit(), softness).y, 0.37f);
}

// The flag leaves out work, never a bit.
TEST(LIT1_Ambient, TheFlagOfUniformLightChangesNothing) {
    test::Random random(3);
    for (int i = 0; i < 1000; ++i) {
        const float r = random.in(0, 5), g = random.in(0, 1), b = random.in(0, 0.01f);
        AmbientView flagged{{r, g, b}, {r, g, b}, {0, 1, 0}, true}, plain = flagged;
        plain.uniform = false;
        const Vec3T<float> direction = random.unit();
        const float softness = random.in(0, 1);
        const Vec3T<float> a = ambient_radiance(flagged, direction, softness),
                           c = ambient_radiance(plain, direction, softness);
        ASSERT_EQ(a.x, c.x);
        ASSERT_EQ(a.y, c.y);
        ASSERT_EQ(a.z, c.z);
    }
}

TEST(LIT1_Ambient, SkyAboveGroundBelowMonotoneBetween) {
    const AmbientView ambient{{1, 2, 3}, {0.5f, 0.25f, 0}, {0, 1, 0}};
    for (const float softness : {0.0f, 0.5f, 1.0f}) {
        EXPECT_EQ(ambient_radiance<float>(ambient, {0, 1, 0}, softness).z, 3);
        EXPECT_EQ(ambient_radiance<float>(ambient, {0, -1, 0}, softness).z, 0);
        EXPECT_FLOAT_EQ(ambient_radiance<float>(ambient, {1, 0, 0}, softness).z, 1.5f);
        float last = 0;
        for (int i = 0; i <= 100; ++i) {
            const float y = -1 + 0.02f * static_cast<float>(i);
            const float z = ambient_radiance<float>(ambient, {std::sqrt(1 - y * y), y, 0}, softness).z;
            EXPECT_GE(z, last);
            last = z;
        }
    }
}

// --- photometry -----------------------------------------------------------------------------

TEST(LIT1_Units, WhiteLambertPlaneUnderOneLuxHasRadianceOneOverPi) {
    const std::vector<LightView> lights{test::directional_light({0, 0, 1}, 1)};
    const MaterialView m = test::plain_material(ShadingModel::kLambert);
    const ShadedPoint<float> p =
        test::shade_unshadowed(test::plain_context(lights), m, test::plain_point({0, 0, -3}, {0, 0, 1}));
    EXPECT_LT(relative(p.radiance.x, 1 / test::kRealPi), 2 * kUlp);
}

TEST(LIT1_Units, CandelaAtADistanceGivesIOverPiDSquared) {
    for (const float d : {0.25f, 1.0f, 3.0f, 10.0f, 1000.0f}) {
        const std::vector<LightView> lights{test::point_light({0, 0, -5 + d}, 12)};
        const MaterialView m = test::plain_material(ShadingModel::kLambert);
        const ShadedPoint<float> p =
            test::shade_unshadowed(test::plain_context(lights), m, test::plain_point({0, 0, -5}, {0, 0, 1}));
        EXPECT_LT(relative(p.radiance.x, 12 / (test::kRealPi * static_cast<Real>(d) * d)), 8 * kUlp);
    }
}

// The sum over lights, each with its visibility, is a sum.
TEST(LIT1_Units, LightsAddUp) {
    const std::vector<LightView> lights{test::directional_light({0, 0, 1}, 1), test::point_light({0, 0, 0}, 8),
                                        test::directional_light({0, 0, 1}, 4)};
    const ShadedPoint<float> p = shade(test::plain_context(lights), test::plain_material(ShadingModel::kLambert),
                                       test::plain_point({0, 0, -2}, {0, 0, 1}), [](int i, const LightSample<float>&) {
                                           return i == 0 ? 1.0f : i == 1 ? 0.5f : 0.25f;
                                       });
    EXPECT_LT(relative(p.radiance.x, (1 + 0.5L * 2 + 0.25L * 4) / test::kRealPi), 4 * kUlp);
}

}  // namespace
}  // namespace tessera
