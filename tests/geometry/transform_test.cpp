// GEO4 and GEO5: change of frame, and the affine and projective transformations, against what they do
// to known points, against their group laws and against GLM.
#include "geometry/matrix.h"
#include "geometry/support.h"

#include <tessera/glm.h>
#include <tessera/transform.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace tessera {
namespace {

using test::expect_near;
using test::Random;

constexpr float kPi = 3.14159265f;

Vec3 move_point(const Mat4& m, Vec3 p) { return cartesian(m * point(p)); }

TEST(Geometry, GEO4_FrameAndItsInverse) {
    // u, v, e are the axes of the frame, seen from the parent: the frame's (1, 0, 0) is origin + u.
    const Vec3 u{0, 1, 0}, v{0, 0, 1}, e{1, 0, 0}, origin{5, 6, 7};
    const Mat4 out = frame_to_parent(u, v, e, origin), in = parent_to_frame(u, v, e, origin);
    EXPECT_EQ(move_point(out, {1, 0, 0}), origin + u);
    EXPECT_EQ(move_point(out, {0, 0, 0}), origin);
    EXPECT_EQ(move_point(in, origin + 3 * e + 2 * v), (Vec3{0, 2, 3}));
    EXPECT_EQ(out * in, Mat4{});
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        const Mat4 r = rotation(random.rotation());
        const Vec3 fu{r(0, 0), r(1, 0), r(2, 0)}, fv{r(0, 1), r(1, 1), r(2, 1)}, fe{r(0, 2), r(1, 2), r(2, 2)};
        const Vec3 o = random.vec3(10);
        expect_near(frame_to_parent(fu, fv, fe, o) * parent_to_frame(fu, fv, fe, o), Mat4{}, 4e-6f);
        const std::optional<Mat4> general = inverse(frame_to_parent(fu, fv, fe, o));
        ASSERT_TRUE(general);
        expect_near(*general, parent_to_frame(fu, fv, fe, o));
    }
}

TEST(Geometry, GEO5_TranslateScaleShear) {
    EXPECT_EQ(move_point(translation({1, 2, 3}), {10, 20, 30}), (Vec3{11, 22, 33}));
    EXPECT_EQ(move_point(scaling({2, 3, 4}), {1, 1, 1}), (Vec3{2, 3, 4}));
    EXPECT_EQ(translation({1, 2, 3}) * translation({-1, -2, -3}), Mat4{});
    EXPECT_EQ(scaling({2, 4, 8}) * scaling({0.5f, 0.25f, 0.125f}), Mat4{});
    const Mat4 sheared = shear(2, 3, 5, 7, 11, 13);
    EXPECT_EQ(move_point(sheared, {1, 0, 0}), (Vec3{1, 5, 11}));
    EXPECT_EQ(move_point(sheared, {0, 1, 0}), (Vec3{2, 1, 13}));
    EXPECT_EQ(move_point(sheared, {0, 0, 1}), (Vec3{3, 7, 1}));
}

TEST(Geometry, GEO5_RotationsTurnCounterClockwise) {
    expect_near(move_point(rotation_x(kPi / 2), {0, 1, 0}), {0, 0, 1}, 1e-6f);
    expect_near(move_point(rotation_y(kPi / 2), {0, 0, 1}), {1, 0, 0}, 1e-6f);
    expect_near(move_point(rotation_z(kPi / 2), {1, 0, 0}), {0, 1, 0}, 1e-6f);
    expect_near(move_point(rotation(Vec3{1, 1, 1}, 2 * kPi / 3), {1, 0, 0}), {0, 1, 0}, 1e-6f);
    EXPECT_EQ(rotation(Vec3{}, 1), Mat4{});
    Random random(6);
    for (int i = 0; i < 500; ++i) {
        const Vec3 axis = random.vec3(3);
        const float angle = random.in(-7, 7);
        const Mat4 r = rotation(axis, angle);
        expect_near(r, from_glm(glm::rotate(glm::mat4(1), angle, glm::normalize(to_glm(axis)))));
        expect_near(r, rotation(quaternion(axis, angle)), 3e-7f);
        expect_near(r * transpose(r), Mat4{}, 5e-7f);
        expect_near(move_point(r, axis), axis, 2e-6f);
        EXPECT_EQ(determinant_sign(to_dmat4(r)), 1);
    }
    EXPECT_EQ(rotation(Quat{0, 0, 0, 0}), Mat4{});
    EXPECT_EQ(rotation(Quat{0, 3, 0, 0}), scaling({-1, 1, -1}));  // normalised first
}

TEST(Geometry, GEO5_ComposeIsTranslationRotationScale) {
    Random random(7);
    for (int i = 0; i < 500; ++i) {
        const Vec3 t = random.vec3(5), s = random.vec3(3);
        const Quat q = random.rotation();
        expect_near(compose(t, q, s), translation(t) * rotation(q) * scaling(s));
        const glm::mat4 oracle =
            glm::translate(glm::mat4(1), to_glm(t)) * glm::mat4_cast(to_glm(q)) * glm::scale(glm::mat4(1), to_glm(s));
        expect_near(compose(t, q, s), from_glm(oracle));
    }
}

