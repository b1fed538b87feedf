// LIT4: the metallic-roughness lobe against an independent implementation of glTF 2.0 appendix B in
// long double (the Smith term by Heitz' Lambda, height-correlated; the base's weight as lobes.h states
// it), reciprocity, and the white furnace:
// integrals over all directions of what leaves per unit of what arrives.
#include "shading/lobes.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using test::Real;
using test::Real3;

LobeParameters<float> parameters(const Vec3T<float>& normal, const Vec3T<float>& view, const Vec3T<float>& base,
                                 float metallic, float roughness) {
    LobeParameters<float> p{};
    p.normal = normal;
    p.view = view;
    p.n_v = dot(normal, view);
    p.base = base;
    p.metallic = metallic;
    p.roughness = roughness;
    p.f0 = mix(Vec3T<float>::splat(0.04f), base, metallic);
    p.f90 = 1;
    return p;
}

Vec3T<float> reflect(const LobeParameters<float>& p, const Vec3T<float>& to_light) {
    return MetallicRoughnessLobe::reflect(p, Incidence<float>{to_light, dot(p.normal, to_light)});
}

// Lambda of Smith's masking function for GGX (Heitz 2014, equation 72).
Real lambda(Real cosine, Real alpha) {
    const Real tan2 = (1 - cosine * cosine) / (cosine * cosine);
    return (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
}

// Specular part without Fresnel: D G / (4 n.l n.v).
Real microfacets(Real n_l, Real n_v, Real3 n, Real3 h, Real alpha) {
    const Real3 across = outer(n, h);
    const Real cos2 = inner(n, h) * inner(n, h), tan2 = inner(across, across) / cos2;
    const Real a2 = alpha * alpha;
    // GGX as Walter et al. 2007 write it: a^2 / (pi cos^4 (a^2 + tan^2)^2).
    const Real d = a2 / (test::kRealPi * cos2 * cos2 * (a2 + tan2) * (a2 + tan2));
    return d / (1 + lambda(n_l, alpha) + lambda(n_v, alpha)) / (4 * n_l * n_v);
}

// BRDF times n.l, of one channel.
Real appendix_b(const LobeParameters<float>& p, Real base, const Vec3T<float>& to_light) {
    const Real3 n = unit(Real3(p.normal)), v = unit(Real3(p.view)), l = unit(Real3(to_light)), h = unit(l + v);
    const Real n_l = inner(n, l), n_v = inner(n, v), metallic = p.metallic;
    if (n_l <= 0) return 0;
    const Real diffuse = base * (1 - metallic), f0 = 0.04L * (1 - metallic) + base * metallic;
    const Real fresnel = f0 + (1 - f0) * std::pow(1 - inner(v, h), 5);
    const Real alpha = static_cast<Real>(p.roughness) * p.roughness;
    // The base gets what the microfacets leave in the flatter direction (lobes.h).
    const Real f90 = std::fmax(f0, 1 / (1 + 11.5L * std::pow(static_cast<Real>(p.roughness), 3)));
    const Real left = 1 - (f0 + (f90 - f0) * std::pow(1 - std::fmin(n_l, n_v), 5));
    return (left * diffuse / test::kRealPi + fresnel * microfacets(n_l, n_v, n, h, alpha)) * n_l;
}

Vec3T<float> above(test::Random& random, const Vec3T<float>& n, float least_cosine) {
    for (;;) {
        const Vec3T<float> d = random.unit();
        if (dot(d, n) > least_cosine) return d;
    }
}

TEST(LIT4_MetallicRoughness, EqualsAppendixB) {
    test::Random random(21);
    Real worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const Vec3T<float> n = random.unit();
        const Vec3T<float> v = above(random, n, 0.01f);
        // Half of the lights near the mirror direction, where smooth surfaces have their highlight.
        Vec3T<float> l = above(random, n, 0.01f);
        const float rough = random.in(MetallicRoughnessLobe::kSmallestRoughness, 1);
        if (i % 2) {
            l = n * (2 * dot(n, v)) - v + random.box(1) * (rough * rough);
            l = l * (1 / std::sqrt(dot(l, l)));
            if (dot(n, l) < 0.01f) continue;
        }
        const float metallic = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 1.0f : random.in(0, 1);
        const LobeParameters<float> p = parameters(n, v, {random.in(0, 1), 1, 0}, metallic, rough);
        const Vec3T<float> got = reflect(p, l);
        const float channels[3] = {got.x, got.y, got.z}, base[3] = {p.base.x, p.base.y, p.base.z};
        for (int c = 0; c < 3; ++c) {
            const Real want = appendix_b(p, base[c], l);
            worst = std::fmax(worst, std::fabs(channels[c] - want) / (want + 1e-6L));
        }
    }
    // Directions are known to 2^-23; the narrowest lobe, alpha 9e-4, magnifies that by 1 / alpha.
    EXPECT_LT(worst, 4e-3L);
}

