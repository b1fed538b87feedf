// Spheres and discs placed by matrices, uneven and mirroring ones too: surface points against the definition in long
// double, and beside the tessellation's vertices.
#include "geometry/matrix.h"
#include "shading/shape_surface.h"
#include "shading/support.h"

#include <tessera/scene.h>

#include <gtest/gtest.h>

#include <cmath>

namespace tessera {
namespace {

using namespace test;

// An instance as a frame has it.
struct Placed {
    InstanceView view{};
    std::array<Real3, 3> columns;  // of object_to_camera
    Real3 centre;

    Placed(Random& random, ShapeView::Kind kind, float radius, const Vec3T<float>& scale) {
        const auto wide = [](float x) { return static_cast<double>(x); };
        glm::dvec4 q(wide(random.in(-1, 1)), wide(random.in(-1, 1)), wide(random.in(-1, 1)), wide(random.in(-1, 1)));
        const Vec3T<float> by = random.box(2);
        const glm::dmat4 m =
            compose_matrix({wide(by.x), wide(by.y), wide(by.z)}, q, {wide(scale.x), wide(scale.y), wide(scale.z)});
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) view.object_to_camera[4 * r + c] = static_cast<float>(m[c][r]);
        const glm::dmat3 normals = normal_matrix(m);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) view.normal_to_camera[3 * r + c] = static_cast<float>(normals[c][r]);
        view.handedness = determinant_sign(m) < 0 ? -1.0f : 1.0f;
        view.shape.kind = kind;
        view.shape.radius = radius;
        view.mesh.tangents = kTangent;
        EXPECT_TRUE(invert_rows(view.object_to_camera, view.shape.camera_to_object));
        const float* rows = view.object_to_camera;
        for (std::size_t c = 0; c < 3; ++c) columns[c] = {rows[c], rows[4 + c], rows[8 + c]};
        centre = {rows[3], rows[7], rows[11]};
    }
    Real3 vector(const Real3& v) const { return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z; }
    Real3 point(const Real3& p) const { return centre + vector(p); }
    // By Cramer's rule.
    Real3 inverse_vector(const Real3& v) const {
        const Real whole = inner(columns[0], outer(columns[1], columns[2]));
        return Real3{inner(v, outer(columns[1], columns[2])), inner(v, outer(columns[2], columns[0])),
                     inner(v, outer(columns[0], columns[1]))} *
               (1 / whole);
    }
    // The gradient, in camera space, of a function whose gradient in object space is `g`.
    Real3 gradient(const Real3& g) const {
        const Real whole = inner(columns[0], outer(columns[1], columns[2]));
        return (outer(columns[1], columns[2]) * g.x + outer(columns[2], columns[0]) * g.y +
                outer(columns[0], columns[1]) * g.z) *
               (1 / whole);
    }

    static constexpr float kTangent[4] = {1, 0, 0, 1};
};

struct Scaled {
    Vec3T<float> scale;
    bool even;
};
constexpr Scaled kScales[] = {{{1, 1, 1}, true},          {{-1, 1, 1}, true},         {{0.3f, -0.3f, 0.3f}, true},
                              {{20, 20, -20}, true},      {{1, 0.4f, 0.7f}, false},   {{-2, 0.5f, 1}, false},
                              {{1, -0.2f, -0.6f}, false}, {{-0.5f, -1, -0.3f}, false}};

// Where a ray meets the shape, in object space, by the definition. t, and the place.
struct Met {
    Real t;
    Real3 at;
};
Met meet(const Placed& p, const Real3& origin, const Real3& direction, bool leaving) {
    const Real3 o = p.inverse_vector(origin - p.centre), d = p.inverse_vector(direction);
    if (p.view.shape.kind == ShapeView::Kind::kDisc) return {-o.y / d.y, o + d * (-o.y / d.y)};
    const Real r = p.view.shape.radius, a = inner(d, d), nearest = -inner(o, d) / a;
    const Real3 q = o + d * nearest;
    const Real half = std::sqrt((r * r - inner(q, q)) / a), t = leaving ? nearest + half : nearest - half;
    return {t, o + d * t};
}
std::array<Real, 2> uv_of(const Placed& p, const Real3& at) {
    if (p.view.shape.kind == ShapeView::Kind::kDisc) {
        const Real width = 2 * static_cast<Real>(p.view.shape.radius);
        return {0.5L + at.x / width, 0.5L + at.z / width};
    }
    return {0.5L + std::atan2(at.x, at.z) / (2 * kRealPi), std::atan2(std::hypot(at.x, at.z), at.y) / kRealPi};
}

