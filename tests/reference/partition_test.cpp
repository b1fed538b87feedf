// The fill rule by its definition: the triangles of a planar triangulation cover every sample exactly
// once, wherever their vertices lie.
#include <gtest/gtest.h>

#include "reference/rasterizer.h"
#include "reference/workload_scene.h"

#include <array>
#include <random>

namespace tessera {
namespace {

constexpr int kSide = 64;  // a power of two: pixel coordinates of 1/256 reach clip space exactly

struct Point {
    std::int64_t x, y;  // 1/256 pixel
    friend bool operator==(const Point&, const Point&) = default;
};
using Triangle = std::array<std::size_t, 3>;

std::int64_t area(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y); }

// A triangulation of a rectangle around the picture by random insertion: every point splits the
// triangle, or the two triangles at the edge, that it falls on.
struct Triangulation {
    std::vector<Point> points;
    std::vector<Triangle> triangles;

    explicit Triangulation(std::int64_t margin) {
        const std::int64_t low = -margin, high = 256 * kSide + margin;
        points = {{low, low}, {high, low}, {high, high}, {low, high}};
        triangles = {{0, 1, 2}, {0, 2, 3}};
    }
    void insert(Point p) {
        const std::size_t index = points.size();
        std::vector<Triangle> next;
        for (const Triangle& t : triangles) {
            const std::int64_t s[3] = {area(points[t[1]], points[t[2]], p), area(points[t[2]], points[t[0]], p),
                                       area(points[t[0]], points[t[1]], p)};
            if (s[0] < 0 || s[1] < 0 || s[2] < 0) {
                next.push_back(t);
                continue;
            }
            for (std::size_t k = 0; k < 3; ++k) {
                const Triangle piece{t[(k + 1) % 3], t[(k + 2) % 3], index};
                if (s[k] > 0) next.push_back(piece);  // a piece without area is the edge itself
            }
        }
        points.push_back(p);
        triangles = std::move(next);
    }
};

Scene to_scene(const Triangulation& t, std::mt19937& random) {
    Scene scene;
    Primitive p;
    for (const Point& v : t.points) {
        p.positions.push_back(
            {static_cast<float>(v.x) / 256.0f - 32.0f, 32.0f - static_cast<float>(v.y) / 256.0f, -1.0f});
        p.normals.push_back({0, 0, 1});
    }
    for (Triangle tri : t.triangles) {
        std::rotate(tri.begin(), tri.begin() + static_cast<std::ptrdiff_t>(random() % 3), tri.end());
        if (random() % 2) std::swap(tri[0], tri[1]);
        for (const std::size_t i : tri) p.indices.push_back(static_cast<std::uint32_t>(i));
    }
    p.material = 0;
    Material glass;  // every covered sample leaves a fragment
    glass.alpha_mode = AlphaMode::kBlend;
    glass.double_sided = true;
    scene.materials.push_back(glass);
    scene.meshes.push_back({"mesh", {std::move(p)}, {}, {}});
    Camera camera;
    camera.type = Camera::Type::kOrthographic;
    camera.xmag = camera.ymag = kSide / 2;
    camera.znear = 0.5f;
    camera.zfar = 2;
    scene.cameras.push_back(camera);
    scene.nodes.emplace_back().mesh = 0;
    scene.nodes[0].camera = 0;
    scene.scenes.push_back({"scene", {0}, {}});
    return scene;
}

void expect_partition(const Triangulation& t, std::mt19937& random, SamplePosition offset) {
    const test::Prepared p(to_scene(t, random), View{}, kSide, kSide);
    const Visibility v = rasterize(p.frame, p.context(), offset, test::no_control());
    std::vector<int> covered(kSide * kSide, 0);
    for (const Fragment& f : v.transparent) ++covered[f.pixel];
    for (std::size_t i = 0; i < covered.size(); ++i)
        ASSERT_EQ(covered[i], 1) << "pixel " << i % kSide << ", " << i / kSide << " of " << t.triangles.size()
                                 << " triangles";
}

// The kinds of places where a fill rule can go wrong.
Point random_point(std::mt19937& random, std::int64_t margin) {
    const auto within = [&](std::int64_t low, std::int64_t high) {
        return std::uniform_int_distribution<std::int64_t>(low, high)(random);
    };
    const std::int64_t last = 256 * kSide;
    switch (random() % 5) {
        case 0:
            return {256 * within(0, kSide - 1) + 128, 256 * within(0, kSide - 1) + 128};  // pixel centres
        case 1:
            return {256 * within(0, kSide), 256 * within(0, kSide)};  // pixel corners
        case 2:
            return {within(0, last), 256 * within(0, kSide - 1) + 128};  // rows of centres
        case 3:
            return {within(-margin, last + margin), within(-margin, last + margin)};
        default:
            return {within(0, last), within(0, last)};
    }
}

class Partition : public testing::TestWithParam<int> {};

TEST_P(Partition, RAS4_RandomTriangulationsCoverEverySampleOnce) {
    // Margins within the view, on the guard band exactly, and beyond it, where triangles are clipped.
    const std::int64_t guard = static_cast<std::int64_t>((static_cast<double>(kGuardBand) - 1) * 0.5 * kSide * 256);
    const std::int64_t margins[] = {0, 300, guard, guard + 77, 40 * guard};
    std::mt19937 random(static_cast<unsigned>(GetParam()));
    for (int i = 0; i < 100; ++i) {
        const std::int64_t margin = margins[random() % 5];
        Triangulation t(margin);
        const int count = 1 + static_cast<int>(random() % 60);
        for (int k = 0; k < count; ++k) {
            const Point p = random_point(random, margin);
            if (std::find(t.points.begin(), t.points.end(), p) == t.points.end()) t.insert(p);
        }
        const SamplePosition offset =
            random() % 2 ? SamplePosition{128, 128}
                         : SamplePosition{static_cast<int>(random() % 256), static_cast<int>(random() % 256)};
        expect_partition(t, random, offset);
        if (HasFatalFailure()) return;
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Partition, testing::Range(1, 11));

}  // namespace
}  // namespace tessera
