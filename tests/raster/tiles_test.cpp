// What meets in a tile or at its borders: equal depths, alpha modes, tiles that pictures are too large for,
// limits and counts.
#include "raster/exactness.h"

#include "cli/workloads.h"
#include "geometry/frame.h"
#include "shading/surface.h"
#include "simd/isa.h"

#include <algorithm>

namespace tessera {
namespace {

using namespace test;

// Two grids in one plane, in chunks of their own, without a triangle in common: the first drawn is seen.
TEST(RasterTiles, RAS5_EqualDepthsAcrossChunksAndTilesGoToTheLowerNumber) {
    Scene scene;
    add_material(scene, unlit({1, 0, 0, 1}));
    add_material(scene, unlit({0, 1, 0, 1}));
    add_mesh(scene, level_grid(40, 0.9f, 0, 0));
    add_mesh(scene, level_grid(47, 0.9f, 0, 1));
    add_mesh(scene, level_grid(5, 0.9f, 0, 1));
    add_orthographic(scene);
    RenderOptions o = all_planes(256, 256, 1);
    for (const bool other_way : {false, true}) {
        const Scene drawn = other_way ? reversed(scene) : scene;
        expect_exact(drawn, o, "grids");
        const RenderResult r = render(drawn, o);
        const std::uint32_t own = 2 * (other_way ? 5u * 5 : 40u * 40);
        std::uint64_t covered = 0;
        for (std::size_t i = 0; i < std::size_t{256} * 256; ++i) {
            const std::uint32_t number = r.primitive.data<std::uint32_t>()[i];
            ASSERT_LE(number, own);
            covered += number != 0;
        }
        EXPECT_NEAR(static_cast<double>(covered), 0.81 * 256 * 256, 1000);
    }
}

// Glass over and under leaves with holes, over solid ground, at the same depth here and there.
TEST(RasterTiles, RAS6_OpaqueCutOutAndTransparentInOneTile) {
    Scene scene;
    for (const AlphaMode mode : {AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend}) {
        Material m = mode == AlphaMode::kMask ? lambert({0.2f, 0.8f, 0.2f}) : unlit({0.3f, 0.4f, 0.9f, 0.55f});
        m.alpha_mode = mode;
        add_material(scene, m);
    }
    for (int layer = 0; layer < 12; ++layer) {
        Primitive p = level_grid(3 + layer, 0.95f - 0.05f * static_cast<float>(layer % 5),
                                 0.25f * static_cast<float>(layer / 2), layer % 3);
        if (layer % 3 == 1) {
            p.colors.emplace_back();
            for (std::size_t i = 0; i < p.positions.size(); ++i)
                p.colors[0].push_back({1, 1, 1, i % 3 == 0 ? 0.1f : 0.9f});
        }
        if (layer % 4 == 3)  // tilted, so that it crosses the others
            for (Vec3& v : p.positions) v.z += 0.8f * v.x;
        add_mesh(scene, p);
    }
    add_orthographic(scene);
    for (const int samples : {1, 4}) {
        expect_exact(scene, all_planes(97, 64, samples), "layers");
        expect_exact(reversed(scene), all_planes(64, 97, samples), "layers, reversed");
    }
}

// 32-bit edges reach over 128 pixels up to pictures of 8192; beyond, tiles of 64 are taken in their place.
TEST(RasterTiles, RAS1_WideAndHighPicturesOfLargeTiles) {
    const Scene scene = triangles_around_the_camera(8);
    for (const auto& [width, height] : {std::pair(8192, 33), std::pair(9000, 40), std::pair(40, 9000)}) {
        RenderOptions o = all_planes(width, height, 1);
        o.view = look_from({0, 0, 1}, {0, 0, -1});
        o.engine = Engine::kReferenceRaster;
        const RenderResult reference = render(scene, o);
        EXPECT_GT(reference.stats.pixels_covered, 1000u);
        o.engine = Engine::kRaster;
        for (const Isa isa : all_isas())
            for (const int side : {128, 64}) {
                o.isa = isa;
                o.raster.tile_side = side;
                const RenderResult r = render(scene, o);
                expect_equal(reference, r, std::to_string(width) + ", tiles of " + std::to_string(side));
                EXPECT_EQ(r.stats.tile_side, width <= 8192 && height <= 8192 ? side : 64);
            }
    }
}

TEST(RasterTiles, OtherSidesAreRefusedByName) {
    const Scene scene = triangles_around_the_camera(8);
    RenderOptions o = all_planes(64, 64, 1);
    for (const int side : {-1, 1, 16, 48, 256}) {
        o.raster.tile_side = side;
        try {
            render(scene, o);
            ADD_FAILURE() << side;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::kUsage);
            EXPECT_NE(std::string(e.what()).find("tile"), std::string::npos) << e.what();
        }
    }
}

// Samples inside the triangles of the soup by definition: vertices transformed and snapped as the contract
// says, edges in 64 bits, one triangle and one sample after the other.
std::uint64_t samples_inside(const Scene& scene, const View& view, int width, int height) {
    const Frame frame = make_frame(scene, view, width, height);
    std::uint64_t count = 0;
    for (const InstanceView& instance : frame.instances)
        for (std::uint32_t t = 0; t < instance.mesh.triangle_count; ++t) {
            std::int64_t x[3], y[3];
            for (std::size_t k = 0; k < 3; ++k) {
                const float* p = instance.mesh.positions + 3 * std::size_t{instance.mesh.triangles[3 * t + k]};
                const PictureVertex<float> v = to_picture(to_clip(instance.object_to_clip, Vec3T<float>::load(p)),
                                                          static_cast<float>(width), static_cast<float>(height));
                x[k] = v.snapped_x;
                y[k] = v.snapped_y;
            }
            // Clockwise on the screen; all of them face the camera.
            std::swap(x[1], x[2]);
            std::swap(y[1], y[2]);
            const auto from = [](std::int64_t low) { return std::max<std::int64_t>((low - 128 + 255) >> 8, 0); };
            for (std::int64_t py = from(std::min({y[0], y[1], y[2]}));
                 py < height && 256 * py + 128 <= std::max({y[0], y[1], y[2]}); ++py)
                for (std::int64_t px = from(std::min({x[0], x[1], x[2]}));
                     px < width && 256 * px + 128 <= std::max({x[0], x[1], x[2]}); ++px) {
                    bool inside = true;
                    for (int k = 0; k < 3 && inside; ++k) {
                        const std::int64_t dx = x[(k + 1) % 3] - x[k], dy = y[(k + 1) % 3] - y[k];
                        const std::int64_t e = dx * (256 * py + 128 - y[k]) - dy * (256 * px + 128 - x[k]);
                        inside = e > 0 || (e == 0 && (dy < 0 || (dy == 0 && dx > 0)));
                    }
                    count += inside;
                }
        }
    return count;
}

// Every sample inside a triangle is tested for depth once. The published count is that of vertices
// transformed and snapped in double; roundings of the float transform move some of 60,000 vertices by
// 1/256 pixel, and with them a few of 16 million samples.
TEST(RasterTiles, BEY1_SamplesTestedOfTheSoup) {
    cli::Workload w = cli::make_workload("soup20k", 1920, 1080);
    constexpr double kPublished = 16406083;
    const std::uint64_t inside = samples_inside(w.scene, w.options.view, 1920, 1080);
    EXPECT_NEAR(static_cast<double>(inside), kPublished, 16);
    w.options.raster.hierarchical_z = false;
    w.options.raster.count_samples = true;
    w.options.want_color = false;
    w.options.want_depth = true;
    for (const Isa isa : all_isas()) {
        w.options.isa = isa;
        const RenderResult r = render(w.scene, w.options);
        EXPECT_EQ(r.stats.samples_tested, inside) << name(isa);
        EXPECT_EQ(r.stats.pixels_covered, 2072594u) << name(isa);
        EXPECT_EQ(r.stats.blocks_hidden, 0u);
    }
    w.options.raster.hierarchical_z = true;
    const RenderResult r = render(w.scene, w.options);
    EXPECT_LT(r.stats.samples_tested, inside);
    EXPECT_EQ(r.stats.pixels_covered, 2072594u);
}

// Vertices at the eye, where w is 0, and in its plane.
TEST(RasterTiles, RAS2_VerticesAtTheEye) {
    Scene scene;
    add_material(scene, unlit({1, 1, 1, 1}));
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, -2}, {0, 1, -2}, {-1, -0.5f, -1}, {1, -0.5f, -1}, {0, -0.1f, -1}, {2, 1, 0}};
    p.normals.assign(7, {0, 0, 1});
    p.indices = {0, 1, 2, 3, 4, 5, 0, 4, 5, 6, 4, 2, 0, 6, 5, 0, 0, 0};
    p.material = 0;
    add_mesh(scene, p);
    RenderOptions o = all_planes(64, 48, 1);
    o.view = look_from({0, 0, 0}, {0, 0, -1});
    expect_exact(scene, o, "eye");
    const RenderResult r = render(scene, o);
    EXPECT_GT(r.stats.clipped, 0u);
    EXPECT_GT(r.stats.culled_degenerate, 2u) << "seen from a point of its own plane a triangle has no area";
    EXPECT_GT(r.stats.pixels_covered, 100u);
}

TEST(RasterTiles, CancellingAndTheFragmentLimitReachTheCaller) {
    Scene scene;
    Material glass = unlit({1, 1, 1, 0.5f});
    glass.alpha_mode = AlphaMode::kBlend;
    const int m = add_material(scene, glass);
    for (int i = 0; i < 40; ++i) add_mesh(scene, rectangle(1, 1, static_cast<float>(i) * 0.1f, m));
    add_orthographic(scene);
    RenderOptions o = small(128, 128);
    o.engine = Engine::kRaster;
    const auto code = [&] {
        try {
            render(scene, o);
        } catch (const Error& e) {
            return e.code();
        }
        return ErrorCode::kInternal;
    };
    o.max_bytes = 128 * 128 * 30;
    EXPECT_EQ(code(), ErrorCode::kLimit);
    o.max_bytes = std::uint64_t{1} << 30;
    EXPECT_NO_THROW(render(scene, o));
    o.cancel = [] { return true; };
    EXPECT_EQ(code(), ErrorCode::kCancelled);
}

}  // namespace
}  // namespace tessera
