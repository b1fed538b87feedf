// The warm renderer: the bits of render(), planes used again, pictures without colour, cameras of hosts,
// and the encoding of the colour plane.
#include <gtest/gtest.h>

#include "bench/workloads.h"
#include "reference/workload_scene.h"
#include "render/scenes.h"
#include "simd/isa.h"

#include <array>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

using namespace test;

constexpr std::array kEngines{Engine::kRaster, Engine::kReferenceRaster, Engine::kReferenceTrace};

RenderOptions all_planes(Engine engine, int samples = 1) {
    RenderOptions o = small(96, 64, samples);
    o.engine = engine;
    o.want_depth = o.want_primitive = true;
    return o;
}

void expect_same_planes(const RenderResult& a, const RenderResult& b) {
    EXPECT_TRUE(same_bytes(a.color, b.color));
    EXPECT_TRUE(same_bytes(a.linear, b.linear));
    EXPECT_TRUE(same_bytes(a.depth, b.depth));
    EXPECT_TRUE(same_bytes(a.primitive, b.primitive));
    EXPECT_EQ(a.stats.pixels_covered, b.stats.pixels_covered);
    EXPECT_EQ(a.stats.fragments_passed, b.stats.fragments_passed);
    EXPECT_EQ(a.warnings, b.warnings);
}

// Textured, lit, with a transparent part, points, and cameras of its own.
Scene mixed_scene() {
    Scene scene = make_scene(wl::sphere(20));
    Material glass = unlit({1, 0.5f, 0, 0.5f});
    glass.alpha_mode = AlphaMode::kBlend;
    add_mesh(scene, rectangle(0.7f, 0.7f, 1.2f, add_material(scene, glass)));
    Primitive dots = rectangle(1, 1, 0, kNone);
    dots.mode = PrimitiveMode::kPoints;
    dots.indices.clear();
    add_mesh(scene, dots);
    add_light(scene, Light{}, {1, 2, 3});
    return scene;
}

TEST(Renderer, DrawsTheBitsOfRenderFromEveryViewInAnyOrder) {
    const Scene scene = mixed_scene();
    const View views[] = {{}, look({0, 0, 3}, {0, 0, 0}), look({2, 1, 2}, {0, 0.2f, 0})};
    for (const Engine engine : kEngines) {
        RenderOptions o = all_planes(engine, 2);
        o.exposure_ev.reset();  // metered for each view
        Renderer renderer(scene, o);
        RenderResult warm;
        for (const int v : {0, 1, 2, 1, 0}) {
            o.view = views[v];
            renderer.draw(views[v], warm);
            const RenderResult cold = render(scene, o);
            expect_same_planes(warm, cold);
            EXPECT_EQ(warm.stats.exposure, cold.stats.exposure);
            EXPECT_EQ(warm.warnings.size(), 0u);
            EXPECT_EQ(warm.stats.color_hash, 0u);
            EXPECT_EQ(cold.stats.color_hash, hash_pixels(cold.color));
        }
    }
}

TEST(Renderer, PlanesThatFitAreUsedAgain) {
    const Scene scene = mixed_scene();
    Renderer renderer(scene, all_planes(Engine::kRaster));
    RenderResult r;
    renderer.draw(r);
    const std::array<const void*, 4> first{r.color.bytes().data(), r.linear.bytes().data(), r.depth.bytes().data(),
                                           r.primitive.bytes().data()};
    renderer.draw(look({0, 0, 3}, {0, 0, 0}), r);
    const std::array<const void*, 4> second{r.color.bytes().data(), r.linear.bytes().data(), r.depth.bytes().data(),
                                            r.primitive.bytes().data()};
    EXPECT_EQ(first, second);

    // A result of another size and with other planes becomes right.
    RenderOptions o = small(40, 30);
    o.want_linear = false;
    Renderer smaller(scene, o);
    smaller.draw(r);
    EXPECT_EQ(r.color.width(), 40);
    EXPECT_TRUE(r.linear.empty() && r.depth.empty() && r.primitive.empty());
    EXPECT_TRUE(same_bytes(r.color, render(scene, o).color));
}

