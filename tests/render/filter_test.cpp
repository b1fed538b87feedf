// Pictures under the filters that are wider than a pixel: analytic values, borders, alpha, engines,
// statistics and limits.
#include <gtest/gtest.h>

#include "image/reconstruction_filter.h"
#include "render/scenes.h"

#include <algorithm>

namespace tessera {
namespace {

using namespace test;

constexpr PixelFilter kWide[] = {PixelFilter::kTent, PixelFilter::kGaussian, PixelFilter::kMitchell};
constexpr Engine kEngines[] = {Engine::kRaster, Engine::kReferenceRaster, Engine::kReferenceTrace};

RenderOptions filtered(PixelFilter filter, int width, int height, int samples) {
    RenderOptions o = small(width, height, samples);
    o.filter = filter;
    return o;
}

// A wall that ends at x = `edge` pixels of a picture 16 pixels wide.
Scene half_plane(double edge, const Material& material) {
    Scene scene;
    Primitive p = rectangle(2, 2, 0, add_material(scene, material));
    p.positions[1].x = p.positions[2].x = static_cast<float>(edge / 8 - 1);
    add_mesh(scene, p);
    add_orthographic(scene);
    return scene;
}

TEST(Filter, RAS7_AnEdgeBecomesTheFiltersIntegral) {
    const int samples = 256;
    for (const PixelFilter filter : kWide)
        for (const double edge : {8.0, 8.3, 8.5, 8.91}) {
            const RenderResult r = render(half_plane(edge, unlit({1, 1, 1, 1})), filtered(filter, 16, 16, samples));
            double whole = 0;
            const double step = 1.0 / 4096, radius = filter_radius(filter);
            for (double t = -radius + step / 2; t < radius; t += step) whole += step * filter_value(filter, t);
            for (int x = 3; x < 13; ++x) {
                double covered = 0;  // by the midpoint rule
                for (double t = -radius + step / 2; t < radius; t += step)
                    if (x + 0.5 + t < edge) covered += step * filter_value(filter, t);
                const double expected = std::min(1.0, std::max(0.0, covered / whole));
                EXPECT_NEAR(linear_at(r, x, 8).w, expected, 1.2 / samples) << edge << " " << x;
            }
        }
}

// One sample makes the filter a convolution of the unfiltered picture, which can be done by hand.
TEST(Filter, RAS7_OneSampleIsAConvolution) {
    const Scene scene = scene_file("spheres.gltf");
    const int w = 40, h = 30;
    const RenderResult sharp = render(scene, filtered(PixelFilter::kBox, w, h, 1));
    for (const PixelFilter filter : kWide) {
        const RenderResult soft = render(scene, filtered(filter, w, h, 1));
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                double sum[4] = {}, weights = 0;
                for (int v = 0; v < h; ++v)
                    for (int u = 0; u < w; ++u) {
                        const double weight = filter_value(filter, u - x) * filter_value(filter, v - y);
                        const Vec4 c = linear_at(sharp, u, v);
                        const float values[4] = {c.x, c.y, c.z, c.w};
                        for (int k = 0; k < 4; ++k) sum[k] += weight * static_cast<double>(values[k]);
                        weights += weight;
                    }
                const double alpha = sum[3] / weights;
                const double kept = alpha <= 1e-7 ? 0 : alpha > 1 ? 1 / alpha : 1;  // alpha back to 0 .. 1
                const Vec4 c = linear_at(soft, x, y);
                const float values[4] = {c.x, c.y, c.z, c.w};
                for (int k = 0; k < 4; ++k) ASSERT_NEAR(values[k], kept * sum[k] / weights, 2e-5) << x << " " << y;
            }
    }
}

TEST(Filter, RAS7_WhatIsFlatStaysFlatToTheBorder) {
    Scene scene;
    add_mesh(scene, rectangle(2, 2, 0, add_material(scene, unlit({0.25f, 0.5f, 0.75f, 1}))));
    add_orthographic(scene);
    for (const PixelFilter filter : kWide)
        for (const int samples : {1, 3, 4, 16})
            for (const int size : {1, 2, 3, 9}) {
                const RenderResult r = render(scene, filtered(filter, size, size, samples));
                for (int y = 0; y < size; ++y)
                    for (int x = 0; x < size; ++x) {
                        const Vec4 c = linear_at(r, x, y);
                        ASSERT_NEAR(c.x, 0.25f, 1e-6f);
                        ASSERT_NEAR(c.y, 0.5f, 1e-6f);
                        ASSERT_NEAR(c.z, 0.75f, 1e-6f);
                        ASSERT_NEAR(c.w, 1.0f, 1e-6f);
                    }
                EXPECT_EQ(r.stats.pixels_covered, static_cast<std::uint64_t>(size * size));
            }
}

TEST(Filter, RAS7_NegativeLobesLeaveAlphaWithinItsRangeAndTheColourItsOwn) {
    const RenderResult r =
        render(half_plane(8.0, unlit({0.5f, 0.25f, 1, 1})), filtered(PixelFilter::kMitchell, 16, 16, 64));
    for (int x = 0; x < 16; ++x) {
        const Vec4 c = linear_at(r, x, 8);
        EXPECT_GE(c.w, 0.0f);
        EXPECT_LE(c.w, 1.0f);
        EXPECT_NEAR(c.x, 0.5f * c.w, 1e-6f) << x;
        EXPECT_NEAR(c.y, 0.25f * c.w, 1e-6f) << x;
        EXPECT_NEAR(c.z, c.w, 1e-6f) << x;
    }
    EXPECT_EQ(linear_at(r, 9, 8), (Vec4{0, 0, 0, 0}));  // would be below 0
    EXPECT_EQ(linear_at(r, 6, 8).w, 1.0f);              // would be above 1
}

// A very bright surface beside a dark one: its halo is negative in the linear plane, and 0 for the film.
TEST(Filter, RAS7_NegativeRadianceIsBlackInThePicture) {
    Material bright = lambert({0, 0, 0});
    bright.emissive = {100, 50, 0};
    Scene scene = half_plane(8.0, bright);
    add_mesh(scene, rectangle(2, 2, -1, add_material(scene, unlit({0.01f, 0.01f, 0.5f, 1}))));
    for (const ToneMap map : {ToneMap::kNone, ToneMap::kNeutral, ToneMap::kAces}) {
        RenderOptions o = filtered(PixelFilter::kMitchell, 16, 16, 16);
        o.tone_map = map;
        o.ambient = 0.0f;
        const RenderResult r = render(scene, o);
        const Vec4 halo = linear_at(r, 9, 8);
        // The edge is 1.5 pixels from the centre, and the filter's integral over 1.5 .. 2 is -1/128.
        EXPECT_NEAR(halo.x, 0.01f - 99.99f / 128, 0.01f);
        EXPECT_NEAR(halo.y, 0.01f - 49.99f / 128, 0.005f);
        EXPECT_NEAR(halo.z, 0.5f + 0.5f / 128, 1e-3f);
        const std::uint8_t* p = r.color.data<std::uint8_t>() + 4 * (8 * 16 + 9);
        EXPECT_LE(p[0], map == ToneMap::kAces ? p[2] : 0);  // ACES mixes the channels
        EXPECT_GT(p[2], 150);
        EXPECT_EQ(p[3], 255);
    }
}

TEST(Filter, BEY1_RasterIsTheReferencesPictureOnEveryInstructionSet) {
    for (const char* name : {"spheres.gltf", "transparency.gltf", "materials.gltf"}) {
        const Scene scene = scene_file(name);
        for (const PixelFilter filter : kWide)
            for (const int samples : {1, 3}) {
                RenderOptions o = filtered(filter, 133, 71, samples);
                o.want_depth = o.want_primitive = true;
                o.engine = Engine::kReferenceRaster;
                const RenderResult reference = render(scene, o);
                o.engine = Engine::kRaster;
                for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
                    if (!isa_supported(isa)) continue;
                    o.isa = isa;
                    o.threads = 1 + static_cast<int>(isa) % 3;
                    const RenderResult r = render(scene, o);
                    const std::string what = std::string(name) + " " + tessera::name(isa);
                    EXPECT_TRUE(same_bytes(reference.linear, r.linear)) << what;
                    EXPECT_TRUE(same_bytes(reference.color, r.color)) << what;
                    EXPECT_TRUE(same_bytes(reference.depth, r.depth)) << what;
                    EXPECT_TRUE(same_bytes(reference.primitive, r.primitive)) << what;
                    EXPECT_EQ(reference.stats.pixels_covered, r.stats.pixels_covered) << what;
                    EXPECT_EQ(reference.stats.fragments_passed, r.stats.fragments_passed) << what;
                    EXPECT_EQ(reference.stats.culled_backface, r.stats.culled_backface) << what;
                    EXPECT_EQ(reference.stats.clipped, r.stats.clipped) << what;
                }
                o.want_linear = o.want_depth = o.want_primitive = false;
                EXPECT_TRUE(same_bytes(reference.color, render(scene, o).color)) << "colour alone";
            }
    }
}

