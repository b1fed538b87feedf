// Shapes as triangles: where the vertices lie, which way they face, that nothing gapes; and what is refused.
#include "scene/shapes.h"

#include <tessera/error.h>
#include <tessera/scene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

namespace tessera {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Shape sphere(float radius, int segments) { return {Shape::Type::kSphere, radius, {0, 0}, segments}; }
Shape disc(float radius, int segments) { return {Shape::Type::kDisc, radius, {0, 0}, segments}; }
Shape plane(float x, float z) { return {Shape::Type::kPlane, 1, {x, z}, 96}; }

using Point = std::array<double, 3>;
Point to_point(const Vec3& v) { return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)}; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double norm(const Point& a) { return std::sqrt(dot(a, a)); }

struct Facet {
    Point a, b, c;
    Point area() const {  // twice, along the normal
        return cross(minus(b, a), minus(c, a));
    }
};
std::vector<Facet> facets(const Primitive& p) {
    std::vector<Facet> result;
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3)
        result.push_back({to_point(p.positions[p.indices[i]]), to_point(p.positions[p.indices[i + 1]]),
                          to_point(p.positions[p.indices[i + 2]])});
    return result;
}

// Vertices with the same bits are one.
using Bits = std::array<std::uint32_t, 3>;
Bits bits(const Vec3& v) {
    return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y), std::bit_cast<std::uint32_t>(v.z)};
}
// How often triangles go along each edge.
std::map<std::pair<Bits, Bits>, int> directed_edges(const Primitive& p) {
    std::map<std::pair<Bits, Bits>, int> edges;
    for (std::size_t i = 0; i < p.indices.size(); ++i) {
        const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
        ++edges[{bits(p.positions[p.indices[i]]), bits(p.positions[p.indices[next]])}];
    }
    return edges;
}

TEST(Shapes, HaveTheCountsThatAreToldBefore) {
    for (const int n : {8, 9, 96, 131, 1024})
        for (const Shape& shape : {sphere(1, n), disc(1, n), plane(1, 2), plane(0, 0)}) {
            const Primitive p = shape_primitive(shape, 7);
            const ShapeCounts counts = shape_counts(shape);
            EXPECT_EQ(p.positions.size(), counts.vertices);
            EXPECT_EQ(p.indices.size(), 3 * counts.triangles);
            EXPECT_EQ(p.shape, shape);
            EXPECT_EQ(p.material, 7);
            EXPECT_EQ(p.mode, PrimitiveMode::kTriangles);
            ASSERT_EQ(p.texcoords.size(), 1u);
            for (const std::size_t size : {p.normals.size(), p.tangents.size(), p.texcoords[0].size()})
                EXPECT_EQ(size, counts.vertices);
            EXPECT_EQ(std::set<std::uint32_t>(p.indices.begin(), p.indices.end()).size(), counts.vertices);
        }
    // A band of triangles at each pole, of quads between; a sector each.
    EXPECT_EQ(shape_counts(sphere(1, 8)).triangles, 8u + 2u * 8u * 2u + 8u);
    EXPECT_EQ(shape_counts(sphere(1, 96)).triangles, 96u + 46u * 96u * 2u + 96u);
    EXPECT_EQ(shape_counts(disc(1, 96)).triangles, 96u);
    EXPECT_EQ(shape_counts(plane(1, 1)).triangles, 2u);
}

