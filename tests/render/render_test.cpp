// render() as a function: options, limits, cancelling, statistics, views, twins, shadows, equal bits.
#include <gtest/gtest.h>

#include "bench/workloads.h"
#include "load/test_files.h"
#include "reference/workload_scene.h"
#include "render/scenes.h"

#include <xmmintrin.h>

#include <cstring>
#include <limits>

namespace tessera {
namespace {

using namespace test;

Scene one_rectangle() {
    Scene scene;
    add_mesh(scene, rectangle(1, 1, 0, add_material(scene, lambert({0.5f, 0.5f, 0.5f}))));
    return scene;
}

ErrorCode refusal(const Scene& scene, const RenderOptions& options) {
    try {
        render(scene, options);
    } catch (const Error& e) {
        return e.code();
    }
    ADD_FAILURE() << "accepted";
    return ErrorCode::kInternal;
}

TEST(Render, OptionsThatMakeNoSenseAreRefused) {
    const Scene scene = one_rectangle();
    const auto with = [](auto change) {
        RenderOptions o = small(8, 8);
        change(o);
        return o;
    };
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.width = 0; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.height = 20000; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.samples = 0; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.samples = 257; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.threads = -1; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.view.camera = 0; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.view.yfov = 4.0f; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.view.up = {0, 0, 0}; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.background = Vec4{2, 0, 0, 1}; })), ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.exposure_ev = std::numeric_limits<float>::quiet_NaN(); })),
              ErrorCode::kUsage);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.max_bytes = 100; })), ErrorCode::kLimit);
    EXPECT_EQ(refusal(scene, with([](RenderOptions& o) { o.cancel = [] { return true; }; })), ErrorCode::kCancelled);
    Scene broken = scene;
    broken.nodes[0].mesh = 7;
    EXPECT_EQ(refusal(broken, small(8, 8)), ErrorCode::kUsage);
}

TEST(Render, TransparentFragmentsStayWithinTheMemoryLimit) {
    Scene scene;
    Material glass = unlit({1, 1, 1, 0.5f});
    glass.alpha_mode = AlphaMode::kBlend;
    const int m = add_material(scene, glass);
    for (int i = 0; i < 20; ++i) add_mesh(scene, rectangle(1, 1, static_cast<float>(i) * 0.1f, m));
    add_orthographic(scene);
    RenderOptions o = small(64, 64);
    o.max_bytes = 64 * 64 * 100;
    EXPECT_EQ(refusal(scene, o), ErrorCode::kLimit);
    o.max_bytes = 64 * 64 * 1000;
    EXPECT_NO_THROW(render(scene, o));
}

TEST(Render, AnEmptySceneIsAllBackground) {
    const RenderResult r = render(Scene{}, small(8, 8));
    EXPECT_EQ(r.stats.pixels_covered, 0u);
    for (const std::byte b : r.color.bytes()) EXPECT_EQ(b, std::byte{0});
}

TEST(Render, ProgressRisesToOne) {
    RenderOptions o = small(64, 64, 4);
    double last = 0;
    bool rising = true;
    o.progress = [&](double p) {
        rising = rising && p >= last;
        last = p;
    };
    render(one_rectangle(), o);
    EXPECT_TRUE(rising);
    EXPECT_GT(last, 0.9);
    EXPECT_LE(last, 1.0);
}

TEST(Render, FewLargeTrianglesAreCancelledBetweenThem) {
    // One mesh of few triangles, each of them all of the picture: the work between two looks at cancel()
    // is measured in samples, not in triangles.
    Scene scene;
    Primitive layers = rectangle(2, 2, 0, add_material(scene, unlit({1, 1, 1, 1})));
    const std::vector<std::uint32_t> once = layers.indices;
    for (int i = 1; i < 40; ++i) layers.indices.insert(layers.indices.end(), once.begin(), once.end());
    add_mesh(scene, std::move(layers));
    add_orthographic(scene);
    RenderOptions o = small(512, 512);
    o.engine = Engine::kReferenceRaster;
    double reached = 0;
    o.progress = [&](double p) { reached = p; };
    o.cancel = [&] { return reached > 0.1; };  // visibility is the first half of the run
    EXPECT_EQ(refusal(scene, o), ErrorCode::kCancelled);
    EXPECT_LT(reached, 0.3);
}

