// Polygons to triangles: the same area, the same winding, every edge of the polygon once.
#include "load/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace tessera {
namespace {

double area(const Vec3& a, const Vec3& b, const Vec3& c) {  // signed, in x and y
    return 0.5 * ((static_cast<double>(b.x) - a.x) * (static_cast<double>(c.y) - a.y) -
                  (static_cast<double>(b.y) - a.y) * (static_cast<double>(c.x) - a.x));
}

double area(const std::vector<Vec3>& polygon) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) sum += area(polygon[0], polygon[i], polygon[i + 1]);
    return sum;
}

void expect_partition(const std::vector<Vec3>& polygon) {
    std::vector<std::uint32_t> triangles;
    triangulate_polygon(polygon, triangles);
    ASSERT_EQ(triangles.size(), 3 * (polygon.size() - 2));
    double sum = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    const double whole = area(polygon);
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        const double part = area(polygon[triangles[i]], polygon[triangles[i + 1]], polygon[triangles[i + 2]]);
        EXPECT_GE(part * whole, 0) << "a triangle is turned over";
        sum += part;
        for (std::size_t k = 0; k < 3; ++k) ++edges[{triangles[i + k], triangles[i + (k + 1) % 3]}];
    }
    EXPECT_NEAR(sum, whole, 1e-9 * std::abs(whole) + 1e-12);
    for (std::uint32_t i = 0; i < polygon.size(); ++i)
        EXPECT_EQ((edges[{i, (i + 1) % static_cast<std::uint32_t>(polygon.size())}]), 1) << "edge " << i;
    for (const auto& [edge, times] : edges) EXPECT_LE(times, 1);
}

TEST(Polygon, ConvexOnesBecomeAFan) {
    std::vector<std::uint32_t> triangles;
    triangulate_polygon(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, triangles);
    EXPECT_EQ(triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
    triangles.clear();
    triangulate_polygon(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}}, triangles);
    EXPECT_TRUE(triangles.empty());
}

TEST(Polygon, ConcaveOnesKeepTheirArea) {
    expect_partition({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}});  // a dart
    expect_partition({{0, 0, 0}, {0, 4, 0}, {1, 1, 0}, {4, 0, 0}});  // the other way round
    expect_partition({{0, 0, 0}, {6, 0, 0}, {6, 2, 0}, {4, 2, 0}, {4, 1, 0}, {2, 1, 0}, {2, 2, 0}, {0, 2, 0}});
    expect_partition({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}});  // corners on edges
    std::vector<Vec3> spiral;
    for (int i = 0; i < 40; ++i)
        spiral.push_back({(1.0f + 0.1f * static_cast<float>(i)) * std::cos(0.4f * static_cast<float>(i)),
                          (1.0f + 0.1f * static_cast<float>(i)) * std::sin(0.4f * static_cast<float>(i)), 0});
    for (int i = 39; i >= 0; --i)
        spiral.push_back({(0.8f + 0.1f * static_cast<float>(i)) * std::cos(0.4f * static_cast<float>(i)),
                          (0.8f + 0.1f * static_cast<float>(i)) * std::sin(0.4f * static_cast<float>(i)), 0});
    expect_partition(spiral);
}

// Radii at random around a centre: never self-crossing, mostly concave.
TEST(Polygon, RandomStars) {
    std::mt19937 random(7);
    for (int round = 0; round < 300; ++round) {
        const int count = 4 + static_cast<int>(random() % 60);
        std::vector<Vec3> star;
        for (int i = 0; i < count; ++i) {
            const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(count);
            const float radius = 0.2f + static_cast<float>(random() % 1000) / 1000;
            star.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
        }
        expect_partition(star);
    }
}

TEST(Polygon, AnyPlaneAndHugeOnes) {
    // A dart in the planes of y, z and z, x.
    for (const bool first : {false, true}) {
        const auto point = [&](float a, float b) { return first ? Vec3{5, a, b} : Vec3{b, 5, a}; };
        std::vector<std::uint32_t> triangles;
        triangulate_polygon(std::vector<Vec3>{point(0, 0), point(4, 0), point(1, 1), point(0, 4)}, triangles);
        EXPECT_EQ(triangles.size(), 6u);
        for (std::size_t i = 0; i < 6; i += 3)  // both triangles touch the reflex corner
            EXPECT_TRUE(triangles[i] == 2 || triangles[i + 1] == 2 || triangles[i + 2] == 2);
    }
    std::vector<Vec3> comb;  // 100,000 corners, half of them reflex
    for (int i = 0; i < 50000; ++i) {
        comb.push_back({static_cast<float>(i), 0, 0});
        comb.push_back({static_cast<float>(i) + 0.5f, i % 2 ? 1.0f : 5.0f, 0});
    }
    std::vector<std::uint32_t> triangles;
    triangulate_polygon(comb, triangles);
    EXPECT_EQ(triangles.size(), 3 * (comb.size() - 2));
    triangles.clear();
    triangulate_polygon(std::vector<Vec3>(1000, Vec3{1, 2, 3}), triangles);  // no extent at all
    EXPECT_EQ(triangles.size(), 3u * 998);
}

}  // namespace
}  // namespace tessera
