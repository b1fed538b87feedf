// What tunes the tile rasterizer changes no byte of any plane.
#include <gtest/gtest.h>

#include "render/scenes.h"

namespace tessera {
namespace {

using namespace test;

TEST(Tuning, BEY1_TileSidesHierarchicalZAndCountingChangeNoByte) {
    std::uint64_t hidden = 0;
    for (const char* name : {"spheres.gltf", "transparency.gltf", "materials.gltf", "hierarchy.gltf"}) {
        const Scene scene = scene_file(name);
        for (const int samples : {1, 3}) {
            RenderOptions o = small(301, 190, samples);
            o.want_depth = o.want_primitive = true;
            o.engine = Engine::kReferenceRaster;
            const RenderResult reference = render(scene, o);
            o.engine = Engine::kRaster;
            for (const int side : {32, 64, 128})
                for (const int tuning : {0, 1, 2, 3}) {
                    const bool hierarchical_z = (tuning & 1) != 0, count = (tuning & 2) != 0;
                    o.raster = {side, hierarchical_z, count};
                    const RenderResult r = render(scene, o);
                    const std::string what =
                        std::string(name) + " " + std::to_string(side) + ", " + std::to_string(tuning);
                    EXPECT_EQ(r.stats.tile_side, side);
                    hidden += r.stats.blocks_hidden;
                    if (!hierarchical_z) {
                        EXPECT_EQ(r.stats.blocks_hidden, 0u) << what;
                    }
                    if (count) {
                        EXPECT_EQ(r.stats.fragments_passed, reference.stats.fragments_passed) << what;
                    }
                    EXPECT_TRUE(same_bytes(reference.color, r.color)) << what;
                    EXPECT_TRUE(same_bytes(reference.linear, r.linear)) << what;
                    EXPECT_TRUE(same_bytes(reference.depth, r.depth)) << what;
                    EXPECT_TRUE(same_bytes(reference.primitive, r.primitive)) << what;
                    EXPECT_EQ(reference.stats.pixels_covered, r.stats.pixels_covered) << what;
                }
        }
    }
    EXPECT_GT(hidden, 0u);
}

}  // namespace
}  // namespace tessera
