// Large records of few pixels, which visibility draws by their box, and those just beyond that size: every
// instruction set against one lane, and one lane against edges in 64 bits and a plain depth test.
#include "raster/tile_jobs.h"

namespace tessera {
namespace {

using namespace test;

class MediumTriangles : public KernelTest {};

// A triangle whose box is about `pixels` wide and high, at (x, y) or thereabouts.
LargeTriangle triangle_at(Random& random, int x, int y, int pixels, std::uint32_t number, SamplePosition sample) {
    LargeTriangle t{};
    const bool on_samples = random.below(4) == 0, sliver = random.below(5) == 0;
    do {
        for (int k = 0; k < 3; ++k) {
            const auto place = [&](int first, std::int32_t part, bool thin) {
                const auto reach = static_cast<std::uint32_t>(thin ? 300 : 256 * pixels + 1);
                const auto at = static_cast<std::int32_t>(random.below(reach));
                return 256 * first + (on_samples ? (at & -256) + part : at);
            };
            t.v[k] = {place(x, sample.x, false), place(y, sample.y, sliver)};
        }
        // As far apart as the box is wide, often exactly.
        if (random.below(2)) t.v[1].x = t.v[0].x + 256 * pixels;
        if (random.below(2)) t.v[2].y = t.v[0].y + (sliver ? 1 : 256 * pixels);
    } while (twice_area(t.v[0], t.v[1], t.v[2]) == 0);
    if (twice_area(t.v[0], t.v[1], t.v[2]) < 0) std::swap(t.v[1], t.v[2]);
    const bool level = random.below(3) == 0;
    const auto slope = [&] { return level ? 0.0f : random.in(-1e-4f, 1e-4f); };
    const float depth = level ? 0.25f * static_cast<float>(random.below(4)) : random.in(0, 1);
    t.depth = {t.v[0].x, t.v[0].y, depth, slope(), slope(), level ? depth : 0.1f, level ? depth : 0.9f};
    t.triangle = number;
    return t;
}

TEST_P(MediumTriangles, OverTheBordersOfTheTile) {
    Random random(700);
    KernelWorld world(random);
    const KernelMesh mesh(random, Place::kSmall, 1);
    std::uint32_t opaque = 0;
    while (world.material(opaque).alpha_mode != AlphaMode::kOpaque) ++opaque;
    world.add(mesh, opaque);
    const SurfaceSource source = world.source();
    std::uint64_t covered = 0;
    for (int round = 0; round < 120; ++round) {
        const int side = 32 << round % 3;
        VisibilityJob job{};
        job.x0 = job.y0 = job.side = side;
        job.offset = {static_cast<std::int32_t>(random.below(256)), round % 2 ? 128 : 255};
        GuardedArray<LargeTriangle> large(90);
        for (std::uint32_t i = 0; i < large.size(); ++i) {
            const int pixels = 1 + static_cast<int>(random.below(19));
            const auto at = [&] {  // across a border, or anywhere
                const auto inside = static_cast<int>(random.below(static_cast<std::uint32_t>(side)));
                const int back = static_cast<int>(random.below(static_cast<std::uint32_t>(pixels) + 2));
                return side + (random.below(3) ? inside : (random.below(2) ? 0 : side) - back);
            };
            const int x = at(), y = at();
            large[i] = triangle_at(random, x, y, pixels, i, job.offset);
        }
        const BinRun runs[] = {{3, 1 | BinRun::kLarge}, {5, 85 | BinRun::kLarge}};
        const TileBin bin{nullptr, large.data(), runs, 2};
        job.bins = &bin;
        job.bin_count = 1;
        job.source = &source;
        job.hierarchical_z = round % 5 != 0;
        job.count = round % 4 != 0;
        std::uint32_t wanted;
        job.overdraw = round % 4 == 1 ? &wanted : nullptr;
        const int width = round % 7 ? side : side - 11;
        VisibilityRun got(side, 86), want(side, 86), plain(side, 86);
        for (VisibilityRun* r : {&got, &want, &plain}) r->clear(side, width, side);
        got.run(kernels(), job);
        want.run(scalar(), job);
        ASSERT_FALSE(got.wrote_before() || want.wrote_before());
        ASSERT_TRUE(same_bytes(got.depth, want.depth));
        ASSERT_TRUE(same_bytes(got.ordinal, want.ordinal));
        ASSERT_TRUE(same_bytes(got.floor, want.floor));
        ASSERT_TRUE(same_bytes(got.overdraw, want.overdraw));
        ASSERT_EQ(std::memcmp(&got.counters, &want.counters, sizeof got.counters), 0);
        // By definition.
        TileCounters counted;
        std::uint32_t ordinal = 0;
        for (const BinRun& run : runs)
            for (std::uint32_t i = run.first; i < run.first + run.size(); ++i) {
                const LargeTriangle& t = large[i];
                ++ordinal;
                ASSERT_EQ(want.triangles[ordinal - 1].triangle, i);
                for (int y = 0; y < side; ++y)
                    for (int x = 0; x < side; ++x) {
                        const std::int32_t sx = 256 * (side + x) + job.offset.x, sy = 256 * (side + y) + job.offset.y;
                        if (!covers(t.v, sx, sy)) continue;
                        const std::size_t at = place_of(x, y, side);
                        const float z = t.depth.at(sx, sy);
                        counted.samples_covered += x < width;
                        if (!(z > plain.depth[at])) continue;
                        ++counted.fragments_passed;
                        plain.depth[at] = z;
                        plain.ordinal[at] = ordinal;
                    }
            }
        ASSERT_TRUE(same_bytes(want.depth, plain.depth));
        ASSERT_TRUE(same_bytes(want.ordinal, plain.ordinal));
        for (std::size_t i = 0; i < want.depth.size(); ++i) ASSERT_LE(want.floor[i / kBlockPixels], want.depth[i]);
        if (job.count) {
            ASSERT_EQ(want.counters.fragments_passed, counted.fragments_passed);
            // What hierarchical Z leaves out is not tested.
            if (!job.hierarchical_z) {
                ASSERT_EQ(want.counters.samples_covered, counted.samples_covered);
            }
        }
        covered += counted.samples_covered;
    }
    EXPECT_GT(covered, 100000u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, MediumTriangles, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