TEST(Renderer, AFailedFrameLeavesItUsable) {
    const Scene scene = mixed_scene();
    Renderer renderer(scene, all_planes(Engine::kRaster));
    RenderResult r;
    View wrong;
    wrong.camera = 3;
    EXPECT_THROW(renderer.draw(wrong, r), Error);
    renderer.draw(r);
    expect_same_planes(r, render(scene, renderer.options()));
    Renderer moved = std::move(renderer);
    moved.draw(r);
    expect_same_planes(r, render(scene, moved.options()));
}

TEST(Renderer, RefusesWhatRenderRefuses) {
    const Scene scene = mixed_scene();
    RenderOptions o = small();
    o.samples = 0;
    EXPECT_THROW(Renderer(scene, o), Error);
    Scene broken = scene;
    broken.nodes[0].mesh = 70;
    EXPECT_THROW(Renderer(broken, small()), Error);
}

TEST(Renderer, PicturesWithoutColourHaveTheSameLabelsAndCountThem) {
    const Scene scene = mixed_scene();
    for (const Engine engine : kEngines) {
        RenderOptions o = all_planes(engine, 3);
        const RenderResult full = render(scene, o);
        o.want_color = o.want_linear = false;
        const RenderResult labels = render(scene, o);
        EXPECT_TRUE(labels.color.empty());
        EXPECT_TRUE(labels.linear.empty());
        EXPECT_EQ(labels.stats.color_hash, 0u);
        EXPECT_TRUE(same_bytes(full.depth, labels.depth));
        EXPECT_TRUE(same_bytes(full.primitive, labels.primitive));
        std::uint64_t labelled = 0;
        for (std::size_t i = 0; i < 96 * 64; ++i) labelled += labels.primitive.data<std::uint32_t>()[i] != 0;
        EXPECT_GT(labelled, 1000u);
        EXPECT_EQ(labels.stats.pixels_covered, labelled);
        EXPECT_EQ(labels.stats.triangles, full.stats.triangles);
        EXPECT_GE(labels.stats.fragments_passed, labelled / 2);
    }
    RenderOptions o = all_planes(Engine::kRaster);
    o.want_color = o.want_linear = false;
    const RenderStats tiles = render(scene, o).stats;
    o.engine = Engine::kReferenceRaster;
    const RenderStats reference = render(scene, o).stats;
    EXPECT_EQ(tiles.fragments_passed, reference.fragments_passed);
    EXPECT_EQ(tiles.culled_backface, reference.culled_backface);
}

// --- cameras of hosts -------------------------------------------------------------------------

View matrices(const wl::Camera& camera) {
    View view;
    view.clip_from_world.emplace();
    view.camera_from_world.emplace();
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) {
            (*view.clip_from_world)(r, c) = camera.mvp[c][r];
            (*view.camera_from_world)(r, c) = camera.view[c][r];
        }
    return view;
}

// The picture of a camera and that of its matrices differ by rounding only, in every engine.
TEST(HostCamera, GivesThePictureOfTheCameraItDescribes) {
    const Scene scene = make_scene(wl::terrain(60));
    for (const Engine engine : kEngines) {
        RenderOptions o = all_planes(engine);
        o.shadows = Shadows::kNone;
        o.view = look({0, 0.9f, 1.3f}, {0, -0.15f, 0});
        const RenderResult own = render(scene, o);
        o.view = matrices(wl::terrain_camera(96, 64));
        const RenderResult host = render(scene, o);
        int other = 0;
        for (std::size_t i = 0; i < 96 * 64; ++i) {
            if (own.primitive.data<std::uint32_t>()[i] != host.primitive.data<std::uint32_t>()[i]) {
                ++other;
                continue;
            }
            if (own.primitive.data<std::uint32_t>()[i] == 0) continue;
            EXPECT_NEAR(own.depth.data<float>()[i], host.depth.data<float>()[i], 2e-4f);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(own.linear.data<float>()[4 * i + c], host.linear.data<float>()[4 * i + c], 2e-3f);
        }
        EXPECT_LT(other, 12) << name(engine);
        EXPECT_GT(host.stats.pixels_covered, 3000u);
    }
}

