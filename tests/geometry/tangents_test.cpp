// Tangents by the MikkTSpace standard: known surfaces, properties, a naive twin written from the
// definition of the groups, vertex splitting, and hostile meshes.
#include "geometry/tangents.h"

#include "geometry/support.h"
#include "geometry/triangles.h"
#include "geometry/weld.h"

#include <tessera/transform.h>

#include <array>
#include <numeric>

namespace tessera {
namespace {

using test::Random;
using Indices = std::vector<std::uint32_t>;

struct TestMesh {
    std::vector<Vec3> positions, normals;
    std::vector<Vec2> uv;
    Indices corners;

    std::vector<Vec4> tangents() const { return corner_tangents(positions, normals, uv, corners); }
};

Vec3 xyz(Vec4 t) { return {t.x, t.y, t.z}; }

// A wavy grid of n x n quads: analytic normals, uv rotated and sheared, with a mirror line in the
// middle column when `mirrored`.
TestMesh wavy_grid(std::uint32_t n, bool mirrored) {
    TestMesh mesh;
    const auto height = [](float x, float y) { return 0.3f * std::sin(2 * x) * std::cos(3 * y); };
    for (std::uint32_t j = 0; j <= n; ++j) {
        for (std::uint32_t i = 0; i <= n; ++i) {
            const float x = 2 * static_cast<float>(i) / static_cast<float>(n) - 1;
            const float y = 2 * static_cast<float>(j) / static_cast<float>(n) - 1;
            mesh.positions.push_back({x, y, height(x, y)});
            const float dx = 0.6f * std::cos(2 * x) * std::cos(3 * y), dy = -0.9f * std::sin(2 * x) * std::sin(3 * y);
            mesh.normals.push_back(normalize({-dx, -dy, 1}));
            const float u = mirrored ? std::fabs(x) : x;
            mesh.uv.push_back({0.8f * u + 0.3f * y, 0.2f * u - 0.9f * y});
        }
    }
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            mesh.corners.insert(mesh.corners.end(), {a, b, d, a, d, c});
        }
    }
    return mesh;
}

void expect_valid(const TestMesh& mesh, const std::vector<Vec4>& tangents) {
    ASSERT_EQ(tangents.size(), mesh.corners.size());
    for (std::size_t c = 0; c < tangents.size(); ++c) {
        const Vec3 t = xyz(tangents[c]);
        ASSERT_NEAR(length(t), 1, 1e-6f) << c;
        const Vec3 n = mesh.normals[mesh.corners[c]];
        if (length(n) > 0) {
            ASSERT_NEAR(dot(t, normalize(n)), 0, 1e-6f) << c;
        }
        ASSERT_EQ(std::fabs(tangents[c].w), 1) << c;
    }
}

TEST(Geometry, GEO_TangentsOfAPlane) {
    // u runs along x, v down (against y), as a picture lies on a wall: right-handed.
    TestMesh wall{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                  {4, Vec3{0, 0, 1}},
                  {{0, 1}, {1, 1}, {1, 0}, {0, 0}},
                  {0, 1, 2, 0, 2, 3}};
    for (const Vec4 t : wall.tangents()) EXPECT_EQ(t, (Vec4{1, 0, 0, 1}));
    for (Vec2& uv : wall.uv) uv.x = -uv.x;  // mirrored
    for (const Vec4 t : wall.tangents()) EXPECT_EQ(t, (Vec4{-1, 0, 0, -1}));
    for (Vec2& uv : wall.uv) uv = {uv.y, 100 * uv.x};  // turned, and stretched: only directions count
    for (const Vec4 t : wall.tangents()) EXPECT_EQ(t, (Vec4{0, -1, 0, 1}));
}

TEST(Geometry, GEO_TangentsAreOrthonormalAndFollowTheMapping) {
    for (const bool mirrored : {false, true}) {
        const TestMesh mesh = wavy_grid(24, mirrored);
        const std::vector<Vec4> tangents = mesh.tangents();
        expect_valid(mesh, tangents);
        for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
            const auto p = [&](std::size_t i) { return mesh.positions[mesh.corners[t + i]]; };
            const auto uv = [&](std::size_t i) { return mesh.uv[mesh.corners[t + i]]; };
            const Vec2 d1 = uv(1) - uv(0), d2 = uv(2) - uv(0);
            const float area = cross(d1, d2);
            const Vec3 du = (p(1) - p(0)) * (d2.y / area) - (p(2) - p(0)) * (d1.y / area);
            const Vec3 dv = (p(2) - p(0)) * (d1.x / area) - (p(1) - p(0)) * (d2.x / area);
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec4 tangent = tangents[t + i];
                EXPECT_GT(dot(normalize(du), xyz(tangent)), 0.95f);
                // The bitangent points against v.
                const Vec3 bitangent = tangent.w * cross(mesh.normals[mesh.corners[t + i]], xyz(tangent));
                EXPECT_LT(dot(dv, bitangent), 0);
            }
        }
    }
}

