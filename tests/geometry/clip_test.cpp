// Out-codes and polygon clipping in homogeneous space, against their definitions.
#include <tessera/clip.h>
#include <tessera/error.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tessera {
namespace {

std::uint32_t code_by_definition(Vec4 p) {
    const double x = p.x, y = p.y, z = p.z, w = p.w;
    return (x < -w ? 1u : 0u) | (x > w ? 2u : 0u) | (y < -w ? 4u : 0u) | (y > w ? 8u : 0u) | (z > w ? 16u : 0u) |
           (z < 0 ? 32u : 0u);
}

double signed_area(const ClipPolygon& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
        const Vec3 a = cartesian(p.positions[i]), b = cartesian(p.positions[(i + 1) % p.positions.size()]);
        sum += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
    }
    return 0.5 * sum;
}

// Area of the polygon's odd-even interior within the square [-1, 1]^2, by counting a fine grid.
double area_by_counting(const std::vector<Vec2>& polygon, int n) {
    int inside = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double x = -1 + (i + 0.5) * 2 / n, y = -1 + (j + 0.5) * 2 / n;
            bool in = false;
            for (std::size_t k = 0; k < polygon.size(); ++k) {
                const Vec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
                if ((a.y > y) != (b.y > y) &&
                    x < (static_cast<double>(b.x) - a.x) * (y - a.y) / (static_cast<double>(b.y) - a.y) + a.x)
                    in = !in;
            }
            inside += in;
        }
    return 4.0 * inside / (static_cast<double>(n) * n);
}

ClipPolygon flat(const std::vector<Vec2>& points, float w = 1) {
    ClipPolygon p;
    for (const Vec2& q : points) p.positions.push_back({q.x * w, q.y * w, 0.5f * w, w});
    return p;
}

TEST(Clip, RAS1_OutCodesFollowTheirDefinition) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(-2, 2);
    std::uint32_t seen = 0;
    for (int i = 0; i < 20000; ++i) {
        Vec4 p{value(random), value(random), value(random), value(random)};
        if (i % 7 == 0) p.x = p.w;  // exactly on a plane is inside
        if (i % 11 == 0) p.z = 0;
        EXPECT_EQ(out_code(p), code_by_definition(p));
        seen |= out_code(p);
    }
    EXPECT_EQ(seen, 63u);
    EXPECT_EQ(out_code({0, 0, 0.5f, 1}), 0u);
    EXPECT_EQ(out_code({1, -1, 1, 1}), 0u);
    EXPECT_EQ(out_code({-3, 2, -1, 1}), kClipLeft | kClipTop | kClipFar);
}

TEST(Clip, RAS1_SegmentsAreAcceptedAndRejectedByTheirCodes) {
    const Vec4 in{0, 0, 0.5f, 1}, left{-2, 0, 0.5f, 1}, left_top{-3, 4, 0.5f, 1}, right{2, 0, 0.5f, 1};
    EXPECT_EQ(out_code(in) | out_code(in), 0u);          // accept
    EXPECT_NE(out_code(left) & out_code(left_top), 0u);  // reject
    EXPECT_EQ(out_code(left) & out_code(right), 0u);     // undecided: crosses the volume
}

TEST(Clip, RAS2_InsidePolygonsComeBackUnchanged) {
    const ClipPolygon p = flat({{-0.5f, -0.5f}, {0.5f, -0.25f}, {0, 0.75f}});
    EXPECT_EQ(clip_polygon(p).positions, p.positions);
}

TEST(Clip, RAS2_OutsidePolygonsVanish) {
    EXPECT_TRUE(clip_polygon(flat({{1.5f, 0}, {3, 0}, {2, 2}})).positions.empty());
    EXPECT_TRUE(clip_polygon(flat({{0, 0}, {1, 0}, {0, 1}}, -1.0f)).positions.empty());  // behind the eye
    EXPECT_TRUE(clip_polygon({}).positions.empty());
}