TEST(Filter, RAS7_LabelsAndCountsAreThoseOfTheBox) {
    const Scene scene = scene_file("hierarchy.gltf");
    for (const Engine engine : kEngines) {
        RenderOptions o = filtered(PixelFilter::kBox, 64, 48, 2);
        o.engine = engine;
        o.want_depth = o.want_primitive = true;
        const RenderResult box = render(scene, o);
        EXPECT_GT(box.stats.pixels_covered, 100u);
        for (const PixelFilter filter : kWide) {
            o.filter = filter;
            const RenderResult wide = render(scene, o);
            EXPECT_TRUE(same_bytes(box.depth, wide.depth)) << name(engine);
            EXPECT_TRUE(same_bytes(box.primitive, wide.primitive)) << name(engine);
            EXPECT_FALSE(same_bytes(box.linear, wide.linear)) << name(engine);
            EXPECT_EQ(box.stats.pixels_covered, wide.stats.pixels_covered) << name(engine);
            EXPECT_EQ(box.stats.fragments_passed, wide.stats.fragments_passed) << name(engine);
            EXPECT_EQ(box.stats.triangles, wide.stats.triangles) << name(engine);
        }
    }
}

TEST(Filter, RAS7_TheTentOverOneSampleIsTheBox) {
    const Scene scene = scene_file("spheres.gltf");
    for (const Engine engine : kEngines) {
        RenderOptions o = filtered(PixelFilter::kBox, 48, 36, 1);
        o.engine = engine;
        const RenderResult box = render(scene, o);
        o.filter = PixelFilter::kTent;
        const RenderResult tent = render(scene, o);
        EXPECT_TRUE(same_bytes(box.linear, tent.linear)) << name(engine);
        EXPECT_TRUE(same_bytes(box.color, tent.color)) << name(engine);
    }
}