TEST(Render, RAS6_CullingIsCounted) {
    const Scene sphere = make_scene(wl::sphere(40));
    RenderOptions o = small(64, 64);
    o.view = look({0, 0, 4}, {0, 0, 0});
    const RenderStats seen = render(sphere, o).stats;
    EXPECT_EQ(seen.triangles, 6400u);
    // From a distance of four radii a little less than half of a sphere is seen, (1 - 1/4) / 2 of it;
    // the two fans at the poles have 80 triangles without area each.
    EXPECT_EQ(seen.culled_degenerate + seen.culled_backface + seen.culled_frustum < seen.triangles, true);
    EXPECT_GE(seen.culled_degenerate, 160u);
    EXPECT_NEAR(static_cast<double>(seen.culled_backface), 6400 * 0.625, 6400 * 0.04);
    EXPECT_EQ(seen.culled_frustum, 0u);

    o.view = look({0, 0, 4}, {0, 0, 8});  // looking away: the object's box goes at once
    const RenderStats away = render(sphere, o).stats;
    EXPECT_EQ(away.culled_frustum, 6400u);
    EXPECT_EQ(away.pixels_covered, 0u);

    o.view = look({0, 0, 0}, {1, 0, 0});  // inside: some in view, some beside it, all back faces
    const RenderStats inside = render(sphere, o).stats;
    EXPECT_GT(inside.culled_frustum, 2000u);
    EXPECT_GT(inside.culled_backface, 200u);
    EXPECT_EQ(inside.pixels_covered, 0u);
}

TEST(Render, GEO6_TheFramedViewShowsEverythingAndFillsThePicture) {
    Scene scene = make_scene(wl::sphere(30));
    for (const Vec3 scale : {Vec3{1, 1, 1}, Vec3{1e-4f, 1e-4f, 1e-4f}, Vec3{3000, 100, 5}, Vec3{0.1f, 8, 0.1f}})
        for (const Vec3 offset : {Vec3{0, 0, 0}, Vec3{20, -7, 3}}) {
            scene.nodes[0].scale = scale;
            scene.nodes[0].translation = offset;
            for (const Vec3 up : {Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
                RenderOptions o = small(120, 80, 4);
                o.view.up = up;
                const RenderResult r = render(scene, o);
                int left = 120, right = -1, top = 80, bottom = -1;
                for (int y = 0; y < 80; ++y)
                    for (int x = 0; x < 120; ++x)
                        if (linear_at(r, x, y).w > 0) {
                            left = std::min(left, x), right = std::max(right, x);
                            top = std::min(top, y), bottom = std::max(bottom, y);
                        }
                // Inside the picture, with a margin; and one direction is used to nearly nine tenths.
                EXPECT_GT(left, 1);
                EXPECT_LT(right, 118);
                EXPECT_GT(top, 1);
                EXPECT_LT(bottom, 78);
                EXPECT_TRUE(right - left > 0.8 * 120 || bottom - top > 0.8 * 80) << right - left << " " << bottom - top;
            }
        }
}

TEST(Render, CamerasOfTheSceneAreChosenByIndex) {
    Scene scene = one_rectangle();
    add_orthographic(scene);  // camera 0
    add_orthographic(scene);  // camera 1, moved aside
    scene.nodes.back().translation = {1, 0, 10};
    RenderOptions o = small(16, 16);
    EXPECT_EQ(render(scene, o).stats.pixels_covered, 256u);
    o.view.camera = 1;
    EXPECT_EQ(render(scene, o).stats.pixels_covered, 128u);
    o.view.camera = 2;
    EXPECT_EQ(refusal(scene, o), ErrorCode::kUsage);
}

TEST(Render, RAY3_HardShadowsFallWhereTheLightIsBlocked) {
    // A wall at z = 0 and a small plate at z = 1, lit along -Z by a lamp at infinity: the plate hides
    // its own shadow, but a slanted sun throws it to the side.
    Scene scene;
    const int white = add_material(scene, lambert({1, 1, 1}));
    add_mesh(scene, rectangle(4, 4, 0, white));
    add_mesh(scene, rectangle(0.25f, 0.25f, 1, white));
    add_orthographic(scene);
    Light sun;
    sun.type = LightType::kDirectional;
    // Turned by 26.565 degrees about Y: the shadow of a plate at height 1 moves by tan = 0.5 to -X.
    const float half = 0.5f * std::atan(0.5f);
    add_light(scene, sun, {0, 0, 5}, {0, std::sin(half), 0, std::cos(half)});
    RenderOptions o = small(64, 64);
    o.engine = Engine::kReferenceTrace;
    o.ambient = 0.0f;
    const RenderResult shadowed = render(scene, o);
    o.shadows = Shadows::kNone;
    const RenderResult open = render(scene, o);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const double wx = (x + 0.5) / 32 - 1, wy = 1 - (y + 0.5) / 32;
            const bool on_plate = std::fabs(wx) < 0.25 && std::fabs(wy) < 0.25;
            const bool in_shadow = !on_plate && std::fabs(wx + 0.5) < 0.25 && std::fabs(wy) < 0.25;
            EXPECT_EQ(linear_at(shadowed, x, y).x, in_shadow ? 0.0f : linear_at(open, x, y).x) << x << " " << y;
        }
}