TEST(LIT4_MetallicRoughness, NothingFromBelowTheSurface) {
    test::Random random(22);
    for (int i = 0; i < 5000; ++i) {
        const Vec3T<float> n = random.unit(), v = above(random, n, 0.0f), below = -above(random, n, 0.0f);
        const Vec3T<float> got = reflect(parameters(n, v, {1, 1, 1}, random.in(0, 1), random.in(0, 1)), below);
        ASSERT_EQ(got.x, 0);
        ASSERT_EQ(got.z, 0);
    }
}

TEST(LIT4_MetallicRoughness, Reciprocal) {
    test::Random random(23);
    for (int i = 0; i < 20000; ++i) {
        const Vec3T<float> n = random.unit(), a = above(random, n, 0.02f), b = above(random, n, 0.02f);
        const float metallic = random.in(0, 1), rough = random.in(0.1f, 1);
        const float ab = reflect(parameters(n, a, {0.7f, 0.7f, 0.7f}, metallic, rough), b).x / dot(n, b);
        const float ba = reflect(parameters(n, b, {0.7f, 0.7f, 0.7f}, metallic, rough), a).x / dot(n, a);
        ASSERT_NEAR(ab / ba, 1, 5e-4) << rough;
    }
}

TEST(LIT4_MetallicRoughness, FiniteAtEveryLimit) {
    const Vec3T<float> n{0, 0, 1}, up{0, 0, 1}, graze{1, 0, 0}, low{1, 0, 1e-7f}, behind{0, 0.6f, -0.8f};
    for (const float rough : {0.0f, 1e-30f, 1e-6f, 0.03f, 1.0f})
        for (const float metallic : {0.0f, 1.0f})
            for (const Vec3T<float>& v : {up, graze, low, -graze, behind})
                for (const Vec3T<float>& l : {up, graze, low, -graze, behind, -v, v}) {
                    const Vec3T<float> got = reflect(parameters(n, v, {1, 1, 1}, metallic, rough), l);
                    ASSERT_TRUE(std::isfinite(got.x) && got.x >= 0) << rough << " " << v.z << " " << l.z;
                }
}

// --- white furnace --------------------------------------------------------------------------

// The integral of reflect() over all directions to the light. Two deterministic grids of directions,
// around the highlight (half vectors distributed as GGX) and over the hemisphere (by the cosine),
// weighted by the sum of their densities (Veach's balance heuristic).
double albedo(const LobeParameters<float>& p, bool highlight, int grid = 96) {
    const double rough = std::max(static_cast<double>(p.roughness), 0.03);
    const double a2 = rough * rough * rough * rough;
    const Real3 v(p.view);
    double sum = 0;
    const auto add = [&](Real3 l) {
        if (l.z <= 0) return;
        const Real3 h = unit(l + v);
        const double c = static_cast<double>(h.z), s2 = static_cast<double>(h.x * h.x + h.y * h.y);
        const double base = a2 * c * c + s2;
        double density = static_cast<double>(l.z) / static_cast<double>(test::kRealPi);
        if (highlight)
            density +=
                a2 * c / (static_cast<double>(test::kRealPi) * base * base * 4 * static_cast<double>(inner(v, h)));
        sum += static_cast<double>(reflect(p, test::to_vec(l)).x) / density;
    };
    for (int i = 0; i < grid; ++i)
        for (int k = 0; k < grid; ++k) {
            const double u = (i + 0.5) / grid, angle = 2 * static_cast<double>(test::kRealPi) * (k + 0.5) / grid;
            const double sin_l = std::sqrt(u);
            add({sin_l * std::cos(angle), sin_l * std::sin(angle), std::sqrt(1 - u)});
            if (!highlight) continue;
            const double c2 = (1 - u) / (1 + (a2 - 1) * u), s = std::sqrt(1 - c2);
            const Real3 h{s * std::cos(angle), s * std::sin(angle), std::sqrt(c2)};
            add(h * (2 * inner(v, h)) - v);
        }
    return sum / (grid * grid);
}

