// Edges as long as the guard band allows, through tiles as large as the picture allows: 32 bits must do, in
// pictures of 8192 pixels with tiles of 128, of 16384 with tiles of 64.
#include "raster/tile_jobs.h"

#include <cmath>

namespace tessera {
namespace {

using namespace test;

class LongEdges : public KernelTest {};

// The point of the guard band's border that a ray from inside it meets.
SnappedVertex on_border(double x, double y, double angle, int picture) {
    const double middle = 128.0 * picture, reach = static_cast<double>(kGuardBand) * 128.0 * picture;
    const double dx = std::cos(angle), dy = std::sin(angle);
    const auto steps = [&](double at, double d) {
        return d == 0 ? 1e30 : ((d > 0 ? middle + reach : middle - reach) - at) / d;
    };
    const double t = std::fmin(steps(x, dx), steps(y, dy));
    const auto clamped = [&](double v) {
        return static_cast<std::int32_t>(std::fmin(std::fmax(v, middle - reach), middle + reach));
    };
    return {clamped(x + dx * t), clamped(y + dy * t)};
}

// A triangle with one edge through the tile, from border to border, and its last vertex on the border too.
LargeTriangle long_triangle(Random& random, int x0, int y0, int side, int picture) {
    const double x = 256.0 * x0 + 256.0 * static_cast<double>(random.in(0, static_cast<float>(side))),
                 y = 256.0 * y0 + 256.0 * static_cast<double>(random.in(0, static_cast<float>(side)));
    constexpr double kPi = 3.14159265358979;
    // Diagonals are the longest in both directions.
    const double angle = random.below(3) ? random.in(0, 6.2831853f) : kPi / 4 + kPi / 2 * random.below(4);
    LargeTriangle t{};
    t.v[0] = on_border(x, y, angle, picture);
    t.v[1] = on_border(x, y, angle + kPi, picture);
    t.v[2] = on_border(x, y, angle + random.in(0.3f, 2.8f), picture);
    if (random.below(3) == 0) t.v[random.below(3)] = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
    if (twice_area(t.v[0], t.v[1], t.v[2]) < 0) std::swap(t.v[1], t.v[2]);
    t.depth = {t.v[0].x, t.v[0].y, 0.5f, 0, 0, 0.5f, 0.5f};
    return t;
}

TEST_P(LongEdges, RAS1_CoverageIsExact) {
    Random random(400);
    KernelWorld drawn(random);
    const KernelMesh mesh(random, Place::kSmall, 1);
    drawn.add(mesh, 0);
    const SurfaceSource source = drawn.source();
    std::uint64_t covered = 0, partly = 0;
    for (int round = 0; round < 400; ++round) {
        const int side = round % 2 ? 128 : 64, picture = round % 2 ? 8192 : 16384, tiles = picture / side;
        const auto tile = [&] {  // any, or one at the border
            const int last = tiles - 1;
            return random.below(2)   ? static_cast<int>(random.below(static_cast<std::uint32_t>(tiles)))
                   : random.below(2) ? 0
                                     : last;
        };
        VisibilityJob job{};
        job.x0 = side * tile();
        job.y0 = side * tile();
        job.side = side;
        job.offset = {static_cast<std::int32_t>(random.below(256)), static_cast<std::int32_t>(random.below(256))};
        const LargeTriangle t = long_triangle(random, job.x0, job.y0, side, picture);
        const BinRun run{0, 1 | BinRun::kLarge};
        const TileBin bin{nullptr, &t, &run, 1};
        job.bins = &bin;
        job.bin_count = 1;
        job.source = &source;
        job.count = round % 3 == 0;
        job.hierarchical_z = round % 5 == 0;
        VisibilityRun got(side, 1), want(side, 1);
        got.clear(side, side, side);
        want.clear(side, side, side);
        got.run(kernels(), job);
        want.run(scalar(), job);
        ASSERT_TRUE(same_bytes(got.ordinal, want.ordinal)) << round;
        ASSERT_TRUE(same_bytes(got.depth, want.depth)) << round;
        std::uint64_t here = 0;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const bool inside = covers(t.v, 256 * (job.x0 + x) + job.offset.x, 256 * (job.y0 + y) + job.offset.y);
                ASSERT_EQ(want.ordinal[place_of(x, y, side)], inside ? 1u : 0u) << round << ", pixel " << x << " " << y;
                here += inside;
            }
        covered += here;
        partly += here > 0 && here < tile_pixels(side);
    }
    EXPECT_GT(covered, 100000u);
    EXPECT_GT(partly, 200u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, LongEdges, testing::Values(Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512),
                         isa_name);

}  // namespace
}  // namespace tessera
