// GEO6: look-at and the projections, row by row as they are published, by what they do to the planes
// of the frustum, and against GLM. GEO7: viewports.
#include "geometry/matrix.h"
#include "geometry/support.h"

#include <tessera/glm.h>
#include <tessera/transform.h>

#include <array>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

namespace tessera {
namespace {

using test::expect_near;
using test::Random;

Mat4 rows(const std::array<float, 16>& r) {
    Mat4 m;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) m(i, j) = r[static_cast<std::size_t>(4 * i + j)];
    return m;
}

TEST(Geometry, GEO6_LookAtIsTheInverseOfThePlacement) {
    Random random(11);
    for (int i = 0; i < 500; ++i) {
        const Vec3 eye = random.vec3(10), target = random.vec3(10), up = random.unit();
        if (length(cross(normalize(target - eye), up)) < 0.05f) continue;
        const Mat4 view = look_at(eye, target, up), placement = camera_placement(eye, target, up);
        expect_near(view * placement, Mat4{}, 4e-6f);
        expect_near(view, from_glm(glm::lookAt(to_glm(eye), to_glm(target), to_glm(up))), 3e-6f);
        // The eye becomes the origin, the target lies on -Z, up has no x and a positive y.
        expect_near(cartesian(view * point(eye)), {}, 1e-5f);
        expect_near(cartesian(view * point(target)), {0, 0, -length(target - eye)}, 1e-5f);
        EXPECT_NEAR((view * direction(up)).x, 0, 1e-6f);
        EXPECT_GT((view * direction(up)).y, 0);
    }
}

TEST(Geometry, GEO6_LookAtWithoutAnUpIsStillARotation) {
    for (const Vec3 up : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 0}, Vec3{0, 1e-30f, 0}}) {
        for (const Vec3 target : {Vec3{0, 5, 0}, Vec3{0, -5, 0}, Vec3{0, 0, 0}}) {
            const Mat4 placement = camera_placement({0, 0, 0}, target, up);
            expect_near(placement * transpose(placement), Mat4{});
            EXPECT_EQ(determinant_sign(to_dmat4(placement)), 1);
            if (target.y != 0) expect_near(cartesian(placement * point({0, 0, -5})), target, 1e-6f);
        }
    }
}

TEST(Geometry, GEO6_FrustumRows) {
    const float l = -1, r = 3, b = -2, t = 4, n = 2, f = 10;
    EXPECT_EQ(frustum(l, r, b, t, n, f), rows({2 * n / (r - l), 0, (r + l) / (r - l), 0,  //
                                               0, 2 * n / (t - b), (t + b) / (t - b), 0,  //
                                               0, 0, n / (f - n), f * n / (f - n),        //
                                               0, 0, -1, 0}));
    EXPECT_EQ(frustum(l, r, b, t, n, std::nullopt), rows({2 * n / (r - l), 0, (r + l) / (r - l), 0,  //
                                                          0, 2 * n / (t - b), (t + b) / (t - b), 0,  //
                                                          0, 0, 0, n,                                //
                                                          0, 0, -1, 0}));
}

TEST(Geometry, GEO6_FrustumMapsItsCornersToTheCanonicalVolume) {
    const float l = -1, r = 3, b = -2, t = 4, n = 2, f = 10;
    const Mat4 m = frustum(l, r, b, t, n, f);
    expect_near(cartesian(m * point({l, b, -n})), {-1, -1, 1}, 1e-6f);
    expect_near(cartesian(m * point({r, t, -n})), {1, 1, 1}, 1e-6f);
    expect_near(cartesian(m * point({l * f / n, t * f / n, -f})), {-1, 1, 0}, 1e-6f);
    expect_near(cartesian(m * point({r * f / n, b * f / n, -f})), {1, -1, 0}, 1e-6f);
    EXPECT_EQ((m * point({0, 0, -7})).w, 7);
    const Mat4 infinite = frustum(l, r, b, t, n, std::nullopt);
    expect_near(cartesian(infinite * point({r, t, -n})), {1, 1, 1}, 1e-6f);
    EXPECT_EQ(cartesian(infinite * point({0, 0, -200})).z, 0.01f);
    EXPECT_EQ((infinite * direction({0, 0, -1})).z, 0);  // the point at infinity has depth 0
    EXPECT_GT((infinite * direction({0, 0, -1})).w, 0);
}

TEST(Geometry, GEO6_TextbookFrustum) {
    const float l = -1, r = 3, b = -2, t = 4, n = 2, f = 10;
    const Mat4 m = frustum_textbook(l, r, b, t, n, f);
    EXPECT_EQ(m, rows({2 * n / (r - l), 0, -(r + l) / (r - l), 0,     //
                       0, 2 * n / (t - b), -(t + b) / (t - b), 0,     //
                       0, 0, (n + f) / (n - f), 2 * n * f / (f - n),  //
                       0, 0, 1, 0}));
    // It looks along +Z: the near plane goes to +1, the far plane to -1.
    expect_near(cartesian(m * point({l, b, n})), {-1, -1, 1}, 1e-6f);
    expect_near(cartesian(m * point({r, t, n})), {1, 1, 1}, 1e-6f);
    expect_near(cartesian(m * point({r * f / n, b * f / n, f})), {1, -1, -1}, 1e-6f);
}

