// Set-up of every instruction set against one lane: triangles, runs, counters and the calls to the owner.
// And what one lane makes of a triangle against the scalar path of every other engine.
#include "raster/kernel_world.h"

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

using namespace test;

class SetupKernel : public KernelTest {};

template <class T>
void expect_same_bytes(const std::vector<T>& a, const std::vector<T>& b, const std::string& what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_EQ(std::memcmp(&a[i], &b[i], sizeof(T)), 0) << what << " " << i << " of " << a.size();
}

void expect_same(const SetupResult& a, const SetupResult& b, const std::string& what) {
    expect_same_bytes(a.small, b.small, what + ", small triangle");
    expect_same_bytes(a.large, b.large, what + ", large triangle");
    expect_same_bytes(a.runs, b.runs, what + ", run");
    expect_same_bytes(a.run_tiles, b.run_tiles, what + ", tile of run");
    expect_same_bytes(a.calls, b.calls, what + ", call");
    ASSERT_EQ(std::memcmp(&a.counters, &b.counters, sizeof a.counters), 0) << what << ", counters";
}

SetupOptions options_of(Random& random) {
    SetupOptions o;
    o.one_sample = random.below(4) != 0;
    o.masks = o.one_sample && random.below(4) != 0;
    if (random.below(3) == 0)
        o.sample = {static_cast<std::int32_t>(random.below(256)), static_cast<std::int32_t>(random.below(256))};
    o.double_sided = random.below(2) == 0;
    o.tile_side = 32 << random.below(3);
    o.room = kMaxLanes + random.below(30);
    return o;
}

TEST_P(SetupKernel, SameTrianglesRunsAndCounters) {
    Random random(11);
    FrontCounters sum;
    for (const Place place : kPlaces)
        for (std::uint32_t triangles = 1; triangles < 120; triangles += triangles < 40 ? 1 : 13) {
            const KernelMesh mesh(random, place, triangles);
            const SetupOptions options = options_of(random);
            SetupResult got, want;
            set_up(kernels(), mesh, 7, options, got);
            set_up(scalar(), mesh, 7, options, want);
            expect_same(got, want,
                        "place " + std::to_string(static_cast<int>(place)) + ", " + std::to_string(triangles));
            if (HasFatalFailure()) return;
            sum.frustum += want.counters.frustum;
            sum.backface += want.counters.backface;
            sum.degenerate += want.counters.degenerate;
            sum.no_sample += want.counters.no_sample;
            sum.small += want.counters.small;
            sum.large += want.counters.large;
        }
    // Every outcome occurred, often.
    for (const std::uint64_t count : {sum.frustum, sum.backface, sum.degenerate, sum.no_sample, sum.small, sum.large})
        EXPECT_GT(count, 200u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, SetupKernel, vector_isas(), isa_name);

// A small triangle's mask against every sample of its 8x8, its depth plane against setup_triangle().
TEST(SetupByDefinition, MasksAndPlanes) {
    const FpEnvironment exact;
    Random random(12);
    int small = 0, large = 0;
    for (int round = 0; round < 300; ++round) {
        const KernelMesh mesh(random, round % 2 ? Place::kSmall : Place::kMixed, 30);
        SetupOptions options;
        options.sample = {static_cast<std::int32_t>(random.below(256)), static_cast<std::int32_t>(random.below(256))};
        SetupResult r;
        set_up(raster_kernels(Isa::kScalar), mesh, 0, options, r);
        const ProjectionView projection = KernelWorld(random).projection;
        TriangleSetup t;
        for (const SmallTriangle& s : r.small) {
            setup_triangle(mesh.instance(), s.triangle, projection, t);
            ASSERT_EQ(t.kind, TriangleSetup::Kind::kPlain);
            ASSERT_EQ(std::memcmp(&s.depth, &t.depth, sizeof s.depth), 0);
            SnappedVertex v[3] = {t.polygon[0], t.polygon[1], t.polygon[2]};
            if (t.orientation > 0) std::swap(v[1], v[2]);
            const int px = static_cast<int>(s.position & 0xffff), py = static_cast<int>(s.position >> 16);
            std::uint64_t mask = 0;
            for (int bit = 0; bit < 64; ++bit)
                if (covers(v, 256 * (px + bit % 8) + options.sample.x, 256 * (py + bit / 8) + options.sample.y))
                    mask |= std::uint64_t{1} << bit;
            ASSERT_EQ(mask, s.rows[0] | static_cast<std::uint64_t>(s.rows[1]) << 32);
            ++small;
        }
        for (const LargeTriangle& l : r.large) {
            setup_triangle(mesh.instance(), l.triangle, projection, t);
            ASSERT_TRUE(t.visible());
            ASSERT_EQ(std::memcmp(&l.depth, &t.depth, sizeof l.depth), 0);
            ASSERT_LT(twice_area(l.v[0], l.v[2], l.v[1]), 0) << "clockwise on the screen";
            ++large;
        }
    }
    EXPECT_GT(small, 1000);
    EXPECT_GT(large, 500);
}

// Who is left out, and as what: the scalar path's judgement, triangle by triangle, of all that are not handed to it.
TEST(SetupByDefinition, RejectsWhatTheScalarPathRejects) {
    const FpEnvironment exact;
    Random random(13);
    std::uint64_t outside = 0, touching = 0;
    const ProjectionView projection = KernelWorld(random).projection;
    for (int round = 0; round < 2000; ++round) {
        KernelMesh mesh(random, kPlaces[static_cast<std::size_t>(round) % std::size(kPlaces)], 60);
        // By turns moved left by 0.3 / 256 pixel: what lay on the left border is outside, and snaps to it.
        if (round / static_cast<int>(std::size(kPlaces)) % 2)
            mesh.instance().object_to_clip[2] = 0.3f / (256 * KernelMesh::kWidth / 2);
        SetupOptions options;
        options.double_sided = false;
        SetupResult r;
        set_up(raster_kernels(Isa::kScalar), mesh, 0, options, r);
        std::vector<bool> slow(mesh.triangles());
        for (const std::uint32_t call : r.calls)
            if (call >> 30 == 2) slow[call & 0x3fffffffu] = true;
        FrontCounters want;
        TriangleSetup t;
        for (std::uint32_t i = 0; i < mesh.triangles(); ++i) {
            setup_triangle(mesh.instance(), i, projection, t);
            if (slow[i]) {
                touching += t.kind == TriangleSetup::Kind::kOutside;
                continue;
            }
            ASSERT_NE(t.kind, TriangleSetup::Kind::kClipped);
            want.frustum += t.kind == TriangleSetup::Kind::kOutside;
            want.degenerate += t.kind == TriangleSetup::Kind::kDegenerate;
            want.backface += t.kind == TriangleSetup::Kind::kPlain && !t.front(mesh.instance());
        }
        ASSERT_EQ(r.counters.frustum, want.frustum) << round;
        ASSERT_EQ(r.counters.degenerate, want.degenerate) << round;
        ASSERT_EQ(r.counters.backface, want.backface) << round;
        outside += want.frustum;
    }
    EXPECT_GT(outside, 500u);
    EXPECT_GT(touching, 5u);
}

}  // namespace
}  // namespace tessera