// Against the parametrisation, with libm.
TEST(Shapes, TheVerticesOfASphereAreWhereTheirCoordinatesSay) {
    for (const int n : {8, 13, 96, 1024})
        for (const float radius : {1.0f, 0.37f, 3e30f}) {
            const Primitive p = shape_primitive(sphere(radius, n));
            const double r = static_cast<double>(radius);
            for (std::size_t i = 0; i < p.positions.size(); ++i) {
                const double phi = 2 * kPi * (static_cast<double>(p.texcoords[0][i].x) - 0.5);
                const double theta = kPi * static_cast<double>(p.texcoords[0][i].y);
                const Point expected{std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
                const Point at = to_point(p.positions[i]), normal = to_point(p.normals[i]);
                for (std::size_t k = 0; k < 3; ++k) {
                    ASSERT_NEAR(at[k] / r, expected[k], 1e-6) << n << " " << i;
                    ASSERT_NEAR(normal[k], expected[k], 1e-6) << n << " " << i;
                }
                ASSERT_NEAR(norm(at) / r, 1, 1.2e-7);  // rounding of three floats
                ASSERT_NEAR(norm(normal), 1, 1.2e-7);
                const Point eastwards{std::cos(phi), 0, -std::sin(phi)};
                const Vec4& t = p.tangents[i];
                ASSERT_NEAR(dot(to_point({t.x, t.y, t.z}), eastwards), 1, 1e-6);
                ASSERT_EQ(t.w, 1);
            }
        }
}

TEST(Shapes, ASphereIsClosedAndFacesOutwards) {
    for (const int n : {8, 9, 96, 257}) {
        const Primitive p = shape_primitive(sphere(1.7f, n));
        const auto edges = directed_edges(p);
        std::set<Bits> vertices;
        for (const auto& [edge, count] : edges) {
            vertices.insert(edge.first);
            ASSERT_EQ(count, 1);
            ASSERT_NE(edge.first, edge.second);
            ASSERT_EQ(edges.count({edge.second, edge.first}), 1u) << n;
        }
        // Euler's formula: one surface without holes.
        EXPECT_EQ(vertices.size() - edges.size() / 2 + p.indices.size() / 3, 2u);
        double volume = 0;
        for (const Facet& f : facets(p)) {
            ASSERT_GT(dot(f.area(), f.a), 0);
            volume += dot(f.a, cross(f.b, f.c)) / 6;
        }
        const double full = 4.0 / 3.0 * kPi * std::pow(static_cast<double>(1.7f), 3);
        EXPECT_LT(volume, full);
        EXPECT_GT(volume, full * (1 - 25.0 / (n * n)));  // inscribed: short by a square of the angle
    }
}

TEST(Shapes, SeamsAndPolesOfASphereHaveTheirOwnCoordinates) {
    constexpr int kSegments = 24;
    const Primitive p = shape_primitive(sphere(1, kSegments));
    std::set<float> poles;
    for (std::size_t t = 0; t < p.indices.size(); t += 3) {
        std::array<Vec2, 3> uv;
        for (std::size_t k = 0; k < 3; ++k) uv[k] = p.texcoords[0][p.indices[t + k]];
        const auto [low, high] = std::minmax({uv[0].x, uv[1].x, uv[2].x});
        EXPECT_LT(high - low, 1.01f / kSegments) << "no triangle goes back over the picture";
        for (std::size_t k = 0; k < 3; ++k) {
            if (uv[k].y != 0 && uv[k].y != 1) continue;
            EXPECT_FLOAT_EQ(uv[k].x, 0.5f * (low + high));
            EXPECT_EQ(std::abs(p.positions[p.indices[t + k]].y), 1);
            poles.insert(uv[k].x);
        }
    }
    EXPECT_EQ(poles.size(), std::size_t{kSegments});
}

TEST(Shapes, ADiscIsAFanThatFacesUp) {
    for (const int n : {8, 9, 1024}) {
        const Primitive p = shape_primitive(disc(2.5f, n));
        for (std::size_t i = 0; i < p.positions.size(); ++i) {
            const Vec3& at = p.positions[i];
            ASSERT_EQ(at.y, 0);
            if (i > 0) {
                ASSERT_NEAR(std::hypot(static_cast<double>(at.x), static_cast<double>(at.z)), 2.5, 3e-7);
            }
            ASSERT_EQ(p.normals[i], (Vec3{0, 1, 0}));
            ASSERT_EQ(p.tangents[i], (Vec4{1, 0, 0, 1}));
            ASSERT_NEAR(p.texcoords[0][i].x, 0.5f + at.x / 5, 1e-7f);
            ASSERT_NEAR(p.texcoords[0][i].y, 0.5f + at.z / 5, 1e-7f);
        }
        double area = 0;
        for (const Facet& f : facets(p)) {
            ASSERT_GT(f.area()[1], 0);
            area += 0.5 * f.area()[1];
        }
        EXPECT_NEAR(area, 0.5 * n * 2.5 * 2.5 * std::sin(2 * kPi / n), 1e-5);
        int border = 0;
        const auto edges = directed_edges(p);
        for (const auto& [edge, count] : edges) {
            ASSERT_EQ(count, 1);
            border += edges.count({edge.second, edge.first}) == 0 ? 1 : 0;
        }
        EXPECT_EQ(border, n);
    }
}

TEST(Shapes, ARectangleHasItsSize) {
    const Primitive p = shape_primitive(plane(4, 3));
    double area = 0;
    for (const Facet& f : facets(p)) {
        EXPECT_GT(f.area()[1], 0);
        area += 0.5 * f.area()[1];
    }
    EXPECT_EQ(area, 12);
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3& at = p.positions[i];
        EXPECT_EQ(std::abs(at.x), 2);
        EXPECT_EQ(at.y, 0);
        EXPECT_EQ(std::abs(at.z), 1.5f);
        EXPECT_EQ(p.texcoords[0][i], (Vec2{at.x / 4 + 0.5f, at.z / 3 + 0.5f}));
        EXPECT_EQ(p.normals[i], (Vec3{0, 1, 0}));
        EXPECT_EQ(p.tangents[i], (Vec4{1, 0, 0, 1}));
    }
}

