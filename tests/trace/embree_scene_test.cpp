// What rays hit first, against the double-precision reference and among Embree's own ways; closed meshes are tight.
#include "trace/trace_frame.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

namespace tessera {
namespace {

using namespace test;

std::vector<Ray> random_rays(Random& random, int count) {
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) rays.push_back(random_ray(random));
    return rays;
}

// One mesh in its own space.
void make_single(TraceFrame& f, Random& random) {
    f.place(add_soup(f, random, 2000), turned(random, {0.9f, 1.2f, -0.7f}, random.vec3(0.3f)));
}

// Several meshes at several places: two as a pair at three places, others alone, mirrored and stretched.
void make_several(TraceFrame& f, Random& random) {
    const std::size_t a = add_soup(f, random, 300), b = add_soup(f, random, 500), c = add_soup(f, random, 200);
    for (int i = 0; i < 3; ++i) {
        const Rows rows = turned(random, {0.5f, 0.6f, i == 1 ? -0.4f : 0.4f}, random.vec3(0.6f));
        f.place(a, rows);
        f.place(b, rows);
    }
    f.place(b, turned(random, {0.01f, 0.5f, 0.5f}, random.vec3(0.5f)));
    f.place(c, turned(random, {-0.3f, -0.4f, -0.5f}, random.vec3(0.5f)));
    f.place(c, moved({0.1f, 0.2f, 0.3f}));
}

void make_all_kinds(TraceFrame& f, Random& random, bool several) {
    several ? make_several(f, random) : make_single(f, random);
    for (std::size_t i = 0; i < f.classes.size(); ++i) f.classes[i].culled = i % 2 == 0;
}

class EmbreeScenes : public testing::TestWithParam<Isa> {};
INSTANTIATE_TEST_SUITE_P(Isas, EmbreeScenes, testing::ValuesIn(trace_isas()),
                         [](const auto& isa) { return std::string(name(isa.param)); });

TEST_P(EmbreeScenes, NearestHitsAreTheReferences) {
    Arena arena(2);
    for (const bool several : {false, true}) {
        for (std::uint32_t seed = 1; seed <= 3; ++seed) {
            Random random(seed);
            TraceFrame f;
            make_all_kinds(f, random, several);
            EmbreeScene scene(GetParam(), kPlenty);
            scene.update(f.frame, f.classes, arena);
            const Truth truth(f);
            const std::vector<Ray> rays = random_rays(random, 3000);
            const Agreement a = compare(truth, rays, nearest<16>(scene, rays));
            expect_agreement(a);
            std::printf("%s, %s: %d of %d rays differ from the reference\n", name(GetParam()),
                        several ? "several" : "single", a.differ, a.rays);
        }
    }
}

// Their matrices have no inverse, and rays would have no direction in their space.
TEST_P(EmbreeScenes, FlatObjectsAreHit) {
    Arena arena(2);
    for (const bool several : {false, true}) {
        for (const Vec3 scale : {Vec3{1, 0.8f, 0}, Vec3{1, 0.8f, 1e-6f}, Vec3{1e-20f, 1, 1}}) {
            Random random(3);
            TraceFrame f;
            if (several) f.place(add_soup(f, random, 200), moved({0.2f, 0, 0}));
            // Triangles apart from each other once they are flat.
            std::vector<Vec3> positions;
            std::vector<std::uint32_t> indices;
            for (std::uint32_t i = 0; i < 400; ++i) {
                const float x = 0.1f * static_cast<float>(i % 20) - 1, y = 0.1f * static_cast<float>(i / 20) - 1;
                for (const Vec3 corner : {Vec3{0, 0, 0}, Vec3{0.09f, 0, 0}, Vec3{0, 0.09f, 0}}) {
                    indices.push_back(static_cast<std::uint32_t>(positions.size()));
                    const Vec3 p = Vec3{x, y, 0} + corner;
                    positions.push_back(scale.x < 1 ? Vec3{random.in(-1, 1), p.x, p.y}
                                                    : Vec3{p.x, p.y, random.in(-1, 1)});
                }
            }
            f.place(f.add_mesh(positions, indices), turned(random, scale, random.vec3(0.3f)),
                    {kMeetsSolid, several, false});
            EmbreeScene scene(GetParam(), kPlenty);
            scene.update(f.frame, f.classes, arena);
            const std::vector<Ray> rays = random_rays(random, 2000);
            expect_agreement(compare(Truth(f), rays, nearest<16>(scene, rays)), 2e-3);
        }
    }
}

TEST_P(EmbreeScenes, EveryWidthAndOrderFindsTheSame) {
    Arena arena(2);
    int differ = 0, count = 0;
    for (const bool several : {false, true}) {
        Random random(17);
        TraceFrame f;
        make_all_kinds(f, random, several);
        EmbreeScene scene(GetParam(), kPlenty);
        scene.update(f.frame, f.classes, arena);
        std::vector<Ray> rays = random_rays(random, 4001);
        // A pinhole picture, whose packets are coherent.
        for (int i = 0; i < 4096; ++i)
            rays.push_back(
                {{0, 0, 4},
                 {0.5f - 0.015625f * static_cast<float>(i % 64), 0.5f - 0.015625f * static_cast<float>(i / 64), -1}});
        const Truth truth(f);
        const std::vector<Hit> single = nearest<1>(scene, rays);
        for (const bool coherent : {false, true}) {
            for (const std::vector<Hit>& hits :
                 {nearest<1>(scene, rays, {coherent}), nearest<4>(scene, rays, {coherent}),
                  nearest<8>(scene, rays, {coherent}), nearest<16>(scene, rays, {coherent})}) {
                for (std::size_t r = 0; r < rays.size(); ++r) {
                    ++count;
                    differ += hits[r].instance != single[r].instance || hits[r].triangle != single[r].triangle;
                    EXPECT_TRUE(truth.agrees(rays[r], hits[r], single[r]));
                }
            }
        }
    }
    std::printf("%s: %d of %d rays differ among widths\n", name(GetParam()), differ, count);
    EXPECT_LE(differ, count / 10000);
}

// Shadow rays are blocked wherever a nearest hit is, and by what is culled for the eye as well.
TEST_P(EmbreeScenes, ShadowsAreTheReferences) {
    Arena arena(2);
    for (const bool several : {false, true}) {
        Random random(23);
        TraceFrame f;
        make_all_kinds(f, random, several);
        EmbreeScene scene(GetParam(), kPlenty);
        scene.update(f.frame, f.classes, arena);
        const Truth truth(f);
        std::vector<Ray> rays = random_rays(random, 3000);
        for (Ray& ray : rays) ray.t_far = 1;
        expect_occluded(scene, truth, rays, 3);
    }
}

TEST_P(EmbreeScenes, RaysThatMakeNoSenseHitNothing) {
    Arena arena(2);
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> bad;
    const Ray good{{0.1f, 0.2f, 4}, {0, 0, -1}};
    for (const float wrong : {nan, inf, -inf, 3e18f, -3e38f}) {
        for (int c = 0; c < 3; ++c) {
            Ray ray = good;
            (c == 0 ? ray.org.x : c == 1 ? ray.org.y : ray.org.z) = wrong;
            bad.push_back(ray);
            ray = good;
            (c == 0 ? ray.dir.x : c == 1 ? ray.dir.y : ray.dir.z) = wrong;
            bad.push_back(ray);
        }
    }
    for (const auto& [near, far] : {std::pair{nan, inf}, {0.0f, nan}, {inf, inf}, {0.0f, -1.0f}, {-1.0f, inf}})
        bad.push_back({good.org, good.dir, near, far});
    bad.push_back({good.org, {0, 0, 0}});
    bad.push_back({good.org, {-0.0f, 0, -0.0f}});
    for (const bool several : {false, true}) {
        Random random(5);
        TraceFrame f;
        f.place(f.add_mesh({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {0, 1, 2}));
        if (several) f.place(add_soup(f, random, 100), moved({0, 0, -5}));
        EmbreeScene scene(GetParam(), kPlenty);
        scene.update(f.frame, f.classes, arena);
        std::vector<Ray> rays;  // good ones between them, which must not suffer
        for (const Ray& ray : bad) {
            rays.push_back(ray);
            rays.push_back(good);
        }
        const auto check = [&](const std::vector<Hit>& hits, const std::vector<int>& blocked) {
            for (std::size_t r = 0; r < rays.size(); ++r) {
                EXPECT_EQ(hits[r].instance, r % 2 ? 0 : kNoHit) << r / 2;
                EXPECT_EQ(blocked[r], r % 2) << r / 2;
            }
        };
        check(nearest<1>(scene, rays), occluded<1>(scene, rays));
        check(nearest<4>(scene, rays), occluded<4>(scene, rays));
        check(nearest<8>(scene, rays), occluded<8>(scene, rays));
        for (const bool coherent : {false, true})
            check(nearest<16>(scene, rays, {coherent}), occluded<16>(scene, rays, coherent));
    }
}

TEST_P(EmbreeScenes, LanesThatAreOffAreNotTouched) {
    Arena arena(2);
    Random random(6);
    TraceFrame f;
    make_several(f, random);
    for (TraceClass& type : f.classes) type = {kMeetsSheer, true, false, true};
    f.classes[0] = {kMeetsSolid, true, false};
    EmbreeScene scene(GetParam(), kPlenty);
    scene.update(f.frame, f.classes, arena);
    for (int round = 0; round < 200; ++round) {
        RayPacket<16> packet{};
        int valid[16];
        for (int i = 0; i < 16; ++i) {
            set_ray(packet, i, random_ray(random), scene.trace_from_camera());
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
            EXPECT_EQ(packet.mask[i], before.mask[i]);
            if (valid[i]) continue;
            EXPECT_EQ(packet.t_far[i], before.t_far[i]);
            EXPECT_EQ(packet.triangle[i], 77u);
            EXPECT_EQ(packet.instance[i], 77u);
            EXPECT_EQ(packet.geometry[i], 77u);
            EXPECT_EQ(packet.u[i], 5.0f);
            EXPECT_EQ(packet.ng_x[i], 5.0f);
        }
    }
}

TEST(EmbreeScene, InstructionSetsFindTheSame) {
    Arena arena(2);
    for (const bool several : {false, true}) {
        Random random(31);
        TraceFrame f;
        make_all_kinds(f, random, several);
        const std::vector<Ray> rays = random_rays(random, 20000);
        std::vector<Hit> first;
        for (const Isa isa : trace_isas()) {
            EmbreeScene scene(isa, kPlenty);
            scene.update(f.frame, f.classes, arena);
            const std::vector<Hit> hits = nearest<8>(scene, rays);
            if (first.empty()) first = hits;
            int differ = 0;
            for (std::size_t r = 0; r < rays.size(); ++r)
                differ += hits[r].instance != first[r].instance || hits[r].triangle != first[r].triangle;
            std::printf("%s: %d of %zu rays differ from %s\n", name(isa), differ, rays.size(), name(trace_isas()[0]));
            EXPECT_LE(differ, 4);
        }
    }
}

// --- closed meshes ------------------------------------------------------------------------------

using Surface = std::pair<std::vector<Vec3>, std::vector<std::uint32_t>>;

// The quads of a grid that closes around itself, of u x v vertices.
void add_quads(Surface& s, std::uint32_t u, std::uint32_t v) {
    for (std::uint32_t i = 0; i < u; ++i) {
        for (std::uint32_t j = 0; j < v; ++j) {
            const std::uint32_t a = i * v + j, b = i * v + (j + 1) % v, c = (i + 1) % u * v + j,
                                d = (i + 1) % u * v + (j + 1) % v;
            s.second.insert(s.second.end(), {a, c, b, b, c, d});
        }
    }
}

Surface torus() {
    Surface s;
    for (int i = 0; i < 24; ++i) {
        for (int j = 0; j < 16; ++j) {
            const float u = 0.2617994f * static_cast<float>(i), v = 0.3926991f * static_cast<float>(j),
                        r = 1 + 0.4f * std::cos(v);
            s.first.push_back({r * std::cos(u), 0.4f * std::sin(v), -r * std::sin(u)});
        }
    }
    add_quads(s, 24, 16);
    return s;
}

// An octahedron, its triangles divided `depth` times; on a sphere, or flat.
Surface octahedron(int depth, bool sphere) {
    Surface s{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
              {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5}};
    for (int d = 0; d < depth; ++d) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, is_new] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(s.first.size()));
            if (is_new) {
                const Vec3 m = (s.first[a] + s.first[b]) * 0.5f;
                s.first.push_back(sphere ? normalize(m) : m);
            }
            return at->second;
        };
        std::vector<std::uint32_t> next;
        for (std::size_t t = 0; t < s.second.size(); t += 3) {
            const std::uint32_t a = s.second[t], b = s.second[t + 1], c = s.second[t + 2], ab = middle(a, b),
                                bc = middle(b, c), ca = middle(c, a);
            next.insert(next.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
        }
        s.second = std::move(next);
    }
    return s;
}

