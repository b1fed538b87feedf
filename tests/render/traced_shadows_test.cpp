// Traced shadows where they must and must not be: none of a surface on itself at any scale and place, no light below a
// wall, and the part that panes, veils and cut-outs leave.
#include <gtest/gtest.h>

#include "render/traced_scenes.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using namespace test;

// Pixels that are lit by more than `margin` without shadows, and how many of them shadows change.
struct Darkened {
    int lit = 0, darkened = 0;
};
Darkened count_darkened(const Scene& scene, RenderOptions o, float margin) {
    const RenderResult shadowed = render(scene, o);
    o.shadows = Shadows::kNone;
    const RenderResult open = render(scene, o);
    Darkened d;
    for (int y = 0; y < o.height; ++y)
        for (int x = 0; x < o.width; ++x) {
            if (!(linear_at(open, x, y).x > margin)) continue;
            ++d.lit;
            d.darkened += linear_at(shadowed, x, y).x != linear_at(open, x, y).x;
        }
    return d;
}

struct Placement {
    float scale;
    Vec3 at;
    bool in_vertices;  // or by the node
};
const Placement kPlacements[] = {{1e-3f, {0, 0, 0}, false},  {1, {0, 0, 0}, false},         {1e4f, {0, 0, 0}, false},
                                 {1e-3f, {0, 0, 0}, true},   {1e4f, {0, 0, 0}, true},       {1, {1e5f, 0, 0}, false},
                                 {1e3f, {1e5f, 0, 0}, true}, {1e3f, {0, -1e5f, 1e5f}, true}};

void put(Scene& scene, Primitive p, const Placement& placed) {
    if (placed.in_vertices) {
        for (Vec3& v : p.positions) v = v * placed.scale + placed.at;
        place(scene, std::move(p), {});
    } else {
        place(scene, std::move(p), placed.at, {}, {placed.scale, placed.scale, placed.scale});
    }
}
std::string text(Engine engine, const Placement& p) {
    return std::string(name(engine)) + ", scale " + std::to_string(p.scale) +
           (p.in_vertices ? " in vertices at " : " at ") + std::to_string(p.at.x) + " " + std::to_string(p.at.y) + " " +
           std::to_string(p.at.z);
}

TEST(TracedShadows, RAY3_ClosedBodiesDoNotShadowTheirLitSide) {
    for (const Engine engine : kTracers)
        for (const Placement& p : kPlacements) {
            Scene scene;
            put(scene, sphere(60, add_material(scene, lambert({1, 1, 1}))), p);
            Light lamp;
            lamp.intensity = p.scale * p.scale;
            add_light(scene, lamp, p.at + Vec3{2, 3, 4} * p.scale);
            // Of at most 0.08 / pi ...: grazing light on flat facets with smooth normals is where these do shadow each
            // other.
            const Darkened d = count_darkened(scene, traced(engine, 160, 120), 0.08f * 0.05f);
            EXPECT_GT(d.lit, 1500) << text(engine, p);
            EXPECT_EQ(d.darkened, 0) << text(engine, p);
        }
}

TEST(TracedShadows, PlanesDoNotShadowThemselves) {
    for (const Engine engine : kTracers)
        for (const Placement& p : kPlacements)
            for (const float height : {0.03f, 0.5f, 5.0f}) {  // of the sun: from grazing to steep
                Scene scene;
                Primitive plane = rectangle(1, 1, 0, add_material(scene, lambert({1, 1, 1})));
                for (std::size_t i = 0; i < 4; ++i) {  // tilted out of every axis
                    const Mat4 turn = rotation({1, 2, 3}, 0.7f);
                    plane.positions[i] = cartesian(turn * point(plane.positions[i]));
                    plane.normals[i] = cartesian(turn * point(plane.normals[i]));
                }
                const Vec3 n = plane.normals[0], along = normalize(plane.positions[1] - plane.positions[0] * 0.3f);
                const Vec3 across = normalize(along - n * dot(n, along));
                put(scene, std::move(plane), p);
                add_sun(scene, across + n * height, 10);
                const Darkened d = count_darkened(scene, traced(engine, 96, 72), 0.0f);
                EXPECT_GT(d.lit, 1000) << text(engine, p);
                EXPECT_EQ(d.darkened, 0) << text(engine, p) << ", sun at " << height;
            }
}

