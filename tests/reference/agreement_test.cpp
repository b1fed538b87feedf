// The rasterizer and the ray caster find visibility in independent ways; they must name the same
// triangle at every sample, except within 1/256 pixel of an edge or where two surfaces coincide.
#include <gtest/gtest.h>

#include "load/test_files.h"
#include "reference/edge_distance.h"
#include "reference/rasterizer.h"
#include "reference/raycaster.h"
#include "reference/workload_scene.h"

#include <cmath>

namespace tessera {
namespace {

using test::edge_distance;
using test::Prepared;

struct Agreement {
    std::uint64_t samples = 0, near_edge = 0, coincident = 0, unexplained = 0;
    std::string first_unexplained;
};

Agreement compare(const Prepared& p, const Visibility& raster, const Visibility& traced) {
    Agreement a;
    SurfaceSampler sampler(p.frame, p.context());
    for (std::size_t i = 0; i < raster.triangle.size(); ++i) {
        ++a.samples;
        const std::uint32_t r = raster.triangle[i], t = traced.triangle[i];
        if (r == t) continue;
        const auto width = static_cast<std::size_t>(raster.width);
        const SamplePosition at{256 * static_cast<int>(i % width) + 128, 256 * static_cast<int>(i / width) + 128};
        double distance = 1e30;
        for (const std::uint32_t number : {r, t})
            if (number != 0) distance = std::min(distance, edge_distance(sampler.setup(number - 1), at));
        const float zr = raster.depth[i], zt = traced.depth[i];
        if (distance <= 1.0 / 256) {
            ++a.near_edge;
        } else if (r != 0 && t != 0 && test::coincident(zr, zt)) {
            ++a.coincident;
        } else {
            if (a.unexplained++ == 0)
                a.first_unexplained = "pixel " + std::to_string(i % width) + "," + std::to_string(i / width) +
                                      " raster " + std::to_string(r) + " traced " + std::to_string(t) + " edge " +
                                      std::to_string(distance);
        }
    }
    return a;
}

Agreement agree(Scene scene, const View& view, int width, int height, const StrokeStyle& style = {}) {
    const Prepared p(std::move(scene), view, width, height, style);
    const SamplePosition centre{128, 128};
    const Bvh bvh(p.frame);
    return compare(p, rasterize(p.frame, p.context(), centre, test::no_control()),
                   cast_rays(p.frame, bvh, p.context(), centre, test::no_control()));
}

void expect_agreement(const std::string& name, const Agreement& a) {
    EXPECT_EQ(a.unexplained, 0u) << name << ": " << a.first_unexplained;
    // The excuses must stay what they are: rare.
    EXPECT_LE(a.near_edge + a.coincident, a.samples / 200) << name;
    if (a.near_edge + a.coincident > 0)
        std::printf("%s: %llu samples, %llu near an edge, %llu coincident\n", name.c_str(),
                    static_cast<unsigned long long>(a.samples), static_cast<unsigned long long>(a.near_edge),
                    static_cast<unsigned long long>(a.coincident));
}

TEST(Agreement, RAY1_RasterAndRaysNameTheSameTriangleOnEveryModel) {
    const std::vector<std::string> names = all_gltf_models();
    if (names.empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    for (const std::string& name : names) {
        Scene scene;
        try {
            scene = load_scene(gltf_model(name).string());
        } catch (const Error&) {
            continue;  // needs an extension; the loader's tests say which
        }
        expect_agreement(name, agree(std::move(scene), View{}, 400, 300));
    }
}

TEST(Agreement, RAY1_RasterAndRaysNameTheSameTriangleOnMeshes) {
    expect_agreement("sphere100k",
                     agree(test::make_scene(wl::sphere(158)), test::look({0, 0, 2.2f}, {0, 0, 0}), 640, 360));
    expect_agreement("terrain100k",
                     agree(test::make_scene(wl::terrain(224)), test::look({0, 0.9f, 1.3f}, {0, -0.15f, 0}), 640, 360));
    Scene shell = test::make_scene(wl::sphere(50));
    shell.materials.emplace_back().double_sided = true;
    shell.meshes[0].primitives[0].material = 0;
    expect_agreement("inside a sphere", agree(std::move(shell), test::look({0.2f, 0.1f, 0}, {1, 0, 0}), 640, 360));
    expect_agreement("soup",
                     agree(test::make_scene(wl::soup(5000, 8, 640, 360)), test::look({0, 0, 0}, {0, 0, -1}), 640, 360));
}

// Crossing the near plane and the guard band: a huge floor under the camera.
TEST(Agreement, RAS2_RasterAndRaysAgreeOnClippedTriangles) {
    wl::Mesh floor;
    for (const float z : {-1000.0f, 1000.0f})
        for (const float x : {-1000.0f, 1000.0f}) floor.vert(x, 0, z, 0, 1, 0, x, z);
    floor.idx = {0, 2, 1, 1, 2, 3};
    for (const float height : {0.001f, 0.1f, 10.0f})
        for (const float turn : {0.0f, 0.3f, 1.1f, 2.9f}) {
            const View view = test::look({0.1f, height, 0.2f}, {std::sin(turn), height - 0.2f, -std::cos(turn)});
            const Agreement a = agree(test::make_scene(floor), view, 320, 200);
            EXPECT_EQ(a.unexplained, 0u) << a.first_unexplained;
            EXPECT_LE(a.near_edge, 40u);
        }
}

// Wire frames and vertices of a mesh, over its own faces.
TEST(Agreement, RAS3_RasterAndRaysAgreeOnPointsAndLines) {
    for (const bool inside : {false, true})
        for (const float size : {1.0f, 6.0f}) {
            Scene scene = test::make_scene(wl::sphere(24));
            Primitive dots = scene.meshes[0].primitives[0], wires;
            dots.mode = PrimitiveMode::kPoints;
            wires = dots;
            wires.normals.clear();
            wires.mode = PrimitiveMode::kLineStrip;
            scene.meshes[0].primitives.push_back(dots);
            scene.meshes[0].primitives.push_back(wires);
            const View view = inside ? test::look({0.2f, 0.1f, 0}, {1, 0, 0}) : test::look({0, 0, 2.2f}, {0, 0, 0});
            const Agreement a = agree(std::move(scene), view, 320, 180, {size, size / 2});
            EXPECT_EQ(a.unexplained, 0u) << a.first_unexplained;
            // Lines on the pixel grid have many centres on their edges.
            EXPECT_LE(a.near_edge + a.coincident, a.samples / 100);
        }
}

TEST(Agreement, RAY2_BruteForceAndHierarchyGiveTheSameHits) {
    const Prepared p(test::make_scene(wl::terrain(20)), test::look({0, 0.9f, 1.3f}, {0, -0.15f, 0}), 160, 90);
    const Bvh all(p.frame, true), tree(p.frame);
    const Visibility a = cast_rays(p.frame, all, p.context(), {128, 128}, test::no_control());
    const Visibility b = cast_rays(p.frame, tree, p.context(), {128, 128}, test::no_control());
    EXPECT_EQ(a.triangle, b.triangle);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_GT(a.counters.fragments_passed, 1000u);
}

}  // namespace
}  // namespace tessera
