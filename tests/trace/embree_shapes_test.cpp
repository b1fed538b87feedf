// Spheres and discs that Embree meets by their formula, against the double-precision reference: alone, beside
// triangles, at uneven and mirroring places, culled and sheer ones, and from frame to frame.
#include "trace/trace_frame.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace tessera {
namespace {

using namespace test;

constexpr TraceClass kSolid{}, kSolidCulled{kMeetsSolid, true, false}, kSheer{kMeetsSheer, false, false, true},
    kSheerCulled{kMeetsSheer, true, false, true}, kGlass{kMeetsSheer, true, true};

Shape sphere(float radius) { return {Shape::Type::kSphere, radius, {0, 0}, 12}; }
Shape disc(float radius) { return {Shape::Type::kDisc, radius, {0, 0}, 12}; }

// From outside, and from anywhere among the shapes.
std::vector<Ray> random_rays(Random& random, int count) {
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        Ray ray = random_ray(random);
        if (i % 3 == 0) ray = {random.vec3(1), random.vec3(1)};
        rays.push_back(ray);
    }
    return rays;
}

enum class Setting { kAlone, kOneNode, kManyNodes };
constexpr Setting kSettings[] = {Setting::kAlone, Setting::kOneNode, Setting::kManyNodes};

// One shape; several with triangles at one node, traced in its space; and pairs of them at several nodes, and a disc
// that is flattened, for which there is no formula.
void make(TraceFrame& f, Random& random, Setting setting, const std::vector<TraceClass>& types) {
    f.frame.exact_shapes = true;
    std::size_t next = 0;
    const auto type = [&] { return types[next++ % types.size()]; };
    const std::size_t ball = f.add_shape(sphere(0.7f)), plate = f.add_shape(disc(0.9f));
    if (setting == Setting::kAlone) {
        const std::size_t mesh = random.below(2) ? ball : plate;  // compilers order arguments as they like
        f.place(mesh, turned(random, {1.3f, -0.9f, 1.1f}, random.vec3(0.1f)), type());
        return;
    }
    const std::size_t soup = add_soup(f, random, 60), small = f.add_shape(sphere(0.3f));
    const std::vector<std::size_t> together = {ball, soup, plate, small};
    if (setting == Setting::kOneNode) {
        const Rows rows = turned(random, {1.1f, 0.8f, -0.9f}, random.vec3(0.2f));
        for (const std::size_t mesh : together) f.place(mesh, rows, type());
        return;
    }
    for (const Vec3 scale : {Vec3{1, 1, 1}, {0.5f, -0.5f, 0.5f}, {0.2f, 0.6f, 1}, {-0.9f, -0.3f, -0.5f}}) {
        const Rows rows = turned(random, scale, random.vec3(0.6f));
        const std::uint32_t first = random.below(4);
        f.place(together[first], rows, type());
        f.place(together[(first + 1 + random.below(3)) % 4], rows, type());
        const std::size_t mesh = random.below(2) ? ball : plate;
        f.place(mesh, turned(random, scale, random.vec3(0.6f)), type());
    }
    f.place(plate, turned(random, {0.5f, 0, 0.3f}, random.vec3(0.6f)), type());
}

class EmbreeShapes : public testing::TestWithParam<Isa> {
  protected:
    EmbreeScene& traced(const TraceFrame& f) {
        scene_ = std::make_unique<EmbreeScene>(GetParam(), kPlenty);
        scene_->update(f.frame, f.classes, arena_);
        return *scene_;
    }
    Arena arena_{2};
    std::unique_ptr<EmbreeScene> scene_;
};
INSTANTIATE_TEST_SUITE_P(Isas, EmbreeShapes, testing::ValuesIn(trace_isas()),
                         [](const auto& isa) { return std::string(name(isa.param)); });

