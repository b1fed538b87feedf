// Whole pictures against what they must be by definition: colours, transparency, cut-outs, exposure,
// background, samples, labels.
#include <gtest/gtest.h>

#include "core/sampling.h"
#include "render/scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace tessera {
namespace {

using namespace test;

constexpr Engine kEngines[] = {Engine::kReferenceRaster, Engine::kReferenceTrace};

TEST(Picture, FB1_UnlitTexturesShowTheirExactCodes) {
    Image texture(16, 16, PixelFormat::kRgba8);
    for (int i = 0; i < 256; ++i) {
        std::uint8_t* t = texture.data<std::uint8_t>() + 4 * i;
        t[0] = static_cast<std::uint8_t>(i), t[1] = static_cast<std::uint8_t>(255 - i),
        t[2] = static_cast<std::uint8_t>(i ^ 85), t[3] = 255;
    }
    Scene scene;
    scene.pictures.push_back({"codes", "", std::make_shared<const Image>(texture), ""});
    scene.samplers.push_back({"", Filter::kNearest, Filter::kNearest, MipFilter::kNone, Wrap::kClamp, Wrap::kClamp});
    scene.textures.push_back({"", 0, 0, ""});
    Material m = unlit({1, 1, 1, 1});
    m.texture(TextureSlot::kBaseColor).texture = 0;
    add_mesh(scene, rectangle(1, 1, 0, add_material(scene, m)));
    add_orthographic(scene);
    for (const Engine engine : kEngines)
        for (const float ev : {0.0f, 3.0f}) {  // unlit is a display colour: exposure does not touch it
            RenderOptions o = small(16, 16);
            o.engine = engine;
            o.exposure_ev = ev;
            EXPECT_TRUE(same_bytes(render(scene, o).color, texture)) << name(engine) << " EV " << ev;
        }
}

TEST(Picture, TEX1_TurnedNormalTexturesTurnTheTangentsMadeForThem) {
    // KHR_texture_transform in the reference, or its matrix applied to the vertices' own uv: one picture.
    Image bumps(2, 2, PixelFormat::kRgba8);
    for (int i = 0; i < 4; ++i) {
        std::uint8_t* t = bumps.data<std::uint8_t>() + 4 * i;
        t[0] = 218, t[1] = 128, t[2] = 218, t[3] = 255;  // leans towards +u
    }
    Light sun;
    sun.type = Light::Type::kDirectional;
    sun.intensity = 3;
    for (const TextureRef& ref : {TextureRef{0, 0, {0, 0}, {1, 1}, 1.5707964f}, TextureRef{0, 0, {0, 0}, {1, 1}, 0.6f},
                                  TextureRef{0, 0, {1, 0}, {-1, 1}, 0}, TextureRef{0, 0, {0, 0}, {1, -2}, -2}}) {
        const auto picture = [&](bool in_reference) {
            Scene scene;
            scene.pictures.push_back({"bumps", "", std::make_shared<const Image>(bumps), ""});
            scene.textures.push_back({"", 0, kNone, ""});
            Material m = lambert({1, 1, 1});
            m.texture(TextureSlot::kNormal).texture = 0;
            if (in_reference) m.texture(TextureSlot::kNormal) = ref;
            Primitive p = rectangle(1, 1, 0, add_material(scene, m));
            const float c = std::cos(ref.rotation), s = std::sin(ref.rotation);
            if (!in_reference)
                for (Vec2& t : p.texcoords[0])
                    t = {c * ref.scale.x * t.x + s * ref.scale.y * t.y + ref.offset.x,
                         -s * ref.scale.x * t.x + c * ref.scale.y * t.y + ref.offset.y};
            add_mesh(scene, std::move(p));
            add_orthographic(scene);
            add_light(scene, sun, {}, {-0.25f, 0.35f, 0, 0.9028f});
            return linear_at(render(scene, small(8, 8)), 4, 4);
        };
        const Vec4 a = picture(true), b = picture(false);
        EXPECT_NEAR(a.x, b.x, 1e-4f) << ref.rotation << " " << ref.scale.x << " " << ref.scale.y;
    }
}

TEST(Picture, LIT10_StackedTransparencyIsComposedFarToNearWhateverTheOrder) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> value(0, 1);
    for (int round = 0; round < 12; ++round) {
        struct Layer {
            float z;
            Vec4 color;
        };
        std::vector<Layer> layers;
        for (int i = 0; i < 6; ++i)
            layers.push_back(
                {static_cast<float>(i) * 0.7f, {value(random), value(random), value(random), value(random)}});
        double expected[4] = {0, 0, 0, 0};
        for (const Layer& l : layers) {  // far to near
            const double a = l.color.w;
            const double c[3] = {l.color.x, l.color.y, l.color.z};
            for (int k = 0; k < 3; ++k) expected[k] = c[k] * a + expected[k] * (1 - a);
            expected[3] = a + expected[3] * (1 - a);
        }
        std::shuffle(layers.begin(), layers.end(), random);
        Scene scene;
        for (const Layer& l : layers) {
            Material m = unlit(l.color);
            m.alpha_mode = AlphaMode::kBlend;
            add_mesh(scene, rectangle(2, 2, l.z, add_material(scene, m)));
        }
        add_orthographic(scene);
        for (const Engine engine : kEngines) {
            RenderOptions o = small(8, 8);
            o.engine = engine;
            const RenderResult r = render(scene, o);
            const Vec4 c = linear_at(r, 3, 5);
            EXPECT_NEAR(c.x, expected[0], 1e-5);
            EXPECT_NEAR(c.y, expected[1], 1e-5);
            EXPECT_NEAR(c.z, expected[2], 1e-5);
            EXPECT_NEAR(c.w, expected[3], 1e-5);
        }
    }
}

