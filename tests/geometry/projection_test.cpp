// Cameras given as matrices by a host: the fields that engines read, and what is refused.
#include "geometry/projection.h"

#include <tessera/error.h>
#include <tessera/transform.h>

#include <gtest/gtest.h>

#include "geometry/frame.h"

#include <limits>

namespace tessera {
namespace {

constexpr float kAspect = 1.5f;
constexpr int kWidth = 300, kHeight = 200;

// OpenGL's perspective matrix, near and far mapped to -1 and 1.
Mat4 gl_perspective(float near, float far) {
    Mat4 m{};
    m.m = {};
    m(0, 0) = 1.7f / kAspect, m(1, 1) = 1.7f;
    m(2, 2) = (near + far) / (near - far), m(2, 3) = 2 * near * far / (near - far);
    m(3, 2) = -1;
    return m;
}

Mat4 gl_orthographic(float near, float far) {
    Mat4 m;
    m(0, 0) = 1 / (2 * kAspect), m(1, 1) = 0.5f;
    m(2, 2) = -2 / (far - near), m(2, 3) = -(far + near) / (far - near);
    return m;
}

const Vec3 kEye{1, 2, 5}, kTarget{0.5f, 0, 0};

FrameCamera host(const Mat4& projection, const Mat4& view) {
    return host_camera(projection * view, view, kWidth, kHeight);
}

TEST(HostCamera, PerspectiveFieldsAreThoseOfTheLens) {
    const FrameCamera f = host(gl_perspective(0.5f, 20), look_at(kEye, kTarget, {0, 1, 0}));
    EXPECT_FALSE(f.projection.orthographic);
    EXPECT_NEAR(f.projection.near, 0.5f, 1e-5f);
    EXPECT_NEAR(f.projection.scale_x, 1.7f / kAspect, 1e-5f);
    EXPECT_NEAR(f.projection.scale_y, 1.7f, 1e-5f);
    EXPECT_TRUE(is_square(f.projection));
    // Tessera's own reversed matrix of the same lens.
    const double z = 0.5 / 19.5;
    EXPECT_NEAR(f.projection.clip_from_camera[10], z, 1e-6);
    EXPECT_NEAR(f.projection.clip_from_camera[11], 20 * z, 1e-5);
    EXPECT_NEAR(f.projection.clip_from_camera[14], -1, 1e-6);
}

TEST(HostCamera, OrthographicIsToldByW) {
    const FrameCamera f = host(gl_orthographic(1, 11), look_at(kEye, kTarget, {0, 1, 0}));
    EXPECT_TRUE(f.projection.orthographic);
    EXPECT_NEAR(f.projection.near, 1, 1e-5f);
    EXPECT_NEAR(f.projection.scale_y, 0.5f, 1e-6f);
    EXPECT_NEAR(f.projection.clip_from_camera[10], 0.1f, 1e-6f);
}

TEST(HostCamera, AFactorOnTheWholeMatrixChangesNothingButClipSpace) {
    Mat4 p = gl_perspective(0.5f, 20);
    for (float& x : p.m) x *= 4;
    const FrameCamera f = host(p, look_at(kEye, kTarget, {0, 1, 0}));
    EXPECT_NEAR(f.projection.near, 0.5f, 1e-5f);
    EXPECT_NEAR(f.projection.scale_y, 1.7f, 1e-5f);
}

TEST(HostCamera, AShiftedLensIsSquareAndATurnedOneIsNot) {
    Mat4 p = gl_perspective(0.5f, 20);
    p(0, 2) = 0.2f;
    EXPECT_TRUE(is_square(host(p, look_at(kEye, kTarget, {0, 1, 0})).projection));
    p(0, 1) = 0.2f;
    EXPECT_FALSE(is_square(host(p, look_at(kEye, kTarget, {0, 1, 0})).projection));
}

// The contract with hosts: x, y and w of nodes without a transform are the host's floats.
TEST(HostCamera, NodesWithoutTransformGetTheVeryFloats) {
    Scene scene;
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.meshes.push_back({"", {p}, {}, {}});
    scene.nodes.resize(2);
    scene.nodes[0].mesh = scene.nodes[1].mesh = 0;
    scene.nodes[1].translation = {1, 2, 3};
    scene.scenes.push_back({"", {0, 1}, {}});
    View view;
    view.camera_from_world = look_at(kEye, kTarget, {0, 1, 0});
    view.clip_from_world = gl_perspective(0.5f, 20) * *view.camera_from_world;
    const Mat4& m = *view.clip_from_world;
    const Frame frame = make_frame(scene, view, kWidth, kHeight);
    ASSERT_EQ(frame.instances.size(), 2u);
    for (int c = 0; c < 4; ++c) {
        for (const int r : {0, 1, 3}) EXPECT_EQ(frame.instances[0].object_to_clip[4 * r + c], m(r, c));
        EXPECT_EQ(frame.instances[0].object_to_clip[8 + c],
                  static_cast<float>((static_cast<double>(m(3, c)) - static_cast<double>(m(2, c))) / 2));
    }
    const Vec4 moved = m * Vec4{1, 2, 3, 1};
    EXPECT_NEAR(frame.instances[1].object_to_clip[3], moved.x, 1e-5f);
    EXPECT_NEAR(frame.instances[1].object_to_clip[15], moved.w, 1e-5f);
    EXPECT_NEAR(frame.instances[1].object_to_camera[11], -moved.w, 1e-5f);
}

TEST(HostCamera, WhatMakesNoSenseIsRefused) {
    const Mat4 view = look_at(kEye, kTarget, {0, 1, 0}), lens = gl_perspective(0.5f, 20), clip = lens * view;
    const auto refused = [&](const Mat4& c, const Mat4& v) {
        try {
            host_camera(c, v, kWidth, kHeight);
        } catch (const Error& e) {
            return e.code() == ErrorCode::kUsage;
        }
        return false;
    };
    EXPECT_FALSE(refused(clip, view));
    Mat4 odd = clip;
    odd(1, 2) = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(refused(odd, view));
    EXPECT_TRUE(refused(clip, scaling({2, 2, 2}) * view)) << "scaled";
    EXPECT_TRUE(refused(clip, scaling({1, 1, -1}) * view)) << "mirrored";
    odd = view;
    odd(3, 0) = 0.1f;
    EXPECT_TRUE(refused(clip, odd)) << "projective";
    EXPECT_TRUE(refused(clip, look_at({5, 2, 1}, kTarget, {0, 1, 0}))) << "another camera's";
    EXPECT_TRUE(refused(scaling({1, 1, 1}) * frustum_textbook(-1, 1, -1, 1, 1, 2) * view, view)) << "looks along +Z";
    EXPECT_TRUE(refused(scaling({0, 1, 1}) * clip, view)) << "flat";
    Mat4 zero;
    zero.m = {};
    EXPECT_TRUE(refused(zero, view));

    Scene scene;
    View half;
    half.clip_from_world = clip;
    EXPECT_THROW(make_frame(scene, half, kWidth, kHeight), Error);
}

}  // namespace
}  // namespace tessera