// By all widths the same names, which are those of the reference.
TEST_P(EmbreeShapes, NearestHitsAreTheReferences) {
    int spheres[2] = {}, discs = 0, triangles = 0;
    for (const Setting setting : kSettings)
        for (const std::vector<TraceClass>& types :
             {std::vector<TraceClass>{kSolid}, {kSolidCulled}, {kGlass, kSolid, kSolidCulled}})
            for (std::uint32_t seed = 1; seed <= 4; ++seed) {
                Random random(seed + 10 * static_cast<std::uint32_t>(setting));
                TraceFrame f;
                make(f, random, setting, types);
                const EmbreeScene& scene = traced(f);
                const Truth truth(f);
                const std::vector<Ray> rays = random_rays(random, 1500);
                for (const bool from_camera : {true, false}) {
                    const std::vector<Hit> hits = nearest<1>(scene, rays, {false, from_camera});
                    const Agreement a = compare(truth, rays, hits, from_camera);
                    EXPECT_EQ(a.wrong, 0) << "of " << a.hit;
                    EXPECT_LE(a.differ, 2) << "of " << a.hit;
                    EXPECT_GT(a.hit, 40);
                    for (const Hit& hit : hits) {
                        if (hit.instance == kNoHit) continue;
                        const ShapeView::Kind kind = f.frame.instances[hit.instance].shape.kind;
                        if (kind == ShapeView::Kind::kSphere) ++spheres[hit.triangle];
                        discs += kind == ShapeView::Kind::kDisc;
                        triangles += kind == ShapeView::Kind::kTriangles;
                    }
                    for (const bool coherent : {false, true})
                        for (const std::vector<Hit>& other : {nearest<1>(scene, rays, {coherent, from_camera}),
                                                              nearest<4>(scene, rays, {coherent, from_camera}),
                                                              nearest<8>(scene, rays, {coherent, from_camera}),
                                                              nearest<16>(scene, rays, {coherent, from_camera})}) {
                            int differ = 0;
                            for (std::size_t r = 0; r < rays.size(); ++r) {
                                differ +=
                                    other[r].instance != hits[r].instance || other[r].triangle != hits[r].triangle;
                                EXPECT_TRUE(truth.agrees(rays[r], other[r], hits[r]));
                            }
                            EXPECT_LE(differ, 1);
                        }
                }
            }
    for (const int count : {spheres[0], spheres[1], discs, triangles}) EXPECT_GT(count, 1000);
}

TEST_P(EmbreeShapes, ShadowsAreTheReferences) {
    for (const Setting setting : kSettings)
        for (std::uint32_t seed = 1; seed <= 4; ++seed) {
            Random random(seed + 30);
            TraceFrame f;
            make(f, random, setting, {kSolidCulled, kSolid});
            const EmbreeScene& scene = traced(f);
            const Truth truth(f);
            std::vector<Ray> rays = random_rays(random, 1500);
            for (Ray& ray : rays) ray.t_far = random.in(0.5f, 1.5f);  // ends within some of them
            expect_occluded(scene, truth, rays, 2);
        }
}

// A ray from outside enters and leaves, one from within leaves; of what is culled only the front is there.
TEST_P(EmbreeShapes, NamesSayWhetherARayEntersOrLeaves) {
    const std::vector<Ray> rays{{{0, 0, 3}, {0, 0, -1}}, {{0, 0, 0.2f}, {0, 0, -1}}, {{0, 0, 3}, {0, 0, 1}}};
    for (const Vec3 scale : {Vec3{1, 1, 1}, {-1, 1, 1}, {0.8f, 1.2f, -0.7f}})
        for (const bool several : {false, true})
            for (const TraceClass& type : {kSolid, kSolidCulled, kGlass}) {
                TraceFrame f;
                f.frame.exact_shapes = true;
                Random random(3);
                const std::size_t ball = f.add_shape(sphere(1));
                f.place(ball, turned(random, scale, {}), type);
                if (several) f.place(ball, moved({9, 0, 0}), type);
                const EmbreeScene& scene = traced(f);
                for (const bool from_camera : {true, false}) {
                    const auto check = [&](const std::vector<Hit>& hits) {
                        EXPECT_EQ(hits[0].instance, 0u);
                        EXPECT_EQ(hits[0].triangle, 0u);
                        EXPECT_LT(hits[0].t, 3);
                        const bool inside = !type.culled || (type.seen_inside && !from_camera);
                        EXPECT_EQ(hits[1].instance, inside ? 0u : kNoHit);
                        if (inside) {
                            EXPECT_EQ(hits[1].triangle, 1u);
                        }
                        EXPECT_EQ(hits[2].instance, kNoHit);
                    };
                    check(nearest<1>(scene, rays, {false, from_camera}));
                    check(nearest<4>(scene, rays, {false, from_camera}));
                    check(nearest<8>(scene, rays, {true, from_camera}));
                    check(nearest<16>(scene, rays, {false, from_camera}));
                }
                if (type.mask == kMeetsSolid) {
                    EXPECT_EQ(occluded<4>(scene, rays), (std::vector<int>{1, 1, 0}));
                }
            }
}