TEST(Geometry, GEO5_InverseOfAffineAndProjective) {
    Random random(8);
    int inverted = 0;
    for (int i = 0; i < 500; ++i) {
        Mat4 m;
        for (float& x : m.m) x = random.in(-1, 1);
        if (std::fabs(glm::determinant(glm::dmat4(to_glm(m)))) < 0.02) continue;
        const std::optional<Mat4> result = inverse(m);
        ASSERT_TRUE(result);
        expect_near(*result, from_glm(glm::mat4(glm::inverse(glm::dmat4(to_glm(m))))), 1e-6f);
        ++inverted;
    }
    EXPECT_GT(inverted, 300);
    // Exact where powers of two are, and independent of units.
    EXPECT_EQ(inverse(scaling({2, 1.0f / 1048576, 1e-20f})), scaling({0.5f, 1048576, 1 / 1e-20f}));
    EXPECT_EQ(inverse(translation({1e7f, 2, 3}) * scaling({1.0f / 1024, 1, 1})),
              scaling({1024, 1, 1}) * translation({-1e7f, -2, -3}));
}

TEST(Geometry, GEO5_SingularMatricesHaveNoInverse) {
    EXPECT_FALSE(inverse(scaling({1, 0, 1})));
    Mat4 magic;
    for (std::size_t i = 0; i < 16; ++i) magic.m[i] = static_cast<float>(i + 1);  // rank 2
    EXPECT_FALSE(inverse(magic));
    Mat4 tenths;
    for (std::size_t i = 0; i < 16; ++i) tenths.m[i] = static_cast<float>(i % 4 + 1) * 0.125f;  // rank 1
    EXPECT_FALSE(inverse(tenths));
    Mat4 broken;
    broken(1, 2) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(inverse(broken));
    EXPECT_FALSE(inverse(scaling({1e-39f, 1, 1})));  // its inverse is beyond the range of float
}

TEST(Geometry, GEO5_ProjectiveMapOfAPlane) {
    // A projective map takes lines to lines: three points on a line stay on one.
    Mat4 m;
    m(3, 0) = 0.25f, m(3, 1) = -0.5f, m(0, 1) = 0.5f;
    const Ray line{{1, 0.5f, 0}, {1, 0.25f, 0}};
    const Vec3 a = move_point(m, line.at(0)), b = move_point(m, line.at(1)), c = move_point(m, line.at(3));
    EXPECT_NEAR(length(cross(b - a, c - a)), 0, 1e-6f);
    EXPECT_GT(length(b - a), 0.1f);
    // Parallel lines meet: the image of a point at infinity is a point.
    EXPECT_NE((m * direction({1, 0, 0})).w, 0);
}

TEST(Geometry, GEO5_NormalMatrixKeepsNormalsPerpendicular) {
    Random random(9);
    for (int i = 0; i < 500; ++i) {
        const Mat4 m = compose(random.vec3(5), random.rotation(), random.vec3(3)) * shear(0.3f, 0, 0, -0.2f, 0, 0);
        const Vec3 a = random.vec3(1), b = random.vec3(1), c = random.vec3(1);
        const Vec3 n = triangle_normal(a, b, c);
        const glm::dmat3 nm = normal_matrix(to_dmat4(m));
        const glm::dvec3 mapped = glm::normalize(nm * to_dvec3(n));
        const Vec3 edge = cartesian(m * point(b)) - cartesian(m * point(a));
        EXPECT_NEAR(glm::dot(mapped, to_dvec3(edge)), 0, 2e-5);
        // The same as the inverse transpose, up to a positive factor.
        const glm::dvec3 oracle = glm::normalize(glm::transpose(glm::inverse(glm::dmat3(to_dmat4(m)))) * to_dvec3(n));
        EXPECT_NEAR(glm::dot(mapped, oracle), 1, 1e-9);
        const double det = glm::determinant(glm::dmat3(to_dmat4(m)));
        EXPECT_EQ(determinant_sign(to_dmat4(m)), det < 0 ? -1 : 1);
    }
    // Flattened along z, a floor still has its normal; tiny scales do not lose it either.
    const glm::dvec3 flat = normal_matrix(to_dmat4(scaling({1, 1, 0}))) * glm::dvec3(0, 0, 1);
    EXPECT_EQ(flat, glm::dvec3(0, 0, 1));
    EXPECT_EQ(determinant_sign(to_dmat4(scaling({1, 1, 0}))), 0);
    EXPECT_EQ(determinant_sign(to_dmat4(scaling({1e-38f, -1e-38f, 1e-38f}))), -1);
}

TEST(Geometry, GEO5_GlmConversionsRoundTrip) {
    Random random(10);
    const Mat4 m = compose(random.vec3(1), random.rotation(), random.vec3(1));
    EXPECT_EQ(from_glm(to_glm(m)), m);
    expect_near(cartesian(from_glm(to_glm(m) * to_glm(Vec4{1, 2, 3, 1}))), move_point(m, {1, 2, 3}), 1e-6f);
    EXPECT_EQ(from_glm(to_glm(Quat{1, 2, 3, 4})), (Quat{1, 2, 3, 4}));
    EXPECT_EQ(from_glm(to_glm(Vec2{1, 2})), (Vec2{1, 2}));
    EXPECT_EQ(from_glm(to_glm(Vec3{1, 2, 3})), (Vec3{1, 2, 3}));
    EXPECT_EQ(to_mat4(to_dmat4(m)), m);
}

}  // namespace
}  // namespace tessera