// A camera above that sees -half .. half of a floor, where the wall at x = 0 throws its shadow to -X, as long as high.
TEST(TracedShadows, NoLightPassesBelowAWall) {
    for (const Engine engine : kTracers)
        for (const float scale : {1e-3f, 1.0f, 1e4f})
            for (const float half : {1.2f, 1e-2f, 1e-3f}) {
                Scene scene;
                const int white = add_material(scene, lambert({1, 1, 1}));
                Primitive floor = rectangle(4, 4, 0, white), wall = rectangle(1, 4, 0, white);
                for (Vec3& v : floor.positions) v = {v.x, 0, -v.y};
                floor.normals.assign(4, {0, 1, 0});
                for (Vec3& v : wall.positions) v = {0, v.x + 1, v.y};  // two metres high
                wall.normals.assign(4, {1, 0, 0});
                place(scene, std::move(floor), {}, {}, {scale, scale, scale});
                place(scene, std::move(wall), {}, {}, {scale, scale, scale});
                add_sun(scene, {1, 2, 0});
                Camera c;
                c.type = Camera::Type::kOrthographic;
                c.xmag = c.ymag = half * scale;
                c.znear = 0.1f * scale, c.zfar = 20 * scale;
                scene.cameras.push_back(c);
                Node node;
                node.camera = 0;
                node.translation = {0, 10 * scale, 0};
                node.rotation = quaternion({1, 0, 0}, -1.57079633f);
                scene.nodes.push_back(node);
                scene.scenes[0].nodes.push_back(static_cast<int>(scene.nodes.size()) - 1);
                const RenderResult r = render(scene, traced(engine, 64, 64));
                int dark = 0, lit = 0;
                for (int y = 0; y < 64; ++y)
                    for (int x = 0; x < 64; ++x) {
                        const float at = ((static_cast<float>(x) + 0.5f) / 32 - 1) * half;
                        if (std::fabs(at + 1) < 0.02f) continue;
                        const bool in_shadow = at > -1 && at < 0;
                        const float got = linear_at(r, x, y).x;
                        ASSERT_EQ(got == 0, in_shadow)
                            << name(engine) << ", scale " << scale << ", half " << half << ", x " << at;
                        ++(in_shadow ? dark : lit);
                    }
                EXPECT_GT(dark, 500);
                EXPECT_GT(lit, 500);
            }
}

// A wall at z = 0; plates at heights 1 and 2 whose shadows fall on its middle, by a sun that is half as far aside as
// high, while they stand beside it in the picture.
struct Plates {
    Scene scene;
    explicit Plates(std::initializer_list<Material> plates) {
        place(scene, rectangle(4, 4, 0, add_material(scene, lambert({1, 1, 1}))), {});
        float height = 1;
        for (const Material& m : plates) {
            place(scene, rectangle(0.25f, 0.25f, 0, add_material(scene, m)), {0.5f * height + 0.05f, 0, height});
            height += 1;
        }
        add_sun(scene, {0.5f, 0, 1});
        add_orthographic(scene);
    }
    // What arrives at a place of the wall.
    Vec3 arrives(Engine engine, float x) const {
        RenderOptions o = traced(engine, 64, 64);
        const int column = static_cast<int>((x + 1) * 32);
        const Vec4 shadowed = linear_at(render(scene, o), column, 32);
        o.shadows = Shadows::kNone;
        const Vec4 open = linear_at(render(scene, o), column, 32);
        return {shadowed.x / open.x, shadowed.y / open.y, shadowed.z / open.z};
    }
};

Material veil(float alpha) {
    Material m;
    m.base_color = {0.5f, 0.1f, 0.9f, alpha};
    m.alpha_mode = AlphaMode::kBlend;
    m.double_sided = true;
    return m;
}

TEST(TracedShadows, NothingBehindALampThrowsShadows) {
    // A lamp between a wall and a lid that nearly touches it.
    for (const Engine engine : kTracers)
        for (const float scale : {1e-3f, 1.0f, 1e4f})
            for (const bool between : {false, true}) {
                Scene scene;
                const int white = add_material(scene, lambert({1, 1, 1}));
                place(scene, rectangle(1, 1, 0, white), {}, {}, {scale, scale, scale});
                place(scene, rectangle(3, 3, 0, white), {0, 0, (between ? 0.999f : 1.001f) * scale}, {},
                      {scale, scale, scale});
                Light lamp;
                lamp.intensity = scale * scale;
                add_light(scene, lamp, {0, 0, scale});
                RenderOptions o = traced(engine, 32, 32);
                o.view = look({1.5f * scale, 0, 0.3f * scale}, {0, 0, 0});  // from below the lid
                o.want_node = true;
                const RenderResult r = render(scene, o);
                int pixels = 0;
                for (int i = 0; i < 32 * 32; ++i) {
                    if (r.node.data<std::uint32_t>()[i] != 1) continue;
                    ++pixels;
                    ASSERT_EQ(linear_at(r, i % 32, i / 32).x > 0, !between) << name(engine) << ", scale " << scale;
                }
                EXPECT_GT(pixels, 50);
            }
}