TEST_P(EmbreeShapes, DiscsAreCulledFromBehind) {
    const std::vector<Ray> rays{{{0.3f, 3, 0}, {0, -1, 0}}, {{0.3f, -3, 0}, {0, 1, 0}}};
    for (const bool upside_down : {false, true})
        for (const bool several : {false, true}) {
            TraceFrame f;
            f.frame.exact_shapes = true;
            const std::size_t plate = f.add_shape(disc(1));
            const float y = upside_down ? -1.0f : 1.0f;
            f.place(plate, {{1, 0, 0, 0, 0, y, 0, 0, 0, 0, 1, 0}}, kSolidCulled);
            if (several) f.place(plate, moved({9, 0, 0}), kSolidCulled);
            const EmbreeScene& scene = traced(f);
            for (const std::vector<Hit>& hits :
                 {nearest<1>(scene, rays), nearest<4>(scene, rays), nearest<16>(scene, rays)}) {
                EXPECT_EQ(hits[0].instance, upside_down ? kNoHit : 0u);
                EXPECT_EQ(hits[1].instance, upside_down ? 0u : kNoHit);
            }
            EXPECT_EQ(occluded<16>(scene, rays), (std::vector<int>{1, 1}));
        }
}

// Of shapes in one place the first is hit, unless it is culled where a later one is not.
TEST_P(EmbreeShapes, TheLowestOfCoincidentShapesIsHit) {
    Random random(4);
    TraceFrame f;
    f.frame.exact_shapes = true;
    const std::size_t ball = f.add_shape(sphere(1)), same = f.add_shape(sphere(1)), larger = f.add_shape(sphere(1.5f)),
                      plate = f.add_shape(disc(1));
    for (const bool several : {false, true}) {
        const auto place = [&](const std::vector<std::pair<std::size_t, TraceClass>>& members) {
            const Rows rows = turned(random, {1.1f, -0.8f, 0.9f}, random.vec3(0.1f));
            f.clear();
            if (several) f.place(plate, moved({9, 0, 0}));
            for (const auto& [mesh, type] : members) f.place(mesh, rows, type);
        };
        std::vector<Ray> rays;
        for (int i = 0; i < 500; ++i) rays.push_back({random.vec3(0.3f), random.unit()});  // from within
        for (int i = 0; i < 500; ++i) rays.push_back({random.unit() * 4.0f, {}});
        for (std::size_t i = 500; i < rays.size(); ++i) rays[i].dir = random.vec3(0.3f) - rays[i].org;
        const auto expect = [&](std::uint32_t outside, std::uint32_t inside, std::uint32_t duplicates) {
            const EmbreeScene& scene = traced(f);
            EXPECT_EQ(scene.statistics().duplicates, duplicates);
            for (const std::vector<Hit>& hits :
                 {nearest<1>(scene, rays), nearest<4>(scene, rays), nearest<8>(scene, rays), nearest<16>(scene, rays)})
                for (std::size_t i = 0; i < hits.size(); ++i) {
                    const std::uint32_t want = i < 500 ? inside : outside;
                    ASSERT_EQ(hits[i].instance, want == kNoHit ? kNoHit : want + several) << i;
                    if (want != kNoHit) {
                        ASSERT_EQ(hits[i].triangle, i < 500 ? 1u : 0u);
                    }
                }
        };
        place({{ball, kSolid}, {same, kSolid}, {ball, kSolidCulled}});
        expect(0, 0, 2);
        place({{ball, kSolidCulled}, {same, kSolidCulled}});
        expect(0, kNoHit, 1);
        place({{larger, kSheer}, {ball, kSheer}, {same, kSolidCulled}});
        expect(2, kNoHit, 0);
        place({{larger, kSolidCulled}, {ball, kSolid}, {plate, kSheer}, {same, kSolid}});
        expect(0, 1, 1);
    }
}

