// The reference's rays against triangles, spheres and discs, beside analytic values; and who wins where two meet.
#include <gtest/gtest.h>

#include "reference/bvh.h"
#include "reference/raycaster.h"
#include "reference/workload_scene.h"
#include "render/scenes.h"

#include <cmath>
#include <random>

namespace tessera {
namespace {

using namespace test;

class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    double in(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
    Vec3d box(double size) {
        const double x = in(-size, size), y = in(-size, size);
        return {x, y, in(-size, size)};
    }

  private:
    std::mt19937_64 engine_;
};

double norm(const Vec3d& v) { return std::sqrt(dot(v, v)); }

// --- triangles ----------------------------------------------------------------------------------

// t = n.(P0 - Q) / n.d, and the point has these barycentrics.
TEST(IntersectTriangle, MeetsThePlaneWhereTheFormulaSays) {
    Random random(1);
    int met = 0, missed = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d v[3] = {random.box(1), random.box(1), random.box(1)};
        const Vec3d n = cross(v[1] - v[0], v[2] - v[0]);
        const double b1 = random.in(-0.5, 1.5), b2 = random.in(-0.5, 1.5), b0 = 1 - b1 - b2;
        const Vec3d aim = v[0] * b0 + v[1] * b1 + v[2] * b2, from = random.box(3),
                    d = (aim - from) * random.in(0.01, 100);
        const double cosine = dot(n, d) / (norm(n) * norm(d)), least = std::min({b0, b1, b2});
        if (norm(n) < 0.01 || std::fabs(cosine) < 0.01 || std::fabs(least) < 1e-9) continue;
        for (const double way : {1.0, -1.0}) {
            const std::optional<RayHit> hit = intersect({from, d * way}, v[0], v[1], v[2]);
            const double t = dot(n, v[0] - from) / dot(n, d * way);
            ASSERT_EQ(hit.has_value(), least > 0 && t > 0) << i;
            ++(hit ? met : missed);
            if (!hit) continue;
            ASSERT_NEAR(hit->t, t, 1e-9 * t);
            ASSERT_NEAR(hit->b[0], b0, 1e-9);
            ASSERT_NEAR(hit->b[1], b1, 1e-9);
            ASSERT_NEAR(hit->b[2], b2, 1e-9);
            // From the other side too.
            ASSERT_TRUE(intersect({from, d * way}, v[0], v[2], v[1]).has_value());
        }
    }
    EXPECT_GT(met, 1000);
    EXPECT_GT(missed, 10000);
}

TEST(IntersectTriangle, EdgesAndCornersBelongToIt) {
    const Vec3d v[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto down = [&](double x, double y) { return intersect({{x, y, 2}, {0, 0, -1}}, v[0], v[1], v[2]); };
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {4.0, 0.0}, {0.0, 4.0}, {2.0, 0.0}, {0.0, 1.0}, {2.0, 2.0}}) {
        ASSERT_TRUE(down(x, y).has_value()) << x << ", " << y;
        EXPECT_EQ(down(x, y)->t, 2);
    }
    for (const auto& [x, y] : {std::pair{-1e-9, 1.0}, {1.0, -1e-9}, {2.0, 2.0 + 1e-9}, {4.0 + 1e-9, 0.0}})
        EXPECT_FALSE(down(x, y).has_value()) << x << ", " << y;
}