TEST(Shapes, APlaneWithoutEndIsWholeAndFineInTheMiddle) {
    const Primitive p = shape_primitive(plane(0, 0));
    const double reach = static_cast<double>(kPlaneReach);
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
        const Vec3& at = p.positions[i];
        EXPECT_EQ(at.y, 0);
        EXPECT_EQ(p.texcoords[0][i], (Vec2{at.x, at.z}));
    }
    const auto edges = directed_edges(p);
    int border = 0;
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        if (edges.count({edge.second, edge.first}) != 0) continue;
        ++border;
        for (const Bits& end : {edge.first, edge.second})
            EXPECT_EQ(std::max(std::abs(std::bit_cast<float>(end[0])), std::abs(std::bit_cast<float>(end[2]))),
                      kPlaneReach);
    }
    EXPECT_EQ(border, 4);
    double area = 0;
    for (const Facet& f : facets(p)) {
        EXPECT_GT(f.area()[1], 0);
        area += 0.5 * f.area()[1];
        const double longest =
            std::max({norm(minus(f.a, f.b)), norm(minus(f.b, f.c)), norm(minus(f.c, f.a)), norm(f.a)});
        const Point middle{(f.a[0] + f.b[0] + f.c[0]) / 3, 0, (f.a[2] + f.b[2] + f.c[2]) / 3};
        EXPECT_LE(longest, 4 * std::max(norm(middle), 1.0));
    }
    EXPECT_EQ(area, 4 * reach * reach);
}

struct Refusal {
    Shape shape;
    const char* location;
};

const std::vector<Refusal>& refusals() {
    static const std::vector<Refusal> all = {
        {sphere(0, 96), "shape/radius"},    {sphere(-1, 96), "shape/radius"},
        {sphere(kNan, 96), "shape/radius"}, {sphere(kInfinity, 96), "shape/radius"},
        {disc(0, 96), "shape/radius"},      {disc(kInfinity, 96), "shape/radius"},
        {sphere(1, 7), "shape/segments"},   {sphere(1, 1025), "shape/segments"},
        {disc(1, -8), "shape/segments"},    {plane(-1, 1), "shape/size"},
        {plane(1, 0), "shape/size"},        {plane(0, 1), "shape/size"},
        {plane(kNan, 1), "shape/size"},     {plane(1, kInfinity), "shape/size"},
        {plane(kNan, kNan), "shape/size"},
    };
    return all;
}

TEST(Shapes, NumbersOutOfRangeAreRefused) {
    for (const Refusal& r : refusals()) try {
            shape_primitive(r.shape);
            ADD_FAILURE() << r.location << " is not refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kUsage);
            EXPECT_EQ(error.location(), r.location);
        }
    // What does not belong to the type is not looked at.
    Shape odd = plane(1, 1);
    odd.radius = kNan, odd.segments = -1;
    EXPECT_NO_THROW(shape_primitive(odd));
    odd = sphere(1, 8);
    odd.size = {kNan, -1};
    EXPECT_NO_THROW(shape_primitive(odd));
}

