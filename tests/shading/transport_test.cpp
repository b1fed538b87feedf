// Light along rays against the laws of optics in long double: mirroring, Snell, Fresnel, Beer; and rays against
// triangles: where they start, where they meet, and what their footprint covers there.
#include "shading/transport.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tessera {
namespace {

using namespace test;

testing::AssertionResult close(Real got, Real want, Real tolerance) {
    if (std::fabs(got - want) <= tolerance) return testing::AssertionSuccess();
    return testing::AssertionFailure() << got << " for " << want << ", " << std::fabs(got - want) << " off, more than "
                                       << tolerance;
}

constexpr float kEtas[] = {1 / 2.4f, 1 / 1.5f, 1 / 1.33f, 0.9f, 1.1f, 1.33f, 1.5f, 2.4f};

// A view at this angle (radians) from the normal.
Vec3T<float> view_at(Random& random, const Vec3T<float>& n, Real angle) {
    const Real3 across = unit(outer(Real3(n), Real3(random.unit())));
    return to_vec(Real3(n) * std::cos(angle) + across * std::sin(angle));
}

TEST(Mirrored, TheAnglesAreEqualAndInOnePlane) {
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const Vec3T<float> n = random.unit(), view = view_at(random, n, static_cast<Real>(random.in(0, 1.565f)));
        const Real3 d(mirrored(view, n, n));
        EXPECT_TRUE(close(norm(d), 1, 1e-6));
        EXPECT_TRUE(close(inner(d, Real3(n)), inner(Real3(view), Real3(n)), 1e-6));
        EXPECT_TRUE(close(inner(d, outer(Real3(view), Real3(n))), 0, 1e-6));
        // On the other side of the normal.
        EXPECT_TRUE(close(norm(d + Real3(view)), 2 * std::fabs(inner(d, Real3(n))), 1e-6));
    }
}

TEST(Mirrored, BentNormalsDoNotTurnLightIntoTheSurface) {
    Random random(2);
    int turned = 0;
    for (int i = 0; i < 5000; ++i) {
        const Vec3T<float> ng = random.unit(), view = view_at(random, ng, static_cast<Real>(random.in(0, 1.57f)));
        const Vec3T<float> bent = normalize_or(ng + random.box(0.9f), ng);
        const Vec3T<float> straight = bent * (2 * dot(bent, view)) - view;
        const Real3 d(mirrored(view, bent, ng));
        EXPECT_GE(inner(d, Real3(ng)), 0.99e-3L);
        EXPECT_TRUE(close(norm(d), 1, 2e-6));
        if (dot(straight, ng) >= 1e-3f) {
            EXPECT_EQ(to_vec(d).x, straight.x);
        } else {
            ++turned;
            // Within the plane of the two.
            EXPECT_TRUE(close(inner(d, outer(Real3(straight), Real3(ng))), 0, 2e-6));
        }
    }
    EXPECT_GT(turned, 200);
}

TEST(Refracted, TheAngleIsSnells) {
    Random random(3);
    for (const float eta : kEtas)
        for (int i = 0; i < 2000; ++i) {
            const Real angle = static_cast<Real>(random.in(0, 1.55f)), sine = std::sin(angle) * eta;
            if (sine > 0.999L) continue;
            const Vec3T<float> n = random.unit(), view = view_at(random, n, angle);
            const Real3 d(refracted(view, n, n, eta).direction);
            EXPECT_TRUE(close(norm(d), 1, 1e-6));
            EXPECT_TRUE(close(norm(outer(d, Real3(n))), sine, 2e-6));
            EXPECT_LT(inner(d, Real3(n)), 0);
            EXPECT_TRUE(close(inner(d, outer(Real3(view), Real3(n))), 0, 1e-6));
            // Across, not back.
            EXPECT_LE(inner(outer(d, Real3(n)), outer(Real3(view), Real3(n))), 1e-6);
        }
}

TEST(Refracted, LightIsReflectedTotallyBeyondTheCriticalAngleAndNotBefore) {
    Random random(4);
    for (const float eta : {1.01f, 1.1f, 1.33f, 1.5f, 2.4f}) {
        const Real critical = std::asin(1 / static_cast<Real>(eta));
        for (int i = 0; i < 2000; ++i) {
            // To the rounding of the squared sine.
            const Real sine =
                std::sin(critical) + (i % 2 ? 1 : -1) * (1e-6L + static_cast<Real>(random.in(0, 1)) / (1 << i % 20));
            if (sine > 1 || sine < 0) continue;
            const Vec3T<float> n{0, 0, 1}, view = view_at(random, n, std::asin(sine));
            const float reflected = refracted(view, n, n, eta).reflected;
            if (i % 2)
                EXPECT_EQ(reflected, 1) << eta << " " << static_cast<double>(sine * eta);
            else
                EXPECT_LT(reflected, 1) << eta << " " << static_cast<double>(sine * eta);
        }
    }
}

TEST(Refracted, AheadAndAtBrewstersAngleItReflectsWhatTheIndicesSay) {
    const Vec3T<float> n{0, 0, 1};
    for (const float eta : kEtas) {
        const Real root = (static_cast<Real>(eta) - 1) / (static_cast<Real>(eta) + 1);
        EXPECT_TRUE(close(refracted(n, n, n, eta).reflected, root * root, 1e-7));
        // The part that oscillates in the plane of incidence vanishes where tan = n2 / n1: half of the other is left.
        const Real angle = std::atan(1 / static_cast<Real>(eta)), across = std::cos(2 * angle);
        Random random(5);
        EXPECT_TRUE(close(refracted(view_at(random, n, angle), n, n, eta).reflected, across * across / 2, 2e-6));
    }
}