TEST(IntersectTriangle, EdgeOnFlatAndBehindAreMisses) {
    const Vec3d v[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    EXPECT_FALSE(intersect({{-1, 1, 0}, {1, 0, 0}}, v[0], v[1], v[2]).has_value()) << "in the plane";
    EXPECT_FALSE(intersect({{1, 1, 1}, {1, 0, 0}}, v[0], v[1], v[2]).has_value()) << "along the plane";
    EXPECT_FALSE(intersect({{1, 1, 1}, {0, 0, 1}}, v[0], v[1], v[2]).has_value()) << "behind";
    EXPECT_FALSE(intersect({{1, 1, 1}, {0, 0, -1}}, v[0], v[1], v[1]).has_value()) << "without area";
    EXPECT_FALSE(intersect({{1, 1, 1}, {0, 0, -1}}, v[0], v[0], v[0]).has_value()) << "a point";
    const std::optional<RayHit> on = intersect({{1, 1, 0}, {0, 0, -1}}, v[0], v[1], v[2]);
    ASSERT_TRUE(on.has_value());
    EXPECT_EQ(on->t, 0);
}

// A ray at the common edge of two triangles meets at least one of them, whatever rounding makes of it; aimed at the
// edge's points exactly it meets both, at the same t.
TEST(IntersectTriangle, NoRayPassesBetweenNeighbours) {
    Random random(2);
    int both = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d a = random.box(1), b = random.box(1), c = random.box(1), from = random.box(5);
        const double s = random.in(0, 1);
        const Vec3d on = a * s + b * (1 - s), d = on - from;
        // The other corner beyond the edge, as it is seen.
        const Vec3d n = cross(a - from, b - from), e = c - n * (2 * dot(n, c - a) / dot(n, n));
        if (std::fabs(dot(n, c - a)) < 1e-3 * norm(n)) continue;
        const std::optional<RayHit> one = intersect({from, d}, a, b, c), two = intersect({from, d}, b, a, e);
        ASSERT_TRUE(one || two) << i;
        both += one && two;
    }
    EXPECT_GT(both, 10);
    // Numbers that are exact: in any order of the corners.
    const Vec3d p[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    for (int k = 0; k <= 16; ++k) {
        const double x = -1 + k / 8.0;
        const CastRay ray{{x, x, 3}, {0, 0, -1}};
        for (int turn = 0; turn < 3; ++turn) {
            const std::size_t i[3] = {0, 1, 2}, j[3] = {0, 2, 3};
            const auto at = [&](const std::size_t(&t)[3], int corner) { return p[t[(corner + turn) % 3]]; };
            const std::optional<RayHit> one = intersect(ray, at(i, 0), at(i, 1), at(i, 2)),
                                        two = intersect(ray, at(j, 0), at(j, 1), at(j, 2));
            ASSERT_TRUE(one && two) << k;
            EXPECT_EQ(one->t, two->t);
            EXPECT_EQ(one->t, 3);
        }
    }
}

// Of the two that meet there, the picture shows the one that comes first.
TEST(IntersectTriangle, TheLowerNumberWinsOnSharedEdges) {
    for (const bool turned : {false, true}) {
        Scene scene;
        Primitive square = rectangle(1, 1, 0, kNone);
        if (turned) square.indices = {0, 2, 3, 0, 1, 2};
        add_mesh(scene, square);
        add_orthographic(scene);
        View view;
        view.camera = 0;
        const Prepared p(scene, view, 64, 64);
        const Bvh tree(p.frame), list(p.frame, true);
        for (const Bvh* bvh : {&tree, &list}) {
            const Visibility seen = cast_rays(p.frame, *bvh, p.context(), {128, 128}, no_control());
            // The diagonal goes through the centres from the bottom left to the top right.
            for (std::size_t k = 0; k < 64; ++k) {
                ASSERT_EQ(seen.triangle[(63 - k) * 64 + k], 1u) << k;
                if (k > 0) {
                    ASSERT_EQ(seen.triangle[(63 - k) * 64 + k - 1], turned ? 1u : 2u) << k;
                    ASSERT_EQ(seen.triangle[(64 - k) * 64 + k], turned ? 2u : 1u) << k;
                }
            }
        }
    }
}

// --- spheres and discs --------------------------------------------------------------------------

InstanceView shape_at(ShapeView::Kind kind, float radius, Vec3 centre = {}, float scale = 1) {
    InstanceView instance{};
    const float to[12] = {scale, 0, 0, centre.x, 0, scale, 0, centre.y, 0, 0, scale, centre.z}, s = 1 / scale;
    const float from[12] = {s, 0, 0, -centre.x * s, 0, s, 0, -centre.y * s, 0, 0, s, -centre.z * s};
    std::copy_n(to, 12, instance.object_to_camera);
    std::copy_n(from, 12, instance.shape.camera_to_object);
    instance.shape.kind = kind;
    instance.shape.radius = radius;
    return instance;
}

// Roots of |Q + t d - C|^2 = r^2.
TEST(IntersectShape, ASphereHasTheRootsOfItsEquation) {
    Random random(3);
    int count[3] = {};
    for (int i = 0; i < 20000; ++i) {
        const Vec3 centre{static_cast<float>(i % 5), -2, static_cast<float>(i % 3)};
        const float scale = i % 2 ? 1.0f : 4.0f;
        const InstanceView sphere = shape_at(ShapeView::Kind::kSphere, 0.75f, centre, scale);
        const double r = 0.75 * static_cast<double>(scale);
        const Vec3d c{centre.x, centre.y, centre.z}, o = c + random.box(2 * r), d = random.box(3), q = o - c;
        const double a = dot(d, d), b = 2 * dot(q, d), e = dot(q, q) - r * r, discriminant = b * b - 4 * a * e;
        if (std::fabs(discriminant) < 1e-6) continue;
        int met = 0;
        for (const bool leaving : {false, true}) {
            const std::optional<RayHit> hit = intersect_shape({o, d}, sphere, leaving);
            const double t = (-b + (leaving ? 1 : -1) * std::sqrt(std::max(discriminant, 0.0))) / (2 * a);
            if (std::fabs(t) < 1e-9) continue;
            ASSERT_EQ(hit.has_value(), discriminant > 0 && t > 0) << i;
            if (hit) {
                ASSERT_NEAR(hit->t, t, 1e-6 * std::max(t, 1.0)) << i;
                ++met;
            }
        }
        ++count[met];
    }
    EXPECT_GT(count[0], 1000);  // beside, or behind
    EXPECT_GT(count[1], 1000);  // from within
    EXPECT_GT(count[2], 1000);
}

TEST(IntersectShape, ASphereFromAllPlaces) {
    const InstanceView sphere = shape_at(ShapeView::Kind::kSphere, 2);
    const auto t = [&](const Vec3d& o, const Vec3d& d, bool leaving) {
        const std::optional<RayHit> hit = intersect_shape({o, d}, sphere, leaving);
        return hit ? hit->t : -1;
    };
    EXPECT_EQ(t({0, 0, 5}, {0, 0, -1}, false), 3);
    EXPECT_EQ(t({0, 0, 5}, {0, 0, -1}, true), 7);
    EXPECT_EQ(t({0, 0, 5}, {0, 0, -0.5}, false), 6);
    // By its rim: once, twice at the same place.
    EXPECT_EQ(t({2, 0, 5}, {0, 0, -1}, false), 5);
    EXPECT_EQ(t({2, 0, 5}, {0, 0, -1}, true), 5);
    EXPECT_EQ(t({2.0000001, 0, 5}, {0, 0, -1}, false), -1);
    EXPECT_EQ(t({2.0000001, 0, 5}, {0, 0, -1}, true), -1);
    // From within, and from the middle.
    EXPECT_EQ(t({0, 0, 1}, {0, 0, -1}, false), -1);
    EXPECT_EQ(t({0, 0, 1}, {0, 0, -1}, true), 3);
    EXPECT_EQ(t({0, 0, 0}, {0, 1, 0}, true), 2);
    // From the surface inwards and outwards.
    EXPECT_EQ(t({0, 0, 2}, {0, 0, -1}, false), 0);
    EXPECT_EQ(t({0, 0, 2}, {0, 0, -1}, true), 4);
    EXPECT_EQ(t({0, 0, 2}, {0, 0, 1}, false), -1);
    EXPECT_EQ(t({0, 0, 2}, {0, 0, 1}, true), 0);
    // Behind.
    EXPECT_EQ(t({0, 0, 5}, {0, 0, 1}, false), -1);
    EXPECT_EQ(t({0, 0, 5}, {0, 0, 1}, true), -1);
}

TEST(IntersectShape, ADiscIsItsPlaneWithinTheRadius) {
    Random random(4);
    int met = 0, missed = 0;
    const InstanceView disc = shape_at(ShapeView::Kind::kDisc, 1.5f, {1, 2, 3}, 2);
    for (int i = 0; i < 20000; ++i) {
        const Vec3d o = Vec3d{1, 2, 3} + random.box(4), d = random.box(1);
        const double t = (2 - o.y) / d.y, x = o.x + d.x * t - 1, z = o.z + d.z * t - 3, far = std::hypot(x, z);
        if (std::fabs(far - 3) < 1e-6 || std::fabs(d.y) < 1e-6) continue;
        const std::optional<RayHit> hit = intersect_shape({o, d}, disc, false);
        ASSERT_EQ(hit.has_value(), t > 0 && far < 3) << i;
        ++(hit ? met : missed);
        if (hit) {
            ASSERT_NEAR(hit->t, t, 1e-9 * t);
        }
    }
    EXPECT_GT(met, 1000);
    EXPECT_GT(missed, 1000);
}

TEST(IntersectShape, ADiscsRimBelongsToItAndItsPlaneDoesNot) {
    const InstanceView disc = shape_at(ShapeView::Kind::kDisc, 2);
    const auto t = [&](const Vec3d& o, const Vec3d& d) {
        const std::optional<RayHit> hit = intersect_shape({o, d}, disc, false);
        return hit ? hit->t : -1;
    };
    EXPECT_EQ(t({2, 3, 0}, {0, -1, 0}), 3);
    EXPECT_EQ(t({0, -3, -2}, {0, 1, 0}), 3) << "from below";
    EXPECT_EQ(t({2.0000001, 3, 0}, {0, -1, 0}), -1);
    EXPECT_EQ(t({-5, 0, 0}, {1, 0, 0}), -1) << "within the plane";
    EXPECT_EQ(t({-5, 1, 0}, {1, 0, 0}), -1) << "along it";
    EXPECT_EQ(t({0, 0, 0}, {1, 0, 0}), -1);
    EXPECT_EQ(t({0.5, 0, 0}, {0, -1, 0}), 0) << "from a point of it";
    EXPECT_EQ(t({0, 3, 0}, {0, 1, 0}), -1) << "behind";
}

// A hierarchy finds of spheres and discs what looking at all of them does.
TEST(IntersectShape, HierarchiesFindAllOfThem) {
    Scene scene;
    Random random(5);
    for (int i = 0; i < 60; ++i) {
        const bool disc = i % 3 == 0;
        add_mesh(scene, i % 10 == 9
                            ? rectangle(0.3f, 0.2f, 0, kNone)
                            : shape_primitive({disc ? Shape::Type::kDisc : Shape::Type::kSphere, 0.4f, {0, 0}, 8}));
        Node& node = scene.nodes.back();
        const auto number = [&](double low, double high) { return static_cast<float>(random.in(low, high)); };
        node.translation = {number(-2, 2), number(-2, 2), number(-2, 2)};
        // Discs face the axes too, where their boxes are flat.
        if (i % 2) node.rotation = {number(0.1, 1), number(-1, 1), number(-1, 1), number(-1, 1)};
        if (i % 4 == 0) node.scale = {number(0.3, 2), number(-2, -0.3), number(0.3, 2)};
    }
    Frame frame;
    frame.exact_shapes = true;
    PreparedScene prepared(scene);
    make_frame(prepared, look({0, 0, 6}, {0, 0, 0}), 64, 64, {}, frame);
    ASSERT_TRUE(frame.has_exact_shapes);
    const Bvh tree(frame), list(frame, true);
    int hits = 0;
    for (int i = 0; i < 5000; ++i) {
        const CastRay ray{{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)},
                          Vec3d{0, 0, -6} + random.box(i % 2 ? 3 : 0)};
        const auto all = [&](const Bvh& bvh) {
            std::vector<std::pair<std::uint32_t, double>> found;
            bvh.traverse(ray, 0.0, 1e9, [&](const RayHit& hit, double t_max) {
                found.emplace_back(hit.triangle, hit.t);
                return t_max;
            });
            std::sort(found.begin(), found.end());
            return found;
        };
        const auto found = all(tree);
        ASSERT_EQ(found, all(list)) << i;
        hits += static_cast<int>(found.size());
    }
    EXPECT_GT(hits, 5000);
}

}  // namespace
}  // namespace tessera