Scene scene_of(const Shape& shape) {
    Scene scene;
    scene.meshes.push_back({"", {shape_primitive({}), shape_primitive(shape)}, {}, {}});
    return scene;
}

TEST(Shapes, WhatIsMadeIsValid) {
    for (const Shape& shape : {sphere(1, 8), sphere(1e-44f, 96), sphere(3e38f, 97), disc(1e-44f, 9), disc(3e38f, 1024),
                               plane(3, 4), plane(1e-44f, 3e38f), plane(0, 0)})
        EXPECT_NO_THROW(validate(scene_of(shape)));
}

TEST(Shapes, ValidationFindsWhatNoShapeHas) {
    const std::vector<std::pair<Shape, std::function<void(Primitive&)>>> faults = {
        {sphere(1, 8), [](Primitive& p) { p.mode = PrimitiveMode::kTriangleStrip; }},
        {sphere(1, 8), [](Primitive& p) { p.indices.resize(p.indices.size() - 3); }},
        {sphere(1, 8), [](Primitive& p) { p.shape->segments = 9; }},
        {sphere(1, 8), [](Primitive& p) { p.shape->type = Shape::Type::kDisc; }},
        {sphere(1, 8), [](Primitive& p) { p.shape->radius = 1.001f; }},
        {sphere(1, 8), [](Primitive& p) { p.positions[11] = p.positions[11] * 0.999f; }},
        {sphere(1, 8), [](Primitive& p) { p.normals.clear(); }},
        {sphere(1, 8), [](Primitive& p) { p.tangents.clear(); }},
        {sphere(1, 8), [](Primitive& p) { p.texcoords.clear(); }},
        {sphere(1, 8), [](Primitive& p) { p.texcoords[0].clear(); }},
        {sphere(1, 8), [](Primitive& p) { p.texcoords.push_back(p.texcoords[0]); }},
        {sphere(1, 8), [](Primitive& p) { p.colors.emplace_back(p.positions.size()); }},
        {sphere(1, 8),
         [](Primitive& p) { p.joints.emplace_back(p.positions.size()), p.weights.emplace_back(p.positions.size()); }},
        {sphere(1, 8),
         [](Primitive& p) {
             p.custom.push_back({"_A", 1, std::vector<float>(p.positions.size())});
         }},
        {sphere(1, 8), [](Primitive& p) { p.targets.resize(1); }},
        {disc(1, 8), [](Primitive& p) { p.positions[0].y = 1e-6f; }},
        {disc(1, 8), [](Primitive& p) { p.positions[3] = p.positions[3] * 1.001f; }},
        {plane(2, 4), [](Primitive& p) { p.positions[0].y = 1e-6f; }},
        {plane(2, 4),
         [](Primitive& p) {
             p.positions[0] = {-1.5f, 0, -1.5f};
         }},
        {plane(2, 4),
         [](Primitive& p) {
             p.shape->size = {0, 0};
         }},
        {plane(0, 0), [](Primitive& p) { p.positions.back().x *= 2; }},
    };
    for (std::size_t i = 0; i < faults.size(); ++i) {
        SCOPED_TRACE(i);
        Scene scene = scene_of(faults[i].first);
        ASSERT_NO_THROW(validate(scene));
        faults[i].second(scene.meshes[0].primitives[1]);
        try {
            validate(scene);
            ADD_FAILURE() << "not found";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kUsage);
            EXPECT_EQ(error.location(), "meshes/0/primitives/1/shape") << error.what();
        }
    }
    for (const Refusal& r : refusals()) {
        Shape good = r.shape;
        good.radius = 1, good.size = {1, 1}, good.segments = 8;
        Scene scene = scene_of(good);
        scene.meshes[0].primitives[1].shape = r.shape;
        try {
            validate(scene);
            ADD_FAILURE() << r.location << " is not found";
        } catch (const Error& error) {
            EXPECT_EQ(error.location(), std::string("meshes/0/primitives/1/") + r.location);
        }
    }
}

}  // namespace
}  // namespace tessera
