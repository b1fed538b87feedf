// Beside the picture: labels, motion, wide filters and strokes with the engines that trace light, and what is refused.
#include <gtest/gtest.h>

#include "render/traced_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace tessera {
namespace {

using namespace test;

RenderOptions all_labels() {
    RenderOptions o;
    o.width = 160, o.height = 120, o.samples = 1;
    o.want_depth = o.want_primitive = o.want_node = o.want_material = o.want_normal = o.want_shading_normal =
        o.want_uv = o.want_position = o.want_albedo = true;
    return o;
}

const Image RenderResult::*const kLabels[] = {
    &RenderResult::depth,  &RenderResult::primitive,      &RenderResult::node,       &RenderResult::material,
    &RenderResult::normal, &RenderResult::shading_normal, &RenderResult::uv,         &RenderResult::position,
    &RenderResult::albedo, &RenderResult::motion,         &RenderResult::motion_seen};

// Pixels of two renderings that show different labels; with `apart`, only where the depths differ by more than
// rounding: at the common edge of two surfaces either may be met.
std::size_t differing_labels(const RenderResult& a, const RenderResult& b, bool apart) {
    std::size_t most = 0;
    for (const auto plane : kLabels) {
        const Image &p = a.*plane, &q = b.*plane;
        if (p.empty() || q.empty()) {
            EXPECT_EQ(p.empty(), q.empty());
            continue;
        }
        const std::size_t size = bytes_per_pixel(p.format());
        std::size_t count = 0;
        for (std::size_t i = 0; i < p.bytes().size() / size; ++i) {
            const float z = a.depth.data<float>()[i], w = b.depth.data<float>()[i];
            const bool same_place = z == w || std::fabs(z - w) <= 1e-5f * std::max(z, w);
            if (apart && same_place) continue;
            count += std::memcmp(p.bytes().data() + i * size, q.bytes().data() + i * size, size) != 0;
        }
        most = std::max(most, count);
    }
    return most;
}

// Bit for bit with the hybrid. Rays may see the other triangle at an edge, and are nearly the ray caster's. What is
// drawn by its formula they see elsewhere: such scenes are compared with the rasterizer's as triangles.
void expect_labels(const std::string& what, const Scene& scene, RenderOptions o) {
    const auto with = [&](Engine engine) {
        o.engine = engine;
        return render(scene, o);
    };
    const RenderResult raster = with(Engine::kRaster), traced = with(Engine::kTrace);
    EXPECT_EQ(differing_labels(raster, with(Engine::kHybrid), false), 0u) << what;
    const std::size_t at_edges = differing_labels(raster, traced, false),
                      rounded = differing_labels(with(Engine::kReferenceTrace), traced, true);
    const double pixels = o.width * o.height;
    EXPECT_LE(static_cast<double>(rounded), 2e-3 * pixels) << what;
    if (has_shapes(scene)) return expect_labels(what + " as triangles", as_triangles(scene), o);
    EXPECT_LE(static_cast<double>(at_edges), 6e-3 * pixels) << what;
    if (at_edges + rounded > 0)
        std::printf(
            "%s: labels of %zu pixels differ from the rasterizer's, of %zu "
            "in depth from the ray caster's, of %.0f\n",
            what.c_str(), at_edges, rounded, pixels);
}

TEST(TracedPlanes, LabelsAreTheRasterizers) {
    for (const std::string& name : all_scene_files()) {
        expect_labels(name, scene_file(name.c_str()), all_labels());
        RenderOptions o = all_labels();  // without a picture
        o.want_color = false;
        o.euclidean_depth = true;
        o.label_space = LabelSpace::kOpenCvCamera;
        expect_labels(name + " alone", scene_file(name.c_str()), o);
    }
}

TEST(TracedPlanes, SoIsMotion) {
    const Scene scene = scene_file("motion.gltf");
    RenderOptions o = all_labels();
    o.want_motion = true;
    o.moment = {0, 0.5};
    o.motion_before = Shot{o.view, {0, 0.4}};
    o.motion_after = Shot{o.view, {0, 0.6}};
    expect_labels("motion.gltf", scene, o);
}

TEST(TracedPlanes, WideFiltersAreTheRasterizers) {
    for (const char* file : {"spheres.gltf", "transparency.gltf"})
        for (const PixelFilter filter : {PixelFilter::kTent, PixelFilter::kGaussian, PixelFilter::kMitchell}) {
            const Scene scene = scene_file(file);
            RenderOptions o;
            o.width = 96, o.height = 72, o.samples = 4;
            o.want_linear = true;
            o.filter = filter;
            o.shadows = Shadows::kNone;
            o.max_depth = 0;
            const RenderResult raster = render(scene, o);
            o.engine = Engine::kHybrid;
            EXPECT_TRUE(same_bytes(raster.linear, render(scene, o).linear)) << file;
            o.engine = Engine::kTrace;
            const RenderResult traced = render(scene, o);
            std::size_t far = 0;  // of four samples and their neighbours one may lie at an edge
            for (int y = 0; y < o.height; ++y)
                for (int x = 0; x < o.width; ++x)
                    far += std::fabs(linear_at(raster, x, y).y - linear_at(traced, x, y).y) > 1e-3f;
            EXPECT_LE(far, 96u * 72 / 100) << file;
        }
}

// With all light traced: the hybrid under a wide filter is the reference's picture under it, and counts all samples.
TEST(TracedPlanes, WideFiltersTakeEverySampleOfTracedLight) {
    const Scene scene = scene_file("spheres.gltf");
    RenderOptions o;
    o.width = 96, o.height = 72, o.samples = 4;
    o.want_linear = true;
    o.filter = PixelFilter::kGaussian;
    o.engine = Engine::kReferenceTrace;
    const RenderResult reference = render(scene, o);
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        o.engine = engine;
        o.filter = PixelFilter::kGaussian;
        const RenderResult wide = render(scene, o);
        std::size_t far = 0;
        for (int y = 0; y < o.height; ++y)
            for (int x = 0; x < o.width; ++x)
                far += std::fabs(linear_at(wide, x, y).y - linear_at(reference, x, y).y) > 1e-4f;
        EXPECT_LE(far, 96u * 72 / 50) << name(engine);
        o.filter = PixelFilter::kBox;
        const RenderResult box = render(scene, o);
        EXPECT_EQ(wide.stats.shadow_rays, box.stats.shadow_rays) << name(engine);
        EXPECT_EQ(wide.stats.mirrored_rays, box.stats.mirrored_rays) << name(engine);
        EXPECT_EQ(wide.stats.primary_rays, box.stats.primary_rays) << name(engine);
    }
}

