// Mirrored light: series of mirrors and their limits in the statistics, and the white furnace, in which nothing is
// brighter than what surrounds it.
#include <gtest/gtest.h>

#include "render/traced_scenes.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using namespace test;

constexpr std::uint64_t kPixels = 32 * 32;

// Two mirrors that face each other and glow; the camera looks through the back of the nearer one. `pane`: far away
// there is something that lets light through, so that the general paths are taken.
Scene mirror_box(float kr, bool with_pane = false) {
    Scene scene;
    Material m = lambert({0, 0, 0});
    m.mirror = {kr, kr, kr};
    m.emissive = {1, 1, 1};
    m.double_sided = false;
    const int mirror = add_material(scene, m);
    place(scene, rectangle(2, 2, 0, mirror), {});
    place(scene, rectangle(2, 2, 0, mirror), {0, 0, 5}, quaternion({0, 1, 0}, 3.14159265f));
    if (with_pane) place(scene, rectangle(1, 1, 0, add_material(scene, pane())), {50, 0, 0});
    add_orthographic(scene);
    return scene;
}

TEST(Mirrors, FacingMirrorsAreASeriesThatEndsAtTheDepth) {
    for (const bool with_pane : {false, true}) {
        const Scene scene = mirror_box(0.5f, with_pane);
        for (const Engine engine : kTracers)
            for (const int depth : {0, 1, 2, 5, 64}) {
                RenderOptions o = traced(engine, 32, 32);
                o.max_depth = depth;
                const RenderResult r = render(scene, o);
                // 1 + 1/2 + ... : exact in binary, as long as it does not vanish.
                EXPECT_EQ(linear_at(r, 9, 20).x, static_cast<float>(2 - std::exp2(-depth)))
                    << name(engine) << " " << depth;
                if (engine == Engine::kReferenceTrace) continue;
                EXPECT_EQ(r.stats.mirrored_rays, kPixels * static_cast<std::uint64_t>(depth)) << name(engine);
                EXPECT_EQ(r.stats.ended_by_depth, depth > 0 ? kPixels : 0u) << name(engine) << " " << depth;
                EXPECT_EQ(r.stats.ended_by_contribution, 0u);
                EXPECT_EQ(r.stats.refracted_rays + r.stats.straight_rays, 0u);
            }
    }
}

TEST(Mirrors, LightThatCountsForTooLittleIsNotFollowed) {
    for (const bool with_pane : {false, true}) {
        const Scene scene = mirror_box(0.5f, with_pane);
        for (const Engine engine : kTracers) {
            RenderOptions o = traced(engine, 32, 32);
            o.max_depth = 64;
            o.min_contribution = 0.2f;  // 1/2 and 1/4 are followed
            const RenderResult r = render(scene, o);
            EXPECT_EQ(linear_at(r, 9, 20).x, 1.75f) << name(engine);
            if (engine == Engine::kReferenceTrace) continue;
            EXPECT_EQ(r.stats.mirrored_rays, 2 * kPixels) << name(engine);
            EXPECT_EQ(r.stats.ended_by_contribution, kPixels) << name(engine);
            EXPECT_EQ(r.stats.ended_by_depth, 0u) << name(engine);
        }
    }
}

// Bodies of one glass within each other are one: light passes between them, and ends where it leaves the outer one.
TEST(Mirrors, OnlyRaysThatEndAreCountedAsEnded) {
    for (const bool nested : {false, true}) {
        Scene scene;
        const int m = add_material(scene, glass(1.5f));
        place(scene, box({2, 2, 1}, m), {});
        if (nested) place(scene, box({1.5f, 1.5f, 0.5f}, m), {});
        add_orthographic(scene);
        for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
            RenderOptions o = traced(engine, 32, 32);
            o.max_depth = 1;
            const RenderStats stats = render(scene, o).stats;
            EXPECT_EQ(stats.mirrored_rays, kPixels) << name(engine);
            EXPECT_EQ(stats.refracted_rays, (nested ? 3 : 1) * kPixels) << name(engine);
            // At the back of the outer body: what would be mirrored and what would leave.
            EXPECT_EQ(stats.ended_by_depth, 2 * kPixels) << name(engine) << (nested ? ", nested" : "");
        }
    }
}