TEST(Clip, RAS2_KnownCornerIsCut) {
    // A triangle that covers the corner (1, 1): the result is the unit square's corner region.
    const ClipPolygon c = clip_polygon(flat({{0, 0}, {3, 0}, {0, 3}}));
    ASSERT_EQ(c.positions.size(), 5u - 1u);  // (0,0) (1,0) (1,1) (0,1)
    EXPECT_NEAR(signed_area(c), 1.0, 1e-6);
}

TEST(Clip, RAS2_FillAreaIsPreservedForConvexAndConcavePolygons) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> radius(0.3f, 2.2f), w(0.2f, 3);
    for (int i = 0; i < 60; ++i) {
        // A star-shaped polygon around a point: simple, and concave nearly always.
        std::vector<Vec2> points;
        const int n = 5 + i % 6;
        for (int k = 0; k < n; ++k) {
            const double a = 2 * 3.14159265358979 * k / n;
            const float r = radius(random);
            points.push_back({static_cast<float>(0.3 + r * std::cos(a)), static_cast<float>(-0.2 + r * std::sin(a))});
        }
        const ClipPolygon c = clip_polygon(flat(points, w(random)), kClipLeft | kClipRight | kClipBottom | kClipTop);
        for (const Vec4& v : c.positions)
            EXPECT_EQ(code_by_definition({v.x * 0.99999f, v.y * 0.99999f, v.z, v.w}) & 15u, 0u);
        // Coincident edges along the planes cancel in the signed area.
        EXPECT_NEAR(signed_area(c), area_by_counting(points, 800), 0.012) << i;
    }
}

TEST(Clip, RAS2_AttributesAreInterpolatedInHomogeneousSpace) {
    // A segment towards the viewer: w runs from 1 to 3, the near plane cuts it.
    ClipPolygon p;
    p.positions = {{0, 0, 2, 1}, {0, 0, 0, 3}, {0.5f, 0, 0, 3}};
    p.attributes = {10, 1, 20, 2, 30, 3};
    p.attributes_per_vertex = 2;
    const ClipPolygon c = clip_polygon(p, kClipNear);
    ASSERT_EQ(c.attributes.size(), 2 * c.positions.size());
    for (std::size_t i = 0; i < c.positions.size(); ++i) {
        // position = sum b_i p_i and attribute = sum b_i a_i with the same b: solve b from w and x.
        const Vec4 q = c.positions[i];
        const double b0 = (3.0 - q.w) / 2.0, b2 = q.x / 0.5, b1 = 1 - b0 - b2;
        EXPECT_NEAR(c.attributes[2 * i], 10 * b0 + 20 * b1 + 30 * b2, 1e-5);
        EXPECT_NEAR(c.attributes[2 * i + 1], b0 + 2 * b1 + 3 * b2, 1e-6);
        EXPECT_LE(q.z, q.w + 1e-6f);
    }
}

TEST(Clip, RAS2_NeighboursGetTheSameNewVertex) {
    std::mt19937 random(9);
    std::uniform_real_distribution<float> value(-3, 3);
    for (int i = 0; i < 500; ++i) {
        const auto vertex = [&] { return Vec4{value(random), value(random), value(random), value(random)}; };
        const Vec4 a = vertex(), b = vertex(), c = vertex(), d = vertex();
        for (std::uint32_t plane = 1; plane <= kClipFar; plane <<= 1) {
            if (((out_code(a) ^ out_code(b)) & plane) == 0) continue;
            ClipPolygon one, two;
            one.positions = {a, b, c};
            two.positions = {b, a, d};
            const auto shared = [&](const ClipPolygon& p) {
                std::size_t hits = 0;
                for (const Vec4& v : clip_polygon(p, plane).positions)
                    for (const Vec4& u : clip_polygon(two, plane).positions) hits += v == u;
                return hits;
            };
            EXPECT_GE(shared(one), 2u);  // the end inside, and the new vertex
        }
    }
}

TEST(Clip, RAS2_MismatchedAttributesAreRefused) {
    ClipPolygon p = flat({{0, 0}, {1, 0}, {0, 1}});
    p.attributes = {1, 2};
    p.attributes_per_vertex = 1;
    EXPECT_THROW(clip_polygon(p), Error);
}

}  // namespace
}  // namespace tessera
