// Which of the surfaces along a ray count: duplicates, culled backs, sheer surfaces, strokes.
#include "geometry/frame.h"
#include "trace/trace_frame.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace tessera {
namespace {

using namespace test;

constexpr TraceClass kSolid{}, kSolidCulled{kMeetsSolid, true, false}, kSheer{kMeetsSheer, false, false, true},
    kSheerCulled{kMeetsSheer, true, false, true}, kGlass{kMeetsSheer, true, true};

class EmbreeSurfaces : public testing::TestWithParam<Isa> {
  protected:
    // The frame, traced.
    EmbreeScene& traced(const TraceFrame& f) {
        scene_ = std::make_unique<EmbreeScene>(GetParam(), kPlenty);
        scene_->update(f.frame, f.classes, arena_);
        return *scene_;
    }
    // The same for all widths.
    Hit nearest_of(const TraceFrame& f, const Ray& ray, bool from_camera = true) {
        EmbreeScene& scene = traced(f);
        const std::vector<Ray> rays(16, ray);
        const Hit hit = nearest<1>(scene, {ray}, {false, from_camera})[0];
        for (const std::vector<Hit>& hits :
             {nearest<4>(scene, rays, {false, from_camera}), nearest<8>(scene, rays, {false, from_camera}),
              nearest<16>(scene, rays, {false, from_camera}), nearest<16>(scene, rays, {true, from_camera})})
            for (const Hit& h : hits) {
                EXPECT_EQ(h.instance, hit.instance);
                EXPECT_EQ(h.triangle, hit.triangle);
            }
        return hit;
    }

