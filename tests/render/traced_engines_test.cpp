// The ray tracer and the hybrid beside the other engines: without traced light the rasterizer's picture, with it the
// recursive reference's.
#include <gtest/gtest.h>

#include "load/test_files.h"
#include "render/traced_pictures.h"

namespace tessera {
namespace {

using namespace test;

// Rays go through vertices where they are, not on the grid of 1/256 pixel: at edges they may see the other triangle.
// Of strokes, which lie on the pixel grid, many edges go through the very samples. What is drawn by its formula they
// see elsewhere: such scenes are compared as triangles.
void expect_the_rasterizers_picture(const std::string& name, const Scene& scene, int width, int height) {
    RenderOptions o = quick(Engine::kRaster, width, height);
    o.shadows = Shadows::kNone;
    o.max_depth = 0;
    const RenderResult raster = render(scene, o);
    o.engine = Engine::kHybrid;
    const RenderResult hybrid = render(scene, o);
    EXPECT_TRUE(same_bytes(raster.linear, hybrid.linear)) << name;
    EXPECT_TRUE(same_bytes(raster.color, hybrid.color)) << name;
    EXPECT_EQ(raster.stats.pixels_covered, hybrid.stats.pixels_covered) << name;
    EXPECT_EQ(hybrid.stats.shadow_rays + hybrid.stats.mirrored_rays + hybrid.stats.refracted_rays, 0u) << name;
    if (has_shapes(scene)) return expect_the_rasterizers_picture(name, as_triangles(scene), width, height);
    o.engine = Engine::kTrace;
    const RenderResult traced = render(scene, o);
    const Differences d = differences(raster, traced);
    print(name + ", trace and raster", d);
    EXPECT_LE(part(d.visible, raster), has_strokes(scene) ? 6e-3 : 2e-3) << name;
    EXPECT_LE(part(d.far, raster), has_strokes(scene) ? 6e-3 : 5e-4) << name;
    EXPECT_EQ(traced.stats.primary_rays, static_cast<std::uint64_t>(width * height));
}

TEST(TracedEngines, WithoutTracedLightTheRasterizersPictureOfEveryScene) {
    for (const std::string& name : all_scene_files())
        expect_the_rasterizers_picture(name, scene_file(name.c_str()), 320, 240);
}

TEST(TracedEngines, WithoutTracedLightTheRasterizersPictureOfAnySize) {
    for (const auto& [width, height] :
         {std::pair{1, 1}, std::pair{3, 5}, std::pair{33, 17}, std::pair{129, 65}, std::pair{300, 2}})
        for (const char* file : {"spheres.gltf", "transparency.gltf"}) {
            RenderOptions o = quick(Engine::kRaster, width, height);
            o.shadows = Shadows::kNone;
            o.max_depth = 0;
            const RenderResult raster = render(scene_file(file), o);
            o.engine = Engine::kTrace;
            const RenderResult traced = render(scene_file(file), o);
            EXPECT_LE(differences(raster, traced).visible, 4u) << file << ", " << width << "x" << height;
            EXPECT_EQ(traced.stats.primary_rays, static_cast<std::uint64_t>(width * height));
        }
}

TEST(TracedEngines, WithoutTracedLightTheRasterizersPictureOfModels) {
    int seen = 0;
    for (const std::string& name : all_gltf_models()) {
        Scene scene;
        try {
            scene = load_scene(gltf_model(name).string());
        } catch (const Error&) {
            continue;  // needs an extension; the loader's tests say which
        }
        expect_the_rasterizers_picture(name, scene, 200, 150);
        ++seen;
    }
    if (seen == 0) GTEST_SKIP() << "no models: set TESSERA_MODELS";
}

TEST(TracedEngines, WithoutTracedLightTheRayCastersPictureOfEveryScene) {
    for (const std::string& name : all_scene_files()) {
        const Scene scene = scene_file(name.c_str());
        RenderOptions o = quick(Engine::kReferenceTrace, 96, 64);
        o.shadows = Shadows::kNone;
        o.max_depth = 0;
        const RenderResult reference = render(scene, o);
        o.engine = Engine::kTrace;
        const RenderResult traced = render(scene, o);
        const Differences d = differences(reference, traced);
        print(name + ", trace and reference without traced light", d);
        EXPECT_LE(part(d.bits, reference), 2e-3) << name;
    }
}

TEST(TracedEngines, TheRecursiveReferencesPictureOfEveryScene) {
    for (const std::string& name : all_scene_files())
        expect_the_references_picture(name, scene_file(name.c_str()), quick(Engine::kTrace, 96, 64));
}

// Neighbouring triangles of one surface, every second one seen from behind: mirrored light goes to the viewer's side,
// and light that enters a body knows whether it does.
TEST(TracedEngines, TheRecursiveReferencesPictureOfTwoSidedSurfaces) {
    Material mirror = lambert({0.2f, 0.2f, 0.2f}), clear = glass(1.5f);
    mirror.mirror = {0.5f, 0.5f, 0.5f};
    clear.double_sided = true;
    for (const Material& m : {lambert({0.8f, 0.8f, 0.8f}), mirror, clear}) {
        Scene scene;
        Primitive curtain;
        for (int i = 0; i <= 24; ++i)
            for (const float y : {-0.9f, 0.9f}) {
                curtain.positions.push_back({static_cast<float>(i) / 12 - 1, y, i % 2 ? 0.2f : 0.0f});
                curtain.normals.push_back({0, 0, 1});
            }
        for (std::uint32_t i = 0; i < 24; ++i) {
            const std::uint32_t v = 2 * i, a = v + (i % 2 ? 1 : 0), b = v + (i % 2 ? 0 : 1);
            curtain.indices.insert(curtain.indices.end(),
                                   {a, v + 2, b, b, a == v ? v + 2 : v + 3, a == v ? v + 3 : v + 2});
        }
        curtain.material = add_material(scene, m);
        add_mesh(scene, curtain);
        place(scene, rectangle(3, 3, -1, add_material(scene, lambert({0.2f, 0.5f, 0.8f}))), {});
        add_sun(scene, {0.2f, 0.3f, 1});
        RenderOptions o = quick(Engine::kTrace, 128, 128);
        o.view = look({0.1f, 0, 2}, {0, 0, 0});
        expect_the_references_picture("two-sided", scene, o);
    }
}

TEST(TracedEngines, TheRecursiveReferencesPictureOfManyKinds) {
    const Scene scene = many_kinds();
    expect_the_references_picture("many kinds", scene, of_many_kinds(Engine::kTrace));
    RenderOptions o = of_many_kinds(Engine::kTrace);
    o.view = look({-0.9f, 0, 0.2f}, {0.5f, -0.2f, 0});  // from within the water and the glass
    expect_the_references_picture("many kinds from within", scene, o);
    o.max_depth = 3;
    o.min_contribution = 0.05f;
    o.shadows = Shadows::kNone;
    o.samples = 3;
    expect_the_references_picture("many kinds, less light", scene, o);
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        const RenderStats stats = render(scene, of_many_kinds(engine)).stats;
        EXPECT_GT(stats.mirrored_rays, 1000u);
        EXPECT_GT(stats.refracted_rays, 1000u);
        EXPECT_GT(stats.straight_rays, 100u);
        EXPECT_GT(stats.shadow_rays, 10000u);
    }
}

}  // namespace
}  // namespace tessera