TEST(Mirrors, ShowWhatIsInFrontOfThem) {
    // A mirror at 45 degrees: what is far on the right appears ahead, left and right exchanged.
    for (const Engine engine : kTracers) {
        Scene scene;
        Material m = lambert({0, 0, 0});
        m.mirror = {0.25f, 0.5f, 1};
        place(scene, rectangle(2, 2, 0, add_material(scene, m)), {}, quaternion({0, 1, 0}, 0.78539816f));
        const auto card = [&](float z, Vec4 color) {  // faces -X, z is what the camera sees as x
            place(scene, rectangle(0.5f, 2, 0, add_material(scene, unlit(color))), {4, 0, z}, toward({1, 0, 0}));
        };
        card(0.5f, {1, 1, 1, 1});
        card(-0.5f, {0.5f, 0.5f, 0.5f, 1});
        add_orthographic(scene);
        const RenderResult r = render(scene, traced(engine, 32, 32));
        // The ray at x meets the mirror at z = -x.
        EXPECT_NEAR(linear_at(r, 4, 16).x, 0.25f, 1e-6f) << name(engine);
        EXPECT_NEAR(linear_at(r, 4, 16).y, 0.5f, 1e-6f);
        EXPECT_NEAR(linear_at(r, 4, 16).z, 1.0f, 1e-6f);
        EXPECT_NEAR(linear_at(r, 27, 16).z, 0.5f, 1e-6f) << name(engine);
    }
}

// --- white furnace
// --------------------------------------------------------------------------

RenderOptions furnace(Engine engine) {
    RenderOptions o = traced(engine, 48, 48);
    o.ambient = 1.0f;
    o.view = look({0, 0, 2.2f}, {0, 0, 0});
    return o;
}

// Least and most of all channels where the body is, before a background as bright as the furnace: light that only went
// through surfaces comes from there.
struct Range {
    float least = 1e9f, most = 0;
    int pixels = 0;
};
Range in_furnace(const Material& m, const RenderOptions& o) {
    Scene scene;
    place(scene, sphere(40, add_material(scene, m)), {});
    const RenderResult r = render(scene, o);
    Range range;
    for (int y = 0; y < o.height; ++y)
        for (int x = 0; x < o.width; ++x) {
            const Vec4 c = linear_at(r, x, y);
            if (c.w == 0) continue;
            ++range.pixels;
            for (const float v : {c.x, c.y, c.z}) {
                range.least = std::min(range.least, v + (1 - c.w));
                range.most = std::max(range.most, v + (1 - c.w));
            }
        }
    EXPECT_GT(range.pixels, 500);
    return range;
}

TEST(Furnace, WhiteLambertMirrorsAndSmoothMetalAreNotToBeSeen) {
    Material matt = lambert({1, 1, 1}), mirror = lambert({0, 0, 0}), metal;
    matt.ambient = {1, 1, 1};
    mirror.mirror = {1, 1, 1};
    metal.roughness = 0;
    for (const Engine engine : kTracers)
        for (const Material& m : {matt, mirror, metal}) {
            const Range range = in_furnace(m, furnace(engine));
            EXPECT_GE(range.least, 0.995f) << name(engine);
            EXPECT_LE(range.most, 1.0001f) << name(engine);
        }
}

TEST(Furnace, NorIsClearGlass) {
    for (const Engine engine : kTracers)
        for (const Material& m : {glass(1.5f), glass(1.33f), pane()}) {
            RenderOptions o = furnace(engine);
            o.max_depth = 32;
            o.min_contribution = 1e-3f;
            const Range range = in_furnace(m, o);
            // What totally reflected light loses at the depth, grazing, is little.
            EXPECT_GE(range.least, 0.98f) << name(engine) << " " << m.ior;
            EXPECT_LE(range.most, 1.0002f) << name(engine) << " " << m.ior;
        }
}

TEST(Furnace, NoMaterialGainsLight) {
    for (const Engine engine : {Engine::kTrace, Engine::kReferenceTrace})
        for (const float metallic : {0.0f, 0.5f, 1.0f})
            for (const float roughness : {0.0f, 0.1f, 0.2f, 0.3f, 1.0f})
                for (const float transmission : {0.0f, 0.5f, 1.0f})
                    for (const float thickness : {0.0f, 1.0f}) {
                        if (transmission == 0 && thickness > 0) continue;
                        Material m = glass(1.5f);
                        m.metallic = metallic, m.roughness = roughness;
                        m.transmission = transmission, m.volume.thickness = thickness;
                        const Range range = in_furnace(m, furnace(engine));
                        EXPECT_LE(range.most, 1.001f)
                            << name(engine) << ", metallic " << metallic << ", roughness " << roughness
                            << ", transmission " << transmission << ", thickness " << thickness;
                    }
}

// Of MTL's glass: as much mirrored as enters, if kr and the transmission are taken by themselves.
TEST(Furnace, NorDoesTheTextbooksGlass) {
    for (const Engine engine : {Engine::kTrace, Engine::kReferenceTrace})
        for (const float transmission : {0.5f, 1.0f})
            for (const float kr : {0.0f, 1.0f}) {
                Material m = glass(1.5f);
                m.model = ShadingModel::kBlinnPhong;
                m.ambient = m.diffuse = {0, 0, 0};
                m.transmission = transmission;
                m.mirror = {kr, kr, kr};
                RenderOptions o = furnace(engine);
                o.max_depth = 16;
                EXPECT_LE(in_furnace(m, o).most, 1.001f) << name(engine) << ", " << transmission << ", " << kr;
            }
}

}  // namespace
}  // namespace tessera
