// What points and lines look like, and what labels call them.
#include "render/scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

namespace tessera {
namespace {

using namespace test;

Primitive strokes(PrimitiveMode mode, std::vector<Vec3> positions, int material = kNone) {
    Primitive p;
    p.mode = mode;
    p.positions = std::move(positions);
    p.material = material;
    return p;
}

// Looks along -Z at [-1, 1]^2.
Scene with_camera(Scene scene) {
    add_orthographic(scene);
    return scene;
}

RenderOptions options(Engine engine) {
    RenderOptions o;
    o.width = o.height = 64;
    o.engine = engine;
    o.samples = 1;
    o.threads = 1;
    o.point_size = 24, o.line_width = 6;
    o.exposure_ev = 0.0f;
    o.want_linear = o.want_primitive = o.want_node = o.want_material = true;
    return o;
}

constexpr Engine kAll[] = {Engine::kRaster, Engine::kReferenceRaster, Engine::kReferenceTrace};

Vec4 linear_at(const RenderResult& r, int x, int y) {
    const float* p = r.linear.data<float>() + 4 * (64 * y + x);
    return {p[0], p[1], p[2], p[3]};
}
Vec4 color_at(const RenderResult& r, int x, int y) {
    const std::uint8_t* p = r.color.data<std::uint8_t>() + 4 * (64 * y + x);
    return {p[0] / 255.0f, p[1] / 255.0f, p[2] / 255.0f, p[3] / 255.0f};
}

TEST(Strokes, WithoutNormalsTheyHaveTheirOwnColour) {
    for (const Engine engine : kAll)
        for (const ShadingModel model : {ShadingModel::kMetallicRoughness, ShadingModel::kLambert}) {
            Scene scene;
            Material m;
            m.model = model;
            if (model == ShadingModel::kLambert)
                m.diffuse = {0.5f, 1, 0.25f};
            else
                m.base_color = {0.5f, 1, 0.25f, 1};
            Primitive dot = strokes(PrimitiveMode::kPoints, {{0, 0, 0}}, add_material(scene, m));
            dot.colors = {{{1, 0.5f, 1, 1}}};
            add_mesh(scene, dot);
            Light light;
            light.type = LightType::kDirectional;
            light.intensity = 1e5f;
            add_light(scene, light, {0, 0, 0});
            const RenderResult r = render(with_camera(scene), options(engine));
            const Vec4 c = linear_at(r, 32, 32);
            EXPECT_FLOAT_EQ(c.x, 0.5f);
            EXPECT_FLOAT_EQ(c.y, 0.5f);
            EXPECT_FLOAT_EQ(c.z, 0.25f);
            EXPECT_EQ(color_at(r, 32, 32).x, 188 / 255.0f);  // a display colour: no tone map
        }
}

// E cos / pi, with the normal of the vertex, not that of the disc.
TEST(Strokes, WithNormalsTheyAreLit) {
    for (const Engine engine : kAll) {
        Scene scene;
        const int white = add_material(scene, lambert({1, 1, 1}));
        Primitive dot = strokes(PrimitiveMode::kPoints, {{0, 0.5f, 0}}, white);
        dot.normals = {{0, 0.6f, 0.8f}};
        Primitive line = strokes(PrimitiveMode::kLines, {{-1, -0.5f, 0}, {1, -0.5f, 0}}, white);
        line.normals = {{0, 0, 1}, {0.6f, 0, 0.8f}};
        add_mesh(scene, dot);
        add_mesh(scene, line);
        Light light;
        light.type = LightType::kDirectional;  // shines along -Z
        light.intensity = 3;
        add_light(scene, light, {0, 0, 0});
        RenderOptions o = options(engine);
        o.ambient = 0.0f;
        o.shadows = Shadows::kNone;
        const RenderResult r = render(with_camera(scene), o);
        EXPECT_NEAR(linear_at(r, 32, 16).x, 3 * 0.8 / 3.14159265, 1e-5);
        // Half-way, the interpolated normal made unit again.
        const double along = (32.5) / 64, x = 0.6 * along, z = 1 - 0.2 * along;
        EXPECT_NEAR(linear_at(r, 32, 48).x, 3 * z / std::sqrt(x * x + z * z) / 3.14159265, 1e-5);
    }
}

TEST(Strokes, WithoutAnyColourTheyAreSeenOnWhiteAndBlack) {
    Scene scene;
    add_mesh(scene, strokes(PrimitiveMode::kPoints, {{0, 0, 0}}));
    const float seen = color_at(render(with_camera(scene), options(Engine::kRaster)), 32, 32).x;
    EXPECT_GT(seen, 0.25f);
    EXPECT_LT(seen, 0.75f);
}

// 1 + the number of the point, line or triangle, whatever else is in view; nodes and materials of the scene.
TEST(Strokes, LabelsNameTheElement) {
    for (const Engine engine : kAll) {
        Scene scene;
        const int first = add_material(scene, unlit({1, 0, 0, 1})), second = add_material(scene, lambert({0, 1, 0}));
        add_mesh(scene, strokes(PrimitiveMode::kPoints, {{-30, 0, 0}, {-0.5f, 0.5f, 0}, {0.5f, 0.5f, 0}}, second));
        add_mesh(scene, strokes(PrimitiveMode::kLineStrip,
                                {{0, 50, 0}, {90, 50, 0}, {-0.9f, -0.25f, 0}, {0.9f, -0.25f, 0}}, first));
        add_mesh(scene, rectangle(0.9f, 0.1f, 0, kNone));
        for (Vec3& p : scene.meshes[2].primitives[0].positions) p.y -= 0.75f;
        const RenderResult r = render(with_camera(scene), options(engine));
        const auto at = [](const Image& plane, int x, int y) { return plane.data<std::uint32_t>()[64 * y + x]; };
        struct Case {
            int x, y;
            std::uint32_t primitive, node, material;
        };
        for (const Case& c : {Case{16, 16, 2, 1, 2}, Case{48, 16, 3, 1, 2}, Case{32, 40, 6, 2, 1}, Case{5, 57, 8, 3, 3},
                              Case{58, 55, 7, 3, 3}, Case{32, 2, 0, 0, 0}}) {
            EXPECT_EQ(at(r.primitive, c.x, c.y), c.primitive) << c.x << "," << c.y;
            EXPECT_EQ(at(r.node, c.x, c.y), c.node);
            EXPECT_EQ(at(r.material, c.x, c.y), c.material);
        }
        EXPECT_EQ(r.stats.points, 3u);
        EXPECT_EQ(r.stats.lines, 3u);
    }
}

TEST(Strokes, LabelsOfSurfacesFaceTheViewerWithoutNormals) {
    for (const Engine engine : kAll) {
        Scene scene;
        add_mesh(scene, strokes(PrimitiveMode::kPoints, {{0, 0, 0.5f}}));
        RenderOptions o = options(engine);
        o.want_normal = o.want_position = o.want_depth = o.want_albedo = true;
        const RenderResult r = render(with_camera(scene), o);
        const float *n = r.normal.data<float>() + 3 * (64 * 32 + 32),
                    *p = r.position.data<float>() + 3 * (64 * 32 + 32);
        EXPECT_EQ((Vec3{n[0], n[1], n[2]}), (Vec3{0, 0, 1}));
        EXPECT_NEAR(p[2], 0.5f, 1e-5f);
        EXPECT_NEAR(r.depth.data<float>()[64 * 32 + 32], 9.5f, 1e-5f);
    }
}

// Points and lines that a camera passes by move as the places do that they stand for.
TEST(Strokes, MotionIsThatOfTheirPlaces) {
    Scene scene;
    add_mesh(scene, strokes(PrimitiveMode::kPoints, {{-0.4f, 0.3f, 0}}));
    add_mesh(scene, strokes(PrimitiveMode::kLines, {{-0.6f, -0.3f, 0.3f}, {0.6f, -0.3f, -0.6f}}));
    RenderOptions o = options(Engine::kRaster);
    o.want_motion = true;
    const auto look = [](Vec3 eye) {
        View v;
        v.eye = eye, v.target = Vec3{0, 0, 0}, v.yfov = 0.8f;
        return v;
    };
    o.view = look({0, 0, 3});
    o.motion_after = Shot{look({0.4f, 0.2f, 2.8f}), {}};
    const RenderResult r = render(scene, o);
    const auto project = [](const View& view, Vec3 p) {
        const Vec4 c = perspective(0.8f, 1, 0.01f, {}) * look_at(*view.eye, *view.target, {0, 1, 0}) * point(p);
        return Vec2{(c.x / c.w + 1) * 32, (1 - c.y / c.w) * 32};
    };
    int points = 0, lines = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const std::uint32_t number = r.primitive.data<std::uint32_t>()[64 * y + x];
            const float* m = r.motion.data<float>() + 4 * (64 * y + x);
            if (number == 0) continue;
            Vec3 place{-0.4f, 0.3f, 0};
            if (number == 2) {  // by bisection: where the line has the pixel's x
                float low = 0, high = 1;
                for (int i = 0; i < 40; ++i) {
                    const float t = 0.5f * (low + high);
                    place = Vec3{-0.6f, -0.3f, 0.3f} * (1 - t) + Vec3{0.6f, -0.3f, -0.6f} * t;
                    (project(o.view, place).x < static_cast<float>(x) + 0.5f ? low : high) = t;
                }
            }
            const Vec2 here = project(o.view, place), there = project(o.motion_after->view, place);
            EXPECT_NEAR(m[0], there.x - here.x, 2e-3f) << x << "," << y;
            EXPECT_NEAR(m[1], there.y - here.y, 2e-3f) << x << "," << y;
            (number == 1 ? points : lines) += 1;
        }
    EXPECT_GT(points, 300);
    EXPECT_GT(lines, 100);
}

TEST(Strokes, TheyCastNoShadows) {
    Scene scene;
    add_mesh(scene, rectangle(1, 1, 0, add_material(scene, lambert({1, 1, 1}))));
    Light light;
    light.type = LightType::kDirectional;
    light.intensity = 3;
    add_light(scene, light, {0, 0, 0});
    const RenderOptions o = options(Engine::kReferenceTrace);
    const RenderResult without = render(with_camera(scene), o);
    // Behind the camera's near plane the light would still be blocked; aside, in the picture.
    add_mesh(scene, strokes(PrimitiveMode::kPoints, {{0.9f, 0.9f, 1}, {0, 0, 9.95f}}));
    const RenderResult with = render(with_camera(scene), o);
    for (int y = 20; y < 64; ++y)
        for (int x = 0; x < 40; ++x) EXPECT_EQ(linear_at(with, x, y), linear_at(without, x, y));
}

TEST(Strokes, MorphsAndMirrorsMoveThem) {
    for (const PrimitiveMode mode : {PrimitiveMode::kPoints, PrimitiveMode::kLineLoop}) {
        Scene moved, baked;
        Primitive p = strokes(mode, {{-0.5f, -0.5f, 0}, {0.5f, -0.25f, 0}, {0, 0.5f, 0}});
        MorphTarget target;
        target.positions = {{0.25f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.125f}};
        Primitive q = p;
        for (std::size_t i = 0; i < 3; ++i) {
            q.positions[i] = q.positions[i] + target.positions[i] * 0.5f;
            q.positions[i].x = -q.positions[i].x;
        }
        p.targets.push_back(target);
        add_mesh(moved, p);
        moved.meshes[0].weights = {0.5f};
        moved.nodes[0].scale = {-1, 1, 1};
        add_mesh(baked, q);
        const RenderResult a = render(with_camera(moved), options(Engine::kRaster)),
                           b = render(with_camera(baked), options(Engine::kRaster));
        EXPECT_GT(a.stats.pixels_covered, 100u);
        EXPECT_EQ(std::memcmp(a.color.data<std::uint8_t>(), b.color.data<std::uint8_t>(), 64 * 64 * 4), 0);
        EXPECT_EQ(std::memcmp(a.primitive.data<std::uint32_t>(), b.primitive.data<std::uint32_t>(), 64 * 64 * 4), 0);
    }
}

TEST(Strokes, SizesAndMemoryOutOfBoundsAreRefused) {
    Scene scene;
    add_mesh(scene, strokes(PrimitiveMode::kPoints, std::vector<Vec3>(10000, Vec3{0, 0, 0})));
    scene = with_camera(scene);
    const auto code = [&](auto change) {
        RenderOptions o = options(Engine::kRaster);
        change(o);
        try {
            render(scene, o);
        } catch (const Error& e) {
            return e.code();
        }
        return ErrorCode::kInternal;
    };
    for (const float size : {0.0f, -1.0f, 257.0f, std::nanf("")}) {
        EXPECT_EQ(code([&](RenderOptions& o) { o.point_size = size; }), ErrorCode::kUsage);
        EXPECT_EQ(code([&](RenderOptions& o) { o.line_width = size; }), ErrorCode::kUsage);
    }
    EXPECT_EQ(code([&](RenderOptions& o) { o.max_bytes = 1000000; }), ErrorCode::kLimit);
    EXPECT_EQ(code([&](RenderOptions& o) { o.max_bytes = 20000000; }), ErrorCode::kInternal);  // not refused
}

TEST(Strokes, NothingInViewIsABackground) {
    Scene scene;
    add_mesh(scene, strokes(PrimitiveMode::kLineStrip, {{5, 5, 0}, {9, 9, 0}, {7, 1e30f, 0}}));
    add_mesh(scene, strokes(PrimitiveMode::kLineLoop, {{0, 0, 0}}));  // no line
    for (const Engine engine : kAll) {
        const RenderResult r = render(with_camera(scene), options(engine));
        EXPECT_EQ(r.stats.pixels_covered, 0u);
        EXPECT_TRUE(r.warnings.empty());
    }
}

}  // namespace
}  // namespace tessera