// Both roots of a sheer sphere, unless its back is culled, in front of the nearest solid surface.
TEST_P(EmbreeShapes, SheerShapesAreFoundCompletely) {
    std::size_t all_before = 0;
    int both = 0;
    for (const Setting setting : {Setting::kOneNode, Setting::kManyNodes})
        for (std::uint32_t seed = 1; seed <= 3; ++seed) {
            Random random(seed + 50);
            TraceFrame f;
            make(f, random, setting, {kSheer, kSolid, kSheerCulled, kSheer, kGlass});
            const EmbreeScene& scene = traced(f);
            const Truth truth(f);
            const std::vector<Ray> rays = random_rays(random, 1200);
            for (const bool from_camera : {true, false}) {
                std::vector<Hit> solid;
                Found before, along;  // what must be found, and what may be
                for (std::uint32_t r = 0; r < rays.size(); ++r) {
                    solid.push_back(truth.nearest(rays[r], from_camera));
                    for (const auto& m : truth.along(rays[r])) {
                        if (!truth.undecided(m.instance) || !truth.shown(m, from_camera)) continue;
                        along.insert({r, m.instance, m.triangle});
                        const auto t = static_cast<float>(m.t);
                        if (t >= solid[r].t || Truth::near_enough(t, solid[r].t) ||
                            truth.doubtful(rays[r], m.instance, m.triangle))
                            continue;
                        before.insert({r, m.instance, m.triangle});
                        both += m.triangle == 1 && before.contains({r, m.instance, 0}) &&
                                f.frame.instances[m.instance].shape.kind == ShapeView::Kind::kSphere;
                    }
                }
                all_before += before.size();
                const auto check = [&](auto width, bool coherent) {
                    constexpr int W = decltype(width)::value;
                    std::vector<SheerHit> sheer;
                    const std::vector<Hit> hits = nearest<W>(scene, rays, {coherent, from_camera, &sheer});
                    EXPECT_EQ(compare(truth, rays, hits, from_camera).wrong, 0);
                    const Found got = found(sheer);
                    std::size_t missing = 0, wrong = 0;
                    for (const auto& s : before) missing += !got.count(s);
                    for (const auto& [r, i, t] : got)
                        wrong += !along.count({r, i, t}) && !truth.doubtful(rays[r], i, t);
                    EXPECT_EQ(missing, 0u) << "of " << before.size() << ", width " << W;
                    EXPECT_EQ(wrong, 0u) << "of " << got.size() << ", width " << W;
                    for (const SheerHit& s : sheer)
                        for (const auto& m : truth.along(rays[s.lane]))
                            if (m.instance == s.instance && m.triangle == s.triangle &&
                                !truth.doubtful(rays[s.lane], s.instance, s.triangle)) {
                                EXPECT_TRUE(Truth::near_enough(s.t, static_cast<float>(m.t)));
                            }
                };
                check(std::integral_constant<int, 1>{}, false);
                check(std::integral_constant<int, 4>{}, true);
                check(std::integral_constant<int, 8>{}, false);
                check(std::integral_constant<int, 16>{}, false);
                check(std::integral_constant<int, 16>{}, true);
            }
            expect_all_sheer(scene, truth, rays);
        }
    EXPECT_GT(all_before, 2000u);
    EXPECT_GT(both, 100);
}

