// BEY2: labels against the geometry of a plane, worked out pixel by pixel in double with OpenCV's pinhole formulas;
// spaces, distances, numbers; every engine; and nothing that was not asked for.
#include <gtest/gtest.h>

#include "render/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace tessera {
namespace {

using namespace test;

constexpr std::array kEngines{Engine::kRaster, Engine::kReferenceRaster, Engine::kReferenceTrace};
constexpr int kWidth = 120, kHeight = 90;
constexpr Intrinsics kPinhole{131.7, 127.3, 49.2, 50.9};

struct Point {
    double x = 0, y = 0, z = 0;
};
double dot(Point a, Point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// A camera that is turned about two axes, as a placement; columns are its axes and its eye.
Mat4 placement() {
    const Mat4 about_y{{0.8f, 0, -0.6f, 0, 0, 1, 0, 0, 0.6f, 0, 0.8f, 0, 0, 0, 0, 1}};
    const Mat4 about_x{{1, 0, 0, 0, 0, 0.8f, -0.6f, 0, 0, 0.6f, 0.8f, 0, 0, 0, 0, 1}};
    Mat4 m = about_y * about_x;
    m(0, 3) = 1.5f, m(1, 3) = -2.0f, m(2, 3) = 3.0f;
    return m;
}

// A rectangle of 2 x 1.6 that faces the camera but for a turn; its texture coordinates go right and up.
struct TiltedScene {
    Scene scene;
    Mat4 object_to_world;
    static constexpr Vec3 kBase{0.25f, 0.5f, 0.75f};

    TiltedScene() {
        Material m;
        m.base_color = {kBase.x, kBase.y, kBase.z, 1};
        add_material(scene, lambert({1, 1, 1}));
        Primitive p = rectangle(1, 0.8f, 0, add_material(scene, m));
        p.texcoords = {{{0, 0}, {2, 0}, {2, 1}, {0, 1}}};
        add_mesh(scene, p);
        const Mat4 turn{{0.96f, 0, 0.28f, 0, 0, 1, 0, 0, -0.28f, 0, 0.96f, 0, 0.1f, -0.05f, -3, 1}};
        object_to_world = placement() * turn;
        scene.nodes[0].matrix = object_to_world;
        scene.nodes.insert(scene.nodes.begin(), Node{});  // so that the mesh's node is not the first
        scene.scenes[0].nodes = {1};
    }
    Point world(double x, double y) const {
        const auto at = [&](int r) {
            return static_cast<double>(object_to_world(r, 0)) * x + static_cast<double>(object_to_world(r, 1)) * y +
                   static_cast<double>(object_to_world(r, 3));
        };
        return {at(0), at(1), at(2)};
    }
};

RenderOptions labels_only(Engine engine) {
    RenderOptions o;
    o.width = kWidth;
    o.height = kHeight;
    o.engine = engine;
    o.view.camera_to_world = placement();
    o.view.intrinsics = kPinhole;
    o.want_color = false;
    o.want_depth = o.want_primitive = o.want_node = o.want_material = true;
    o.want_normal = o.want_shading_normal = o.want_uv = o.want_position = o.want_albedo = true;
    return o;
}

const float* at(const Image& plane, int x, int y, int numbers) {
    return plane.data<float>() + numbers * (y * plane.width() + x);
}
std::uint32_t number_at(const Image& plane, int x, int y) { return plane.data<std::uint32_t>()[y * plane.width() + x]; }

// Where the ray through a pixel's centre meets the plane: on it, in camera space of OpenCV.
struct Meeting {
    double u, v, distance;  // in the rectangle's own coordinates; along the axis
    Point camera, world;
};
std::optional<Meeting> meet(const TiltedScene& t, int px, int py) {
    const Mat4 c = placement();
    const auto axis = [&](int i) {
        return Point{static_cast<double>(c(0, i)), static_cast<double>(c(1, i)), static_cast<double>(c(2, i))};
    };
    const Point right = axis(0), up = axis(1), back = axis(2), eye = axis(3);
    const double x = (px - kPinhole.cx) / kPinhole.fx, y = (py - kPinhole.cy) / kPinhole.fy;
    const Point d{right.x * x - up.x * y - back.x, right.y * x - up.y * y - back.y, right.z * x - up.z * y - back.z};
    // eye + s d = origin + u a + v b, by Cramer's rule.
    const Point o = t.world(0, 0), pa = t.world(1, 0), pb = t.world(0, 1);
    const Point a{pa.x - o.x, pa.y - o.y, pa.z - o.z}, b{pb.x - o.x, pb.y - o.y, pb.z - o.z},
        r{eye.x - o.x, eye.y - o.y, eye.z - o.z};
    const auto cross = [](Point p, Point q) {
        return Point{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
    };
    const Point n = cross(a, b);
    const double s = -dot(n, r) / dot(n, d);
    const Point hit{eye.x + s * d.x, eye.y + s * d.y, eye.z + s * d.z};
    const Point w{hit.x - o.x, hit.y - o.y, hit.z - o.z};
    const double u = dot(cross(w, b), n) / dot(n, n), v = dot(cross(a, w), n) / dot(n, n);
    if (std::fabs(u) > 1 || std::fabs(v) > 0.8) return std::nullopt;
    return Meeting{u, v, s, {s * x, s * y, s}, hit};
}
bool near_border(const Meeting& m) { return std::fabs(m.u) > 0.985 || std::fabs(m.v) > 0.785; }

TEST(Labels, BEY2_OfATiltedPlaneAreThoseOfItsGeometry) {
    const TiltedScene t;
    for (const Engine engine : kEngines) {
        const RenderResult r = render(t.scene, labels_only(engine));
        RenderOptions euclidean = labels_only(engine);
        euclidean.euclidean_depth = true;
        const RenderResult e = render(t.scene, euclidean);
        int hits = 0, misses = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const std::optional<Meeting> m = meet(t, x, y);
                const std::uint32_t triangle = number_at(r.primitive, x, y);
                if (!m || triangle == 0) {
                    ASSERT_TRUE(triangle == 0 || !m) << x << ", " << y;
                    ASSERT_TRUE(!m || near_border(*m)) << x << ", " << y;
                    if (triangle != 0) continue;  // by rounding
                    ++misses;
                    EXPECT_EQ(number_at(r.node, x, y) + number_at(r.material, x, y), 0u);
                    EXPECT_EQ(*at(r.depth, x, y, 1), std::numeric_limits<float>::infinity());
                    for (const Image* plane : {&r.normal, &r.shading_normal, &r.position, &r.albedo})
                        for (int i = 0; i < 3; ++i) EXPECT_EQ(at(*plane, x, y, 3)[i], 0.0f);
                    EXPECT_EQ(at(r.uv, x, y, 2)[0], 0.0f);
                    continue;
                }
                ++hits;
                EXPECT_TRUE(triangle == 1 || triangle == 2);
                EXPECT_EQ(number_at(r.node, x, y), 2u);
                EXPECT_EQ(number_at(r.material, x, y), 2u);
                EXPECT_NEAR(*at(r.depth, x, y, 1), m->distance, 2e-5 * m->distance);
                EXPECT_NEAR(*at(e.depth, x, y, 1), std::sqrt(dot(m->camera, m->camera)), 2e-5 * m->distance);
                const float* n = at(r.normal, x, y, 3);
                for (int i = 0; i < 3; ++i) EXPECT_NEAR(n[i], t.object_to_world(i, 2), 1e-6);
                for (int i = 0; i < 3; ++i) EXPECT_EQ(at(r.shading_normal, x, y, 3)[i], n[i]);
                const float* p = at(r.position, x, y, 3);
                EXPECT_NEAR(p[0], m->world.x, 3e-5 * m->distance);
                EXPECT_NEAR(p[1], m->world.y, 3e-5 * m->distance);
                EXPECT_NEAR(p[2], m->world.z, 3e-5 * m->distance);
                // Surfaces go through vertices snapped to 1/256 pixel.
                const double slack = m->distance / kPinhole.fy / 128;
                EXPECT_NEAR(at(r.uv, x, y, 2)[0], m->u + 1, 2 * slack);
                EXPECT_NEAR(at(r.uv, x, y, 2)[1], (m->v / 0.8 + 1) / 2, slack);
                EXPECT_EQ(at(r.albedo, x, y, 3)[0], TiltedScene::kBase.x);
                EXPECT_EQ(at(r.albedo, x, y, 3)[2], TiltedScene::kBase.z);
            }
        EXPECT_GT(hits, 3000) << name(engine);
        EXPECT_GT(misses, 1000) << name(engine);
        EXPECT_EQ(r.stats.pixels_covered, static_cast<std::uint64_t>(kWidth * kHeight - misses));
    }
}

TEST(Labels, BEY2_SpacesAreTheSamePointsElsewhere) {
    const TiltedScene t;
    RenderOptions o = labels_only(Engine::kRaster);
    const RenderResult world = render(t.scene, o);
    o.label_space = LabelSpace::kCamera;
    const RenderResult camera = render(t.scene, o);
    o.label_space = LabelSpace::kOpenCvCamera;
    const RenderResult cv = render(t.scene, o);
    o.label_space = LabelSpace::kWorld;
    o.label_from_world = Mat4{{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}};
    const RenderResult own = render(t.scene, o);
    const Mat4 c = placement();
    int hits = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            if (number_at(world.primitive, x, y) == 0) continue;
            ++hits;
            const float *p = at(camera.position, x, y, 3), *q = at(world.position, x, y, 3),
                        *n = at(camera.normal, x, y, 3), *k = at(world.normal, x, y, 3);
            for (int i = 0; i < 3; ++i) {
                EXPECT_NEAR(q[i], c(i, 0) * p[0] + c(i, 1) * p[1] + c(i, 2) * p[2] + c(i, 3), 2e-6);
                EXPECT_NEAR(k[i], c(i, 0) * n[0] + c(i, 1) * n[1] + c(i, 2) * n[2], 1e-6);
                const float sign = i == 0 ? 1.0f : -1.0f;
                EXPECT_EQ(at(cv.position, x, y, 3)[i], sign * p[i]);
                EXPECT_EQ(at(cv.normal, x, y, 3)[i], sign * n[i]);
            }
            EXPECT_NEAR(-p[2], *at(world.depth, x, y, 1), 1e-5);
            EXPECT_LT(n[0] * p[0] + n[1] * p[1] + n[2] * p[2], 0) << "away from the viewer";
            EXPECT_NEAR(at(own.position, x, y, 3)[0], -q[1] + 7, 2e-6);
            EXPECT_NEAR(at(own.position, x, y, 3)[1], q[0] + 8, 2e-6);
            EXPECT_NEAR(at(own.normal, x, y, 3)[0], -k[1], 1e-6);
        }
    EXPECT_GT(hits, 3000);
    o.label_from_world = Mat4{{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}};
    EXPECT_THROW(render(t.scene, o), Error);
}

TEST(Labels, BEY2_BacksFaceTheViewerToo) {
    Scene scene;
    Primitive p = rectangle(1, 1, 0, add_material(scene, lambert({1, 1, 1})));
    add_mesh(scene, p);
    RenderOptions o = labels_only(Engine::kRaster);
    o.view = {};
    o.view.eye = {0, 0, -3};
    o.view.target = {0, 0, 0};
    const RenderResult r = render(scene, o);
    EXPECT_EQ(at(r.normal, kWidth / 2, kHeight / 2, 3)[2], -1.0f);
}

TEST(Labels, BEY2_OrthographicViewsHaveThemToo) {
    Scene scene;
    Primitive p = rectangle(0.5f, 0.5f, 2, kNone);
    add_mesh(scene, p);
    add_orthographic(scene);
    for (const Engine engine : kEngines) {
        RenderOptions o = labels_only(engine);
        o.view = {};
        o.width = o.height = 64;
        o.euclidean_depth = true;  // rays are parallel: the same
        const RenderResult r = render(scene, o);
        for (int y = 20; y < 44; y += 3)
            for (int x = 20; x < 44; x += 3) {
                EXPECT_NEAR(at(r.position, x, y, 3)[0], (x + 0.5) / 32 - 1, 1e-6);
                EXPECT_NEAR(at(r.position, x, y, 3)[1], 1 - (y + 0.5) / 32, 1e-6);
                EXPECT_NEAR(at(r.position, x, y, 3)[2], 2, 1e-5);
                EXPECT_NEAR(*at(r.depth, x, y, 1), 8, 1e-5);
                EXPECT_EQ(at(r.normal, x, y, 3)[2], 1.0f);
            }
    }
}

// Which surface is labelled: the nearest with alpha of at least one half; the colour's own alpha is another thing.
TEST(Labels, BEY2_TransparentSurfacesCountFromOneHalf) {
    for (const float alpha : {0.4f, 0.6f}) {
        Scene scene;
        Material glass = unlit({0, 1, 0, alpha});
        glass.alpha_mode = AlphaMode::kBlend;
        add_mesh(scene, rectangle(1, 1, 0, add_material(scene, unlit({1, 0, 0, 1}))));
        add_mesh(scene, rectangle(0.5f, 0.5f, 1, add_material(scene, glass)));
        for (const Engine engine : kEngines) {
            RenderOptions o = labels_only(engine);
            o.view = {};
            o.view.eye = {0, 0, 5};
            o.view.target = {0, 0, 0};
            o.want_alpha = true;
            o.background.reset();
            const RenderResult r = render(scene, o);
            const int x = kWidth / 2, y = kHeight / 2;
            EXPECT_EQ(number_at(r.material, x, y), alpha < 0.5f ? 1u : 2u);
            EXPECT_EQ(at(r.albedo, x, y, 3)[1], alpha < 0.5f ? 0.0f : 1.0f);
            EXPECT_NEAR(*at(r.depth, x, y, 1), alpha < 0.5f ? 5 : 4, 1e-4);
            EXPECT_EQ(*at(r.alpha, x, y, 1), 1.0f);
            EXPECT_EQ(*at(r.alpha, 0, 0, 1), 0.0f);
            EXPECT_TRUE(r.color.empty() && r.linear.empty());
        }
    }
}

// Numbers of primitives are those of the scene, whether a duplicate is dropped or not.
TEST(Labels, BEY2_PrimitivesKeepTheirNumbersWhereDuplicatesPart) {
    Scene scene;
    const int white = add_material(scene, lambert({1, 1, 1}));
    add_mesh(scene, rectangle(0.3f, 0.3f, 0, white));
    scene.nodes.push_back(scene.nodes[0]);  // at the same place at first
    scene.scenes[0].nodes.push_back(1);
    add_mesh(scene, rectangle(0.3f, 0.3f, 0, white));
    scene.nodes[2].translation = {0, 1, 0};
    Animation slide;
    slide.samplers.push_back({{0, 1}, {0, 0, 0, 1, 0, 0}, Interpolation::kLinear});
    slide.channels.push_back({0, 1, AnimationPath::kTranslation});
    scene.animations.push_back(slide);
    for (const Engine engine : {Engine::kRaster, Engine::kReferenceRaster})
        for (const double time : {0.0, 1.0}) {
            RenderOptions o = labels_only(engine);
            o.view = {};
            o.view.eye = {0, 0.5f, 4};
            o.view.target = {0, 0.5f, 0};
            o.moment = {0, time};
            const RenderResult r = render(scene, o);
            std::uint32_t highest = 0;
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x) highest = std::max(highest, number_at(r.primitive, x, y));
            EXPECT_EQ(highest, 6u) << time;
        }
}