Surface cube() {
    Surface s;
    for (std::uint32_t i = 0; i < 8; ++i)
        s.first.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    s.second = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return s;
}

// Rays at vertices and at points of edges, by which they enter the closed surface, and cannot pass without a hit: they
// would also enter a somewhat smaller one.
struct AimedRay {
    Ray ray;
    bool vertex;  // at one, else at an edge or within a triangle
};
std::vector<AimedRay> rays_at_edges(const Surface& surface, bool ring, Random& random) {
    TraceFrame smaller;
    std::vector<Vec3> positions = surface.first;
    for (Vec3& p : positions) {
        const Vec3 middle = ring ? normalize(Vec3{p.x, 0, p.z}) : Vec3{};
        p = middle + (p - middle) * 0.9f;
    }
    smaller.place(smaller.add_mesh(positions, surface.second));
    const Truth inner(smaller);
    std::vector<AimedRay> rays;
    for (std::size_t t = 0; t < surface.second.size(); t += 3) {
        const Vec3 a = surface.first[surface.second[t]], b = surface.first[surface.second[t + 1]],
                   c = surface.first[surface.second[t + 2]], n = cross(b - a, c - a);
        Vec3 org = random.unit() * 5.0f;
        if (dot(org - a, n) < 0) org = org * -1.0f;
        const float s = random.in(0, 1);
        for (const Vec3 target : {a, (a + b) * 0.5f, b + (c - b) * s, c + (a - c) * s, (a + b + c) * (1.0f / 3)}) {
            const Ray ray{org, target - org};
            if (dot(ray.dir, n) < 0 && inner.nearest(ray).instance == 0) rays.push_back({ray, target == a});
        }
    }
    return rays;
}

