// TEX6: the tangent frame of a surface point and normal maps: orthonormal per pixel, turned on back
// faces, mirrored with handedness; light in world and in tangent space gives the same picture.
#include "shading/shade.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace tessera {
namespace {

using test::Real;
using test::Real3;

constexpr float kPresent[1] = {0};

// A triangle with random normals and tangents around +Z, in an object turned and scaled at random.
struct Piece {
    InstanceView instance{};
    Corner<float> corners[3]{};
    Barycentrics<float> bary{};
};

Piece make_piece(test::Random& random, bool mirrored) {
    Piece p;
    p.instance.mesh.tangents = p.instance.mesh.uvs[0] = kPresent;
    p.instance.handedness = mirrored ? -1.0f : 1.0f;
    // Rotation about a random frame, times a scale, with x turned over where it mirrors.
    const Vec3T<float> z = random.unit(), x = normalize_or(cross(random.unit(), z), {1, 0, 0}), y = cross(z, x);
    const float s = random.in(0.2f, 5), sx = mirrored ? -s : s;
    const Vec3T<float> columns[3] = {x * sx, y * s, z * s};
    for (int c = 0; c < 3; ++c) {
        const float column[3] = {columns[c].x, columns[c].y, columns[c].z};
        for (int r = 0; r < 3; ++r) {
            p.instance.object_to_camera[4 * r + c] = column[r];
            p.instance.normal_to_camera[3 * r + c] = column[r] / (s * s);
        }
    }
    p.instance.object_to_camera[11] = -20;
    float sum = 0;
    for (int i = 0; i < 3; ++i) {
        Corner<float>& c = p.corners[i];
        c.position = Vec3T<float>{i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f, 0} + random.box(0.2f);
        const Vec3T<float> n = Vec3T<float>{0, 0, 1} + random.box(0.3f), t = Vec3T<float>{1, 0, 0} + random.box(0.4f);
        c.normal = normalize_or(n, n);
        c.tangent = {t.x, t.y, t.z, 1};
        c.uv[0] = {c.position.x, c.position.y};
        sum += p.bary.b[i] = random.in(0.01f, 1);
    }
    for (float& b : p.bary.b) b /= sum;
    return p;
}

SurfacePoint<float> point_of(const Piece& p, float front) {
    return surface_point(p.instance, p.corners, p.bary, {0, 0, 1}, front, 1.0f);
}

TEST(TEX6_Frame, OrthonormalAtEveryPoint) {
    test::Random random(31);
    for (int i = 0; i < 20000; ++i) {
        const SurfacePoint<float> s = point_of(make_piece(random, i % 2), i % 3 ? 1.0f : -1.0f);
        const Real3 n(s.normal), t(s.tangent), b(s.bitangent);
        for (const Real3& v : {n, t, b}) ASSERT_NEAR(static_cast<double>(norm(v)), 1, 4e-7);
        ASSERT_LT(std::fabs(inner(n, t)), 6e-7L);
        ASSERT_LT(std::fabs(inner(n, b)), 6e-7L);
        ASSERT_LT(std::fabs(inner(t, b)), 6e-7L);
    }
}

// Where the tangent is missing or along the normal, some frame still stands.
TEST(TEX6_Frame, StandsOnUselessTangents) {
    test::Random random(32);
    for (int i = 0; i < 3000; ++i) {
        Piece p = make_piece(random, false);
        for (Corner<float>& c : p.corners) {
            c.normal = p.corners[0].normal;
            c.tangent = i % 2 ? Vec4T<float>{0, 0, 0, 1} : Vec4T<float>{c.normal.x, c.normal.y, c.normal.z, 1};
        }
        const SurfacePoint<float> s = point_of(p, 1);
        ASSERT_NEAR(dot(s.tangent, s.tangent), 1, 1e-6);
        ASSERT_NEAR(dot(s.bitangent, s.bitangent), 1, 1e-3);
        ASSERT_NEAR(dot(s.normal, s.tangent), 0, 1e-3);
    }
}

// The bitangent is the image of w cross(n, t) under the object's own map: a mirroring instance, or
// w = -1, turns it over; both together do not.
TEST(TEX6_Frame, HandednessAndMirroring) {
    test::Random random(33);
    for (int i = 0; i < 3000; ++i) {
        Piece p = make_piece(random, i % 2);
        const float w = i % 4 < 2 ? 1.0f : -1.0f;
        for (Corner<float>& c : p.corners) {
            c.normal = p.corners[0].normal;
            const Vec3T<float> t = p.corners[0].tangent.xyz();
            const Vec3T<float> across = normalize_or(t - c.normal * dot(t, c.normal), t);
            c.tangent = {across.x, across.y, across.z, w};
        }
        const Vec3T<float> object_bitangent = cross(p.corners[0].normal, p.corners[0].tangent.xyz()) * w;
        const Real3 want = unit(Real3(transform_direction(p.instance.object_to_camera, object_bitangent)));
        ASSERT_LT(distance(point_of(p, 1).bitangent, want), 2e-6L);
    }
}

TEST(TEX6_Frame, NormalsPointToTheViewer) {
    test::Random random(34);
    for (int i = 0; i < 2000; ++i) {
        const Piece p = make_piece(random, i % 2);
        const SurfacePoint<float> front = point_of(p, 1), back = point_of(p, -1);
        ASSERT_EQ(front.normal.x, -back.normal.x);
        ASSERT_EQ(front.geometric_normal.z, -back.geometric_normal.z);
        // Perpendicular to the edges in camera space.
        for (int k = 1; k < 3; ++k) {
            const Vec3T<float> edge =
                transform_direction(p.instance.object_to_camera, p.corners[k].position - p.corners[0].position);
            ASSERT_LT(std::fabs(inner(Real3(front.geometric_normal), unit(Real3(edge)))), 2e-6L);
        }
    }
}

// --- maps -----------------------------------------------------------------------------------

// The component of the normal that an 8-bit channel stands for, in the precision that texels have.
Real component(int code) { return 2 * test::value15(test::channel15(code)) - 1; }

class Map {
  public:
    Map() : texture_(1, 1, 1, 1) {}
    MaterialView material(int r, int g, int b) {
        texture_.set(0, 0, 0, {{test::channel15(r), test::channel15(g), test::channel15(b), 32767}});
        MaterialView m = test::plain_material(ShadingModel::kLambert);
        TextureInput& input = m.inputs[static_cast<int>(TextureSlot::kNormal)];
        input.texture = &texture_.view();
        const float identity[6] = {1, 0, 0, 0, 1, 0};
        std::memcpy(input.transform, identity, sizeof identity);
        return m;
    }

