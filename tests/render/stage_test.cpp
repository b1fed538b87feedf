// The stages of the tile rasterizer as pictures: numbers that follow from the scene, the same bytes
// everywhere, colours that rise with the numbers, refusals.
#include <gtest/gtest.h>

#include "render/scenes.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace tessera {
namespace {

using namespace test;

constexpr Stage kStages[] = {Stage::kBins, Stage::kHiZ, Stage::kOverdraw, Stage::kCost};

RenderOptions showing(Stage stage, int width, int height, int samples = 1) {
    RenderOptions o = small(width, height, samples);
    o.show = stage;
    o.want_linear = false;
    o.raster.tile_side = 64;
    return o;
}

// Walls that fill the picture, at these heights in the order of submission.
Scene walls(std::initializer_list<float> heights) {
    Scene scene;
    for (const float z : heights) add_mesh(scene, rectangle(2, 2, z, add_material(scene, unlit({1, 1, 1, 1}))));
    add_orthographic(scene);
    return scene;
}

template <class T>
std::set<T> values(const Image& plane) {
    const auto pixels = static_cast<std::size_t>(plane.width()) * static_cast<std::size_t>(plane.height());
    return {plane.data<T>(), plane.data<T>() + pixels};
}

std::set<std::uint32_t> numbers(const Scene& scene, const RenderOptions& options) {
    return values<std::uint32_t>(render(scene, options).stage);
}

TEST(Stage, OverdrawCountsTheSamplesThatAreTested) {
    using Set = std::set<std::uint32_t>;
    const int side = 64;  // one tile, drawn whole
    EXPECT_EQ(numbers(walls({}), showing(Stage::kOverdraw, side, side)), Set{0});
    EXPECT_EQ(numbers(walls({0}), showing(Stage::kOverdraw, side, side)), Set{1});
    EXPECT_EQ(numbers(walls({0}), showing(Stage::kOverdraw, side, side, 4)), Set{4});
    EXPECT_EQ(numbers(walls({0, 1}), showing(Stage::kOverdraw, side, side)), Set{2}) << "back to front";
    RenderOptions o = showing(Stage::kOverdraw, side, side);
    EXPECT_EQ(numbers(walls({1, 0}), o), Set{1}) << "front to back: hidden by hierarchical Z";
    o.raster.hierarchical_z = false;
    EXPECT_EQ(numbers(walls({1, 0}), o), Set{2}) << "front to back, and nothing hides it";
}

TEST(Stage, OverdrawIsTheCountOfTheStatistics) {
    const Scene scene = scene_file("transparency.gltf");
    RenderOptions o = showing(Stage::kOverdraw, 133, 71, 3);
    o.want_depth = o.want_primitive = true;  // whose own pass at the pixel centres counts nowhere
    const RenderResult r = render(scene, o);
    const std::uint32_t* tested = r.stage.data<std::uint32_t>();
    EXPECT_EQ(std::accumulate(tested, tested + 133 * 71, std::uint64_t{0}), r.stats.samples_tested);
    EXPECT_GT(r.stats.samples_tested, 1000u);
}

TEST(Stage, BinsCountTheTrianglesOfATile) {
    using Set = std::set<std::uint32_t>;
    EXPECT_EQ(numbers(walls({}), showing(Stage::kBins, 64, 64)), Set{0});
    EXPECT_EQ(numbers(walls({0, 1, 2}), showing(Stage::kBins, 64, 64)), Set{6});
    // A wall in the left half of a picture of 2 x 2 tiles.
    Scene scene;
    Primitive p = rectangle(2, 2, 0, add_material(scene, unlit({1, 1, 1, 1})));
    p.positions[1].x = p.positions[2].x = -0.25f;
    add_mesh(scene, p);
    add_orthographic(scene);
    const RenderResult r = render(scene, showing(Stage::kBins, 128, 128));
    const std::uint32_t* bins = r.stage.data<std::uint32_t>();
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) {
            const std::uint32_t count = bins[y * 128 + x];
            EXPECT_LE(count, 2u);
            EXPECT_EQ(count > 0, x < 64) << x << " " << y;
        }
    EXPECT_EQ(r.stats.tile_side, 64);
}

TEST(Stage, HierarchicalZIsTheLowestDepthOfABlock) {
    RenderOptions o = showing(Stage::kHiZ, 64, 64);
    EXPECT_EQ(values<float>(render(walls({}), o).stage), std::set<float>{0.0f});
    // Orthographic: reversed depth falls evenly from 1 at the near plane, 0.1, to 0 at the far one, 20.
    const std::set<float> level = values<float>(render(walls({0}), o).stage);
    ASSERT_EQ(level.size(), 1u);
    EXPECT_NEAR(*level.begin(), (20 - 10) / 19.9f, 1e-5f);
    const std::set<float> nearer = values<float>(render(walls({0, 5}), o).stage);
    ASSERT_EQ(nearer.size(), 1u);
    EXPECT_NEAR(*nearer.begin(), (20 - 5) / 19.9f, 1e-5f);
    o.raster.hierarchical_z = false;
    EXPECT_EQ(values<float>(render(walls({0}), o).stage), std::set<float>{0.0f});
}