// Embree's edges are tight because triangles that share one compute the same number for it. The few edges that meet in
// a vertex do so one by one: of rays aimed at the very vertex some slip through between them.
TEST_P(EmbreeScenes, ClosedMeshesAreTightAtEdges) {
    Arena arena(2);
    Random random(41);
    std::size_t most = 0;
    const Surface surfaces[] = {cube(), octahedron(3, false), octahedron(4, true), torus()};
    for (const Surface& surface : surfaces) {
        const bool ring = &surface == surfaces + 3;
        std::vector<AimedRay> aimed;
        for (int i = 0; i < (surface.second.size() < 100 ? 50 : 3); ++i)
            for (const AimedRay& ray : rays_at_edges(surface, ring, random)) aimed.push_back(ray);
        std::vector<Ray> rays;
        for (const AimedRay& a : aimed) rays.push_back(a.ray);
        EXPECT_GT(rays.size(), 1000u);
        for (const int kind : {0, 1, 2, 3}) {
            TraceFrame f;
            f.place(f.add_mesh(surface.first, surface.second), {}, {kMeetsSolid, kind / 2 == 1, false});
            if (kind % 2) f.place(f.add_mesh({{0, 90, 0}, {1, 90, 0}, {0, 91, 0}}, {0, 1, 2}), moved({1, 2, 3}));
            EmbreeScene scene(GetParam(), kPlenty);
            scene.update(f.frame, f.classes, arena);
            for (const std::vector<Hit>& hits :
                 {nearest<1>(scene, rays), nearest<4>(scene, rays), nearest<8>(scene, rays), nearest<16>(scene, rays),
                  nearest<16>(scene, rays, {true})}) {
                std::size_t slipped[2] = {};
                for (std::size_t r = 0; r < rays.size(); ++r) {
                    // Not through a convex one to its far side either.
                    if (hits[r].instance != 0 || (!ring && hits[r].t > 1.001f)) ++slipped[aimed[r].vertex];
                }
                EXPECT_EQ(slipped[0], 0u) << "of " << rays.size();
                EXPECT_LE(slipped[1], rays.size() / 100) << "of " << rays.size();
                most = std::max(most, slipped[1]);
            }
        }
    }
    std::printf("%s: at most %zu rays slip through a vertex\n", name(GetParam()), most);
}

TEST(EmbreeScene, AnEmptyFrameStopsNothing) {
    Arena arena(1);
    TraceFrame f;
    EmbreeScene scene(trace_isas().back(), kPlenty);
    const std::vector<Ray> rays{{{0, 0, 4}, {0, 0, -1}}};
    for (int round = 0; round < 2; ++round) {
        EXPECT_EQ(nearest<1>(scene, rays)[0], Hit{});
        EXPECT_EQ(nearest<16>(scene, rays)[0], Hit{});
        EXPECT_EQ(occluded<16>(scene, rays)[0], 0);
        EXPECT_TRUE(find_sheer<16>(scene, rays).empty());
        scene.update(f.frame, f.classes, arena);
        EXPECT_EQ(scene.statistics().groups, 0u);
    }
}

}  // namespace
}  // namespace tessera