  private:
    test::TestTexture texture_;
};

// 128 stands for 1/255 or so: the flat texel tilts the normal by atan(sqrt(2) / 255), no more.
TEST(TEX6_NormalMap, FlatTexelTiltsByItsQuantisationOnly) {
    test::Random random(35);
    Map map;
    const MaterialView m = map.material(128, 128, 255);
    const Real tilt = std::atan(std::sqrt(2.0L) * component(128));
    ASSERT_NEAR(static_cast<double>(component(128)), 1 / 255.0, 1 / 32767.0);
    for (int i = 0; i < 2000; ++i) {
        const SurfacePoint<float> s = point_of(make_piece(random, i % 2), i % 3 ? 1.0f : -1.0f);
        const Real3 n(shading_normal(m, s));
        ASSERT_NEAR(static_cast<double>(norm(outer(n, Real3(s.normal)))), static_cast<double>(std::sin(tilt)), 1e-6);
    }
}

// Decoded, scaled and turned by the frame, in long double; behind, all of the frame is turned.
TEST(TEX6_NormalMap, IsTheFramesCombinationAndTurnsOnBackFaces) {
    test::Random random(36);
    Map map;
    for (int i = 0; i < 5000; ++i) {
        const int r = static_cast<int>(random.below(256)), g = static_cast<int>(random.below(256)),
                  b = 140 + static_cast<int>(random.below(116));
        MaterialView m = map.material(r, g, b);
        m.normal_scale = random.in(0, 2);
        const Piece p = make_piece(random, i % 2);
        const SurfacePoint<float> front = point_of(p, 1), back = point_of(p, -1);
        const Real x = component(r) * m.normal_scale, y = component(g) * m.normal_scale, z = component(b);
        const Real3 want = unit(Real3(front.tangent) * x + Real3(front.bitangent) * y + Real3(front.normal) * z);
        ASSERT_LT(distance(shading_normal(m, front), want), 2e-6L);
        ASSERT_LT(distance(shading_normal(m, back), want * -1), 2e-6L);
    }
}

// Lambert's cosine from the mapped normal in camera space equals that from the light taken into
// tangent space.
TEST(TEX6_NormalMap, LightInTangentSpaceGivesTheSamePicture) {
    test::Random random(37);
    Map map;
    for (int i = 0; i < 5000; ++i) {
        const int r = static_cast<int>(random.below(256)), g = static_cast<int>(random.below(256)), b = 255;
        const MaterialView m = map.material(r, g, b);
        const SurfacePoint<float> s = point_of(make_piece(random, i % 2), 1);
        const std::vector<LightView> lights{test::directional_light(random.unit(), kPi)};
        SurfacePoint<float> bent = s;
        bent.normal = shading_normal(m, s);
        const float got = test::shade_unshadowed(test::plain_context(lights), m, bent).radiance.x;
        const Real3 light(Vec3T<float>::load(lights[0].to_light));
        const Real3 local{inner(light, Real3(s.tangent)), inner(light, Real3(s.bitangent)),
                          inner(light, Real3(s.normal))};
        const Real3 mapped = unit(Real3{component(r), component(g), component(b)});
        ASSERT_NEAR(got, static_cast<double>(std::fmax(inner(mapped, local), 0.0L)), 2e-6);
    }
}

}  // namespace
}  // namespace tessera