// Calls `check(placed, ray, leaving, truth, point)` for many rays that do not graze the shape nor pass its poles.
template <class Check>
void for_many_rays(std::uint32_t seed, const Check& check) {
    Random random(seed);
    int count = 0;
    for (const Scaled& scaled : kScales)
        for (int i = 0; i < 1000; ++i) {
            const ShapeView::Kind kind = i % 4 == 0 ? ShapeView::Kind::kDisc : ShapeView::Kind::kSphere;
            const Placed p(random, kind, random.in(0.5f, 2), scaled.scale);
            const bool disc = kind == ShapeView::Kind::kDisc, leaving = !disc && i % 2;
            const Real r = p.view.shape.radius;
            Real3 to = Real3(random.unit()) * (r * static_cast<Real>(random.in(0.2f, 0.8f)));
            if (disc) to.y = 0;
            const Real3 from = Real3(random.unit()) * (r * (leaving && i % 3 == 0 ? 0.4L : 3.0L));
            const ConeRay<float> ray{to_vec(p.point(from)), to_vec(unit(p.vector(to - from))), random.in(0, 0.01f)};
            const Met met = meet(p, Real3(ray.origin), Real3(ray.direction), leaving);
            const Real3 normal = unit(p.gradient(disc ? Real3{0, 1, 0} : met.at));
            if (!(std::fabs(inner(normal, Real3(ray.direction))) > 0.2L) || met.t < 0) continue;
            if (!disc && std::hypot(met.at.x, met.at.z) < 0.2L * r) continue;
            const RaySurface<float> got = shape_surface<float>(p.view, ray, leaving, 0.01f, 0.5f);
            check(p, ray, leaving, met, normal, got);
            if (testing::Test::HasFatalFailure()) return;
            ++count;
        }
    EXPECT_GT(count, 4000);
}

TEST(PlacedShape, PointsAndNormalsAreThoseOfTheDefinition) {
    for_many_rays(1, [](const Placed& p, const ConeRay<float>& ray, bool leaving, const Met& met, const Real3& normal,
                        const RaySurface<float>& got) {
        const SurfacePoint<float>& s = got.point;
        const Real size = norm(p.centre) + 3 * norm(p.vector({1, 1, 1})), slack = 1e-5L * size;
        ASSERT_LE(distance(s.position, p.point(met.at)), slack);
        ASSERT_LE(std::fabs(got.distance - met.t), slack);
        ASSERT_LE(std::fabs(got.width - (ray.width + 0.01f * got.distance)), 1e-6f * size);
        // An ellipsoid's normal is its gradient; it is on the viewer's side.
        const bool disc = p.view.shape.kind == ShapeView::Kind::kDisc;
        const Real side = inner(normal, Real3(ray.direction)) > 0 ? -1 : 1;
        ASSERT_EQ(s.side, side);
        if (!disc) {
            ASSERT_EQ(s.side, leaving ? -1 : 1);
        }
        ASSERT_LE(distance(s.normal, normal * side), 1e-4L);
        ASSERT_LE(distance(s.geometric_normal, normal * side), 1e-4L);
        ASSERT_LE(distance(s.view, Real3(ray.direction) * -1), 1e-9L);
        const std::array<Real, 2> uv = uv_of(p, met.at);
        const Real u = s.uv[0].x - std::round(s.uv[0].x - uv[0]);
        ASSERT_LE(std::fabs(u - uv[0]), 1e-4L);
        ASSERT_LE(std::fabs(s.uv[0].y - uv[1]), 1e-4L);
        ASSERT_TRUE(s.color.x == 1 && s.color.y == 1 && s.color.z == 1 && s.color.w == 1);
    });
}

