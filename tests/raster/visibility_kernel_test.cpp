// Visibility of every instruction set against one lane, and of one lane against 64-bit edges and a plain
// depth test at every pixel.
#include "raster/tile_jobs.h"

namespace tessera {
namespace {

using namespace test;

struct Setting {
    Random random;
    KernelWorld world;
    std::vector<std::unique_ptr<KernelMesh>> meshes;
    SetupOptions options;
    bool hierarchical_z, count, overdraw;

    Setting(std::uint32_t seed, Place place) : random(seed), world(random) {
        const std::uint32_t instances = 1 + random.below(4);
        for (std::uint32_t i = 0; i < instances; ++i)
            meshes.push_back(std::make_unique<KernelMesh>(random, place, 1 + random.below(60)));
        options.tile_side = 32 << random.below(3);
        options.one_sample = random.below(4) != 0;
        if (random.below(3) == 0)
            options.sample = {static_cast<std::int32_t>(random.below(256)),
                              static_cast<std::int32_t>(random.below(256))};
        hierarchical_z = random.below(3) != 0;
        count = random.below(4) != 0;
        overdraw = count && random.below(2);
    }
    // The job of a tile, without the arrays.
    VisibilityJob job(const TileScene& scene, const SurfaceSource& source, int column, int row) const {
        VisibilityJob j{};
        j.side = options.tile_side;
        j.x0 = column * j.side;
        j.y0 = row * j.side;
        j.offset = options.sample;
        j.bins = scene.bins.data();
        j.bin_count = static_cast<std::uint32_t>(scene.bins.size());
        j.source = &source;
        j.hierarchical_z = hierarchical_z;
        j.count = count;
        static std::uint32_t wanted;
        j.overdraw = overdraw ? &wanted : nullptr;
        return j;
    }
};

// Calls visit(scene, job, triangles) for every tile of random scenes of every kind.
template <class Visit>
void for_each_tile(std::uint32_t seed, int rounds, Visit&& visit) {
    for (const Place place : kPlaces)
        for (int round = 0; round < rounds; ++round) {
            Setting s(seed++, place);
            TileScene scene(s.random, s.world, s.meshes, s.options);
            const SurfaceSource source = s.world.source();
            for (int row = 0; row < scene.rows(); ++row)
                for (int column = 0; column < scene.columns(); ++column) {
                    const std::uint32_t triangles =
                        scene.bin(static_cast<std::uint32_t>(row * scene.columns() + column));
                    visit(s, s.job(scene, source, column, row), triangles);
                    if (testing::Test::HasFatalFailure()) return;
                }
        }
}

class VisibilityKernel : public KernelTest {};

void expect_same(const VisibilityRun& got, const VisibilityRun& want) {
    ASSERT_FALSE(got.wrote_before() || want.wrote_before());
    ASSERT_TRUE(same_bytes(got.depth, want.depth));
    ASSERT_TRUE(same_bytes(got.ordinal, want.ordinal));
    ASSERT_TRUE(same_bytes(got.floor, want.floor));
    ASSERT_TRUE(same_bytes(got.overdraw, want.overdraw));
    ASSERT_TRUE(same_bytes(got.triangles, want.triangles));
    ASSERT_EQ(std::memcmp(&got.counters, &want.counters, sizeof got.counters), 0);
    ASSERT_EQ(got.fragments.size(), want.fragments.size());
    if (!got.fragments.empty()) {
        ASSERT_EQ(std::memcmp(got.fragments.data(), want.fragments.data(),
                              got.fragments.size() * sizeof(VisibilityRun::Fragment)),
                  0);
    }
}

TEST_P(VisibilityKernel, SameDepthsOrdinalsFloorsAndCounters) {
    std::uint64_t passed = 0, hidden = 0, fragments = 0;
    for_each_tile(100, 12, [&](const Setting& s, const VisibilityJob& job, std::uint32_t triangles) {
        const int side = job.side;
        // Some pictures end within the tile.
        const int width = s.options.sample.x % 2 ? side - 5 : side, height = s.options.sample.y % 2 ? 3 : side;
        VisibilityRun got(side, triangles), want(side, triangles);
        for (VisibilityRun* r : {&got, &want}) r->clear(side, width, height);
        got.run(kernels(), job);
        want.run(scalar(), job);
        expect_same(got, want);
        passed += want.counters.fragments_passed;
        hidden += want.counters.blocks_hidden;
        fragments += want.fragments.size();
    });
    EXPECT_GT(passed, 100000u);
    EXPECT_GT(hidden, 100u);
    EXPECT_GT(fragments, 10000u);
}

// Masks of every shape, whole ones too, at every place that meets the tile; level ones at equal depths.
TEST_P(VisibilityKernel, MasksOverTheBordersOfTheTile) {
    Random random(300);
    const KernelWorld world(random);
    const SurfaceSource source = world.source();
    std::uint64_t covered = 0;
    for (int round = 0; round < 60; ++round) {
        const int side = 32 << round % 3;
        GuardedArray<SmallTriangle> small(200);
        for (std::size_t i = 0; i < small.size(); ++i) {
            const auto at = [&] {  // on a border, or anywhere
                const int inside = static_cast<int>(random.below(static_cast<std::uint32_t>(side) + 7)) - 7;
                return side + (random.below(3)   ? inside
                               : random.below(2) ? -static_cast<int>(random.below(8))
                                                 : side - 1 - static_cast<int>(random.below(8)));
            };
            const int x = at(), y = at();
            const auto rows = [&] { return random.below(3) ? random.below(~0u) : ~0u; };
            const bool level = random.below(3) == 0;
            const auto slope = [&] { return level ? 0.0f : random.in(-1e-4f, 1e-4f); };
            const float depth = level ? 0.25f * static_cast<float>(random.below(4)) : random.in(0, 1);
            small[i] = {{256 * x + static_cast<int>(random.below(2000)), 256 * y - 77, depth, slope(), slope(),
                         level ? depth : 0.1f, level ? depth : 0.9f},
                        static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y) << 16,
                        {rows(), rows()},
                        static_cast<std::uint32_t>(i),
                        0};
        }
        const BinRun runs[] = {{0, 1}, {1, 120}, {130, 70}};
        const TileBin bin{small.data(), nullptr, runs, 3};
        VisibilityJob job{};
        job.x0 = job.y0 = job.side = side;
        job.offset = {static_cast<std::int32_t>(random.below(256)), 128};
        job.bins = &bin;
        job.bin_count = 1;
        job.source = &source;
        job.count = round % 4 != 0;
        std::uint32_t wanted;
        job.overdraw = round % 4 == 1 ? &wanted : nullptr;
        VisibilityRun got(side, 191), want(side, 191);
        const int width = round % 2 ? side : side - 11;
        got.clear(side, width, side);
        want.clear(side, width, side);
        got.run(kernels(), job);
        want.run(scalar(), job);
        expect_same(got, want);
        covered += want.counters.samples_covered;
        // By definition.
        VisibilityRun plain(side, 191);
        plain.clear(side, width, side);
        std::uint32_t ordinal = 0;
        for (const BinRun& run : runs)
            for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
                const SmallTriangle& t = small[i];
                ++ordinal;
                for (int bit = 0; bit < kBlockPixels; ++bit) {
                    const int x = static_cast<int>(t.position & 0xffff) + bit % 8 - side,
                              y = static_cast<int>(t.position >> 16) + bit / 8 - side;
                    if (!(t.rows[bit / 32] >> bit % 32 & 1) || x < 0 || y < 0 || x >= side || y >= side) continue;
                    const float z = t.depth.at(256 * (side + x) + job.offset.x, 256 * (side + y) + job.offset.y);
                    const std::size_t place = place_of(x, y, side);
                    if (!(z > plain.depth[place])) continue;
                    plain.depth[place] = z;
                    plain.ordinal[place] = ordinal;
                }
            }
        ASSERT_TRUE(same_bytes(want.depth, plain.depth));
        ASSERT_TRUE(same_bytes(want.ordinal, plain.ordinal));
    }
    EXPECT_GT(covered, 100000u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, VisibilityKernel, vector_isas(), isa_name);

// Opaque triangles only: every covered sample against the depth there, triangle after triangle; the floors
// below every depth of their block.
TEST(VisibilityByDefinition, DepthTestAtEverySample) {
    const FpEnvironment exact;
    std::uint64_t covered = 0;
    for_each_tile(500, 10, [&](const Setting& s, const VisibilityJob& job, std::uint32_t triangles) {
        const int side = job.side;
        for (const InstanceView& i : s.world.instances())
            if (s.world.material(i.material).alpha_mode != AlphaMode::kOpaque) return;
        VisibilityRun got(side, triangles), want(side, triangles);
        got.clear(side, side, side);
        want.clear(side, side, side);
        got.run(raster_kernels(Isa::kScalar), job);
        std::uint32_t ordinal = 0;
        for (std::uint32_t b = 0; b < job.bin_count; ++b)
            for (std::uint32_t r = 0; r < job.bins[b].run_count; ++r) {
                const BinRun run = job.bins[b].runs[r];
                for (std::uint32_t i = run.first; i < run.first + run.size(); ++i) {
                    ++ordinal;
                    const std::uint32_t number =
                        run.large() ? job.bins[b].large[i].triangle : job.bins[b].small[i].triangle;
                    const std::uint32_t instance =
                        run.large() ? job.bins[b].large[i].instance : job.bins[b].small[i].instance;
                    TriangleSetup t;
                    setup_triangle(s.world.instances()[instance], number, s.world.projection, t);
                    SnappedVertex v[3];
                    if (run.large())
                        std::copy_n(job.bins[b].large[i].v, 3, v);
                    else
                        for (int k = 0; k < 3; ++k) v[k] = t.polygon[t.orientation > 0 ? (3 - k) % 3 : k];
                    for (int y = 0; y < side; ++y)
                        for (int x = 0; x < side; ++x) {
                            const std::int32_t sx = 256 * (job.x0 + x) + job.offset.x,
                                               sy = 256 * (job.y0 + y) + job.offset.y;
                            if (!covers(v, sx, sy)) continue;
                            ++covered;
                            const std::size_t at = place_of(x, y, side);
                            const float z = t.depth.at(sx, sy);
                            if (!(z > want.depth[at])) continue;
                            want.depth[at] = z;
                            want.ordinal[at] = ordinal;
                        }
                }
            }
        ASSERT_TRUE(same_bytes(got.depth, want.depth));
        ASSERT_TRUE(same_bytes(got.ordinal, want.ordinal));
        for (std::size_t i = 0; i < got.depth.size(); ++i) ASSERT_LE(got.floor[i / kBlockPixels], got.depth[i]);
    });
    EXPECT_GT(covered, 100000u);
}

}  // namespace
}  // namespace tessera
