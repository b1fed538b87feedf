// What is built, refitted and kept from frame to frame; limits; the host's threads.
#include "core/parallel.h"
#include "simd/guarded_memory.h"
#include "trace/trace_frame.h"

#include <tessera/error.h>

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>

#if !defined(TESSERA_STD_THREADS)
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#endif

namespace tessera {
namespace {

using namespace test;

std::vector<Ray> random_rays(Random& random, int count) {
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) rays.push_back(random_ray(random));
    return rays;
}

class EmbreeUpdate : public testing::TestWithParam<Isa> {
  protected:
    void expect_the_references(const TraceFrame& f) {
        const std::vector<Ray> rays = random_rays(random_, 800);
        const Agreement a = compare(Truth(f), rays, nearest<16>(scene_, rays));
        EXPECT_EQ(a.wrong, 0) << "of " << a.hit;
        EXPECT_GT(a.hit, 20);
    }
    BuildStatistics update(const TraceFrame& f) {
        scene_.update(f.frame, f.classes, arena_);
        return scene_.statistics();
    }

    Random random_{99};
    Arena arena_{2};
    EmbreeScene scene_{GetParam(), kPlenty};
};
INSTANTIATE_TEST_SUITE_P(Isas, EmbreeUpdate, testing::ValuesIn(trace_isas()),
                         [](const auto& isa) { return std::string(name(isa.param)); });

TEST_P(EmbreeUpdate, ACameraThatMovesBuildsNothing) {
    TraceFrame f;
    const std::size_t a = add_soup(f, random_, 200), b = add_soup(f, random_, 300);
    for (int frame = 0; frame < 4; ++frame) {
        const Rows rows = turned(random_, {1, 1, 1}, random_.vec3(0.2f));
        f.clear();
        f.place(a, rows);
        f.place(b, rows);
        const BuildStatistics s = update(f);
        EXPECT_EQ(s.groups, 1u);
        EXPECT_EQ(s.built, frame == 0 ? 1u : 0u);
        EXPECT_EQ(s.refitted, 0u);
        EXPECT_GT(s.bytes, 0u);
        expect_the_references(f);
        // One place: traced where it is, by the inverse matrix.
        bool identity = true;
        for (int i = 0; i < 12; ++i) identity &= scene_.trace_from_camera()[i] == Rows{}.m[i];
        EXPECT_FALSE(identity);
    }
}

TEST_P(EmbreeUpdate, EqualSetsShareAHierarchyAndUnusedOnesGo) {
    TraceFrame f;
    const std::size_t a = add_soup(f, random_, 200), b = add_soup(f, random_, 300);
    const auto place_pairs = [&](int pairs) {
        for (int i = 0; i < pairs; ++i) {
            const Rows rows = turned(random_, {0.7f, 0.7f, 0.7f}, random_.vec3(0.5f));
            f.place(a, rows);
            f.place(b, rows);
        }
    };
    place_pairs(5);
    BuildStatistics s = update(f);
    EXPECT_EQ(s.groups, 1u);
    EXPECT_EQ(s.built, 1u);
    expect_the_references(f);
    // Another of them alone is another set, which is new; the first stays.
    f.place(b, turned(random_, {0.7f, 0.7f, 0.7f}, random_.vec3(0.5f)));
    s = update(f);
    EXPECT_EQ(s.groups, 2u);
    EXPECT_EQ(s.built, 1u);
    expect_the_references(f);
    // What is not drawn is let go, with its memory, and built again when it comes back.
    const std::uint64_t bytes = s.bytes;
    f.clear();
    f.place(a);
    s = update(f);
    EXPECT_EQ(s.built, 1u);
    EXPECT_LT(s.bytes, bytes);
    f.clear();
    place_pairs(1);
    EXPECT_EQ(update(f).built, 1u);
    expect_the_references(f);
    // The same meshes, traced in another way.
    f.classes[1] = {kMeetsSolid, true, false};
    EXPECT_EQ(update(f).built, 1u);
    expect_the_references(f);
    EXPECT_EQ(update(f).built, 0u);
}

TEST_P(EmbreeUpdate, FlatObjectsAreMadeAnewForEachFrame) {
    TraceFrame f;
    const std::size_t a = add_soup(f, random_, 100);
    for (int frame = 0; frame < 2; ++frame) {
        f.clear();
        f.place(a, turned(random_, {1, 0, 1}, {}));
        EXPECT_EQ(update(f).built, 1u);
        expect_the_references(f);
    }
}

TEST_P(EmbreeUpdate, RefittedShapesAreHitAsRebuiltOnes) {
    for (const bool several : {false, true}) {
        TraceFrame f;
        const std::size_t mesh = add_soup(f, random_, 400, 0.2f, true), still = add_soup(f, random_, 100);
        const Rows rows = turned(random_, {1, 1, -1}, {});
        f.place(mesh, rows, {kMeetsSolid, true, false});
        if (several) f.place(still, moved({0.1f, 0, 0}));
        EXPECT_EQ(update(f).built, several ? 2u : 1u);
        expect_the_references(f);
        for (int frame = 0; frame < 3; ++frame) {
            for (Vec3& p : f.positions(mesh)) p = p + random_.vec3(0.2f);
            const BuildStatistics s = update(f);
            EXPECT_EQ(s.built, 0u);
            EXPECT_EQ(s.refitted, 1u);
            expect_the_references(f);
            EmbreeScene fresh(GetParam(), kPlenty);
            fresh.update(f.frame, f.classes, arena_);
            const std::vector<Ray> rays = random_rays(random_, 2000);
            const std::vector<Hit> refitted = nearest<8>(scene_, rays), rebuilt = nearest<8>(fresh, rays);
            int differ = 0;
            for (std::size_t r = 0; r < rays.size(); ++r) differ += !(refitted[r] == rebuilt[r]);
            EXPECT_LE(differ, 2);
        }
        EXPECT_EQ(update(f).refitted, 0u) << "nothing moved";
        // Triangles that meet and part again change what is left out.
        std::vector<Vec3>& p = f.positions(mesh);
        const std::vector<Vec3> apart = p;
        for (int frame = 0; frame < 2; ++frame) {
            p = apart;
            if (frame == 0) std::copy_n(p.begin(), 3, p.begin() + 3);
            const BuildStatistics s = update(f);
            EXPECT_EQ(s.duplicates, frame == 0 ? 1u : 0u);
            EXPECT_EQ(s.built, 1u);
            EXPECT_EQ(s.refitted, 0u);
            expect_the_references(f);
        }
        f.clear();
        scene_.update(f.frame, f.classes, arena_);
    }
}

TEST_P(EmbreeUpdate, MemoryBehindAMeshIsNotRead) {
    TraceFrame f;
    const std::size_t mesh = add_soup(f, random_, 500);
    std::vector<float> numbers;
    for (const Vec3& p : f.positions(mesh)) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    const GuardedArray<float> positions(numbers);
    const GuardedArray<std::uint32_t> triangles(f.indices(mesh));
    f.mesh(mesh).view.positions = positions.data();
    f.mesh(mesh).view.triangles = triangles.data();
    for (const bool deformed : {false, true}) {
        f.mesh(mesh).deformed = deformed;
        f.clear();
        f.place(mesh);
        update(f);
        expect_the_references(f);
    }
}

TEST_P(EmbreeUpdate, TheMemoryLimitIsKept) {
    TraceFrame f;
    f.place(add_soup(f, random_, 20000, 0.05f), turned(random_, {1, 1, 1}, {}));
    TraceFrame small;
    small.place(add_soup(small, random_, 10));
    small.place(0, moved({0.5f, 0, 0}));
    const std::vector<Ray> rays = random_rays(random_, 100);
    for (const std::uint64_t limit : {0, 1000, 100000, 1000000}) {
        EmbreeScene scene(GetParam(), limit);
        for (int round = 0; round < 2; ++round) {
            try {
                scene.update(f.frame, f.classes, arena_);
                ADD_FAILURE() << limit;
            } catch (const Error& e) {
                EXPECT_EQ(e.code(), ErrorCode::kLimit);
                EXPECT_NE(std::string(e.what()).find(std::to_string(limit) + " bytes"), std::string::npos) << e.what();
            }
            // Nothing half made is traced.
            for (const Hit& hit : nearest<16>(scene, rays)) EXPECT_EQ(hit, Hit{});
            for (const int blocked : occluded<16>(scene, rays)) EXPECT_EQ(blocked, 0);
        }
        if (limit < 1000000) continue;
        scene.update(small.frame, small.classes, arena_);  // which fits
        EXPECT_LE(scene.statistics().bytes, limit);
        EXPECT_EQ(compare(Truth(small), rays, nearest<16>(scene, rays)).wrong, 0);
    }
}

TEST_P(EmbreeUpdate, ManyThreadsTrace) {
    TraceFrame f;
    const std::size_t mesh = add_soup(f, random_, 1000);
    f.place(mesh, {}, {kMeetsSolid, true, false});
    f.place(mesh, turned(random_, {1, 1, -1}, {}), {kMeetsSheer, true, false, true});
    update(f);
    const std::vector<Ray> rays = random_rays(random_, 2000);
    const std::vector<Hit> want = nearest<16>(scene_, rays);
    std::atomic<int> differ{0};
    Arena many(4);
    many.for_each(8, [&](std::size_t) {
        std::vector<SheerHit> sheer;
        differ += nearest<16>(scene_, rays, {false, true, &sheer}) != want;
    });
    EXPECT_EQ(differ, 0);
}

#if !defined(TESSERA_STD_THREADS)
TEST_P(EmbreeUpdate, TheHostsParallelismIsLeftAlone) {
    const auto limit = [] { return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism); };
    const std::size_t before = limit();
    TraceFrame f;
    f.place(add_soup(f, random_, 5000));
    Arena one(1);
    std::atomic<int> strange{0};
    std::atomic<bool> done{false};
    // Tasks of the host while hierarchies are built: none of them may come to run on a thread that builds.
    std::thread builder([&] {
        const auto self = std::this_thread::get_id();
        std::thread host([&] {
            while (!done) tbb::parallel_for(0, 64, [&](int) { strange += std::this_thread::get_id() == self; });
        });
        for (int i = 0; i < 20; ++i) {
            EmbreeScene scene(GetParam(), kPlenty);
            scene.update(f.frame, f.classes, one);
        }
        done = true;
        host.join();
    });
    builder.join();
    EXPECT_EQ(strange, 0);
    EXPECT_EQ(limit(), before);
}
#endif

}  // namespace
}  // namespace tessera