// The cone's edge rays, parallel to the ray: a little aside in the surface's own direction, and across that.
TEST(PlacedShape, FootprintsAreWhatTheConeCovers) {
    for_many_rays(2, [](const Placed& p, const ConeRay<float>& ray, bool leaving, const Met&, const Real3& normal,
                        const RaySurface<float>& got) {
        const Real3 o(ray.origin), d = unit(Real3(ray.direction)), sideways = unit(outer(normal, d));
        const Real h = 1e-7L;
        const auto gain = [&](const Real3& aside) {
            const std::array<Real, 2> a = uv_of(p, meet(p, o - aside * h, d, leaving).at),
                                      b = uv_of(p, meet(p, o + aside * h, d, leaving).at);
            const Real u = b[0] - a[0];
            const Real scale = 0.5L * static_cast<Real>(got.width) / (2 * h);  // half of it: a sample's
            return std::array<Real, 2>{(u - std::round(u)) * scale, (b[1] - a[1]) * scale};
        };
        // The ellipse has no sense of rotation.
        const auto expect = [&](Real u, Real v, const std::array<Real, 2>& want) {
            const Real size = std::hypot(want[0], want[1]), sign = u * want[0] + v * want[1] < 0 ? -1 : 1;
            ASSERT_LE(std::hypot(u - sign * want[0], v - sign * want[1]), 3e-3L * size);
        };
        const Footprint<float>& f = got.point.footprint[0];
        expect(f.ux, f.vx, gain(sideways));
        expect(f.uy, f.vy, gain(outer(sideways, d)));
    });
}

// Tangents go with u, bitangents against v, however the node mirrors.
TEST(PlacedShape, TangentsFollowTheCoordinates) {
    for_many_rays(3, [](const Placed& p, const ConeRay<float>&, bool, const Met& met, const Real3& normal,
                        const RaySurface<float>& got) {
        const SurfacePoint<float>& s = got.point;
        const bool disc = p.view.shape.kind == ShapeView::Kind::kDisc;
        const Real3 by_u = disc ? Real3{1, 0, 0} : Real3{met.at.z, 0, -met.at.x},
                    by_v = disc ? Real3{0, 0, 1}
                                : Real3{met.at.x * met.at.y, -met.at.x * met.at.x - met.at.z * met.at.z,
                                        met.at.z * met.at.y};
        const Real3 t(s.tangent), b(s.bitangent);
        ASSERT_LE(norm(t - unit(p.vector(by_u))), 2e-4L);
        ASSERT_LT(inner(b, p.vector(by_v)), 0);
        ASSERT_LE(std::fabs(inner(t, normal)), 1e-4L);
        ASSERT_LE(std::fabs(inner(b, normal)), 1e-4L);
        ASSERT_LE(std::fabs(inner(b, t)), 1e-5L);
        ASSERT_LE(std::fabs(norm(b) - 1), 1e-5L);
    });
}

// At the tessellation's vertices: their normals, tangents and texture coordinates.
TEST(PlacedShape, TheTessellationsVerticesAgree) {
    Random random(4);
    for (const Shape::Type type : {Shape::Type::kSphere, Shape::Type::kDisc})
        for (const Scaled& scaled : kScales) {
            const bool disc = type == Shape::Type::kDisc;
            const Primitive mesh = shape_primitive({type, 1.3f, {0, 0}, 24});
            const Placed p(random, disc ? ShapeView::Kind::kDisc : ShapeView::Kind::kSphere, 1.3f, scaled.scale);
            int seen = 0;
            for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
                const auto wide = [](const Vec3& v) { return Real3{v.x, v.y, v.z}; };
                const Real3 at = wide(mesh.positions[i]), normal = wide(mesh.normals[i]);
                if (!disc && std::fabs(normal.y) > 0.999L) continue;  // of the poles each sector has one
                const Real3 from = at * (disc ? 0.999L : 1.0L) + normal * 2;
                const ConeRay<float> ray{to_vec(p.point(from)), to_vec(unit(p.vector(normal * -1))), 0};
                const SurfacePoint<float> s = shape_surface<float>(p.view, ray, false, 0, 1).point;
                SurfacePoint<float> vertex{};
                const Vec3T<float> n = to_vec(unit(p.gradient(normal)));
                const Vec4& tangent = mesh.tangents[i];
                set_tangent_frame(
                    vertex, n,
                    transform_direction(p.view.object_to_camera, Vec3T<float>{tangent.x, tangent.y, tangent.z}),
                    tangent.w * p.view.handedness);
                ASSERT_LE(distance(s.normal, Real3(n)), 2e-4L);
                ASSERT_LE(distance(s.tangent, Real3(vertex.tangent)), 2e-4L);
                ASSERT_LE(distance(s.bitangent, Real3(vertex.bitangent)), 2e-4L);
                const Vec2& uv = mesh.texcoords[0][i];
                ASSERT_NEAR(s.uv[0].x - std::round(s.uv[0].x - uv.x), uv.x, 1e-3f);
                ASSERT_NEAR(s.uv[0].y, uv.y, 1e-3f);
                ++seen;
            }
            EXPECT_GT(seen, 20);
        }
}

}  // namespace
}  // namespace tessera