// The definition, the slow way: two corners at one vertex are in one group when their triangles share
// an edge there and have one orientation; closed transitively. For meshes in which every triangle is
// mapped and no edge has more than two triangles.
std::vector<Vec3> naive_tangents(const TestMesh& mesh) {
    const std::size_t n = mesh.corners.size();
    const auto same = [&](std::size_t i, std::size_t j) {
        const std::uint32_t a = mesh.corners[i], b = mesh.corners[j];
        return mesh.positions[a] == mesh.positions[b] && mesh.normals[a] == mesh.normals[b] && mesh.uv[a] == mesh.uv[b];
    };
    const auto position = [&](std::size_t c) { return mesh.positions[mesh.corners[c]]; };
    const auto corner = [](std::size_t t, std::size_t i) { return 3 * t + i % 3; };
    const auto area = [&](std::size_t t) {
        const Vec2 a = mesh.uv[mesh.corners[3 * t]];
        return cross(mesh.uv[mesh.corners[3 * t + 1]] - a, mesh.uv[mesh.corners[3 * t + 2]] - a);
    };
    std::vector<std::size_t> group(n);
    std::iota(group.begin(), group.end(), std::size_t{0});
    const auto join = [&](std::size_t a, std::size_t b) {
        const std::size_t from = group[a], to = group[b];
        for (std::size_t& g : group) g = g == from ? to : g;
    };
    for (std::size_t t = 0; t < n / 3; ++t)
        for (std::size_t s = 0; s < t; ++s)
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j) {
                    const bool shared = same(corner(t, i), corner(s, j + 1)) && same(corner(t, i + 1), corner(s, j));
                    if (!shared || (area(t) > 0) != (area(s) > 0)) continue;
                    join(corner(t, i), corner(s, j + 1));
                    join(corner(t, i + 1), corner(s, j));
                }
    std::vector<Vec3> sums(n);
    for (std::size_t c = 0; c < n; ++c) {
        const std::size_t t = c / 3;
        const Vec3 normal = mesh.normals[mesh.corners[c]];
        const auto flat = [&](Vec3 v) { return normalize(v - normal * dot(normal, v)); };
        const Vec2 a = mesh.uv[mesh.corners[3 * t]];
        const Vec2 d1 = mesh.uv[mesh.corners[3 * t + 1]] - a, d2 = mesh.uv[mesh.corners[3 * t + 2]] - a;
        const Vec3 e1 = position(3 * t + 1) - position(3 * t), e2 = position(3 * t + 2) - position(3 * t);
        const Vec3 du = (e1 * d2.y - e2 * d1.y) * (area(t) > 0 ? 1.0f : -1.0f);
        const Vec3 to_next = flat(position(corner(t, c % 3 + 1)) - position(c));
        const Vec3 to_previous = flat(position(corner(t, c % 3 + 2)) - position(c));
        const float angle = std::acos(std::clamp(dot(to_next, to_previous), -1.0f, 1.0f));
        sums[group[c]] = sums[group[c]] + flat(du) * angle;
    }
    std::vector<Vec3> result(n);
    for (std::size_t c = 0; c < n; ++c) result[c] = normalize(sums[group[c]]);
    return result;
}

TEST(Geometry, GEO_TangentsAgainstTheDefinition) {
    Random random(30);
    for (int round = 0; round < 30; ++round) {
        TestMesh mesh = wavy_grid(6, round % 2 == 1);
        for (Vec3& p : mesh.positions) p = p + random.vec3(0.08f);
        for (Vec3& n : mesh.normals) n = normalize(n + random.vec3(0.2f));
        // Islands of other uv orientation, seams (vertices doubled with another uv) and holes.
        Indices kept;
        for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
            if (random.below(10) == 0) continue;
            for (std::size_t i = 0; i < 3; ++i) {
                std::uint32_t v = mesh.corners[t + i];
                if (random.below(6) == 0) {
                    mesh.positions.push_back(mesh.positions[v]);
                    mesh.normals.push_back(mesh.normals[v]);
                    mesh.uv.push_back(random.below(2) == 0 ? mesh.uv[v] : random.vec2(1));
                    v = static_cast<std::uint32_t>(mesh.positions.size() - 1);
                }
                kept.push_back(v);
            }
        }
        mesh.corners = kept;
        const std::vector<Vec4> tangents = mesh.tangents();
        const std::vector<Vec3> naive = naive_tangents(mesh);
        expect_valid(mesh, tangents);
        for (std::size_t c = 0; c < naive.size(); ++c) EXPECT_GT(dot(naive[c], xyz(tangents[c])), 0.9999f) << c;
    }
}