TEST(TracedShadows, VeilsLeaveTheProductOfWhatTheyLetThrough) {
    for (const Engine engine : kTracers) {
        const Vec3 one = Plates({veil(0.25f)}).arrives(engine, 0),
                   two = Plates({veil(0.25f), veil(0.6f)}).arrives(engine, 0),
                   beside = Plates({veil(0.25f)}).arrives(engine, -0.5f);
        for (const float c : {one.x, one.y, one.z}) EXPECT_NEAR(c, 0.75f, 1e-6f) << name(engine);
        for (const float c : {two.x, two.y, two.z}) EXPECT_NEAR(c, 0.3f, 1e-6f) << name(engine);
        for (const float c : {beside.x, beside.y, beside.z}) EXPECT_EQ(c, 1) << name(engine);
        const Vec3 stopped = Plates({veil(0.25f), lambert({1, 1, 1})}).arrives(engine, 0);
        for (const float c : {stopped.x, stopped.y, stopped.z}) EXPECT_EQ(c, 0) << name(engine);
    }
}

TEST(TracedShadows, GlassTintsLight) {
    const Vec3 tint{0.8f, 0.4f, 0.2f};
    for (const Engine engine : kTracers) {
        // Through a pane once, less what is mirrored; a body has two faces.
        const Vec3 through = Plates({pane(tint)}).arrives(engine, 0),
                   twice = Plates({pane(tint), pane(tint)}).arrives(engine, 0);
        const float got[] = {through.x, through.y, through.z}, got_twice[] = {twice.x, twice.y, twice.z};
        const float want[] = {tint.x, tint.y, tint.z};
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(got[c], 0.96f * want[c], 1e-5f) << name(engine);
            EXPECT_NEAR(got_twice[c], 0.96f * 0.96f * want[c] * want[c], 1e-5f) << name(engine);
        }
    }
}

TEST(TracedShadows, BodiesTakeLightOnItsWayThroughThem) {
    // Half a metre of glass, above the wall or with the lamp inside.
    constexpr float kThickness = 0.5f, kDistance = 0.4f;
    const Vec3 color{0.9f, 0.5f, 0.2f};
    Material m = glass(1.5f);
    m.volume.attenuation_color = color;
    m.volume.attenuation_distance = kDistance;
    for (const Engine engine : kTracers)
        for (const bool within : {false, true}) {
            Scene scene;
            place(scene, rectangle(4, 4, 0, add_material(scene, lambert({1, 1, 1}))), {});
            place(scene, box({1, 1, 0.5f * kThickness}, add_material(scene, m)), {0.3f, 0.1f, 2});
            Light lamp;
            lamp.intensity = 10;
            add_light(scene, lamp, {0, 0, within ? 2 : 3.0f});
            RenderOptions o = traced(engine, 33, 33);
            o.view = look({3, 0, 1}, {0, 0, 0});  // from below the glass
            const Vec4 shadowed = linear_at(render(scene, o), 16, 16);
            o.shadows = Shadows::kNone;
            const Vec4 open = linear_at(render(scene, o), 16, 16);
            const float got[] = {shadowed.x / open.x, shadowed.y / open.y, shadowed.z / open.z},
                        want[] = {color.x, color.y, color.z};
            for (std::size_t c = 0; c < 3; ++c) {
                const double faces = within ? 0.96 : 0.96 * 0.96, way = within ? 0.5 * kThickness : kThickness;
                EXPECT_NEAR(got[c], faces * std::pow(static_cast<double>(want[c]), way / kDistance), 2e-3)
                    << name(engine) << ", within " << within << ": " << got[c];
            }
        }
}

TEST(TracedShadows, CutOutsThrowTheirShape) {
    Image halves(2, 1, PixelFormat::kRgba8);
    std::uint8_t* t = halves.data<std::uint8_t>();
    std::fill_n(t, 8, std::uint8_t{255});
    t[3] = 0;  // the left half is not there
    for (const Engine engine : kTracers) {
        Material m;
        m.alpha_mode = AlphaMode::kMask;
        m.double_sided = true;
        m.texture(TextureSlot::kBaseColor).texture = 0;
        Plates plates({m});
        plates.scene.pictures.push_back({"", "", std::make_shared<const Image>(halves), ""});
        plates.scene.samplers.push_back(
            {"", Filter::kNearest, Filter::kNearest, MipFilter::kNone, Wrap::kClamp, Wrap::kClamp});
        plates.scene.textures.push_back({"", 0, 0, ""});
        for (int i = -12; i < 12; ++i) {  // the shadow lies at -0.2 .. 0.3, its middle at 0.05
            const float x = (static_cast<float>(i) + 0.5f) / 32, in_plate = x - 0.05f;
            const bool dark = in_plate > 0 && in_plate < 0.25f;
            EXPECT_EQ(plates.arrives(engine, x).x, dark ? 0 : 1) << name(engine) << " " << x;
        }
    }
}

}  // namespace
}  // namespace tessera