TEST(Labels, BEY2_OnlyWhatIsAskedForIsThere) {
    const TiltedScene t;
    using Wish = bool RenderOptions::*;
    using Plane = Image RenderResult::*;
    const std::pair<Wish, Plane> pairs[] = {{&RenderOptions::want_depth, &RenderResult::depth},
                                            {&RenderOptions::want_primitive, &RenderResult::primitive},
                                            {&RenderOptions::want_node, &RenderResult::node},
                                            {&RenderOptions::want_material, &RenderResult::material},
                                            {&RenderOptions::want_normal, &RenderResult::normal},
                                            {&RenderOptions::want_shading_normal, &RenderResult::shading_normal},
                                            {&RenderOptions::want_uv, &RenderResult::uv},
                                            {&RenderOptions::want_position, &RenderResult::position},
                                            {&RenderOptions::want_albedo, &RenderResult::albedo},
                                            {&RenderOptions::want_alpha, &RenderResult::alpha},
                                            {&RenderOptions::want_motion, &RenderResult::motion}};
    for (const Engine engine : {Engine::kRaster, Engine::kReferenceRaster}) {
        RenderOptions all = labels_only(engine);
        all.want_alpha = all.want_motion = true;
        const RenderResult everything = render(t.scene, all);
        for (const auto& [wish, plane] : pairs) {
            RenderOptions o = labels_only(engine);
            for (const auto& [other, unused] : pairs) o.*other = false;
            o.*wish = true;
            const RenderResult r = render(t.scene, o);
            for (const auto& [unused, other] : pairs) {
                if (other == plane)
                    EXPECT_TRUE(same_bytes(r.*other, everything.*other));
                else
                    EXPECT_TRUE((r.*other).empty());
            }
            EXPECT_TRUE(r.color.empty() && r.linear.empty());
        }
    }
}