Scene with_strokes(bool mirror) {
    Scene scene;
    Material m = lambert({0.8f, 0.8f, 0.8f});
    if (mirror) m.mirror = {0.5f, 0.5f, 0.5f};
    place(scene, rectangle(4, 4, 0, add_material(scene, m)), {});
    Primitive lines, dots;
    lines.mode = PrimitiveMode::kLineStrip;
    lines.positions = {{-0.7f, -0.6f, 1}, {0.1f, 0.7f, 1}, {0.8f, -0.2f, 0.5f}};
    dots.mode = PrimitiveMode::kPoints;
    dots.positions = {{-0.5f, 0.5f, 1}, {0.5f, 0.5f, 0.7f}};
    lines.material = dots.material = add_material(scene, unlit({1, 0, 0, 1}));
    place(scene, lines, {});
    place(scene, dots, {});
    add_sun(scene, {0.5f, 0.3f, 1});
    add_orthographic(scene);
    return scene;
}

TEST(TracedPlanes, StrokesAreDrawnThrowNoShadowAndAreInNoMirror) {
    const Scene scene = with_strokes(false), mirrored = with_strokes(true);
    Scene bare = mirrored;
    bare.scenes[0].nodes.erase(bare.scenes[0].nodes.begin() + 1, bare.scenes[0].nodes.begin() + 3);
    for (const Engine engine : kTracers) {
        RenderOptions o = traced(engine, 64, 64);
        o.point_size = 12, o.line_width = 5;
        o.want_node = true;
        const RenderResult shadowed = render(scene, o);
        o.shadows = Shadows::kNone;
        EXPECT_TRUE(same_bytes(shadowed.linear, render(scene, o).linear)) << name(engine);
        RenderOptions as_raster = o;
        as_raster.engine = Engine::kRaster;
        EXPECT_EQ(differing_pixels(shadowed.node, render(scene, as_raster).node), 0u) << name(engine);
        o.shadows = Shadows::kTraced;
        const RenderResult with = render(mirrored, o), without = render(bare, o);
        int strokes = 0, floor = 0;
        for (int i = 0; i < 64 * 64; ++i) {
            const bool stroke = with.node.data<std::uint32_t>()[i] > 1;
            ++(stroke ? strokes : floor);
            const Vec4 a = linear_at(with, i % 64, i / 64), b = linear_at(without, i % 64, i / 64);
            EXPECT_EQ(a, stroke ? (Vec4{1, 0, 0, 1}) : b) << name(engine) << " " << i;
        }
        EXPECT_GT(strokes, 300);
        EXPECT_GT(floor, 1000);
    }
}