TEST(Geometry, GEO_TangentsDoNotDependOnIndexing) {
    for (const bool mirrored : {false, true}) {
        const TestMesh indexed = wavy_grid(10, mirrored);
        TestMesh soup;
        for (const std::uint32_t v : indexed.corners) {
            soup.corners.push_back(static_cast<std::uint32_t>(soup.positions.size()));
            soup.positions.push_back(indexed.positions[v]);
            soup.normals.push_back(indexed.normals[v]);
            soup.uv.push_back(indexed.uv[v]);
        }
        EXPECT_EQ(soup.tangents(), indexed.tangents());
    }
}

TEST(Geometry, GEO_TangentsWeldMinusZero) {
    const std::vector<Vec3> positions{{0, 0, 0}, {-0.0f, 0, 0}, {1, 0, 0}, {0, 0, 0}};
    const std::vector<Vec3> normals{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}};
    EXPECT_EQ(weld_vertices(positions, normals, {}), (Indices{0, 0, 2, 3}));
}

TEST(Geometry, GEO_DegenerateTrianglesBorrowTangentsAndCutNothing) {
    TestMesh mesh = wavy_grid(4, false);
    const std::vector<Vec4> before = mesh.tangents();
    const Indices regular = mesh.corners;
    // A seam's sliver: vertex 25 is at the place of 7 with another uv, so the triangle has area in uv
    // but none in space. In front, where it would be the first to claim the edge between 7 and 8.
    mesh.positions.push_back(mesh.positions[7]);
    mesh.normals.push_back(mesh.normals[7]);
    mesh.uv.push_back({5, 5});
    const Indices degenerate{8, 7, 25, 7, 7, 8, 12, 12, 12};
    mesh.corners.insert(mesh.corners.begin(), degenerate.begin(), degenerate.end());
    const std::vector<Vec4> after = mesh.tangents();
    for (std::size_t c = 0; c < regular.size(); ++c) EXPECT_EQ(after[c + degenerate.size()], before[c]);
    for (std::size_t c = 0; c < degenerate.size(); ++c) {
        if (degenerate[c] == 25) continue;
        const auto like = std::find(regular.begin(), regular.end(), degenerate[c]) - regular.begin();
        EXPECT_EQ(after[c], before[static_cast<std::size_t>(like)]);
    }
    expect_valid(mesh, after);
}

TEST(Geometry, GEO_TrianglesWithoutATangentTakeTheOrientationOfOthers) {
    // The first triangle is a line along x on which only v changes with the place: it has no dP/du. Its
    // uv area has the other sign than the second's, and yet it takes that one's tangents.
    const TestMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}},
                        {4, Vec3{0, 0, 1}},
                        {{0, 0}, {0, 1}, {-1, 2}, {-1, 0}},
                        {0, 1, 2, 1, 0, 3}};
    const std::vector<Vec4> tangents = mesh.tangents();
    expect_valid(mesh, tangents);
    EXPECT_EQ(tangents[0], tangents[4]);
    EXPECT_EQ(tangents[1], tangents[3]);
}

TEST(Geometry, GEO_TrianglesWithoutMappingJoinTheirNeighbours) {
    // The second triangle's uv have no area: on the shared edge it takes the tangents of the first,
    // and its own vertex, which no mapping reaches, gets something usable.
    const TestMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                        {4, Vec3{0, 0, 1}},
                        {{0, 0}, {0, 1}, {1, 0}, {0.5f, 0.5f}},
                        {0, 1, 2, 2, 1, 3}};
    const std::vector<Vec4> tangents = mesh.tangents();
    for (std::size_t c = 0; c < 5; ++c) EXPECT_EQ(tangents[c], (Vec4{0, 1, 0, 1})) << c;
    expect_valid(mesh, tangents);
    // Alone, or without any uv, it gets something usable.
    TestMesh alone = mesh;
    alone.corners = {2, 1, 3};
    expect_valid(alone, alone.tangents());
    alone.uv.clear();
    expect_valid(alone, alone.tangents());
}