TEST(Labels, GEO6_PosesAndIntrinsicsAreChecked) {
    const TiltedScene t;
    RenderOptions o = labels_only(Engine::kRaster);
    const auto refused = [&](const std::string& part) {
        try {
            render(t.scene, o);
            ADD_FAILURE() << part;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kUsage);
            EXPECT_NE(error.message().find(part), std::string::npos) << error.message();
        }
    };
    o.view.intrinsics = {0, 100, 1, 1};
    refused("focal lengths");
    o.view.intrinsics = {100, 100, std::numeric_limits<double>::quiet_NaN(), 1};
    refused("finite");
    o.view.intrinsics = {1e8, 100, 1, 1};
    refused("focal lengths");
    o.view.intrinsics = kPinhole;
    (*o.view.camera_to_world)(0, 0) = 3;
    refused("rigid");
    // Framing with a shifted lens: all of it is in the picture.
    o.view.camera_to_world.reset();
    const RenderResult r = render(t.scene, o);
    for (int x = 0; x < kWidth; ++x)
        EXPECT_EQ(number_at(r.primitive, x, 0) + number_at(r.primitive, x, kHeight - 1), 0u);
    for (int y = 0; y < kHeight; ++y)
        EXPECT_EQ(number_at(r.primitive, 0, y) + number_at(r.primitive, kWidth - 1, y), 0u);
    EXPECT_GT(r.stats.pixels_covered, 1000u);
}

}  // namespace
}  // namespace tessera