TEST(Picture, LIT10_InterpenetratingTransparencyIsSortedPerPixel) {
    // Two panes that cross at x = 0: red is in front on one side, green on the other.
    Scene scene;
    for (int k = 0; k < 2; ++k) {
        Material m = unlit(k == 0 ? Vec4{1, 0, 0, 0.5f} : Vec4{0, 1, 0, 0.5f});
        m.alpha_mode = AlphaMode::kBlend;
        Primitive p = rectangle(1, 1, 0, add_material(scene, m));
        for (Vec3& v : p.positions) v.z = (k == 0 ? 0.8f : -0.8f) * v.x;
        add_mesh(scene, p);
    }
    add_orthographic(scene);
    for (const Engine engine : kEngines) {
        RenderOptions o = small(32, 32);
        o.engine = engine;
        const RenderResult r = render(scene, o);
        const Vec4 left = linear_at(r, 4, 10), right = linear_at(r, 27, 10);
        EXPECT_EQ(left, (Vec4{0.25f, 0.5f, 0, 0.75f}));  // green in front of red
        EXPECT_EQ(right, (Vec4{0.5f, 0.25f, 0, 0.75f}));
    }
}

TEST(Picture, LIT10_OpaqueSurfacesHideTransparentOnesBehindThem) {
    Scene scene;
    Material glass = unlit({1, 0, 0, 0.5f});
    glass.alpha_mode = AlphaMode::kBlend;
    add_mesh(scene, rectangle(2, 2, -1, add_material(scene, glass)));
    add_mesh(scene, rectangle(2, 2, 0, add_material(scene, unlit({0, 0, 1, 1}))));
    add_orthographic(scene);
    for (const Engine engine : kEngines) {
        RenderOptions o = small(8, 8);
        o.engine = engine;
        EXPECT_EQ(linear_at(render(scene, o), 4, 4), (Vec4{0, 0, 1, 1}));
    }
}