TEST(Geometry, GEO_TangentsOfHostileMeshesAreFiniteAndFast) {
    constexpr std::uint32_t kMany = 200000;
    TestMesh shared_edge;  // every triangle has the edge 0-1, in both directions
    shared_edge.positions = {{0, 0, 0}, {1, 0, 0}};
    TestMesh star;  // every triangle has vertex 0 and shares no edge
    star.positions = {{0, 0, 0}};
    TestMesh fan = star;  // every triangle has vertex 0 and shares both edges
    Random random(31);
    for (std::uint32_t i = 0; i < kMany; ++i) {
        const auto v = static_cast<std::uint32_t>(shared_edge.positions.size());
        shared_edge.positions.push_back(random.vec3(1));
        if (i % 2 == 0)
            shared_edge.corners.insert(shared_edge.corners.end(), {0, 1, v});
        else
            shared_edge.corners.insert(shared_edge.corners.end(), {1, 0, v});
        star.positions.push_back(random.vec3(1));
        star.positions.push_back(random.vec3(1));
        star.corners.insert(star.corners.end(), {0, 2 * i + 1, 2 * i + 2});
        fan.positions.push_back(random.vec3(1));
        if (i > 0) fan.corners.insert(fan.corners.end(), {0, i, i + 1});
    }
    for (TestMesh* mesh : {&shared_edge, &star, &fan}) {
        for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
            mesh->normals.push_back({0, 0, 1});
            mesh->uv.push_back(random.vec2(1));
        }
        expect_valid(*mesh, mesh->tangents());
        Primitive p;
        p.positions = mesh->positions, p.normals = mesh->normals, p.texcoords = {mesh->uv}, p.indices = mesh->corners;
        EXPECT_EQ(with_tangents(p, 0).indices.size(), mesh->corners.size());
    }
}

TEST(Geometry, GEO_TangentsOfExtremeNumbersAreFinite) {
    Random random(32);
    const std::array<float, 8> special{0, -0.0f, 1e-45f, 1e-38f, 3.4e38f, -3.4e38f, 1, 1e20f};
    for (int round = 0; round < 300; ++round) {
        TestMesh mesh;
        const auto pick = [&] { return special[random.below(8)]; };
        for (int i = 0; i < 8; ++i) {
            mesh.positions.push_back({pick(), pick(), pick()});
            mesh.normals.push_back(random.below(5) == 0 ? Vec3{} : random.unit());
            mesh.uv.push_back({pick(), pick()});
        }
        for (int i = 0; i < 36; ++i) mesh.corners.push_back(random.below(8));
        expect_valid(mesh, mesh.tangents());
    }
}

TEST(Geometry, GEO_TangentsSplitVerticesAtMirrors) {
    const TestMesh mesh = wavy_grid(8, true);
    Primitive p;
    p.material = 2;
    p.positions = mesh.positions, p.normals = mesh.normals, p.indices = mesh.corners;
    p.texcoords = {std::vector<Vec2>(mesh.uv.size()), mesh.uv};  // the mapping is set 1
    p.targets.resize(1);
    p.targets[0].positions = mesh.normals;
    const Primitive result = with_tangents(p, 1);
    const std::vector<Vec4> tangents = mesh.tangents();
    ASSERT_EQ(result.indices.size(), p.indices.size());
    ASSERT_EQ(result.tangents.size(), result.positions.size());
    EXPECT_EQ(result.material, 2);
    for (std::size_t c = 0; c < p.indices.size(); ++c) {
        EXPECT_EQ(result.tangents[result.indices[c]], tangents[c]);
        EXPECT_EQ(result.positions[result.indices[c]], p.positions[p.indices[c]]);
        EXPECT_EQ(result.texcoords[1][result.indices[c]], mesh.uv[p.indices[c]]);
        EXPECT_EQ(result.targets[0].positions[result.indices[c]], mesh.normals[p.indices[c]]);
    }
    // The nine vertices of the mirror line have two tangents each; nothing else is split.
    EXPECT_EQ(result.positions.size(), p.positions.size() + 9);
    for (std::size_t v = 0; v < p.positions.size(); ++v) EXPECT_EQ(result.positions[v], p.positions[v]);
}

TEST(Geometry, GEO_TangentsOfStripsAndOfNothing) {
    Primitive strip;
    strip.mode = PrimitiveMode::kTriangleStrip;
    strip.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    strip.texcoords = {{{0, 1}, {1, 1}, {0, 0}, {1, 0}}};
    EXPECT_TRUE(with_tangents(strip, 0).tangents.empty());  // no normals
    strip.normals.assign(4, {0, 0, 1});
    const Primitive result = with_tangents(strip, 0);
    EXPECT_EQ(result.mode, PrimitiveMode::kTriangles);
    EXPECT_EQ(result.indices, (Indices{0, 1, 2, 1, 3, 2}));
    EXPECT_EQ(result.tangents, std::vector<Vec4>(4, Vec4{1, 0, 0, 1}));
    for (const Vec4 t : with_tangents(strip, 7).tangents) EXPECT_NEAR(length(xyz(t)), 1, 1e-6f);
    strip.indices = {0, 1};
    EXPECT_EQ(triangle_count(with_tangents(strip, 0)), 0u);
}

}  // namespace
}  // namespace tessera