TEST(Stage, CostGrowsWithTheWork) {
    const RenderOptions o = showing(Stage::kCost, 64, 64);
    const auto cost = [&](std::initializer_list<float> heights) { return *numbers(walls(heights), o).begin(); };
    EXPECT_EQ(cost({}), 0u);
    const std::uint32_t one = cost({0}), covered = cost({0, 1}), hidden = cost({1, 0});
    EXPECT_GT(one, 64u * 64u);
    EXPECT_GT(covered, hidden);
    EXPECT_GT(hidden, one);
    EXPECT_EQ(*numbers(walls({0}), showing(Stage::kCost, 64, 64, 3)).begin(), 3 * one);
}

TEST(Stage, TheSameBytesOnEveryInstructionSetAndThreadCount) {
    for (const char* name : {"spheres.gltf", "transparency.gltf", "materials.gltf"}) {
        const Scene scene = scene_file(name);
        for (const Stage stage : kStages)
            for (const int samples : {1, 3}) {
                RenderOptions o = showing(stage, 133, 97, samples);
                o.isa = Isa::kScalar;
                o.threads = 1;
                const RenderResult scalar = render(scene, o);
                EXPECT_FALSE(scalar.stage.empty());
                for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
                    if (!isa_supported(isa)) continue;
                    o.isa = isa;
                    o.threads = 2 + static_cast<int>(isa) % 3;
                    const RenderResult r = render(scene, o);
                    EXPECT_TRUE(same_bytes(scalar.stage, r.stage)) << name << " " << tessera::name(isa);
                    EXPECT_TRUE(same_bytes(scalar.color, r.color)) << name << " " << tessera::name(isa);
                }
            }
    }
}

TEST(Stage, ColoursRiseWithTheNumbersAndTilesHaveBorders) {
    const Scene scene = scene_file("spheres.gltf");
    const auto brightness = [](const std::uint8_t* p) { return 0.30 * p[0] + 0.59 * p[1] + 0.11 * p[2]; };
    RenderOptions o = showing(Stage::kOverdraw, 128, 96);
    const RenderResult r = render(scene, o);
    const std::uint32_t* number = r.stage.data<std::uint32_t>();
    const std::uint8_t* color = r.color.data<std::uint8_t>();
    const std::uint32_t most = *std::max_element(number, number + 128 * 96);
    ASSERT_GT(most, 1u);
    for (std::size_t i = 0; i < 128 * 96; ++i) {
        EXPECT_NEAR(brightness(color + 4 * i), 255.0 * number[i] / most, 1.1) << i;
        EXPECT_EQ(color[4 * i + 3], 255);
    }
    o.show = Stage::kBins;
    const RenderResult bins = render(scene, o);
    const std::uint8_t* p = bins.color.data<std::uint8_t>() + std::size_t{4} * (20 * 128 + 64);
    EXPECT_GT(brightness(p + 4), 10);
    EXPECT_NEAR(brightness(p), brightness(p + 4) / 2, 1.0);
}

TEST(Stage, ThePictureIsUntouchedAndPlanesAreLetGo) {
    const Scene scene = scene_file("spheres.gltf");
    RenderOptions o = showing(Stage::kCost, 40, 30);
    o.want_linear = true;
    const RenderResult shown = render(scene, o);
    o.show = Stage::kPicture;
    RenderResult plain = shown;
    Renderer(scene, o).draw(plain);
    EXPECT_TRUE(plain.stage.empty());
    EXPECT_FALSE(same_bytes(plain.color, shown.color));
    EXPECT_TRUE(same_bytes(plain.linear, shown.linear));
}

TEST(Stage, RefusesWhatHasNoTiles) {
    const Scene scene = walls({0});
    const auto refused = [&](const RenderOptions& o, const char* because) {
        try {
            render(scene, o);
            ADD_FAILURE() << "accepted: " << because;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::kUsage);
            EXPECT_NE(std::string(e.what()).find(because), std::string::npos) << e.what();
        }
    };
    RenderOptions o = showing(Stage::kBins, 8, 8);
    o.engine = Engine::kReferenceRaster;
    refused(o, "reference-raster");
    o.engine = Engine::kReferenceTrace;
    refused(o, "reference-trace");
    o = showing(Stage::kBins, 8, 8);
    o.filter = PixelFilter::kTent;
    refused(o, "filter");
    o = showing(Stage::kBins, 8, 8);
    o.want_color = false;
    refused(o, "colour");
    o.show = static_cast<Stage>(9);
    refused(o, "stage");
}

}  // namespace
}  // namespace tessera