TEST(HostCamera, ShiftedLensesShowTheRayCasterTheSame) {
    const Scene scene = make_scene(wl::sphere(10));
    View view = matrices(wl::sphere_camera(96, 64));
    for (int c = 0; c < 4; ++c) (*view.clip_from_world)(0, c) += 0.1f * (*view.clip_from_world)(3, c);
    RenderOptions o = all_planes(Engine::kRaster);
    o.view = view;
    const RenderResult raster = render(scene, o);
    EXPECT_GT(raster.stats.pixels_covered, 1000u);
    o.engine = Engine::kReferenceTrace;
    o.shadows = Shadows::kNone;
    const RenderResult traced = render(scene, o);
    int other = 0;
    for (std::size_t i = 0; i < 96 * 64; ++i)
        other += raster.primitive.data<std::uint32_t>()[i] != traced.primitive.data<std::uint32_t>()[i];
    EXPECT_LT(other, 4);
}

TEST(HostCamera, TheRayCasterRefusesTurnedPictures) {
    const Scene scene = make_scene(wl::sphere(10));
    View view = matrices(wl::sphere_camera(96, 64));
    for (int c = 0; c < 4; ++c) (*view.clip_from_world)(0, c) += 0.1f * (*view.clip_from_world)(1, c);
    RenderOptions o = all_planes(Engine::kRaster);
    o.view = view;
    EXPECT_GT(render(scene, o).stats.pixels_covered, 1000u);
    o.engine = Engine::kReferenceTrace;
    EXPECT_THROW(render(scene, o), Error);
}

// --- encoding -----------------------------------------------------------------------------------

TEST(Encoding, LinearStoresValuesAndBackgroundAsTheyAre) {
    Scene scene;
    add_mesh(scene, rectangle(0.5f, 2, 0, add_material(scene, unlit({0.5f, 0.25f, 2, 1}))));
    add_orthographic(scene);
    for (const Engine engine : kEngines) {
        RenderOptions o = small(32, 32);
        o.engine = engine;
        o.background = Vec4{0.2f, 0.4f, 1, 1};
        o.encoding = Encoding::kLinear;
        const RenderResult r = render(scene, o);
        const auto* edge = r.color.data<std::uint8_t>();
        const auto* middle = edge + 4 * (32 * 16 + 16);
        EXPECT_EQ(edge[0], 51);
        EXPECT_EQ(edge[1], 102);
        EXPECT_EQ(edge[2], 255);
        EXPECT_EQ(middle[0], 128);
        EXPECT_EQ(middle[1], 64);
        EXPECT_EQ(middle[2], 255);
        EXPECT_EQ(middle[3], 255);
        o.encoding = Encoding::kSrgb;
        const RenderResult s = render(scene, o);
        EXPECT_EQ(s.color.data<std::uint8_t>()[0], 51) << "the background is what the plane stores, either way";
        EXPECT_EQ(s.color.data<std::uint8_t>()[4 * (32 * 16 + 16)], 188);
        EXPECT_TRUE(same_bytes(r.linear, s.linear));
    }
    RenderOptions o = small();
    o.encoding = static_cast<Encoding>(7);
    EXPECT_THROW(render(scene, o), Error);
}

TEST(Encoding, LinearHasTheSameBitsOnEveryInstructionSet) {
    const Scene scene = mixed_scene();
    RenderOptions o = small(97, 61, 2);
    o.encoding = Encoding::kLinear;
    o.engine = Engine::kReferenceRaster;
    const RenderResult reference = render(scene, o);
    o.engine = Engine::kRaster;
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
        if (!isa_supported(isa)) continue;
        o.isa = isa;
        EXPECT_TRUE(same_bytes(render(scene, o).color, reference.color)) << name(isa);
    }
}

}  // namespace
}  // namespace tessera