TEST(Geometry, GEO6_PerspectiveAgainstGlm) {
    Random random(12);
    for (int i = 0; i < 200; ++i) {
        const float yfov = random.in(0.1f, 2.8f), aspect = random.in(0.3f, 3), n = random.in(0.01f, 1);
        const float f = n * random.in(2, 10000);
        // Reversed depth is GLM's zero-to-one projection with the planes exchanged.
        expect_near(perspective(yfov, aspect, n, f), from_glm(glm::perspectiveRH_ZO(yfov, aspect, f, n)), 1e-5f);
        const Mat4 p = perspective(yfov, aspect, n, std::nullopt);
        const float half = static_cast<float>(std::tan(static_cast<double>(yfov) / 2));
        EXPECT_NEAR(p(1, 1) * half, 1, 3e-7f);
        EXPECT_NEAR(p(0, 0) * half * aspect, 1, 3e-7f);
        // The symmetric one is the general one with opposite sides.
        expect_near(frustum(-n * half * aspect, n * half * aspect, -n * half, n * half, n, f),
                    perspective(yfov, aspect, n, f));
    }
}

TEST(Geometry, GEO6_Orthographic) {
    const Mat4 m = orthographic(-1, 3, -2, 4, 2, 10);
    expect_near(cartesian(m * point({-1, -2, -2})), {-1, -1, 1}, 1e-6f);
    expect_near(cartesian(m * point({3, 4, -10})), {1, 1, 0}, 1e-6f);
    expect_near(cartesian(m * point({1, 1, -6})), {0, 0, 0.5f}, 1e-6f);
    expect_near(m, from_glm(glm::orthoRH_ZO(-1.0f, 3.0f, -2.0f, 4.0f, 10.0f, 2.0f)));
    EXPECT_EQ((m * point({7, 7, 7})).w, 1);
}

TEST(Geometry, GEO7_HalfPixelCentres) {
    const Viewport whole{0, 0, 640, 480};
    EXPECT_EQ(ndc_to_pixel({-1, 1}, whole), (Vec2{0, 0}));  // y is up in NDC, down in the picture
    EXPECT_EQ(ndc_to_pixel({1, -1}, whole), (Vec2{640, 480}));
    EXPECT_EQ(ndc_to_pixel({0, 0}, whole), (Vec2{320, 240}));
    // Pixel (0, 0) has its centre at (0.5, 0.5); pixel (639, 479) half a pixel before the border.
    const Vec2 first = ndc_to_pixel({-1 + 1.0f / 640, 1 - 1.0f / 480}, whole);
    EXPECT_NEAR(first.x, 0.5f, 2e-5f);
    EXPECT_NEAR(first.y, 0.5f, 2e-5f);
    const Vec2 last = ndc_to_pixel({1 - 1.0f / 640, -1 + 1.0f / 480}, whole);
    EXPECT_NEAR(last.x, 639.5f, 1e-4f);
    EXPECT_NEAR(last.y, 479.5f, 1e-4f);
    // A picture of one pixel looks through its centre.
    EXPECT_EQ(pixel_to_ndc({0.5f, 0.5f}, {0, 0, 1, 1}), (Vec2{0, 0}));
}

TEST(Geometry, GEO7_SeveralViewportsInOnePicture) {
    // Four views side by side: each canonical square fills its own quarter and they share borders.
    const std::array<Viewport, 4> quarters{
        Viewport{0, 0, 320, 200}, {320, 0, 320, 200}, {0, 200, 320, 280}, {320, 200, 320, 280}};
    EXPECT_EQ(ndc_to_pixel({1, -1}, quarters[0]), ndc_to_pixel({-1, 1}, quarters[3]));
    EXPECT_EQ(ndc_to_pixel({1, 1}, quarters[2]), ndc_to_pixel({-1, 1}, quarters[3]));
    Random random(13);
    for (const Viewport& viewport : quarters) {
        for (int i = 0; i < 100; ++i) {
            const Vec2 ndc = random.vec2(1);
            const Vec2 pixel = ndc_to_pixel(ndc, viewport);
            EXPECT_GE(pixel.x, viewport.x);
            EXPECT_LE(pixel.x, viewport.x + viewport.width);
            EXPECT_GE(pixel.y, viewport.y);
            EXPECT_LE(pixel.y, viewport.y + viewport.height);
            const Vec2 back = pixel_to_ndc(pixel, viewport);
            EXPECT_NEAR(back.x, ndc.x, 1e-6f);
            EXPECT_NEAR(back.y, ndc.y, 1e-6f);
            const Vec4 by_matrix = viewport_matrix(viewport) * Vec4{ndc.x, ndc.y, 0.25f, 1};
            EXPECT_NEAR(by_matrix.x, pixel.x, 1e-4f);
            EXPECT_NEAR(by_matrix.y, pixel.y, 1e-4f);
            EXPECT_EQ(by_matrix.z, 0.25f);
        }
    }
}

TEST(Geometry, GEO7_WindowToViewport) {
    const Viewport window{-2, 10, 4, 2}, viewport{100, 200, 50, 100};
    EXPECT_EQ(window_to_viewport({-2, 10}, window, viewport), (Vec2{100, 200}));
    EXPECT_EQ(window_to_viewport({2, 12}, window, viewport), (Vec2{150, 300}));
    EXPECT_EQ(window_to_viewport({-1, 11.5f}, window, viewport), (Vec2{112.5f, 275}));
    EXPECT_EQ(window_to_viewport({4, 9}, window, viewport), (Vec2{175, 150}));  // outside goes outside
}

}  // namespace
}  // namespace tessera