TEST_P(EmbreeShapes, LanesThatAreOffAreNotTouched) {
    Random random(6);
    TraceFrame f;
    make(f, random, Setting::kManyNodes, {kSheer, kSolid, kSheerCulled});
    const EmbreeScene& scene = traced(f);
    const Truth truth(f);
    int hit = 0;
    for (int round = 0; round < 150; ++round) {
        RayPacket<16> packet{};
        std::array<Ray, 16> rays;
        int valid[16];
        for (int i = 0; i < 16; ++i) {
            rays[static_cast<std::size_t>(i)] = random_ray(random);
            set_ray(packet, i, rays[static_cast<std::size_t>(i)], scene.trace_from_camera());
            valid[i] = random.below(2) ? -1 : 0;
            packet.triangle[i] = packet.instance[i] = packet.geometry[i] = 77;
            packet.u[i] = packet.ng_x[i] = 5;
        }
        const RayPacket<16> before = packet;
        std::vector<SheerHit> sheer;
        if (round % 3 == 0) scene.nearest<16>(valid, packet, round % 2, true, &sheer);
        if (round % 3 == 1) scene.occluded<16>(valid, packet, round % 2);
        if (round % 3 == 2) scene.occluded<16>(valid, packet, round % 2, &sheer);
        for (const SheerHit& s : sheer) EXPECT_TRUE(valid[s.lane]);
        for (int i = 0; i < 16; ++i) {
            const Ray& ray = rays[static_cast<std::size_t>(i)];
            if (valid[i] && round % 3 == 0) {
                const Hit want = truth.nearest(ray);
                hit += want.instance != kNoHit;
                EXPECT_TRUE(truth.agrees(ray, {packet.instance[i], packet.triangle[i], packet.t_far[i]}, want));
            }
            if (valid[i]) continue;
            EXPECT_EQ(packet.t_far[i], before.t_far[i]);
            EXPECT_EQ(packet.triangle[i], 77u);
            EXPECT_EQ(packet.instance[i], 77u);
            EXPECT_EQ(packet.geometry[i], 77u);
            EXPECT_EQ(packet.u[i], 5.0f);
            EXPECT_EQ(packet.ng_x[i], 5.0f);
        }
    }
    EXPECT_GT(hit, 50);
}

// Without a formula in between its triangles are hit, as they are without exact shapes at all.
TEST_P(EmbreeShapes, ShapesMoveGrowAndChangeWithTheirFrames) {
    Random random(70);
    TraceFrame f;
    const std::size_t ball = f.add_shape(sphere(0.7f)), plate = f.add_shape(disc(0.9f)), soup = add_soup(f, random, 40);
    EmbreeScene scene(GetParam(), kPlenty);
    const auto place = [&](bool exact) {
        f.clear();
        f.frame.exact_shapes = exact;
        const Rows rows = turned(random, {1, 0.7f, -0.8f}, random.vec3(0.3f));
        f.place(ball, rows);
        f.place(soup, rows);
        f.place(plate, turned(random, {1, 1, 1}, random.vec3(0.3f)), kSolidCulled);
        scene.update(f.frame, f.classes, arena_);
        const std::vector<Ray> rays = random_rays(random, 800);
        const Agreement a = compare(Truth(f), rays, nearest<16>(scene, rays));
        EXPECT_EQ(a.wrong, 0) << "of " << a.hit;
        EXPECT_LE(a.differ, 2);
        EXPECT_GT(a.hit, 100);
        return scene.statistics().built;
    };
    EXPECT_EQ(place(true), 2u);
    for (int frame = 0; frame < 3; ++frame) EXPECT_EQ(place(true), 0u) << "only moved";
    f.shape(ball).radius = 0.4f;
    EXPECT_EQ(place(true), 1u);
    f.shape(plate).radius = 0.5f;
    EXPECT_EQ(place(true), 1u);
    EXPECT_EQ(place(true), 0u);
    EXPECT_EQ(place(false), 2u);
    EXPECT_EQ(place(false), 0u);
    EXPECT_EQ(place(true), 2u);
    EXPECT_EQ(place(true), 0u);
}

}  // namespace
}  // namespace tessera