TEST(Filter, RAS7_AWarmRendererForgetsTheLastFrame) {
    const Scene scene = scene_file("transparency.gltf");
    for (const PixelFilter filter : kWide) {
        RenderOptions o = filtered(filter, 50, 38, 2);
        o.want_depth = true;
        const RenderResult cold = render(scene, o);
        View other = o.view;
        other.eye = Vec3{0, 1, 9};
        other.target = Vec3{0, 0, 0};
        Renderer renderer(scene, o);
        RenderResult warm;
        renderer.draw(other, warm);
        EXPECT_FALSE(same_bytes(cold.linear, warm.linear));
        renderer.draw(warm);
        EXPECT_TRUE(same_bytes(cold.color, warm.color));
        EXPECT_TRUE(same_bytes(cold.linear, warm.linear));
        EXPECT_TRUE(same_bytes(cold.depth, warm.depth));
        EXPECT_EQ(cold.stats.pixels_covered, warm.stats.pixels_covered);
    }
}

TEST(Filter, RAS7_OnlyThePlanesThatAreWanted) {
    const Scene scene = scene_file("transparency.gltf");
    for (const Engine engine : kEngines) {
        RenderOptions o = filtered(PixelFilter::kGaussian, 50, 38, 2);
        o.engine = engine;
        o.want_depth = o.want_primitive = true;
        const RenderResult all = render(scene, o);
        o.want_color = false;
        const RenderResult linear = render(scene, o);
        EXPECT_TRUE(linear.color.empty()) << name(engine);
        EXPECT_TRUE(same_bytes(all.linear, linear.linear)) << name(engine);
        EXPECT_EQ(all.stats.pixels_covered, linear.stats.pixels_covered) << name(engine);
        o.want_linear = false;
        const RenderResult labels = render(scene, o);
        EXPECT_TRUE(labels.color.empty() && labels.linear.empty()) << name(engine);
        EXPECT_TRUE(same_bytes(all.depth, labels.depth)) << name(engine);
        EXPECT_TRUE(same_bytes(all.primitive, labels.primitive)) << name(engine);
        EXPECT_GT(labels.stats.pixels_covered, 100u) << name(engine);
    }
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

TEST(Filter, RAS7_LimitsAndCancelling) {
    const Scene scene = half_plane(8, unlit({1, 1, 1, 1}));
    for (const Engine engine : kEngines) {
        RenderOptions o = filtered(PixelFilter::kBox, 64, 64, 2);
        o.engine = engine;
        o.max_bytes = 64 * 64 * 56;
        EXPECT_NO_THROW(render(scene, o));
        o.filter = PixelFilter::kGaussian;  // has a second plane
        EXPECT_EQ(refusal(scene, o), ErrorCode::kLimit);
        o.max_bytes = 64 * 64 * 66;
        EXPECT_NO_THROW(render(scene, o));

        double last = 0;
        bool rising = true;
        o.progress = [&](double p) {
            rising = rising && p >= last;
            last = p;
        };
        render(scene, o);
        EXPECT_TRUE(rising);
        EXPECT_GT(last, 0.9);
        last = 0;
        o.cancel = [&] { return last > 0.4; };
        EXPECT_EQ(refusal(scene, o), ErrorCode::kCancelled);
        EXPECT_LT(last, 0.9);
    }
    RenderOptions o = small(8, 8);
    o.filter = static_cast<PixelFilter>(9);
    EXPECT_EQ(refusal(scene, o), ErrorCode::kUsage);
}

}  // namespace
}  // namespace tessera