TEST(Refracted, AtEveryAngleFresnelsSinesAndTangents) {
    Random random(6);
    for (const float eta : kEtas)
        for (Real angle = 0.01L; angle < 1.55L; angle += 0.01L) {
            const Vec3T<float> n = random.unit(), view = view_at(random, n, angle);
            const Real i = std::acos(inner(Real3(view), Real3(n)) / norm(Real3(view)) / norm(Real3(n)));
            if (eta * std::sin(i) > 0.999L) continue;
            const Real t = std::asin(eta * std::sin(i));
            const Real s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
            const Refraction<float> r = refracted(view, n, n, eta);
            EXPECT_TRUE(close(r.reflected, (s * s + p * p) / 2, 2e-5)) << eta << " " << static_cast<double>(angle);
            // What goes on, by the amplitudes of the electric field (Born and Wolf, 1.5.2, formulas 20 and 35), along
            // the direction that was found.
            const Real ci = std::cos(i), ct = -inner(Real3(r.direction), Real3(n)), m = 1 / static_cast<Real>(eta);
            const Real ts = 2 * ci / (ci + m * ct), tp = 2 * ci / (m * ci + ct);
            EXPECT_TRUE(close(r.reflected + m * ct / ci * (ts * ts + tp * tp) / 2, 1, 1e-4))
                << eta << " " << static_cast<double>(angle);
        }
}

TEST(Refracted, BetweenEqualIndicesThereIsNothing) {
    Random random(7);
    for (int i = 0; i < 5000; ++i) {
        const Vec3T<float> n = random.unit();
        const Real above = i % 2 ? static_cast<Real>(random.in(0, 1.5f))
                                 : kRealPi / 2 - std::exp(static_cast<Real>(random.in(-12, 0)));
        const Vec3T<float> view = view_at(random, n, above);
        const Refraction<float> r = refracted(view, n, n, 1.0f);
        EXPECT_LT(r.reflected, 1e-6f) << "cosine " << dot(n, view);
        EXPECT_LT(distance(r.direction, Real3(view) * -1), 2e-3L) << "cosine " << dot(n, view);
    }
}

TEST(Refracted, AnythingGivesAPartAndADirectionBelow) {
    Random random(8);
    for (int i = 0; i < 20000; ++i) {
        const Vec3T<float> ng = random.unit(), bent = normalize_or(ng + random.box(0.5f), ng);
        const Vec3T<float> view = view_at(random, ng, static_cast<Real>(random.in(0, 1.5708f)));
        const Refraction<float> r = refracted(view, i % 2 ? ng : bent, ng, random.in(0.3f, 3));
        EXPECT_TRUE(r.reflected >= 0 && r.reflected <= 1) << r.reflected;
        EXPECT_TRUE(close(norm(Real3(r.direction)), 1, 2e-6));
        EXPECT_LE(dot(r.direction, ng), -0.99e-3f);
    }
}

TEST(Transmittance, IsBeersLaw) {
    Random random(9);
    for (int i = 0; i < 2000; ++i) {
        const Vec3T<float> a{random.in(0, 3), random.in(0, 0.1f), std::exp(random.in(-20, 20))};
        const float d = std::exp(random.in(-10, 5));
        const Vec3T<float> t = transmittance(a, d);
        const auto expect = [&](float got, float absorbed) {
            const Real want = std::exp(-static_cast<Real>(absorbed) * d);
            EXPECT_TRUE(close(got, want, 1e-6L + 2e-7L * static_cast<Real>(absorbed) * d * want));
        };
        expect(t.x, a.x), expect(t.y, a.y), expect(t.z, a.z);
    }
    const Vec3T<float> t = transmittance(Vec3T<float>{0, 1, 1e9f}, 3e38f),
                       none = transmittance(Vec3T<float>{0, 1, 1e9f}, 0.0f);
    EXPECT_EQ(t.x, 1);
    EXPECT_EQ(t.y, 0);
    EXPECT_EQ(t.z, 0);
    EXPECT_EQ(none.y, 1);
    EXPECT_EQ(none.z, 1);
}

TEST(RayOrigin, IsOnTheSideThatTheRayGoesTo) {
    Random random(10);
    for (int i = 0; i < 5000; ++i) {
        const Vec3T<float> p = random.box(std::exp(random.in(-10, 12))), ng = random.unit(), d = random.unit();
        const float size = coordinate_size(p, i % 2 ? 0.0f : std::exp(random.in(-10, 12)));
        const Vec3T<float> from = ray_origin(p, ng, d, size);
        const Real height = inner(Real3(from) - Real3(p), Real3(ng)) * (dot(ng, d) < 0 ? -1 : 1);
        EXPECT_GT(height, 3.5e-6L * size);
        EXPECT_LT(height, 4.5e-6L * size);
        EXPECT_GE(size, std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}));
    }
}

TEST(OntoPlane, MovesAPointAlongTheNormalToTheRoundingOfItsCoordinates) {
    Random random(11);
    for (int i = 0; i < 5000; ++i) {
        const float size = std::exp(random.in(-10, 12));
        const Vec3T<float> vertex = random.box(size), ng = random.unit(), p = random.box(size);
        const Vec3T<float> q = onto_plane(p, ng, dot(ng, vertex));
        EXPECT_TRUE(close(inner(Real3(q) - Real3(vertex), Real3(ng)), 0, 1e-6L * size));
        EXPECT_LT(norm(outer(Real3(q) - Real3(p), Real3(ng))), 1e-6L * size);
    }
}

}  // namespace
}  // namespace tessera
