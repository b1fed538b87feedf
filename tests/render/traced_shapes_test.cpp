// Exact shapes with all kinds of light: the ray tracer's pictures and labels are the recursive reference's, with the
// same bits whatever the threads and tiles; and their triangles' pictures come to look like them.
#include <gtest/gtest.h>

#include "render/pinhole.h"
#include "render/traced_pictures.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using namespace test;

Shape sphere_of(float radius, int segments) { return {Shape::Type::kSphere, radius, {0, 0}, segments}; }
Shape disc_of(float radius, int segments) { return {Shape::Type::kDisc, radius, {0, 0}, segments}; }

// Mirrors, glass within glass, cut-outs and veils, on an endless floor; evenly scaled, stretched and mirrored.
Scene shapes_of_many_kinds(int segments = 24) {
    Scene scene;
    add_dots(scene);
    const auto put = [&](const Shape& shape, const Material& m, Vec3 at, Quat turn = {}, Vec3 scale = {1, 1, 1}) {
        place(scene, shape_primitive(shape, add_material(scene, m)), at, turn, scale);
    };
    const auto [mirror, water, flint, metal, veil, leaf] = kinds();
    Material thin_veil = veil, one_sided_leaf = leaf;
    thin_veil.base_color.w = 0.7f;
    thin_veil.double_sided = false;
    one_sided_leaf.double_sided = false;
    put({Shape::Type::kPlane, 1, {0, 0}, 96}, lambert({0.7f, 0.6f, 0.5f}), {0, -1, 0});
    put(disc_of(1.2f, segments), mirror, {0, 0, -2}, quaternion({1, 0, 0}, 1.4f));
    put(sphere_of(0.8f, segments), water, {-0.9f, 0, 0}, {}, {-1, 1, 0.9f});
    put(sphere_of(0.5f, segments), flint, {-0.5f, 0.2f, 0.3f});
    put(sphere_of(0.5f, segments), metal, {0.9f, -0.4f, 0}, {0.1f, 0.2f, 0.3f, 0.927f}, {1.2f, -0.8f, 1});
    put(sphere_of(0.3f, segments), mirror, {0.3f, -0.7f, 0.8f});
    put(sphere_of(0.35f, segments), veil, {0.8f, 0.5f, 0.8f});
    put(sphere_of(0.25f, segments), thin_veil, {0.1f, 0.7f, 1}, {}, {1, 1, -0.6f});
    put(sphere_of(0.3f, segments), leaf, {-0.2f, -0.4f, 1.3f}, {0.1f, 0.2f, 0.3f, 0.927f});
    put(sphere_of(0.3f, segments), one_sided_leaf, {-1.2f, -0.6f, 1.2f});
    put(disc_of(0.4f, segments), leaf, {1.3f, 0.6f, 0.2f}, quaternion({1, 0, 0}, 1));
    put(disc_of(0.4f, segments), veil, {-1.3f, 0.9f, 0.4f}, quaternion({1, 0, 0}, 1.2f));
    place(scene, rectangle(0.4f, 0.4f, 0, add_material(scene, pane({1, 0.6f, 0.6f}))), {0.3f, -0.2f, 1.6f});
    add_sun(scene, {0.3f, 1, 0.6f});
    Light lamp;
    lamp.intensity = 10;
    add_light(scene, lamp, {-1, 2, 2});
    return scene;
}

RenderOptions of_shapes(Engine engine) {
    RenderOptions o = quick(engine, 160, 120);
    o.view = look({0.3f, 0.5f, 3.5f}, {0, -0.1f, 0});
    o.want_node = o.want_material = o.want_normal = o.want_shading_normal = o.want_uv = o.want_position =
        o.want_albedo = true;
    return o;
}

constexpr const Image RenderResult::*kPlanes[] = {
    &RenderResult::linear,   &RenderResult::depth,    &RenderResult::primitive, &RenderResult::node,
    &RenderResult::uv,       &RenderResult::material, &RenderResult::normal,    &RenderResult::shading_normal,
    &RenderResult::position, &RenderResult::albedo};

