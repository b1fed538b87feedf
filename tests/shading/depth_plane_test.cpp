// RAS5: the canonical depth plane against the plane's depth in long double: at the vertices, between
// them, clamped to the triangle's own range; of clipped triangles too.
#include "shading/triangle_setup.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

using test::Real;
using test::Real3;

constexpr float kWidth = 1024, kHeight = 768;

// One triangle before a 90 degree lens, near plane 0.1, infinitely far.
struct OneTriangle {
    float positions[9];
    std::uint32_t indices[3] = {0, 1, 2};
    InstanceView instance{};
    ProjectionView projection{};

    OneTriangle() {
        const float clip[16] = {0.75f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0.1f, 0, 0, -1, 0};
        std::memcpy(instance.object_to_clip, clip, sizeof clip);
        instance.mesh.positions = positions;
        instance.mesh.triangles = indices;
        instance.mesh.triangle_count = 1;
        instance.mesh.vertex_count = 3;
        instance.handedness = 1;
        projection.width = kWidth;
        projection.height = kHeight;
        projection.near = 0.1f;
    }

    // z / w of the triangle's plane where the ray through a 24.8 position meets it.
    Real depth(Real x, Real y) const {
        const Real3 ray{(x / (128 * kWidth) - 1) / 0.75L, 1 - y / (128 * kHeight), -1};
        const Real3 a{positions[0], positions[1], positions[2]}, b{positions[3], positions[4], positions[5]},
            c{positions[6], positions[7], positions[8]};
        const Real3 n = outer(b - a, c - a);
        return 0.1f * inner(n, ray) / inner(n, a);
    }
};

void randomise(test::Random& random, bool crossing, OneTriangle& t) {
    const float far = std::exp2(random.in(-1, 8));
    for (int i = 0; i < 3; ++i) {
        const Vec3T<float> v = Vec3T<float>{0, 0, -far} + random.box(0.8f * far);
        t.positions[3 * i] = v.x;
        t.positions[3 * i + 1] = v.y;
        t.positions[3 * i + 2] = crossing && i == 2 ? random.in(0.01f, 1) * far : v.z;
    }
}

// A slope is known to the roundings of the picture positions over the triangle's height, so the error
// is stated in units of the change of depth over the triangle (its range), and only for triangles that
// are not slivers.
TEST(RAS5_DepthPlane, IsThePlaneOfTheTriangle) {
    test::Random random(51);
    OneTriangle t;
    TriangleSetup setup;
    int plain = 0, clipped = 0;
    for (int i = 0; i < 60000; ++i) {
        randomise(random, i % 2, t);
        setup_triangle(t.instance, 0, t.projection, setup);
        if (!setup.visible()) continue;
        const bool cut = setup.kind == TriangleSetup::Kind::kClipped;
        const DepthPlane<float>& plane = setup.depth;
        ASSERT_LE(plane.lowest, plane.highest);
        ASSERT_LE(plane.highest, 1.0f);
        ASSERT_GE(plane.lowest, 0.0f);
        const SnappedVertex &a = setup.polygon[0], &b = setup.polygon[1], &c = setup.polygon[2];
        const Real area = std::fabs(static_cast<Real>(twice_area(a, b, c)));
        const Real size = std::max(
            {std::hypot(b.x - a.x, b.y - a.y), std::hypot(c.x - a.x, c.y - a.y), std::hypot(c.x - b.x, c.y - b.y)});
        const Real height = area / size;  // of the thinnest direction, 1/256 pixel
        if (height < 4 * 256) continue;
        for (int k = 0; k < 8; ++k) {
            const float u = random.in(0, 1), v = random.in(0, 1 - u);
            const auto along = [&](int p, int q, int r) {
                return p + static_cast<std::int32_t>(u * static_cast<float>(q - p) + v * static_cast<float>(r - p));
            };
            const std::int32_t x = along(a.x, b.x, c.x), y = along(a.y, b.y, c.y);
            const Real want =
                std::clamp(t.depth(x, y), static_cast<Real>(plane.lowest), static_cast<Real>(plane.highest));
            const Real got = plane.at(x, y);
            ASSERT_GE(got, plane.lowest);
            ASSERT_LE(got, plane.highest);
            const Real range = static_cast<Real>(plane.highest) - plane.lowest;
            ASSERT_NEAR(static_cast<double>(got), static_cast<double>(want),
                        static_cast<double>(plane.highest * 1e-6L + range * 2 / height))
                << "case " << i << (cut ? ", clipped" : "") << ", height " << static_cast<double>(height);
        }
        ++(cut ? clipped : plain);
    }
    EXPECT_GT(plain, 4000);
    EXPECT_GT(clipped, 2000);
}

// Beyond the triangle the plane would go on; the result stays within the triangle's depths.
TEST(RAS5_DepthPlane, NeverLeavesTheRangeOfTheTriangle) {
    test::Random random(52);
    OneTriangle t;
    TriangleSetup setup;
    for (int i = 0; i < 20000; ++i) {
        randomise(random, i % 2, t);
        setup_triangle(t.instance, 0, t.projection, setup);
        if (!setup.visible()) continue;
        for (int k = 0; k < 4; ++k) {
            const float z = setup.depth.at(static_cast<int>(random.below(1u << 20)) - (1 << 19),
                                           static_cast<int>(random.below(1u << 20)) - (1 << 19));
            ASSERT_GE(z, setup.depth.lowest);
            ASSERT_LE(z, setup.depth.highest);
        }
    }
}

// A triangle parallel to the picture has one depth, exactly, everywhere: near / distance.
TEST(RAS5_DepthPlane, LevelTrianglesTieExactly) {
    OneTriangle t;
    TriangleSetup setup;
    test::Random random(53);
    for (int i = 0; i < 1000; ++i) {
        const float d = std::exp2(static_cast<float>(random.below(10)));
        for (int k = 0; k < 3; ++k) {
            t.positions[3 * k] = random.in(-1, 1) * d;
            t.positions[3 * k + 1] = random.in(-1, 1) * d;
            t.positions[3 * k + 2] = -d;
        }
        setup_triangle(t.instance, 0, t.projection, setup);
        if (!setup.visible()) continue;
        for (int k = 0; k < 10; ++k)
            ASSERT_EQ(setup.depth.at(static_cast<int>(random.below(262144)), static_cast<int>(random.below(196608))),
                      0.1f / d);
    }
}

// The same polygon whichever vertex comes first: the same depth to rounding.
TEST(RAS5_DepthPlane, AnchoredAtTheTriangleNotAtThePicture) {
    OneTriangle t;
    TriangleSetup setup;
    test::Random random(54);
    for (int i = 0; i < 5000; ++i) {
        randomise(random, false, t);
        setup_triangle(t.instance, 0, t.projection, setup);
        if (setup.kind != TriangleSetup::Kind::kPlain) continue;
        // At the anchor the plane holds the vertex' own depth, up to the snapping distance.
        const DepthPlane<float>& p = setup.depth;
        ASSERT_EQ(p.anchor_x, setup.polygon[0].x);
        ASSERT_EQ(p.anchor_y, setup.polygon[0].y);
        const float own = setup.vertices[0].z / setup.vertices[0].w;
        ASSERT_NEAR(p.at(p.anchor_x, p.anchor_y), own, std::fabs(p.ddx) + std::fabs(p.ddy) + 1e-7f * own);
    }
}

}  // namespace
}  // namespace tessera