// The message of the refusal.
std::string refusal(const RenderOptions& o) {
    try {
        render(Scene{}, o);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::kUsage);
        return e.what();
    }
    ADD_FAILURE() << "accepted";
    return "";
}

TEST(TracedPlanes, OptionsOfTracedLightThatMakeNoSenseAreRefusedByName) {
    const auto said = [](auto change) {
        RenderOptions o = small(8, 8);
        o.engine = Engine::kTrace;
        change(o);
        return refusal(o);
    };
    const auto has = [](const std::string& message, const char* part) {
        EXPECT_NE(message.find(part), std::string::npos) << message;
    };
    has(said([](RenderOptions& o) { o.max_depth = 65; }), "depth");
    has(said([](RenderOptions& o) { o.max_depth = -1; }), "depth");
    has(said([](RenderOptions& o) { o.min_contribution = -1; }), "contribution");
    has(said([](RenderOptions& o) { o.min_contribution = 1.5f; }), "contribution");
    has(said([](RenderOptions& o) { o.min_contribution = std::nanf(""); }), "contribution");
    has(said([](RenderOptions& o) { o.shadows = static_cast<Shadows>(3); }), "shadows");
    const auto traced_by_reference = [](RenderOptions& o) {
        o.engine = Engine::kReferenceRaster;
        o.shadows = Shadows::kTraced;
    };
    has(said(traced_by_reference), "reference-raster");
    has(said(traced_by_reference), "shadows");
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        const auto stage = [engine](RenderOptions& o) {
            o.engine = engine;
            o.show = Stage::kBins;
        };
        has(said(stage), name(engine));
    }
    RenderOptions o = small(8, 8);
    o.engine = Engine::kTrace;
    o.max_depth = 64;
    o.min_contribution = 1;
    EXPECT_NO_THROW(render(Scene{}, o));
    o.engine = Engine::kRaster;
    o.shadows = Shadows::kTraced;
    EXPECT_NO_THROW(render(Scene{}, o));
}

TEST(TracedPlanes, TheRasterizerWithTracedShadowsIsTheHybridWithoutMirrors) {
    const Scene scene = scene_file("spheres.gltf");
    RenderOptions o;
    o.width = 96, o.height = 72, o.samples = 2;
    o.want_linear = true;
    o.shadows = Shadows::kTraced;
    const RenderResult raster = render(scene, o);
    o.engine = Engine::kHybrid;
    o.max_depth = 0;
    const RenderResult hybrid = render(scene, o);
    EXPECT_TRUE(same_bytes(raster.linear, hybrid.linear));
    EXPECT_GT(raster.stats.shadow_rays, 1000u);
    EXPECT_EQ(raster.stats.shadow_rays, hybrid.stats.shadow_rays);
}

}  // namespace
}  // namespace tessera