TEST(Render, RAY3_ConvexBodiesDoNotShadowTheirLitSide) {
    for (const float scale : {1e-3f, 1.0f, 1e4f}) {
        Scene scene = make_scene(wl::sphere(60));
        scene.nodes[0].scale = {scale, scale, scale};
        scene.materials.push_back(lambert({1, 1, 1}));
        scene.meshes[0].primitives[0].material = 0;
        Light lamp;
        lamp.intensity = scale * scale;
        add_light(scene, lamp, {2 * scale, 3 * scale, 4 * scale});
        RenderOptions o = small(160, 120);
        o.ambient = 0.0f;
        o.engine = Engine::kReferenceTrace;
        const RenderResult shadowed = render(scene, o);
        o.shadows = Shadows::kNone;
        const RenderResult open = render(scene, o);
        int darkened = 0, lit = 0;
        for (int y = 0; y < 120; ++y)
            for (int x = 0; x < 160; ++x) {
                // Grazing light on flat facets with smooth normals is where facets do shadow each other.
                if (linear_at(open, x, y).x < 0.08f * 0.05f) continue;
                ++lit;
                darkened += linear_at(shadowed, x, y).x != linear_at(open, x, y).x;
            }
        EXPECT_GT(lit, 1500);
        EXPECT_EQ(darkened, 0) << scale;
    }
}

TEST(Render, BEY1_TheCallersFloatingPointModesChangeNothingAndAreKept) {
    const Scene scene = make_scene(wl::sphere(20));
    const RenderResult plain = render(scene, small(64, 64));
    const unsigned saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040u | 0x6000u);  // flush to zero, denormals are zero, round towards zero
    const unsigned changed = _mm_getcsr();
    const RenderResult odd = render(scene, small(64, 64));
    const unsigned after = _mm_getcsr();
    _mm_setcsr(saved);
    EXPECT_EQ(after & 0xe040u, changed & 0xe040u);
    EXPECT_TRUE(same_bytes(plain.linear, odd.linear));
}

TEST(Render, BEY1_EnginesGiveEqualColoursWhereTheySeeTheSameTriangle) {
    Scene scene = make_scene(wl::terrain(40));
    RenderOptions o = small(160, 90);
    o.view = look({0, 0.9f, 1.3f}, {0, -0.15f, 0});
    o.shadows = Shadows::kNone;
    o.want_primitive = true;
    const RenderResult a = render(scene, o);
    o.engine = Engine::kReferenceTrace;
    const RenderResult b = render(scene, o);
    int same = 0;
    for (std::size_t i = 0; i < 160 * 90; ++i) {
        if (a.primitive.data<std::uint32_t>()[i] != b.primitive.data<std::uint32_t>()[i]) continue;
        ++same;
        EXPECT_EQ(std::memcmp(a.linear.data<float>() + 4 * i, b.linear.data<float>() + 4 * i, 16), 0);
    }
    EXPECT_GT(same, 14300);
}

TEST(Render, BEY1_RepetitionAndThreadsGiveTheSameBits) {
    const Scene scene = make_scene(wl::sphere(20));
    const RenderResult first = render(scene, small(48, 48, 3));
    for (const int threads : {1, 2, 3, 8}) {
        RenderOptions o = small(48, 48, 3);
        o.threads = threads;
        EXPECT_TRUE(same_bytes(first.linear, render(scene, o).linear));
    }
}

TEST(Render, IndexedAndSpreadOutMeshesAreTwins) {
    Scene indexed = make_scene(wl::sphere(12)), spread = indexed;
    Primitive& p = spread.meshes[0].primitives[0];
    const Primitive original = p;
    p.positions.clear(), p.normals.clear(), p.indices.clear();
    for (const std::uint32_t i : original.indices) {
        p.positions.push_back(original.positions[i]);
        p.normals.push_back(original.normals[i]);
    }
    EXPECT_TRUE(same_bytes(render(indexed, small(64, 64)).linear, render(spread, small(64, 64)).linear));
}

TEST(Render, FilesOfOneModelInSeveralFormsAreTwins) {
    const std::vector<std::vector<std::string>> twins = {
        {"Box/glTF/Box.gltf", "Box/glTF-Binary/Box.glb", "Box/glTF-Embedded/Box.gltf"},
        {"Triangle/glTF/Triangle.gltf", "Triangle/glTF-Embedded/Triangle.gltf"},
        {"AnimatedMorphCube/glTF/AnimatedMorphCube.gltf", "AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb"},
        {"BoxAnimated/glTF/BoxAnimated.gltf", "BoxAnimated/glTF-Binary/BoxAnimated.glb"},
        {"TextureSettingsTest/glTF/TextureSettingsTest.gltf", "TextureSettingsTest/glTF-Binary/TextureSettingsTest.glb",
         "TextureSettingsTest/glTF-Embedded/TextureSettingsTest.gltf"},
        {"Cameras/glTF/Cameras.gltf", "Cameras/glTF-Embedded/Cameras.gltf"},
    };
    if (all_gltf_models().empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    for (const auto& files : twins) {
        const RenderResult first = render(load_scene(gltf_model(files[0]).string()), small(96, 72, 2));
        EXPECT_GT(first.stats.pixels_covered, 100u);
        for (const std::string& file : files)
            EXPECT_TRUE(
                same_bytes(first.linear, render(load_scene(gltf_model(file).string()), small(96, 72, 2)).linear))
                << file;
    }
}

}  // namespace
}  // namespace tessera