    Arena arena_{2};
    std::unique_ptr<EmbreeScene> scene_;
};
INSTANTIATE_TEST_SUITE_P(Isas, EmbreeSurfaces, testing::ValuesIn(trace_isas()),
                         [](const auto& isa) { return std::string(name(isa.param)); });

// Seen from +z, counter-clockwise.
const std::vector<Vec3> kCorners{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
const Ray kFromFront{{0, 0, 3}, {0, 0, -1}}, kFromBehind{{0, 0, -3}, {0, 0, 1}};

// The corners of a triangle in its frame, in an order of their own.
auto place_of(const TraceFrame& f, std::uint32_t instance, std::uint32_t triangle) {
    const InstanceView& i = f.frame.instances[instance];
    std::array<std::array<float, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
        std::copy_n(i.mesh.positions + 3 * std::size_t{i.mesh.triangles[3 * std::size_t{triangle} + k]}, 3,
                    corners[k].begin());
    std::sort(corners.begin(), corners.end());
    return std::pair(corners, std::vector<float>(i.object_to_camera, i.object_to_camera + 12));
}

TEST_P(EmbreeSurfaces, TheLowestOfDuplicatesIsHit) {
    Random random(1);
    TraceFrame f;
    // Every triangle of a soup four more times, in a random order of meshes, triangles and corners, turned over too.
    const std::size_t base = add_soup(f, random, 300);
    std::vector<std::uint32_t> indices = f.indices(base);
    std::vector<Vec3> positions = f.positions(base);
    for (int copy = 0; copy < 4; ++copy) {
        for (std::uint32_t t = 0; t < 300; ++t) {
            const std::uint32_t pick = random.below(300), r = random.below(3);
            std::uint32_t v[3] = {3 * pick + r, 3 * pick + (r + 1) % 3, 3 * pick + (r + 2) % 3};
            if (random.below(2)) std::swap(v[1], v[2]);
            if (random.below(2)) {  // the same place by other vertices
                for (std::uint32_t& i : v) {
                    positions.push_back(positions[i]);
                    i = static_cast<std::uint32_t>(positions.size() - 1);
                }
            }
            indices.insert(indices.end(), v, v + 3);
        }
    }
    const std::size_t many = f.add_mesh(positions, indices);
    for (const bool several : {false, true}) {
        for (const TraceClass& type : {kSolid, kSolidCulled}) {
            f.clear();
            if (several) f.place(base, moved({0, 0, 0.5f}), type);
            const Rows rows = turned(random, {1, 0.8f, -1.1f}, random.vec3(0.2f));
            f.place(many, rows, type);
            f.place(base, rows, type);
            f.place(many, rows, type);
            EmbreeScene& scene = traced(f);
            EXPECT_GE(scene.statistics().duplicates, 1000u);
            const Truth truth(f);
            std::vector<Ray> rays;
            for (int i = 0; i < 3000; ++i) rays.push_back(random_ray(random));
            const std::vector<Hit> hits = nearest<16>(scene, rays);
            EXPECT_EQ(compare(truth, rays, hits).wrong, 0);
            int hit = 0;
            for (std::size_t r = 0; r < rays.size(); ++r) {
                if (hits[r].instance == kNoHit || truth.doubtful(rays[r], hits[r].instance, hits[r].triangle)) continue;
                ++hit;
                const auto place = place_of(f, hits[r].instance, hits[r].triangle);
                Hit lowest;
                for (const auto& m : truth.along(rays[r]))
                    if (truth.shown(m, true) && place_of(f, m.instance, m.triangle) == place &&
                        std::tie(m.instance, m.triangle) < std::tie(lowest.instance, lowest.triangle))
                        lowest = {m.instance, m.triangle, 0};
                EXPECT_EQ(hits[r].instance, lowest.instance);
                EXPECT_EQ(hits[r].triangle, lowest.triangle);
            }
            EXPECT_GT(hit, 1000);
        }
    }
}

TEST_P(EmbreeSurfaces, BacksAreCulledAndFrontsAreNot) {
    for (const Rows& rows :
         {Rows{}, Rows{{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}, Rows{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0}}}) {
        // The front stays the front of a mirrored object, which is turned to the other side by the last matrix only.
        const bool toward = rows.m[10] > 0;
        for (const bool several : {false, true}) {
            TraceFrame f;
            const std::size_t mesh = f.add_mesh(kCorners, {0, 1, 2});
            f.place(mesh, rows, kSolidCulled);
            if (several) f.place(mesh, moved({9, 0, 0}), kSolidCulled);
            EXPECT_EQ(nearest_of(f, toward ? kFromFront : kFromBehind).instance, 0u);
            EXPECT_EQ(nearest_of(f, toward ? kFromBehind : kFromFront).instance, kNoHit);
            // Light is stopped from both sides.
            EXPECT_EQ(occluded<16>(*scene_, {kFromFront, kFromBehind}), (std::vector<int>{1, 1}));
            EXPECT_EQ(occluded<1>(*scene_, {kFromFront, kFromBehind}), (std::vector<int>{1, 1}));
            f.classes[0].seen_inside = true;
            EXPECT_EQ(nearest_of(f, toward ? kFromBehind : kFromFront, true).instance, kNoHit);
            EXPECT_EQ(nearest_of(f, toward ? kFromBehind : kFromFront, false).instance, 0u);
        }
    }
}

// Two faces in one place, each of which is drawn from one side.
TEST_P(EmbreeSurfaces, WallsOfTwoFacesShowTheRightOne) {
    TraceFrame f;
    const std::size_t front = f.add_mesh(kCorners, {0, 1, 2, 0, 2, 1}), back = f.add_mesh(kCorners, {1, 0, 2});
    f.place(front, {}, kSolidCulled);
    EXPECT_EQ(nearest_of(f, kFromFront).triangle, 0u);
    EXPECT_EQ(nearest_of(f, kFromBehind).triangle, 1u);
    f.place(back, {}, kSolidCulled);  // behind both
    EXPECT_EQ(nearest_of(f, kFromBehind).instance, 0u);
    EXPECT_EQ(scene_->statistics().duplicates, 1u);
    f.place(front, {}, kSolid);  // what is seen of it is hidden by the two together
    EXPECT_EQ(nearest_of(f, kFromFront).instance, 0u);
    EXPECT_EQ(nearest_of(f, kFromBehind).instance, 0u);
    EXPECT_EQ(scene_->statistics().duplicates, 3u);

    // What hides only some rays' view of it does not hide the third, and sheer surfaces hide nothing.
    f.clear();
    f.place(front, {}, kSheer);
    f.place(back, {}, {kMeetsSolid, true, true});
    f.place(back, {}, kSolid);
    EXPECT_EQ(nearest_of(f, kFromFront).instance, 2u);
    EXPECT_EQ(scene_->statistics().duplicates, 0u);
}

// Everything sheer in front of the nearest solid surface, against all that the reference finds along a ray.
TEST_P(EmbreeSurfaces, SheerSurfacesAreFoundCompletely) {
    for (const bool several : {false, true}) {
        Random random(several ? 8 : 9);
        TraceFrame f;
        const std::size_t a = add_soup(f, random, 400), b = add_soup(f, random, 300), c = add_soup(f, random, 40);
        const Rows rows = turned(random, {1, 0.9f, -0.8f}, random.vec3(0.1f));
        f.place(a, rows, kSheer);
        f.place(b, rows, kSheerCulled);
        f.place(c, rows, kSolid);
        f.place(b, several ? turned(random, {0.8f, 0.7f, 0.6f}, random.vec3(0.2f)) : rows, kGlass);
        f.place(c, several ? turned(random, {-1, -1, -1}, {}) : rows, kSolidCulled);
        EmbreeScene& scene = traced(f);
        EXPECT_TRUE(scene.has_sheer());
        const Truth truth(f);
        std::vector<Ray> rays;
        for (int i = 0; i < 1500; ++i) rays.push_back(random_ray(random));
        for (const bool from_camera : {true, false}) {
            std::vector<Hit> solid;
            Found before, along;  // what must be found, and what may be
            for (std::uint32_t r = 0; r < rays.size(); ++r) {
                solid.push_back(truth.nearest(rays[r], from_camera));
                for (const auto& m : truth.along(rays[r])) {
                    if (!truth.undecided(m.instance) || !truth.shown(m, from_camera)) continue;
                    along.insert({r, m.instance, m.triangle});
                    const auto t = static_cast<float>(m.t);
                    if (t < solid[r].t && !Truth::near_enough(t, solid[r].t) &&
                        !truth.doubtful(rays[r], m.instance, m.triangle))
                        before.insert({r, m.instance, m.triangle});
                }
            }
            EXPECT_GT(before.size(), 800u);
            const auto check = [&](auto width, bool coherent) {
                constexpr int W = decltype(width)::value;
                std::vector<SheerHit> sheer;
                const std::vector<Hit> hits = nearest<W>(scene, rays, {coherent, from_camera, &sheer});
                expect_agreement(compare(truth, rays, hits, from_camera), 2e-3);
                const Found got = found(sheer);
                std::size_t missing = 0, wrong = 0;
                for (const auto& s : before) missing += !got.count(s);
                for (const auto& [r, i, t] : got) wrong += !along.count({r, i, t}) && !truth.doubtful(rays[r], i, t);
                EXPECT_EQ(missing, 0u) << "of " << before.size() << ", width " << W;
                EXPECT_EQ(wrong, 0u) << "of " << got.size() << ", width " << W;
                for (const SheerHit& s : sheer) {
                    for (const auto& m : truth.along(rays[s.lane])) {
                        if (m.instance == s.instance && m.triangle == s.triangle &&
                            !truth.doubtful(rays[s.lane], s.instance, s.triangle)) {
                            EXPECT_TRUE(Truth::near_enough(s.t, static_cast<float>(m.t)));
                        }
                    }
                }
                // Without asking for them, the same solid surfaces.
                const std::vector<Hit> alone = nearest<W>(scene, rays, {coherent, from_camera});
                for (std::size_t r = 0; r < rays.size(); ++r) EXPECT_TRUE(truth.agrees(rays[r], alone[r], hits[r]));
            };
            check(std::integral_constant<int, 1>{}, false);
            check(std::integral_constant<int, 4>{}, true);
            check(std::integral_constant<int, 8>{}, false);
            check(std::integral_constant<int, 16>{}, false);
            check(std::integral_constant<int, 16>{}, true);
        }
        expect_all_sheer(scene, truth, rays);
        // Sheer surfaces stop no light.
        std::vector<int> want;
        for (const Ray& ray : rays) {
            bool blocked = false;
            for (const auto& m : truth.along(ray)) blocked |= !truth.sheer(m.instance);
            want.push_back(blocked);
        }
        int differ = 0;
        const std::vector<int> got = occluded<16>(scene, rays, true);
        for (std::size_t r = 0; r < rays.size(); ++r) differ += got[r] != want[r];
        EXPECT_LE(differ, 2);
    }
}

TEST_P(EmbreeSurfaces, RaysMeetOnlyWhatTheirMaskNames) {
    for (const bool several : {false, true}) {
        TraceFrame f;
        const std::size_t mesh = f.add_mesh(kCorners, {0, 1, 2});
        f.place(mesh, moved({0, 0, several ? 1.0f : 0.0f}), {kMeetsStroke, false, false});
        f.place(f.add_mesh({{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}}, {0, 1, 2}), {}, kSheer);
        f.place(f.add_mesh({{-1, -1, -2}, {1, -1, -2}, {0, 1, -2}}, {0, 1, 2}), {}, kSolid);
        EmbreeScene& scene = traced(f);
        const auto ray = [](std::uint32_t mask) { return Ray{{0, 0, 3}, {0, 0, -1}, 0, 99, mask}; };
        const std::vector<Ray> rays{ray(kMeetsAll), ray(kMeetsSolid), ray(kMeetsSheer | kMeetsSolid), ray(kMeetsSheer),
                                    ray(0)};
        std::vector<SheerHit> sheer;
        const std::vector<Hit> hits = nearest<8>(scene, rays, {false, true, &sheer});
        EXPECT_EQ(hits[0].instance, 0u);
        EXPECT_EQ(hits[1].instance, 2u);
        EXPECT_EQ(hits[2].instance, 2u);
        EXPECT_EQ(hits[3].instance, kNoHit);
        EXPECT_EQ(hits[4].instance, kNoHit);
        EXPECT_EQ(found(sheer), (Found{{2, 1, 0}, {3, 1, 0}}));
        EXPECT_EQ(occluded<8>(scene, rays), (std::vector<int>{1, 1, 1, 0, 0}));
        EXPECT_EQ(found(find_sheer<8>(scene, rays)), (Found{{0, 1, 0}, {2, 1, 0}, {3, 1, 0}}));
    }
}

// Points and lines as the frame makes them, in a space of the picture.
TEST_P(EmbreeSurfaces, StrokesAreHitWhereTheReferenceHitsThem) {
    for (const bool with_mesh : {false, true}) {
        Scene s;
        Random random(12);
        Primitive lines;
        lines.mode = PrimitiveMode::kLines;
        for (int i = 0; i < 60; ++i) lines.positions.push_back(random.vec3(1));
        s.meshes.push_back({"lines", {lines}, {}, {}});
        if (with_mesh) {
            Primitive soup;
            for (int i = 0; i < 90; ++i) soup.positions.push_back(random.vec3(1));
            s.meshes[0].primitives.push_back(soup);
        }
        s.nodes.emplace_back().mesh = 0;
        s.scenes.push_back({"scene", {0}, {}});
        View view;
        view.eye = {0.5f, 0.3f, 4};
        view.target = {0, 0, 0};
        view.yfov = 0.6f;
        StrokeStyle style;
        style.line_width = 9;
        TraceFrame f;
        f.frame = make_frame(s, view, 200, 150, style);
        for (const InstanceView& instance : f.frame.instances)
            f.classes.push_back({instance.mesh.is_stroke() ? kMeetsStroke : kMeetsSolid, true, false});
        EmbreeScene& scene = traced(f);
        EXPECT_EQ(scene.statistics().groups, with_mesh ? 2u : 1u);
        std::vector<Ray> rays;
        for (int i = 0; i < 3000; ++i)
            rays.push_back({{0, 0, 0}, {random.in(-0.4f, 0.4f), random.in(-0.3f, 0.3f), -1}});
        expect_agreement(compare(Truth(f), rays, nearest<16>(scene, rays)), 2e-3);
    }
}

}  // namespace
}  // namespace tessera
