// Textures of what a material mirrors, against the definitions in long double: KHR_materials_specular,
// KHR_materials_pbrSpecularGlossiness, and ks and ns of the Phong models.
#include "shading/shade.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace tessera {
namespace {

using test::Real;
using test::Real3;

// A 1 x 1 texture of one random texel.
class OneTexel {
  public:
    explicit OneTexel(test::Random& random) : texture_(1, 1, 1, 1) {
        for (std::int16_t& c : texel_.c) c = static_cast<std::int16_t>(random.below(32768));
        texture_.fill(0, texel_);
    }
    void put_into(MaterialView& m, TextureSlot slot) {
        TextureInput& in = m.inputs[static_cast<int>(slot)];
        in.texture = &texture_.view();
        in.plain = true;
    }
    Real operator[](int channel) const { return test::value15(texel_.c[channel]); }

  private:
    Texel texel_{};
    test::TestTexture texture_;
};

MaterialView random_material(test::Random& random, ShadingModel model) {
    MaterialView m = test::plain_material(model);
    for (float& c : m.base_color) c = random.in(0, 1);
    m.metallic = model == ShadingModel::kMetallicRoughness ? random.in(0, 1) : 0;
    m.roughness = random.in(0, 1);
    return m;
}

SurfacePoint<float> random_point(test::Random& random) {
    return test::plain_point(random.unit() * random.in(0.5f, 20), random.unit());
}

void expect_near(const Vec3T<float>& got, Real3 want) {
    ASSERT_LT(test::distance(got, want), 5e-7L * (1 + norm(want)));
}

// dielectric_f0 = min(((n - 1) / (n + 1))^2 colour, 1) strength, dielectric_f90 = strength; metal keeps its own.
TEST(LIT4_Specular, TexturesMultiplyStrengthAndColour) {
    test::Random random(31);
    for (int i = 0; i < 2000; ++i) {
        MaterialView m = random_material(random, ShadingModel::kMetallicRoughness);
        for (float& r : m.reflectance) r = random.in(0, 1.5f);
        m.dielectric_edge = random.in(0, 1);
        OneTexel strength(random), color(random);
        const bool has_strength = i % 3 != 1, has_color = i % 3 != 2;
        if (has_strength) strength.put_into(m, TextureSlot::kSpecular);
        if (has_color) color.put_into(m, TextureSlot::kSpecularColor);
        const LobeParameters<float> p = evaluate_material(m, random_point(random));
        const Real edge = m.dielectric_edge * (has_strength ? strength[3] : 1), metal = m.metallic;
        const auto f0 = [&](int c) {
            const Real dielectric = std::fmin(m.reflectance[c] * (has_color ? color[c] : 1), 1.0L) * edge;
            return dielectric * (1 - metal) + m.base_color[c] * metal;
        };
        expect_near(p.f0, {f0(0), f0(1), f0(2)});
        ASSERT_NEAR(static_cast<double>(p.f90), static_cast<double>(edge * (1 - metal) + metal), 1e-6);
        expect_near(p.base, {m.base_color[0], m.base_color[1], m.base_color[2]});
        ASSERT_EQ(p.roughness, m.roughness);
    }
}

// f0 = specular, diffuse = colour (1 - max(specular)), roughness = 1 - glossiness, of each texel.
TEST(LIT4_SpecularGlossiness, IsItsDefinitionAtEveryTexel) {
    test::Random random(32);
    for (int i = 0; i < 2000; ++i) {
        MaterialView m = random_material(random, ShadingModel::kSpecularGlossiness);
        for (float& r : m.reflectance) r = random.in(0, 1);
        OneTexel texel(random);
        texel.put_into(m, TextureSlot::kSpecularColor);
        const LobeParameters<float> p = evaluate_material(m, random_point(random));
        const Real3 specular{m.reflectance[0] * texel[0], m.reflectance[1] * texel[1], m.reflectance[2] * texel[2]};
        const Real left = 1 - std::fmax(specular.x, std::fmax(specular.y, specular.z));
        expect_near(p.f0, specular);
        expect_near(p.base, Real3{m.base_color[0], m.base_color[1], m.base_color[2]} * left);
        ASSERT_NEAR(static_cast<double>(p.roughness), static_cast<double>(1 - (1 - Real{m.roughness}) * texel[3]),
                    1e-6);
        ASSERT_EQ(p.f90, 1);
        ASSERT_EQ(p.metallic, 0);
    }
}

// The picture's highlight: ks times the colour of one texture, ns times the alpha of the other.
TEST(LIT2_LIT3_HighlightTextures, MultiplyKsAndNs) {
    test::Random random(33);
    for (int i = 0; i < 6000; ++i) {
        const ShadingModel model = i % 2 ? ShadingModel::kPhong : ShadingModel::kBlinnPhong;
        MaterialView m = test::plain_material(model);
        for (float& k : m.diffuse) k = 0;
        for (float& k : m.specular) k = random.in(0, 1);
        m.shininess = random.in(1, 60);
        OneTexel scale(random), color(random);
        const bool has_scale = i % 3 != 1, has_color = i % 3 != 2;
        if (has_scale) scale.put_into(m, TextureSlot::kSpecular);
        if (has_color) color.put_into(m, TextureSlot::kSpecularColor);
        const SurfacePoint<float> s = random_point(random);
        const std::vector<LightView> lights{test::directional_light(random.unit(), 2)};
        const ShadedPoint<float> got = test::shade_unshadowed(test::plain_context(lights), m, s);
        const Real3 n(s.normal), v = unit(Real3{} - Real3(s.position)), l(Vec3T<float>::load(lights[0].to_light));
        const Real n_l = inner(n, l);
        const Real cosine = model == ShadingModel::kPhong ? inner(v, n * (2 * n_l) - l) : inner(n, unit(l + v));
        const Real ns = m.shininess * (has_scale ? scale[3] : 1);
        const Real power = n_l > 0 ? 2 / test::kRealPi * std::pow(std::fmax(cosine, 0.0L), ns) : 0;
        const auto ks = [&](int c) { return m.specular[c] * (has_color ? color[c] : 1); };
        const Real3 want = Real3{ks(0), ks(1), ks(2)} * power;
        ASSERT_LT(distance(got.radiance, want), 1e-6L + 8 * ns * 0x1p-23L) << "ns " << static_cast<double>(ns);
    }
}

// A texture of white is no texture.
TEST(LIT4_Specular, WhiteTexturesChangeNothing) {
    test::Random random(34);
    test::TestTexture white(1, 1, 1, 1);
    white.fill(0, {{32767, 32767, 32767, 32767}});
    for (const ShadingModel model : {ShadingModel::kMetallicRoughness, ShadingModel::kBlinnPhong})
        for (int i = 0; i < 500; ++i) {
            MaterialView m = random_material(random, model);
            for (int c = 0; c < 3; ++c) {
                m.reflectance[c] = random.in(0, 1);
                m.dielectric[c] = m.reflectance[c] * 0.5f;
                m.specular[c] = random.in(0, 1);
            }
            m.dielectric_edge = 0.5f;
            m.shininess = 20;
            const std::vector<LightView> lights{test::directional_light(random.unit(), 2)};
            const ShadingContext context = test::plain_context(lights);
            const SurfacePoint<float> s = random_point(random);
            const ShadedPoint<float> plain = test::shade_unshadowed(context, m, s);
            TextureInput& in = m.inputs[static_cast<int>(TextureSlot::kSpecularColor)];
            in.texture = &white.view();
            in.plain = true;
            const ShadedPoint<float> textured = test::shade_unshadowed(context, m, s);
            ASSERT_EQ(textured.radiance.x, plain.radiance.x);
            ASSERT_EQ(textured.radiance.y, plain.radiance.y);
            ASSERT_EQ(textured.radiance.z, plain.radiance.z);
        }
}

}  // namespace
}  // namespace tessera