// The most pixels that differ in a plane, colours among them.
std::size_t most_differing(const RenderResult& a, const RenderResult& b) {
    std::size_t most = 0;
    for (const auto plane : kPlanes) {
        EXPECT_FALSE((a.*plane).empty());
        most = std::max(most, differing_pixels(a.*plane, b.*plane));
    }
    return most;
}

TEST(TracedShapes, ColoursAndLabelsAreTheReferences) {
    const Scene scene = shapes_of_many_kinds();
    const auto expect = [&](const char* what, RenderOptions o) {
        o.engine = Engine::kReferenceTrace;
        const RenderResult reference = render(scene, o);
        o.engine = Engine::kTrace;
        const std::size_t differ = most_differing(reference, render(scene, o));
        std::printf("%s: %zu of %d pixels differ from the reference\n", what, differ, o.width * o.height);
        EXPECT_LE(static_cast<double>(differ), 1e-3 * o.width * o.height) << what;
    };
    RenderOptions o = of_shapes(Engine::kTrace);
    expect("all light", o);
    RenderOptions less = o;
    less.shadows = Shadows::kNone;
    expect("no shadows", less);
    less.max_depth = 0;
    expect("no traced light", less);
    less.shadows = Shadows::kTraced;
    expect("shadows alone", less);
    RenderOptions other = o;
    other.samples = 3;
    other.max_depth = 3, other.min_contribution = 0.05f;
    other.label_space = LabelSpace::kOpenCvCamera;
    other.euclidean_depth = true;
    expect("less light", other);
    other = o;
    other.view = look({-0.9f, 0, 0.2f}, {0.5f, -0.2f, 0});
    expect("from within the water and the glass", other);
    other.view = look({-0.2f, -0.4f, 1.32f}, {0.5f, -0.2f, 0});
    expect("from within the leaves", other);
    other.view = look({0.8f, 0.5f, 0.9f}, {-0.5f, -0.2f, 0});
    expect("from within the veil", other);
}

TEST(TracedShapes, OrthographicPicturesAreTheReferences) {
    Scene scene = shapes_of_many_kinds();
    scene.scenes[0].nodes.erase(scene.scenes[0].nodes.begin() +
                                12);  // the pane, whose diagonal is on the pixel centres
    add_orthographic(scene);
    RenderOptions o = of_shapes(Engine::kReferenceTrace);
    o.view = {};
    o.view.camera = 0;
    const RenderResult reference = render(scene, o);
    o.engine = Engine::kTrace;
    EXPECT_LE(most_differing(reference, render(scene, o)), 160u * 120 / 1000);
}

TEST(TracedShapes, TheSameBitsWhateverTheThreadsTilesAndInstructions) {
    const Scene scene = shapes_of_many_kinds();
    RenderOptions o = of_shapes(Engine::kTrace);
    o.samples = 2;
    o.threads = 1;
    const RenderResult first = render(scene, o);
    for (const int threads : {2, 4})
        for (const int side : {32, 64, 128}) {
            o.threads = threads;
            o.raster.tile_side = side;
            const RenderResult r = render(scene, o);
            EXPECT_EQ(most_differing(first, r), 0u) << threads << " threads, tiles of " << side;
            EXPECT_EQ(first.stats.shadow_rays, r.stats.shadow_rays);
            EXPECT_EQ(first.stats.refracted_rays, r.stats.refracted_rays);
            EXPECT_EQ(first.stats.straight_rays, r.stats.straight_rays);
        }
    o = of_shapes(Engine::kTrace);
    o.samples = 2;
    o.isa = Isa::kScalar;
    const RenderResult scalar = render(scene, o);
    for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
        if (!isa_supported(isa)) continue;
        o.isa = isa;
        const std::size_t differ = most_differing(scalar, render(scene, o));
        if (differ > 0) std::printf("%s: %zu pixels differ from scalar\n", name(isa), differ);
        EXPECT_LE(differ, 160u * 120 / 1000) << name(isa);
    }
}