TEST(Picture, TEX1_CutOutsLetTheSurfaceBehindThrough) {
    Image texture(2, 1, PixelFormat::kRgba8);
    const std::uint8_t texels[8] = {255, 0, 0, 255, 255, 0, 0, 100};  // left solid, right below the cut-off
    std::copy(texels, texels + 8, texture.data<std::uint8_t>());
    Scene scene;
    scene.pictures.push_back({"", "", std::make_shared<const Image>(texture), ""});
    scene.samplers.push_back({"", Filter::kNearest, Filter::kNearest, MipFilter::kNone, Wrap::kClamp, Wrap::kClamp});
    scene.textures.push_back({"", 0, 0, ""});
    Material leaf = unlit({1, 1, 1, 1});
    leaf.texture(TextureSlot::kBaseColor).texture = 0;
    leaf.alpha_mode = AlphaMode::kMask;
    const int leaf_index = add_material(scene, leaf), wall = add_material(scene, unlit({0, 1, 0, 1}));
    add_mesh(scene, rectangle(1, 1, 1, leaf_index));
    add_mesh(scene, rectangle(1, 1, 0, wall));
    add_orthographic(scene);
    for (const Engine engine : kEngines) {
        RenderOptions o = small(16, 16);
        o.engine = engine;
        o.want_primitive = true;
        const RenderResult r = render(scene, o);
        EXPECT_EQ(linear_at(r, 3, 8), (Vec4{1, 0, 0, 1}));
        EXPECT_EQ(linear_at(r, 12, 8), (Vec4{0, 1, 0, 1}));
        EXPECT_LE(r.primitive.data<std::uint32_t>()[8 * 16 + 3], 2u);
        EXPECT_GE(r.primitive.data<std::uint32_t>()[8 * 16 + 12], 3u);
    }
}

TEST(Picture, LIT1_WhiteUnderOneLuxHasTheRadianceOfOneOverPi) {
    Scene scene;
    add_mesh(scene, rectangle(2, 2, 0, add_material(scene, lambert({1, 1, 1}))));
    add_orthographic(scene);
    Light sun;
    sun.type = LightType::kDirectional;
    add_light(scene, sun, {0, 0, 5});  // shines along -Z, onto the wall
    for (const Engine engine : kEngines) {
        RenderOptions o = small(4, 4);
        o.engine = engine;
        o.ambient = 0.0f;
        EXPECT_NEAR(linear_at(render(scene, o), 1, 2).x, 1 / 3.14159265358979, 1e-6);
    }
}

TEST(Picture, LIT1_AutomaticExposureMakesTheUnitOfLightIrrelevant) {
    const auto picture = [](float lux) {
        Scene scene;
        add_mesh(scene, rectangle(2, 2, 0, add_material(scene, lambert({0.6f, 0.3f, 0.1f}))));
        add_orthographic(scene);
        Light sun;
        sun.type = LightType::kDirectional;
        sun.intensity = lux;
        add_light(scene, sun, {0, 0, 5});
        RenderOptions o = small(4, 4);
        o.exposure_ev.reset();
        return render(scene, o);
    };
    const RenderResult dim = picture(1), bright = picture(131072);  // a power of two scales exactly
    EXPECT_TRUE(same_bytes(dim.color, bright.color));
    EXPECT_NEAR(dim.stats.exposure / bright.stats.exposure, 131072.0, 1e-3);
    // The metered white is exposed to 0.7: so is what reflects 60 % of it, to 0.42 and the ambient.
    EXPECT_GT(dim.color.data<std::uint8_t>()[0], 160);
    EXPECT_LT(dim.color.data<std::uint8_t>()[0], 190);
}

TEST(Picture, ScenesWithoutLightsGetTheStudio) {
    Scene scene;
    add_mesh(scene, rectangle(2, 2, 0, add_material(scene, lambert({1, 1, 1}))));
    add_orthographic(scene);
    RenderOptions o = small(4, 4);
    const RenderResult lit = render(scene, o);
    EXPECT_GT(linear_at(lit, 2, 2).x, 0.3f);
    EXPECT_EQ(lit.stats.exposure, 1.0);
    o.lighting = Lighting::kScene;
    o.ambient = 0.0f;
    EXPECT_EQ(linear_at(render(scene, o), 2, 2).x, 0.0f);
}

