// Traced light at the limits: cameras of hosts, more layers than rays pass, numbers that no model should have.
#include <gtest/gtest.h>

#include "render/traced_pictures.h"

#include <limits>
#include <random>

namespace tessera {
namespace {

using namespace test;

View host_view() {
    const wl::Camera camera = wl::sphere_camera(96, 64);
    View view;
    view.clip_from_world.emplace(), view.camera_from_world.emplace();
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) {
            (*view.clip_from_world)(r, c) = camera.mvp[c][r];
            (*view.camera_from_world)(r, c) = camera.view[c][r];
        }
    return view;
}

TEST(TracedLimits, ShiftedLensesSeeTheSameByRays) {
    const Scene scene = make_scene(wl::sphere(10));
    RenderOptions o = quick(Engine::kRaster, 96, 64);
    o.view = host_view();
    Mat4& clip = *o.view.clip_from_world;
    for (int c = 0; c < 4; ++c) clip(0, c) += 0.1f * clip(3, c), clip(1, c) -= 0.2f * clip(3, c);
    const RenderResult raster = render(scene, o);
    EXPECT_GT(raster.stats.pixels_covered, 1000u);
    o.engine = Engine::kTrace;
    EXPECT_LT(differing_pixels(raster.primitive, render(scene, o).primitive), 6u);
    expect_the_references_picture("shifted lens", scene, o);
}

// As the ray caster they refuse them; or they draw what the rasterizer does.
TEST(TracedLimits, TurnedPicturesAreRefusedOrRight) {
    const Scene scene = make_scene(wl::sphere(10));
    RenderOptions o = quick(Engine::kRaster, 96, 64);
    o.view = host_view();
    for (int c = 0; c < 4; ++c) (*o.view.clip_from_world)(0, c) += 0.1f * (*o.view.clip_from_world)(1, c);
    const RenderResult raster = render(scene, o);
    o.engine = Engine::kTrace;
    try {
        EXPECT_LT(differing_pixels(raster.primitive, render(scene, o).primitive), 6u);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::kUsage);
    }
}

TEST(TracedLimits, LightPassesManyVeilsInAMirror) {
    // At 45 degrees: what is beside the mirror, behind 40 and 80 veils of 3 %; rays pass 64 of them.
    for (const int count : {40, 80}) {
        Scene scene;
        Material mirror = lambert({0, 0, 0}), thin;
        mirror.mirror = {1, 1, 1};
        place(scene, rectangle(2, 2, 0, add_material(scene, mirror)), {}, quaternion({0, 1, 0}, 0.78539816f));
        thin.base_color = {0, 0, 0, 0.03f};
        thin.metallic = 1;
        thin.roughness = 1;
        thin.alpha_mode = AlphaMode::kBlend;
        thin.double_sided = true;
        const int veil = add_material(scene, thin);
        for (int i = 0; i < count; ++i)
            place(scene, rectangle(3, 3, 0, veil), {2 + 0.05f * static_cast<float>(i), 0, 0}, toward({1, 0, 0}));
        place(scene, rectangle(5, 5, 0, add_material(scene, unlit({1, 1, 1, 1}))), {8, 0, 0}, toward({1, 0, 0}));
        add_orthographic(scene);
        for (const Engine engine : kTracers) {
            const RenderResult r = render(scene, traced(engine, 8, 8));
            const double want = count < 64 ? std::pow(0.97, count) : 0;
            EXPECT_NEAR(linear_at(r, 4, 4).x, want, 1e-4) << name(engine) << ", " << count << " veils";
        }
    }
}