constexpr double kCosines[] = {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0};
constexpr float kRoughnesses[] = {0.0f, 0.03f, 0.1f, 0.2f, 0.35f, 0.5f, 0.7f, 0.85f, 1.0f};

Vec3T<float> view_at(double cosine) {
    return {static_cast<float>(std::sqrt(1 - cosine * cosine)), 0, static_cast<float>(cosine)};
}

TEST(LIT4_WhiteFurnace, MetalNeverReturnsMoreThanItReceives) {
    for (const float rough : kRoughnesses)
        for (const double cosine : kCosines) {
            const double e = albedo(parameters({0, 0, 1}, view_at(cosine), {1, 1, 1}, 1, rough), true);
            EXPECT_LE(e, 1.004) << "roughness " << rough << ", n.v " << cosine;
            // A single-scattering lobe loses what it would scatter twice: much at full roughness only.
            EXPECT_GE(e, rough < 0.3f ? 0.88 : 0.3) << "roughness " << rough << ", n.v " << cosine;
        }
}

// A white dielectric returns nearly all: its base gets what the microfacets leave.
TEST(LIT4_WhiteFurnace, NorDoesAnyMixtureOfDielectricAndMetal) {
    for (const float metallic : {0.0f, 0.25f, 0.5f, 0.75f})
        for (const float rough : kRoughnesses)
            for (const double cosine : kCosines) {
                const double e = albedo(parameters({0, 0, 1}, view_at(cosine), {1, 1, 1}, metallic, rough), true);
                EXPECT_LE(e, 1.004) << "metallic " << metallic << ", roughness " << rough << ", n.v " << cosine;
                if (metallic > 0) continue;
                EXPECT_GE(e, 0.74) << "roughness " << rough << ", n.v " << cosine;
            }
}

TEST(LIT4_WhiteFurnace, AmbientLightNeverGainsEither) {
    const AmbientView furnace = test::even_ambient(1);
    for (int m = 0; m <= 10; ++m)
        for (int r = 0; r <= 100; ++r)
            for (int c = 0; c <= 100; ++c) {
                const Vec3T<float> v = view_at(0.01 * c);
                const float metallic = 0.1f * static_cast<float>(m), rough = 0.01f * static_cast<float>(r);
                const LobeParameters<float> p = parameters({0, 0, 1}, v, {1, 1, 1}, metallic, rough);
                const Vec3T<float> e = MetallicRoughnessLobe::reflect_ambient(p, furnace);
                ASSERT_LE(e.x, 1.000001f) << metallic << " " << rough << " " << v.z;
                ASSERT_GE(e.x, 0.0f);
            }
}

// The split-sum fit against the integral: it is rough work, and worst for rough metals at a grazing
// angle, which it makes too dark.
TEST(LIT4_WhiteFurnace, AmbientHighlightApproximatesTheIntegral) {
    const AmbientView furnace = test::even_ambient(1);
    double sum = 0;
    int count = 0;
    for (const float rough : {0.2f, 0.35f, 0.5f, 0.7f, 0.85f, 1.0f})
        for (const double cosine : {0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0}) {
            const LobeParameters<float> p = parameters({0, 0, 1}, view_at(cosine), {0.9f, 0.9f, 0.9f}, 1, rough);
            const double fit = static_cast<double>(MetallicRoughnessLobe::reflect_ambient(p, furnace).x);
            const double difference = std::fabs(fit - albedo(p, true));
            EXPECT_LT(difference, cosine < 0.35 ? 0.29 : 0.18) << rough << " " << cosine;
            sum += difference;
            ++count;
        }
    EXPECT_LT(sum / count, 0.12);
}

TEST(LIT4_WhiteFurnace, LambertReturnsAll) {
    const MaterialView m = test::plain_material(ShadingModel::kLambert);
    const SurfacePoint<float> point = test::plain_point({0, 0, -1}, {0, 0, 1});
    double sum = 0;
    constexpr int kRings = 400;
    for (int i = 0; i < kRings; ++i) {  // rings of equal solid angle
        const float cosine = (static_cast<float>(i) + 0.5f) / kRings;
        const Vec3T<float> l = view_at(static_cast<double>(cosine));
        const std::vector<LightView> lights{test::directional_light(l, 1)};
        sum += static_cast<double>(test::shade_unshadowed(test::plain_context(lights), m, point).radiance.x) * 2 *
               static_cast<double>(test::kRealPi) / kRings;
    }
    EXPECT_NEAR(sum, 1, 1e-4);
}

}  // namespace
}  // namespace tessera
