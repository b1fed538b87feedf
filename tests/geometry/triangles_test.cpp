// Triangles of lists, strips and fans against the tables of glTF 2.0, section 3.7.2.1; flat normals
// of the primitives that have none.
#include "geometry/triangles.h"

#include "geometry/normals.h"
#include "geometry/support.h"

#include <tessera/transform.h>

#include <numeric>

namespace tessera {
namespace {

using Indices = std::vector<std::uint32_t>;

Primitive primitive_of(PrimitiveMode mode, std::size_t vertices, Indices indices = {}) {
    Primitive p;
    p.mode = mode;
    test::Random random(20);
    for (std::size_t i = 0; i < vertices; ++i) p.positions.push_back(random.vec3(1));
    p.indices = std::move(indices);
    return p;
}

Indices triples(const Primitive& p) {
    const TriangleList list(p);
    EXPECT_EQ(list.count(), triangle_count(p));
    return {list.indices().begin(), list.indices().end()};
}

TEST(Geometry, GEO_TriangleModes) {
    using M = PrimitiveMode;
    EXPECT_EQ(triples(primitive_of(M::kTriangles, 7)), (Indices{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(triples(primitive_of(M::kTriangleStrip, 6)), (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4}));
    EXPECT_EQ(triples(primitive_of(M::kTriangleFan, 6)), (Indices{1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0}));
    const Indices v{9, 8, 7, 6, 5};
    EXPECT_EQ(triples(primitive_of(M::kTriangles, 10, v)), (Indices{9, 8, 7}));
    EXPECT_EQ(triples(primitive_of(M::kTriangleStrip, 10, v)), (Indices{9, 8, 7, 8, 6, 7, 7, 6, 5}));
    EXPECT_EQ(triples(primitive_of(M::kTriangleFan, 10, v)), (Indices{8, 7, 9, 7, 6, 9, 6, 5, 9}));
    // Degenerate triangles keep their numbers.
    EXPECT_EQ(triples(primitive_of(M::kTriangleStrip, 4, {0, 1, 1, 2})), (Indices{0, 1, 1, 1, 2, 1}));
}

TEST(Geometry, GEO_TrianglesOfNothing) {
    using M = PrimitiveMode;
    for (const M mode : {M::kPoints, M::kLines, M::kLineLoop, M::kLineStrip}) {
        EXPECT_FALSE(has_triangles(mode));
        EXPECT_TRUE(triples(primitive_of(mode, 10)).empty());
    }
    for (const M mode : {M::kTriangles, M::kTriangleStrip, M::kTriangleFan}) {
        EXPECT_TRUE(has_triangles(mode));
        for (std::size_t n = 0; n < 3; ++n) EXPECT_TRUE(triples(primitive_of(mode, n)).empty());
        EXPECT_TRUE(triples(primitive_of(mode, 10, {1, 2})).empty());
    }
}

TEST(Geometry, GEO_UsedIndexCount) {
    using M = PrimitiveMode;
    const auto used = [](M mode, std::size_t n) { return used_index_count(primitive_of(mode, n)); };
    EXPECT_EQ(used(M::kPoints, 5), 5u);
    EXPECT_EQ(used(M::kLines, 5), 4u);
    EXPECT_EQ(used(M::kLineStrip, 1), 0u);
    EXPECT_EQ(used(M::kLineLoop, 2), 2u);
    EXPECT_EQ(used(M::kTriangles, 5), 3u);
    EXPECT_EQ(used(M::kTriangleFan, 5), 5u);
    EXPECT_EQ(used(M::kTriangleStrip, 2), 0u);
}

TEST(Geometry, GEO_IndexedListsAreViewed) {
    const Primitive p = primitive_of(PrimitiveMode::kTriangles, 4, {0, 1, 2, 2, 1, 3});
    const TriangleList list(p);
    EXPECT_EQ(list.indices().data(), p.indices.data());
    // What a list owns survives the list's move.
    TriangleList strip(primitive_of(PrimitiveMode::kTriangleStrip, 5));
    const TriangleList moved = std::move(strip);
    EXPECT_EQ(moved[2], (std::array<std::uint32_t, 3>{2, 3, 4}));
}

// Triangles of a strip that lies in a plane all face the same way; so do a fan's.
TEST(Geometry, GEO_StripsAndFansKeepTheirWinding) {
    Primitive strip = primitive_of(PrimitiveMode::kTriangleStrip, 8);
    for (std::size_t i = 0; i < 8; ++i) strip.positions[i] = {static_cast<float>(i / 2), static_cast<float>(i % 2), 0};
    Primitive fan = primitive_of(PrimitiveMode::kTriangleFan, 5);
    fan.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}};
    const auto normal_of = [](const Primitive& p, std::array<std::uint32_t, 3> t) {
        return triangle_normal(p.positions[t[0]], p.positions[t[1]], p.positions[t[2]]);
    };
    const TriangleList strip_list(strip), fan_list(fan);
    for (std::size_t i = 0; i < strip_list.count(); ++i) EXPECT_EQ(normal_of(strip, strip_list[i]), (Vec3{0, 0, -1}));
    for (std::size_t i = 0; i < fan_list.count(); ++i) EXPECT_EQ(normal_of(fan, fan_list[i]), (Vec3{0, 0, 1}));
}

Primitive fully_dressed(PrimitiveMode mode, Indices indices) {
    Primitive p = primitive_of(mode, 6, std::move(indices));
    test::Random random(21);
    p.material = 3;
    p.extras = "{\"a\":1}";
    for (std::size_t i = 0; i < 6; ++i) p.tangents.push_back({1, 0, 0, 1});
    p.texcoords.resize(2);
    p.colors.resize(1);
    p.joints.resize(1);
    p.weights.resize(1);
    p.custom.push_back({"_HEAT", 3, {}});
    p.targets.resize(1);
    for (std::uint16_t i = 0; i < 6; ++i) {
        for (std::vector<Vec2>& uv : p.texcoords) uv.push_back(random.vec2(1));
        p.colors[0].push_back({random.in(0, 1), 0, 0, 1});
        p.joints[0].push_back({i, 0, 0, 0});
        p.weights[0].push_back({1, 0, 0, 0});
        for (int k = 0; k < 3; ++k) p.custom[0].values.push_back(random.in(0, 1));
        p.targets[0].positions.push_back(random.vec3(1));
        p.targets[0].normals.push_back(random.vec3(1));
        p.targets[0].tangents.push_back(random.vec3(1));
    }
    return p;
}

TEST(Geometry, GEO_FlatNormalsDuplicateEveryAttribute) {
    for (const PrimitiveMode mode :
         {PrimitiveMode::kTriangles, PrimitiveMode::kTriangleStrip, PrimitiveMode::kTriangleFan}) {
        const Primitive p = fully_dressed(mode, {0, 1, 2, 2, 1, 3, 5, 4, 4});
        const Indices from = triples(p);
        const Primitive flat = with_flat_normals(p);
        EXPECT_EQ(flat.mode, PrimitiveMode::kTriangles);
        EXPECT_TRUE(flat.indices.empty());
        EXPECT_EQ(flat.material, 3);
        EXPECT_EQ(flat.extras, p.extras);
        ASSERT_EQ(flat.positions.size(), from.size());
        EXPECT_TRUE(flat.tangents.empty());
        EXPECT_TRUE(flat.targets[0].normals.empty());
        EXPECT_TRUE(flat.targets[0].tangents.empty());
        for (std::size_t i = 0; i < from.size(); ++i) {
            const std::size_t s = from[i];
            EXPECT_EQ(flat.positions[i], p.positions[s]);
            EXPECT_EQ(flat.texcoords[0][i], p.texcoords[0][s]);
            EXPECT_EQ(flat.texcoords[1][i], p.texcoords[1][s]);
            EXPECT_EQ(flat.colors[0][i], p.colors[0][s]);
            EXPECT_EQ(flat.joints[0][i], p.joints[0][s]);
            EXPECT_EQ(flat.weights[0][i], p.weights[0][s]);
            EXPECT_EQ(flat.targets[0].positions[i], p.targets[0].positions[s]);
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_EQ(flat.custom[0].values[3 * i + k], p.custom[0].values[3 * s + k]);
        }
        for (std::size_t i = 0; i < from.size(); i += 3) {
            const Vec3 n = triangle_normal(flat.positions[i], flat.positions[i + 1], flat.positions[i + 2]);
            const Vec3 expected = n == Vec3{} ? kDegenerateNormal : n;
            for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(flat.normals[i + k], expected);
        }
    }
}

TEST(Geometry, GEO_FlatNormalsOfPointsAndDegenerates) {
    const Primitive points = with_flat_normals(primitive_of(PrimitiveMode::kPoints, 4));
    EXPECT_EQ(points.positions.size(), 4u);
    EXPECT_TRUE(points.normals.empty());
    Primitive spike = primitive_of(PrimitiveMode::kTriangles, 3);
    spike.positions = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
    for (const Vec3 n : with_flat_normals(spike).normals) EXPECT_EQ(n, kDegenerateNormal);
    EXPECT_TRUE(with_flat_normals(primitive_of(PrimitiveMode::kTriangleStrip, 2)).positions.empty());
}

}  // namespace
}  // namespace tessera