// Triangles without area, with normals of no length or of the other side, and corners as far away as `far`, of every
// kind of material; a lamp at a corner.
Scene odd_scene(std::uint32_t seed, float far) {
    std::mt19937 engine(seed);
    const auto in = [&](float low, float high) {
        return low + (high - low) * static_cast<float>(engine() >> 8) / 16777216.0f;
    };
    const float odd[] = {0, 1e-30f, -1e-12f, far, -far};
    Scene scene;
    Material mirror = lambert({0.3f, 0.3f, 0.3f}), veil;
    mirror.mirror = {0.5f, 0.5f, 0.5f};
    veil.base_color.w = 0.5f;
    veil.alpha_mode = AlphaMode::kBlend;
    for (const Material& m :
         {lambert({0.7f, 0.7f, 0.7f}), mirror, glass(1.5f, {0.9f, 1, 0.9f}), pane({1, 0.8f, 0.8f}), veil}) {
        Primitive p;
        for (int t = 0; t < 40; ++t) {
            const Vec3 middle{in(-1, 1), in(-1, 1), in(-1, 1)};
            for (int k = 0; k < 3; ++k) {
                Vec3 v = middle + Vec3{in(-0.3f, 0.3f), in(-0.3f, 0.3f), in(-0.3f, 0.3f)};
                if (t % 8 == 1 && k > 0) v = p.positions.back();
                if (t % 8 == 2) (k == 0 ? v.x : v.z) = odd[engine() % std::size(odd)];
                p.positions.push_back(v);
                const Vec3 n{in(-1, 1), in(-1, 1), in(-1, 1)};
                p.normals.push_back(t % 8 == 3 ? Vec3{0, 0, 0} : normalize(n));
            }
        }
        p.material = add_material(scene, m);
        place(scene, p, {});
    }
    add_sun(scene, {0.3f, 1, 0.6f});
    add_light(scene, Light{}, scene.meshes[0].primitives[0].positions[0]);
    add_orthographic(scene);  // the near plane of a view would depend on the bounds
    scene.cameras[0].type = Camera::Type::kPerspective;
    scene.nodes.back().translation = {0, 0, 3.5f};
    return scene;
}

void expect_sane(const RenderResult& r) {
    for (int i = 0; i < r.linear.width() * r.linear.height(); ++i) {
        const float* p = r.linear.data<float>() + 4 * i;
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(p[c] >= 0 && p[c] < std::numeric_limits<float>::infinity()) << p[c];
        ASSERT_TRUE(p[3] >= 0 && p[3] <= 1) << p[3];
    }
}

TEST(TracedLimits, OddTrianglesAreDrawnAsTheReferenceDoes) {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        const Scene scene = odd_scene(seed, 20);
        RenderOptions o = quick(Engine::kTrace, 64, 48);
        o.exposure_ev = 0.0f;
        expect_the_references_picture("odd triangles " + std::to_string(seed), scene, o);
        const RenderResult r = render(scene, o);
        expect_sane(r);
        EXPECT_GT(r.stats.pixels_covered, 700u);
        EXPECT_GT(r.stats.mirrored_rays + r.stats.refracted_rays, 300u);
    }
}

// Between panes every ray becomes two, and nothing ends them here but the limit.
TEST(TracedLimits, RaysWithoutEndAreRefused) {
    Scene scene;
    const int material = add_material(scene, pane());
    for (int i = 0; i < 24; ++i) place(scene, rectangle(4, 4, 0, material), {0, 0, -0.25f * static_cast<float>(i)});
    RenderOptions o = quick(Engine::kTrace, 24, 24);
    o.max_depth = 64;
    o.min_contribution = 0;
    try {
        render(scene, o);
        FAIL() << "drawn";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::kLimit);
        EXPECT_NE(std::string(e.what()).find("max_depth"), std::string::npos) << e.what();
    }
    o.max_depth = 6;
    EXPECT_GT(render(scene, o).stats.refracted_rays, 1000u);
}

TEST(TracedLimits, HugeNumbersGiveNumbers) {
    for (const float far : {1e4f, 1e9f, 1e15f, 1e20f, 1e30f, 3e38f})
        for (std::uint32_t seed = 1; seed <= 4; ++seed)
            for (const Engine engine : kTracers) {
                RenderOptions o = quick(engine, 64, 48);
                o.exposure_ev = 0.0f;
                expect_sane(render(odd_scene(seed, far), o));
                if (HasFatalFailure()) FAIL() << name(engine) << ", " << far << ", seed " << seed;
            }
}

}  // namespace
}  // namespace tessera