TEST(Picture, BackgroundKeepsItsColourAndTransparencyItsAlpha) {
    Scene scene;
    add_mesh(scene, rectangle(0.5f, 0.5f, 0, add_material(scene, unlit({1, 0, 0, 1}))));
    add_orthographic(scene);
    RenderOptions o = small(16, 16, 4);
    o.background = Vec4{10 / 255.0f, 128 / 255.0f, 200 / 255.0f, 1};
    RenderResult r = render(scene, o);
    const std::uint8_t* p = r.color.data<std::uint8_t>();
    EXPECT_EQ(p[0], 10);
    EXPECT_EQ(p[1], 128);
    EXPECT_EQ(p[2], 200);
    EXPECT_EQ(p[3], 255);
    o.background.reset();
    r = render(scene, o);
    EXPECT_EQ(r.color.data<std::uint8_t>()[3], 0);
    EXPECT_EQ(r.color.data<std::uint8_t>()[4 * (8 * 16 + 8) + 3], 255);
}

TEST(Picture, RAS7_SamplesLieWithinThePixelAndAverageToItsCentre) {
    EXPECT_EQ(sample_offset(0, 1).x, 128);
    EXPECT_EQ(sample_offset(0, 1).y, 128);
    for (int count : {2, 3, 4, 5, 8, 16, 64, 256}) {
        double x = 0, y = 0;
        std::vector<int> columns;
        for (int i = 0; i < count; ++i) {
            const SampleOffset s = sample_offset(i, count);
            EXPECT_TRUE(s.x >= 0 && s.x < 256 && s.y >= 0 && s.y < 256);
            x += s.x;
            y += s.y;
            columns.push_back(s.x);
        }
        EXPECT_NEAR(x / count, 128, 1) << count;
        EXPECT_NEAR(y / count, 128, 32) << count;
        std::sort(columns.begin(), columns.end());
        EXPECT_TRUE(std::adjacent_find(columns.begin(), columns.end()) == columns.end())
            << "no two samples share a column";
    }
}

TEST(Picture, RAS7_SupersamplingApproachesTheCoveredArea) {
    // A half plane whose edge cuts pixel (8, y) at 30 % of its width.
    Scene scene;
    const float edge = (8.3f / 16.0f) * 2 - 1;
    Primitive p = rectangle(1, 1, 0, add_material(scene, unlit({1, 1, 1, 1})));
    p.positions[1].x = p.positions[2].x = edge;
    add_mesh(scene, p);
    add_orthographic(scene);
    for (const int samples : {16, 64, 256}) {
        const RenderResult r = render(scene, small(16, 16, samples));
        EXPECT_NEAR(linear_at(r, 8, 5).w, 0.3, 0.5 / samples + 1e-3);
        EXPECT_EQ(linear_at(r, 7, 5).w, 1.0f);
        EXPECT_EQ(linear_at(r, 9, 5).w, 0.0f);
    }
}

TEST(Picture, LabelsAreTakenAtTheCentreAndNotFiltered) {
    Scene scene;
    add_mesh(scene, rectangle(0.5f, 2, -2.5f, add_material(scene, unlit({1, 1, 1, 1}))));
    Material glass = unlit({1, 1, 1, 0.4f});  // too thin to count as the surface
    glass.alpha_mode = AlphaMode::kBlend;
    add_mesh(scene, rectangle(2, 2, 3, add_material(scene, glass)));
    add_orthographic(scene);
    for (const Engine engine : kEngines)
        for (const int samples : {1, 4}) {
            RenderOptions o = small(16, 16, samples);
            o.engine = engine;
            o.want_depth = o.want_primitive = true;
            const RenderResult r = render(scene, o);
            const float* depth = r.depth.data<float>();
            const std::uint32_t* id = r.primitive.data<std::uint32_t>();
            for (int x = 0; x < 16; ++x) {
                const bool hit = x >= 4 && x < 12;
                EXPECT_EQ(depth[5 * 16 + x], hit ? 12.5f : std::numeric_limits<float>::infinity()) << x;
                EXPECT_EQ(id[5 * 16 + x] != 0, hit);
                EXPECT_LE(id[5 * 16 + x], 2u);
            }
        }
}

