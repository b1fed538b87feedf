// Normals from the triangles around a vertex, against the definition.
#include "scene/vertex_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tessera {
namespace {

// A sphere of latitudes and longitudes: its own normals are known.
TEST(VertexNormals, LIT5_OfASphereAreItsRadii) {
    constexpr int kRings = 48, kSegments = 96;
    std::vector<Vec3> positions;
    for (int r = 0; r <= kRings; ++r)
        for (int s = 0; s < kSegments; ++s) {
            const double theta = 3.14159265358979 * r / kRings, phi = 2 * 3.14159265358979 * s / kSegments;
            positions.push_back({static_cast<float>(std::sin(theta) * std::cos(phi)),
                                 static_cast<float>(std::cos(theta)),
                                 static_cast<float>(-std::sin(theta) * std::sin(phi))});
        }
    std::vector<std::uint32_t> corners;
    const auto vertex = [](int r, int s) { return static_cast<std::uint32_t>(r * kSegments + s % kSegments); };
    for (int r = 0; r < kRings; ++r)
        for (int s = 0; s < kSegments; ++s) {
            corners.insert(corners.end(), {vertex(r, s), vertex(r + 1, s), vertex(r + 1, s + 1)});
            corners.insert(corners.end(), {vertex(r, s), vertex(r + 1, s + 1), vertex(r, s + 1)});
        }
    const std::vector<Vec3> normals = angle_weighted_normals(positions, corners, corners, positions.size());
    for (int r = 1; r < kRings; ++r)
        for (int s = 0; s < kSegments; ++s) {
            const Vec3 &n = normals[vertex(r, s)], &p = positions[vertex(r, s)];
            EXPECT_NEAR(n.x * p.x + n.y * p.y + n.z * p.z, 1, 1e-4) << r << " " << s;
            EXPECT_NEAR(n.x * n.x + n.y * n.y + n.z * n.z, 1, 1e-6);
        }
    std::size_t count = 0;
    const std::vector<std::uint32_t> groups = crease_groups(positions, corners, count);
    // One normal at each position, also at the poles' slivers, which have no area on one side.
    EXPECT_EQ(count, positions.size());
    ASSERT_EQ(groups.size(), corners.size());
}

TEST(VertexNormals, NothingToGoByGivesSomethingThatShades) {
    const std::vector<Vec3> positions{{1, 1, 1}, {1, 1, 1}, {2, 2, 2}, {9, 9, 9}};
    const std::vector<std::uint32_t> corners{0, 1, 2};
    for (const Vec3& n : angle_weighted_normals(positions, corners, corners, positions.size()))
        EXPECT_EQ(n, (Vec3{0, 0, 1}));
    // Two sides of one triangle.
    const std::vector<Vec3> triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::uint32_t> both{0, 1, 2, 0, 2, 1};
    for (const Vec3& n : angle_weighted_normals(triangle, both, both, 3)) EXPECT_EQ(n, (Vec3{0, 0, 1}));
}

// A fan of quarter turns around an axis: sharp edges part it, gentle ones do not.
TEST(VertexNormals, CreasesPartWhatFoldsByMoreThanSixtyDegrees) {
    for (const int degrees : {20, 55, 65, 90}) {
        const double a = degrees * 3.14159265358979 / 180;
        const std::vector<Vec3> positions{
            {0, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {static_cast<float>(std::cos(a)), static_cast<float>(-std::sin(a)), 0}};
        const std::vector<std::uint32_t> corners{0, 2, 1, 0, 1, 3};
        std::size_t count = 0;
        const std::vector<std::uint32_t> groups = crease_groups(positions, corners, count);
        EXPECT_EQ(count, degrees < 60 ? 4u : 6u) << degrees;
        EXPECT_EQ(groups[0] == groups[3], degrees < 60) << degrees;
    }
    // Hub of a wheel with more triangles than are compared.
    std::vector<Vec3> wheel{{0, 0, 0}};
    std::vector<std::uint32_t> corners;
    for (std::uint32_t i = 0; i < 100; ++i) {
        wheel.push_back({static_cast<float>(i), 1, i % 2 ? 5.0f : -5.0f});
        if (i > 0) corners.insert(corners.end(), {0, i, i + 1});
    }
    std::size_t count = 0;
    const std::vector<std::uint32_t> groups = crease_groups(wheel, corners, count);
    for (std::size_t c = 0; c < corners.size(); c += 3) EXPECT_EQ(groups[c], groups[0]);
}

}  // namespace
}  // namespace tessera
