// What must not matter: the order in which triangles are drawn where depths differ, the order of vertices in
// memory, how instances fall into chunks, repetition and warm memory.
#include "raster/exactness.h"

#include "cli/workload_meshes.h"

#include <tessera/renderer.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace tessera {
namespace {

using namespace test;

RenderOptions soup_options() {
    RenderOptions o = all_planes(256, 144, 1);
    o.view = look_from({0, 0, 0}, {0, 0, -1});
    o.exposure_ev = 0.0f;  // metering samples triangles by their number
    return o;
}

// Colours and depths stay; number n becomes the n-th from the end.
void expect_reversible(const Scene& scene, RenderOptions o, const std::string& what) {
    for (const Isa isa : all_isas())
        for (const bool hierarchical_z : {true, false}) {
            o.isa = isa;
            o.raster.hierarchical_z = hierarchical_z;
            const RenderResult a = render(scene, o), b = render(reversed(scene), o);
            EXPECT_EQ(differing(a.color, b.color), 0u) << what;
            EXPECT_EQ(differing(a.linear, b.linear), 0u) << what;
            EXPECT_EQ(differing(a.depth, b.depth), 0u) << what;
            const auto *na = a.primitive.data<std::uint32_t>(), *nb = b.primitive.data<std::uint32_t>();
            const auto total = static_cast<std::uint32_t>(a.stats.triangles);
            std::uint64_t wrong = 0, covered = 0;
            for (std::size_t i = 0; i < a.primitive.bytes().size() / 4; ++i) {
                wrong += nb[i] != (na[i] == 0 ? 0 : total + 1 - na[i]);
                covered += na[i] != 0;
            }
            EXPECT_EQ(wrong, 0u) << what;
            EXPECT_GT(covered, 1000u) << what;
            EXPECT_EQ(a.stats.pixels_covered, b.stats.pixels_covered) << what;
        }
}

TEST(RasterOrder, CARD3_DrawOrderIsNoMatterWhereDepthsDiffer) {
    Scene soup;
    add_material(soup, lambert({0.7f, 0.6f, 0.5f}));
    Primitive mesh = cli::soup_mesh(9000, 8, 256, 144);  // several chunks
    mesh.material = 0;
    add_mesh(soup, std::move(mesh));
    expect_reversible(soup, soup_options(), "soup");

    RenderOptions o = soup_options();
    o.view = look_from({0, 0, 1}, {0, 0, -1});
    expect_reversible(triangles_around_the_camera(5), o, "around the camera");
}

// The same triangles with their vertices in a row, and far apart in an order of their own among vertices that
// nobody uses.
TEST(RasterOrder, CARD3_PlacesOfVerticesInMemoryAreNoMatter) {
    const Primitive ordered = cli::terrain_mesh(60);
    Primitive scattered = ordered;
    std::vector<std::uint32_t> place(ordered.positions.size() * 40);
    std::iota(place.begin(), place.end(), 0u);
    std::mt19937 random(3);
    std::shuffle(place.begin(), place.end(), random);
    scattered.positions.assign(place.size(), {0, 0, 0});
    scattered.normals.assign(place.size(), {0, 1, 0});
    for (std::size_t i = 0; i < ordered.positions.size(); ++i) {
        scattered.positions[place[i]] = ordered.positions[i];
        scattered.normals[place[i]] = ordered.normals[i];
    }
    for (std::uint32_t& i : scattered.indices) i = place[i];
    Scene a, b;
    add_mesh(a, ordered);
    add_mesh(b, scattered);
    RenderOptions o = all_planes(256, 144, 2);
    o.view = look_from({0, 0.9f, 1.3f}, {0, -0.15f, 0});
    for (const Isa isa : all_isas()) {
        o.isa = isa;
        expect_equal_planes(render(a, o), render(b, o), name(isa));
    }
    expect_exact(b, o, "scattered");
}

TEST(RasterOrder, CARD3_ManySmallInstancesInAChunk) {
    Scene scene;
    for (int m = 0; m < 7; ++m) {
        Material material = lambert({0.1f * static_cast<float>(m), 0.5f, 0.9f - 0.1f * static_cast<float>(m)});
        if (m == 5) material.alpha_mode = AlphaMode::kBlend;
        material.base_color.w = 0.6f;
        material.double_sided = m % 2 == 0;
        add_material(scene, material);
    }
    std::mt19937 random(4);
    const auto value = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
    for (int i = 0; i < 900; ++i) {
        const float size = i % 50 == 0 ? 0.5f : 0.03f;
        add_mesh(scene, rectangle(size, size * value(0.2f, 1), 0, i % 7));
        Node& node = scene.nodes.back();
        const float x = value(-1.6f, 1.6f), y = value(-1, 1);
        node.translation = {x, y, value(-4, -1)};
        node.scale = {i % 11 == 0 ? -1.0f : 1.0f, 1, 1};
    }
    RenderOptions o = soup_options();
    o.samples = 2;
    expect_exact(scene, o, "instances");
}

TEST(RasterOrder, CARD3_AHundredRepetitionsOnEightThreads) {
    const Scene scene = triangles_around_the_camera(6);
    RenderOptions o = soup_options();
    o.view = look_from({0, 0, 1}, {0, 0, -1});
    o.samples = 2;
    o.threads = 8;
    o.raster.tile_side = 32;
    Renderer renderer(scene, o);
    RenderResult first, again;
    renderer.draw(first);
    for (int i = 1; i < 100; ++i) {
        renderer.draw(again);
        expect_equal(first, again, "run " + std::to_string(i));
        ASSERT_FALSE(testing::Test::HasFailure()) << "run " << i;
    }
    o.engine = Engine::kReferenceRaster;
    expect_equal(render(scene, o), first, "the first run");
}

}  // namespace
}  // namespace tessera
