// Pictures through glass against geometrical optics: a slab moves what is behind it, a prism mirrors all of the light,
// a thick block takes a part of it, a ball turns the picture around, water in a glass is one body.
#include <gtest/gtest.h>

#include "render/traced_scenes.h"

#include <cmath>

namespace tessera {
namespace {

using namespace test;

constexpr double kDegree = 3.14159265358979323846 / 180;

// The reference is slow.
int side_of(Engine engine) { return engine == Engine::kReferenceTrace ? 64 : 256; }
RenderResult picture(const Scene& scene, Engine engine) {
    RenderOptions o = traced(engine, side_of(engine), side_of(engine));
    o.min_contribution = 0.02f;
    return render(scene, o);
}
// The first pixel of a row, from x = -1/2 to 1/2, of which test() is true; as the x of its left edge.
template <class Test>
double first_at(const RenderResult& r, double height, Test&& test) {
    const int side = r.linear.width(), row = static_cast<int>((1 - height) / 2 * side);
    int x = side / 4;
    while (x < side * 3 / 4 && !test(linear_at(r, x, row))) ++x;
    return 2.0 * x / side - 1;
}

// Left of x = `edge` one colour, right of it another.
void add_wall(Scene& scene, float edge, float z, Vec3 left, Vec3 right) {
    place(scene, rectangle(4, 4, 0, add_material(scene, unlit({left.x, left.y, left.z, 1}))), {edge - 4, 0, z});
    place(scene, rectangle(4, 4, 0, add_material(scene, unlit({right.x, right.y, right.z, 1}))), {edge + 4, 0, z});
}

TEST(Refraction, ASlabMovesWhatIsBehindIt) {
    constexpr double kThickness = 0.5;
    for (const Engine engine : kTracers)
        for (const double ior : {1.33, 1.5, 2.4})
            for (const double degrees : {-40.0, 20.0, 40.0, 60.0}) {
                const double i = degrees * kDegree, s = std::sin(i);
                const double offset = kThickness * s * (1 - std::cos(i) / std::sqrt(ior * ior - s * s));
                Scene scene;
                add_wall(scene, 0, -6, {0, 0, 0}, {1, 1, 1});
                const int m = add_material(scene, glass(static_cast<float>(ior)));
                place(scene, box({3, 0.45f, 0.5f * static_cast<float>(kThickness)}, m), {0, -0.5f, 0},
                      quaternion({0, 1, 0}, static_cast<float>(i)));
                add_orthographic(scene);
                const RenderResult r = picture(scene, engine);
                const auto bright = [](const Vec4& c) { return c.x > 0.3f; };
                const double pixel = 2.0 / side_of(engine);
                EXPECT_NEAR(first_at(r, 0.5, bright), 0, 1e-6) << name(engine);  // above it
                EXPECT_NEAR(first_at(r, -0.5, bright), offset, pixel) << name(engine) << ", " << ior << ", " << degrees;
            }
}

TEST(Refraction, APrismMirrorsAllOfTheLightBeyondTheCriticalAngle) {
    // A right angle at (0.5, 0.5) in x and z; light enters one leg, meets the hypotenuse at 45 degrees.
    const auto prism = [](int material) {
        const Vec3 p{0.5f, -1, 0.5f}, q{-0.5f, -1, 0.5f}, r{0.5f, -1, -0.5f}, up{0, 2, 0};
        return solid({{q, p, p + up, q + up},
                      {p, r, r + up, p + up},
                      {r, q, q + up, r + up},
                      {q, r, p},
                      {p + up, r + up, q + up}},
                     material);
    };
    for (const Engine engine : kTracers)
        for (const float ior : {1.5f, 1.3f}) {
            Scene scene;
            place(scene, prism(add_material(scene, glass(ior))), {});
            place(scene, rectangle(3, 3, 0, add_material(scene, unlit({1, 0, 0, 1}))), {2, 0, 0}, toward({1, 0, 0}));
            place(scene, rectangle(3, 3, -2, add_material(scene, unlit({0, 1, 0, 1}))), {-1.5f, 0, 0});
            add_orthographic(scene);
            const RenderResult r = render(scene, traced(engine, 64, 64));
            for (const int x : {20, 30, 40}) {
                const Vec4 c = linear_at(r, x, 32);
                if (ior == 1.5f) {  // in and out: 4 % are lost each time
                    EXPECT_NEAR(c.x, 0.96 * 0.96 / (1 - 0.04 * 0.04), 2e-3) << name(engine) << " " << x;
                    EXPECT_EQ(c.y, 0) << name(engine) << " " << x;
                } else {
                    const double sine = 1.3 * std::sin(45 * kDegree), a = 45 * kDegree, b = std::asin(sine);
                    const double s = std::sin(a - b) / std::sin(a + b), t = std::tan(a - b) / std::tan(a + b);
                    const double part = (s * s + t * t) / 2, leg = 4 * 1.3 / (2.3 * 2.3);
                    EXPECT_NEAR(c.x, leg * leg * part, 0.01) << name(engine) << " " << x;
                    EXPECT_NEAR(c.y, leg * (1 - part), 0.01) << name(engine) << " " << x;
                }
            }
        }
}

TEST(Refraction, AThickBlockTakesLightByBeersLaw) {
    const double color[3] = {0.5, 0.25, 0.9}, distance = 1.5, thickness = 2;
    for (const Engine engine : kTracers) {
        Scene scene;
        Material m = glass(1.5f);
        m.volume.attenuation_distance = static_cast<float>(distance);
        m.volume.attenuation_color = {0.5f, 0.25f, 0.9f};
        // A metre thick in its own space, twice that in the world.
        place(scene, box({2, 2, 0.5f}, add_material(scene, m)), {}, {}, {1, 1, 2});
        place(scene, rectangle(4, 4, -5, add_material(scene, unlit({1, 1, 1, 1}))), {});
        add_orthographic(scene);
        const Vec4 got = linear_at(render(scene, traced(engine, 8, 8)), 3, 5);
        const float values[3] = {got.x, got.y, got.z};
        for (int c = 0; c < 3; ++c) {
            // Through both faces, and to and fro between them.
            const double left = std::pow(color[c], thickness / distance), r = 0.04;
            EXPECT_NEAR(values[c], (1 - r) * (1 - r) * left / (1 - r * r * left * left), 1e-4)
                << name(engine) << " " << c;
        }
    }
}

// Where a ray parallel to the axis at height h meets the plane at z beyond the centre of a unit ball.
double behind_ball(double h, double z, double ior) {
    const double turn = 2 * (std::asin(h) - std::asin(h / ior));
    return (h - z * std::sin(turn)) / std::cos(turn);
}

TEST(Refraction, ABallTurnsThePictureAround) {
    for (const Engine engine : kTracers)
        for (const double ior : {1.33, 1.5}) {
            Scene scene;
            place(scene,
                  sphere(engine == Engine::kReferenceTrace ? 40 : 100,
                         add_material(scene, glass(static_cast<float>(ior)))),
                  {});
            add_wall(scene, 0.3f, -6, {1, 0, 0}, {0, 0, 1});
            add_orthographic(scene);
            const RenderResult r = picture(scene, engine);
            double low = -0.5, high = 0;  // heights on the left meet the wall on the right
            for (int i = 0; i < 50; ++i) {
                const double h = (low + high) / 2;
                (behind_ball(h, 6, ior) > 0.3 ? low : high) = h;
            }
            // Blue on the left, where the wall is red, and red on the right.
            const auto red = [](const Vec4& c) { return c.x > c.z; };
            EXPECT_NEAR(first_at(r, -1e-3, red), low, 2.0 / side_of(engine)) << name(engine) << " " << ior;
            const int side = side_of(engine);
            EXPECT_GT(linear_at(r, side * 3 / 8, side / 2).z, 0.5f) << name(engine);
            EXPECT_GT(linear_at(r, side * 9 / 16, side / 2).x, 0.5f) << name(engine);
        }
}

TEST(Refraction, ABallGathersLightAtItsFocus) {
    constexpr double kSpot = 0.03, kFocus = 1.5;  // n R / (2 (n - 1))
    for (const Engine engine : kTracers) {
        Scene scene;
        place(scene, sphere(engine == Engine::kReferenceTrace ? 40 : 100, add_material(scene, glass(1.5f))), {});
        place(scene, rectangle(0.03f, 0.03f, 0, add_material(scene, unlit({1, 1, 1, 1}))),
              {0, 0, -static_cast<float>(kFocus)});
        add_orthographic(scene);
        const RenderResult r = render(scene, traced(engine, 64, 64));
        for (int x = 0; x < 64; ++x) {
            const double h = (x + 0.5) / 32 - 1, at = std::fabs(behind_ball(std::fabs(h), kFocus, 1.5));
            if (std::fabs(h) > 0.7) continue;
            if (at > kSpot * 0.9 && at < kSpot * 1.1) continue;
            EXPECT_EQ(linear_at(r, x, 32).x > 0.85f, at < kSpot)
                << name(engine) << " " << x << ": " << linear_at(r, x, 32).x;
        }
    }
}

// Water that reaches into the wall of its glass, where the glass fills the space: four boundaries, and the way through
// water that is left.
TEST(Refraction, WaterThatReachesIntoItsGlassEndsThere) {
    for (const Engine engine : kTracers) {
        Scene scene;
        Material outer = glass(1.5f), inner = glass(1.33f);
        outer.volume.priority = 1;
        inner.volume.attenuation_distance = 1;
        inner.volume.attenuation_color = {0.3f, 0.6f, 0.9f};
        const int wall = add_material(scene, outer), water = add_material(scene, inner);
        place(scene, box({2, 2, 0.25f}, wall), {0, 0, 0.75f});
        place(scene, box({2, 2, 0.25f}, wall), {0, 0, -0.75f});
        place(scene, box({1.9f, 1.9f, 0.7f}, water), {});
        place(scene, rectangle(4, 4, -5, add_material(scene, unlit({1, 1, 1, 1}))), {});
        add_orthographic(scene);
        const Vec4 c = linear_at(render(scene, traced(engine, 4, 4)), 1, 2);
        const float values[3] = {c.x, c.y, c.z};
        const double color[3] = {0.3, 0.6, 0.9}, outside = 1 - 0.04, inside = 1 - std::pow(0.17 / 2.83, 2);
        for (int k = 0; k < 3; ++k)  // what goes to and fro is some thousandths
            EXPECT_NEAR(values[k], outside * outside * inside * inside * color[k], 4e-3) << name(engine);
    }
}

TEST(Refraction, DispersionSpreadsColoursByTheirIndices) {
    constexpr double kDispersion = 20, kIor = 1.5, kThickness = 1;
    const double i = 50 * kDegree, s = std::sin(i);
    for (const Engine engine : kTracers) {
        Scene scene;
        add_wall(scene, 0, -6, {0, 0, 0}, {1, 1, 1});
        Material m = glass(static_cast<float>(kIor));
        m.dispersion = static_cast<float>(kDispersion);
        place(scene, box({3, 2, 0.5f * static_cast<float>(kThickness)}, add_material(scene, m)), {},
              quaternion({0, 1, 0}, static_cast<float>(i)));
        add_orthographic(scene);
        const RenderResult r = picture(scene, engine);
        for (int c = 0; c < 3; ++c) {  // 20 / V: the Abbe number is that of the indices' difference
            const double ior = kIor + (c - 1) * (kIor - 1) * kDispersion / 40;
            const double offset = kThickness * s * (1 - std::cos(i) / std::sqrt(ior * ior - s * s));
            const auto bright = [c](const Vec4& v) { return (c == 0 ? v.x : c == 1 ? v.y : v.z) > 0.3f; };
            EXPECT_NEAR(first_at(r, 0, bright), offset, 2.0 / side_of(engine)) << name(engine) << ", channel " << c;
        }
    }
}

}  // namespace
}  // namespace tessera