// A scene of one renderer, drawn again from elsewhere and with the shapes' engines by turns.
TEST(TracedShapes, TheSameBitsOfARendererThatDrawsAgain) {
    const Scene scene = shapes_of_many_kinds();
    const RenderOptions o = of_shapes(Engine::kTrace);
    const RenderResult once = render(scene, o);
    Renderer renderer(scene, o);
    RenderResult again;
    View aside = o.view;
    aside.eye = Vec3{2, 1, 3};
    for (const View& view : {o.view, aside, o.view}) renderer.draw(view, again);
    EXPECT_EQ(most_differing(once, again), 0u);
}

// --- beside the triangles -----------------------------------------------------------------------

struct BesideTriangles {
    std::size_t nodes = 0, far = 0;  // pixels that show another node; of others those with another colour
    double normals = 0;              // the largest difference of normals where the node is the same
};
BesideTriangles beside(const RenderResult& exact, const RenderResult& triangles) {
    BesideTriangles b;
    for (int i = 0; i < exact.node.width() * exact.node.height(); ++i) {
        if (exact.node.data<std::uint32_t>()[i] != triangles.node.data<std::uint32_t>()[i]) {
            ++b.nodes;
            continue;
        }
        double apart = 0;
        for (int c = 0; c < 3; ++c) {
            const float *n = exact.normal.data<float>() + 3 * i, *m = triangles.normal.data<float>() + 3 * i;
            b.normals = std::max(b.normals, static_cast<double>(std::fabs(n[c] - m[c])));
            const float *p = exact.linear.data<float>() + 4 * i, *q = triangles.linear.data<float>() + 4 * i;
            apart = std::max(apart, static_cast<double>(std::fabs(p[c] - q[c])));
        }
        b.far += apart > 5e-3;
    }
    return b;
}

// Opaque shapes apart from each other: they differ along outlines, by as much as the triangles lie within.
TEST(TracedShapes, TrianglesComeToLookLikeThem) {
    const auto scene_of = [](int segments) {
        Scene scene;
        const int white = add_material(scene, lambert({0.8f, 0.8f, 0.8f}));
        place(scene, shape_primitive(sphere_of(0.8f, segments), white), {-0.9f, 0, 0});
        place(scene, shape_primitive(sphere_of(0.8f, segments), white), {0.9f, -0.2f, 0}, {0.1f, 0.2f, 0.3f, 0.927f},
              {0.5f, 1.2f, -0.8f});
        place(scene, shape_primitive(disc_of(0.5f, segments), white), {0, 0.9f, -1}, quaternion({1, 0, 0}, 1.2f));
        add_sun(scene, {0.3f, 0.5f, 1});
        return scene;
    };
    std::size_t before[2] = {};
    for (const int segments : {16, 64, 256}) {
        const Scene scene = scene_of(segments);
        RenderOptions o = of_shapes(Engine::kTrace);
        o.width = 320, o.height = 240;
        o.ambient = 0.1f;
        o.shadows = Shadows::kNone, o.max_depth = 0;
        const RenderResult exact = render(scene, o);
        int engine = 0;
        for (const Engine by_triangles : {Engine::kRaster, Engine::kHybrid}) {
            o.engine = by_triangles;
            const RenderResult triangles = render(scene, o);
            const BesideTriangles b = beside(exact, triangles);
            std::printf("%s, %d segments: %zu pixels of another node, %zu of another colour, normals %.2g apart\n",
                        name(by_triangles), segments, b.nodes, b.far, b.normals);
            if (segments == 16) {
                EXPECT_GT(b.nodes, 300u);
            } else {
                EXPECT_LT(8 * b.nodes, before[engine]);
            }
            before[engine++] = b.nodes;
            if (segments == 256) {
                EXPECT_LE(b.nodes, 20u);
                EXPECT_LE(b.far, 20u);
            }
        }
    }
}

}  // namespace
}  // namespace tessera
