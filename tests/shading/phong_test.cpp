// LIT2 and LIT3: Lambert, Phong and Blinn-Phong against the textbooks' formulas, literally, in long
// double. I_l is irradiance / pi throughout (lobes.h).
#include "shading/shade.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera {
namespace {

using test::Real;
using test::Real3;

struct Setting {
    MaterialView material;
    std::vector<LightView> lights;
    ShadingContext context;
    SurfacePoint<float> point;
};

// A random material, point and three directional lights, some behind the surface.
void randomise(test::Random& random, ShadingModel model, Setting& s) {
    s.material = test::plain_material(model);
    for (int c = 0; c < 3; ++c) {
        s.material.ambient[c] = random.in(0, 1);
        s.material.diffuse[c] = random.in(0, 1);
        s.material.specular[c] = random.in(0, 1);
        s.material.emission[c] = random.in(0, 1);
    }
    s.material.shininess = std::exp2(random.in(0, 8));
    s.lights.clear();
    for (int i = 0; i < 3; ++i) s.lights.push_back(test::directional_light(random.unit(), random.in(0, 4)));
    s.context = test::plain_context(s.lights);
    const float ambient = random.in(0, 1);
    s.context.ambient = {{ambient, ambient, ambient}, {ambient, ambient, ambient}, {0, 1, 0}};
    const Vec3T<float> n = random.unit();
    s.point = test::plain_point(random.unit() * random.in(0.5f, 20), n);
}

Real3 load(const float* p) { return {p[0], p[1], p[2]}; }

// I = ke + Ia ka + sum over lights of kd Il (l.n) + ks Il (highlight).
Real3 textbook(const Setting& s, bool blinn) {
    const Real3 n(s.point.normal), v = unit(Real3{} - Real3(s.point.position));
    Real3 sum = load(s.material.emission) + load(s.material.ambient) * load(s.context.ambient.sky);
    for (const LightView& light : s.lights) {
        const Real3 l = load(light.to_light), il = load(light.intensity) * (1 / test::kRealPi);
        const Real n_l = inner(n, l);
        sum = sum + load(s.material.diffuse) * il * std::fmax(n_l, 0.0L);
        if (s.material.model == ShadingModel::kLambert || n_l <= 0) continue;
        const Real3 r = n * (2 * n_l) - l, h = unit(l + v);
        const Real cosine = std::fmax(blinn ? inner(n, h) : inner(v, r), 0.0L);
        sum = sum + load(s.material.specular) * il * std::pow(cosine, static_cast<Real>(s.material.shininess));
    }
    return sum;
}

class TextbookTest : public testing::TestWithParam<ShadingModel> {};

// The largest error has a cause: the cosine is known to some 2^-23, and the exponent ns magnifies that.
TEST_P(TextbookTest, LIT2_LIT3_EqualsTheFormula) {
    test::Random random(11);
    Setting s;
    for (int i = 0; i < 20000; ++i) {
        randomise(random, GetParam(), s);
        const ShadedPoint<float> got = test::shade_unshadowed(s.context, s.material, s.point);
        const Real3 want = textbook(s, GetParam() == ShadingModel::kBlinnPhong);
        const Real tolerance = 1e-6L + 3 * 4 * static_cast<Real>(s.material.shininess) * 0x1p-23L;
        ASSERT_LT(distance(got.radiance, want), tolerance * (1 + norm(want))) << "ns " << s.material.shininess;
        ASSERT_EQ(got.alpha, 1);
    }
}

TEST_P(TextbookTest, LIT2_LIT3_NoLightFromBehindTheSurface) {
    test::Random random(12);
    Setting s;
    for (int i = 0; i < 2000; ++i) {
        randomise(random, GetParam(), s);
        for (float& e : s.material.emission) e = 0;
        s.context.ambient = {};
        for (LightView& l : s.lights) {
            // Turned to the back: n.l <= 0, also where the highlight's own cosine is positive.
            const Vec3T<float> d = Vec3T<float>::load(l.to_light);
            if (dot(d, s.point.normal) > 0) test::set3(l.to_light, -d);
        }
        const ShadedPoint<float> p = test::shade_unshadowed(s.context, s.material, s.point);
        ASSERT_EQ(p.radiance.x, 0);
        ASSERT_EQ(p.radiance.y, 0);
        ASSERT_EQ(p.radiance.z, 0);
    }
}

// The base-colour texture (here: the vertex colour, which takes the same way) modulates ka and kd only.
TEST_P(TextbookTest, LIT2_LIT3_ColourModulatesDiffuseAndAmbientNotTheHighlight) {
    test::Random random(13);
    Setting s;
    for (int i = 0; i < 200; ++i) {
        randomise(random, GetParam(), s);
        s.point.color = {0.5f, 0.25f, 0, 1};
        const ShadedPoint<float> got = test::shade_unshadowed(s.context, s.material, s.point);
        s.point.color = {1, 1, 1, 1};
        const float factor[3] = {0.5f, 0.25f, 0};
        for (int c = 0; c < 3; ++c) {
            s.material.ambient[c] *= factor[c];
            s.material.diffuse[c] *= factor[c];
        }
        ASSERT_LT(distance(got.radiance, Real3(test::shade_unshadowed(s.context, s.material, s.point).radiance)),
                  1e-5L);
    }
}

INSTANTIATE_TEST_SUITE_P(Shading, TextbookTest,
                         testing::Values(ShadingModel::kLambert, ShadingModel::kPhong, ShadingModel::kBlinnPhong),
                         [](const auto& instance) {
                             return std::string(instance.param == ShadingModel::kLambert ? "Lambert"
                                                : instance.param == ShadingModel::kPhong ? "Phong"
                                                                                         : "BlinnPhong");
                         });

// The highlight's value as a function of the angle between view and mirror direction, light and view
// in one plane with the normal; Blinn's halfway angle is half of that angle.
float highlight(ShadingModel model, float shininess, Real off) {
    MaterialView m = test::plain_material(model);
    for (float& d : m.diffuse) d = 0;
    for (float& k : m.specular) k = 1;
    m.shininess = shininess;
    const Real in = 0.5L, out = in + off;
    const std::vector<LightView> lights{
        test::directional_light(test::to_vec(Real3{-std::sin(in), 0, std::cos(in)}), kPi)};
    const Vec3T<float> toward_eye = test::to_vec(Real3{std::sin(out), 0, std::cos(out)});
    return test::shade_unshadowed(test::plain_context(lights), m, test::plain_point(-toward_eye, {0, 0, 1})).radiance.x;
}

// cos^(4 ns)(a / 2) and cos^ns(a) agree to second order: exponents 4 ns against ns give lobes that
// differ by less than 2 % of the peak from ns = 16 on; with equal exponents they differ by far more.
TEST(LIT3_Blinn, ExponentOfAboutFourNsGivesPhongsLobe) {
    for (const float ns : {16.0f, 32.0f, 100.0f}) {
        Real four = 0, one = 0;
        for (int i = 0; i <= 100; ++i) {
            const Real off = i * 0.01L;
            const Real phong = highlight(ShadingModel::kPhong, ns, off);
            four = std::fmax(four, std::fabs(highlight(ShadingModel::kBlinnPhong, 4 * ns, off) - phong));
            one = std::fmax(one, std::fabs(highlight(ShadingModel::kBlinnPhong, ns, off) - phong));
        }
        EXPECT_LT(four, 0.02L) << ns;
        EXPECT_GT(one, 0.3L) << ns;
    }
}

TEST(LIT2_Phong, PeakIsKsInTheMirrorDirectionAndFollowsThePower) {
    for (const float ns : {1.0f, 10.0f, 200.0f}) {
        EXPECT_NEAR(highlight(ShadingModel::kPhong, ns, 0), 1, 1e-6 * ns + 1e-6);
        EXPECT_NEAR(highlight(ShadingModel::kPhong, ns, 0.3L),
                    static_cast<double>(std::pow(std::cos(0.3L), static_cast<Real>(ns))), 1e-6 * ns + 1e-6);
    }
}

TEST(LIT2_Unlit, ShowsItsColourWhateverTheLight) {
    std::vector<LightView> lights{test::directional_light({0, 0, 1}, 100)};
    ShadingContext c = test::plain_context(lights);
    c.unlit_scale = 0.25f;
    c.ambient = {{1, 1, 1}, {1, 1, 1}, {0, 1, 0}};
    MaterialView m = test::plain_material(ShadingModel::kUnlit);
    m.base_color[0] = 0.5f;
    m.emission[1] = 9;
    const ShadedPoint<float> p = test::shade_unshadowed(c, m, test::plain_point({0, 0, -1}, {0, 0, 1}));
    EXPECT_EQ(p.radiance.x, 0.125f);
    EXPECT_EQ(p.radiance.y, 0.25f);
}

// Whole exponents are powers by multiplication: each product doubles the error that is there and rounds
// once, so the whole power is right to about one rounding per unit of the exponent.
TEST(LIT2_Power, WholeExponentsByMultiplicationAndOthersByPow) {
    test::Random random(14);
    for (int i = 0; i < 40000; ++i) {
        const float x = random.in(0.01f, 1);
        const float exponent = i % 2 ? static_cast<float>(1 + random.below(1024)) : random.in(0.1f, 1200);
        const Real want = std::pow(static_cast<Real>(x), static_cast<Real>(exponent));
        if (want < 1e-37L) continue;
        const Real tolerance = i % 2 ? exponent * 0x1p-24L * 1.01L : 2e-5L;
        ASSERT_LE(std::fabs(power_cosine(x, Exponent(exponent)) - want), want * tolerance) << x << "^" << exponent;
    }
    for (const float exponent : {0.0f, 0.5f, 1.0f, 2.0f, 31.0f, 1024.0f, 1025.0f}) {
        EXPECT_EQ(power_cosine(1.0f, Exponent(exponent)), 1.0f) << exponent;
        EXPECT_EQ(power_cosine(-0.5f, Exponent(exponent)), exponent == 0 ? 1.0f : 0.0f) << exponent;
    }
}

}  // namespace
}  // namespace tessera
