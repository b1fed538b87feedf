// Points and lines in every engine and on every instruction set: the same bits as the reference, whatever the camera.
#include "raster/exactness.h"

#include <random>
#include <string>

namespace tessera {
namespace {

using namespace test;

// All modes and alpha modes, with normals and without, near and far, behind the camera and through the near plane, at a
// node that mirrors, over a wall.
Scene strokes_around(unsigned seed, float reach) {
    std::mt19937 random(seed);
    const auto in = [&](float low, float high) {
        return low + (high - low) * static_cast<float>(random() % 65536) / 65535.0f;
    };
    Scene scene;
    for (const AlphaMode mode : {AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend}) {
        Material m;
        m.base_color = {in(0.3f, 1), in(0.3f, 1), in(0.3f, 1), 0.6f};
        m.alpha_mode = mode;
        add_material(scene, m);
    }
    add_mesh(scene, rectangle(2, 2, -1, kNone));
    for (int i = 0; i < 16; ++i) {
        Primitive p;
        p.mode = static_cast<PrimitiveMode>(i % 4);
        p.material = i / 4 == 3 ? kNone : i / 4;
        p.colors.resize(i % 3 == 0 ? 0 : 1);
        for (int v = 0; v < 60; ++v) {
            const float size = v % 5 == 0 ? reach : 2;
            p.positions.push_back({in(-size, size), in(-size, size), in(-size, size)});
            if (i % 2) p.normals.push_back(normalize({in(-1, 1), in(-1, 1), in(0.1f, 1)}));
            if (!p.colors.empty()) p.colors[0].push_back({in(0, 1), in(0, 1), in(0, 1), in(0, 1)});
        }
        if (i % 5 == 0)
            for (int v = 0; v < 71; ++v) p.indices.push_back(static_cast<std::uint32_t>(random() % 60));
        add_mesh(scene, std::move(p));
        if (i % 7 == 0) scene.nodes.back().scale = {-1, 1, 1};
    }
    return scene;
}

TEST(Strokes, CARD3_PointsAndLinesHaveTheBitsOfTheReference) {
    unsigned seed = 1;
    for (const float reach : {2.5f, 1e4f, 1e12f})
        for (const auto& [size, line] : {std::pair(2.0f, 1.0f), std::pair(9.5f, 3.5f), std::pair(70.0f, 40.0f)})
            for (const int samples : {1, 4}) {
                RenderOptions o = all_planes(129, 97, samples);
                o.view = look_from({0, 0, 1}, {0, 0, -1});
                o.point_size = size, o.line_width = line;
                const Scene scene = strokes_around(seed++, reach);
                expect_exact(scene, o, std::to_string(reach) + " " + std::to_string(size));
                EXPECT_GT(render(scene, o).stats.clipped + render(scene, o).stats.large_triangles, 0u);
            }
}

TEST(Strokes, CARD3_WithoutPerspectiveToo) {
    for (unsigned seed = 20; seed < 24; ++seed) {
        Scene scene = strokes_around(seed, 3);
        add_orthographic(scene);
        RenderOptions o = all_planes(100, 60, seed % 2 ? 4 : 1);
        o.point_size = 6, o.line_width = 2;
        expect_exact(scene, o, "orthographic");
    }
}

// Small ones are masks, which other tests of lines alone in a picture have, too; many at once share vectors and tiles.
TEST(Strokes, CARD3_ManyShortLinesInOneVector) {
    std::mt19937 random(5);
    Scene scene;
    Primitive p;
    p.mode = PrimitiveMode::kLines;
    for (int i = 0; i < 20000; ++i) {
        const float x = static_cast<float>(random() % 2048) / 1024 - 1,
                    y = static_cast<float>(random() % 2048) / 1024 - 1;
        p.positions.push_back({x, y, 0});
        p.positions.push_back({x + static_cast<float>(random() % 65) / 1024 - 0.03125f,
                               y + static_cast<float>(random() % 65) / 1024 - 0.03125f, 0});
    }
    add_mesh(scene, std::move(p));
    add_orthographic(scene);
    RenderOptions o = all_planes(256, 256, 1);
    expect_exact(scene, o, "short lines");
    EXPECT_GT(render(scene, o).stats.small_triangles, 10000u);
    o.line_width = 2.5f;
    expect_exact(scene, o, "short lines, wider");
}

}  // namespace
}  // namespace tessera