// A picture of one colour is that colour as a factor: what textures multiply is what factors say, up to the 15 bits
// of a texel. Specular-glossiness without a texture takes another way.
TEST(Picture, LIT4_TexturesOfWhatIsMirroredAreFactors) {
    Image grey(1, 1, PixelFormat::kRgba8);
    std::uint8_t* t = grey.data<std::uint8_t>();
    t[0] = 188, t[1] = 137, t[2] = 0, t[3] = 102;
    const Vec3 color{0.50289f, 0.25016f, 0};  // of these codes (IEC 61966-2-1)
    const float alpha = 102.0f / 255;
    Light sun;
    sun.type = Light::Type::kDirectional;
    sun.intensity = 3;
    for (const ShadingModel model : {ShadingModel::kMetallicRoughness, ShadingModel::kSpecularGlossiness,
                                     ShadingModel::kPhong, ShadingModel::kBlinnPhong}) {
        const auto picture = [&](bool textured) {
            Scene scene;
            scene.pictures.push_back({"grey", "", std::make_shared<const Image>(grey), ""});
            scene.textures.push_back({"", 0, kNone, ""});
            Material m;
            m.model = model;
            m.base_color = {0.8f, 0.7f, 0.6f, 1};
            m.diffuse = {0.2f, 0.2f, 0.2f};
            m.metallic = 0;
            const bool glossy = model == ShadingModel::kSpecularGlossiness;
            m.roughness = textured || !glossy ? 0.25f : 1 - 0.75f * alpha;
            m.specular_color = m.specular = textured ? Vec3{1, 1, 1} : color;
            m.specular_strength = textured || glossy ? 1 : alpha;
            m.shininess = textured ? 20 : 20 * alpha;
            if (textured) {
                m.texture(TextureSlot::kSpecularColor).texture = 0;
                if (!glossy) m.texture(TextureSlot::kSpecular).texture = 0;
            }
            add_mesh(scene, rectangle(1, 1, 0, add_material(scene, m)));
            scene.lights.push_back(sun);
            scene.nodes.emplace_back().light = 0;
            scene.scenes[0].nodes.push_back(1);
            RenderOptions o = small(16, 16);
            o.view.eye = Vec3{0.2f, 0.3f, 2};
            o.view.target = Vec3{0, 0, 0};
            o.exposure_ev = 0.0f;
            o.want_linear = o.want_albedo = true;
            return render(scene, o);
        };
        const RenderResult a = picture(true), b = picture(false);
        // What is mirrored is no part of the diffuse colour of specular-glossiness.
        const std::size_t middle = 3 * (16 * 8 + 8);
        for (const RenderResult* r : {&a, &b}) {
            if (model != ShadingModel::kSpecularGlossiness) break;
            EXPECT_NEAR(r->albedo.data<float>()[middle], 0.8f * (1 - color.x), 1e-4f);
        }
        double most = 0, largest = 0;
        for (std::size_t i = 0; i < 16 * 16 * 4; ++i) {
            const double x = a.linear.data<float>()[i], y = b.linear.data<float>()[i];
            most = std::max(most, std::abs(x - y) / (1 + std::abs(y)));
            largest = std::max(largest, y);
        }
        EXPECT_LT(most, 5e-4) << static_cast<int>(model);
        EXPECT_GT(largest, 0.02);
    }
}

}  // namespace
}  // namespace tessera
