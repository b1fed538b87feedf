// Pictures of two engines side by side: how many pixels differ and in what; and a scene of many kinds of bodies.
#pragma once

#include "render/traced_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace tessera::test {

inline RenderOptions quick(Engine engine, int width, int height) {
    RenderOptions o;
    o.width = width, o.height = height;
    o.samples = 1;
    o.engine = engine;
    o.want_linear = o.want_primitive = o.want_depth = true;
    return o;
}

inline bool has_strokes(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives)
            if (p.mode < PrimitiveMode::kTriangles) return true;
    return false;
}

// Whether rays see something else than the rasterizer: shapes that are drawn by their formula.
inline bool has_shapes(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives)
            if (p.shape) return true;
    return false;
}
// The scene with what the rasterizer draws of its shapes, for everybody.
inline Scene as_triangles(Scene scene) {
    for (Mesh& mesh : scene.meshes)
        for (Primitive& p : mesh.primitives) p.shape.reset();
    return scene;
}

// Pixels that differ at all; by more than rounding; those among the latter where another depth is seen; and those that
// differ although both show one triangle.
struct Differences {
    std::size_t bits = 0, visible = 0, far = 0, same_triangle = 0;
};
inline Differences differences(const RenderResult& a, const RenderResult& b) {
    Differences d;
    for (int i = 0; i < a.linear.width() * a.linear.height(); ++i) {
        const float *p = a.linear.data<float>() + 4 * i, *q = b.linear.data<float>() + 4 * i;
        if (std::memcmp(p, q, 4 * sizeof(float)) == 0) continue;
        ++d.bits;
        d.same_triangle += a.primitive.data<std::uint32_t>()[i] == b.primitive.data<std::uint32_t>()[i];
        bool visible = false;
        for (int c = 0; c < 4; ++c)
            visible = visible || !(std::fabs(p[c] - q[c]) <= 1e-5f * std::max(1.0f, std::fabs(p[c])));
        d.visible += visible;
        const float z = a.depth.data<float>()[i], w = b.depth.data<float>()[i];
        d.far += visible && !(std::fabs(z - w) <= 1e-5f * std::max(z, w));
    }
    return d;
}
inline void print(const std::string& what, const Differences& d) {
    if (d.bits == 0) return;
    std::printf("%s: %zu pixels differ, %zu visibly, %zu in depth, %zu on one triangle\n", what.c_str(), d.bits,
                d.visible, d.far, d.same_triangle);
}
inline double part(std::size_t count, const RenderResult& r) {
    return static_cast<double>(count) / (r.linear.width() * r.linear.height());
}

// Equal bits but where rounding decides what a ray meets. The hybrid draws triangles, and scenes with shapes once more
// as these.
inline void expect_the_references_picture(const std::string& name, const Scene& scene, RenderOptions o) {
    if (has_shapes(scene)) expect_the_references_picture(name + " as triangles", as_triangles(scene), o);
    o.engine = Engine::kReferenceTrace;
    const RenderResult reference = render(scene, o);
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        if (engine == Engine::kHybrid && has_shapes(scene)) continue;
        o.engine = engine;
        const Differences d = differences(reference, render(scene, o));
        print(name + ", " + tessera::name(engine) + " and reference", d);
        EXPECT_LE(part(d.bits, reference), engine == Engine::kTrace ? 2e-3 : 5e-3)
            << name << ", " << tessera::name(engine);
        EXPECT_LE(part(d.same_triangle, reference), 1e-3) << name << ", " << tessera::name(engine);
    }
}

// A texture of dots with holes.
inline void add_dots(Scene& scene) {
    Image dots(8, 8, PixelFormat::kRgba8);
    for (int i = 0; i < 64; ++i) {
        std::uint8_t* t = dots.data<std::uint8_t>() + 4 * i;
        t[0] = 200, t[1] = 120, t[2] = static_cast<std::uint8_t>(4 * i), t[3] = (i + i / 8) % 3 ? 255 : 0;
    }
    scene.pictures.push_back({"dots", "", std::make_shared<const Image>(dots), ""});
    scene.textures.push_back({"", 0, kNone, ""});
}

struct Kinds {
    Material mirror, water, flint, metal, veil, leaf;  // leaf: cut out of the dots
};
inline Kinds kinds() {
    Kinds k;
    k.mirror = lambert({0.1f, 0.1f, 0.1f});
    k.mirror.mirror = {0.8f, 0.9f, 0.7f};
    k.water = glass(1.33f, {0.8f, 0.9f, 1});
    k.water.volume.attenuation_distance = 0.5f;
    k.water.volume.attenuation_color = {0.4f, 0.7f, 0.9f};
    k.flint = glass(1.6f);
    k.flint.volume.priority = 1;
    k.flint.dispersion = 0.5f;
    k.metal.base_color = {0.9f, 0.7f, 0.3f, 1};
    k.metal.roughness = 0.1f;
    k.veil.base_color = {0.2f, 0.8f, 0.4f, 0.4f};
    k.leaf.texture(TextureSlot::kBaseColor).texture = 0;
    k.veil.alpha_mode = AlphaMode::kBlend;
    k.leaf.alpha_mode = AlphaMode::kMask;
    for (Material* m : {&k.veil, &k.leaf}) m->metallic = 0, m->double_sided = true;
    return k;
}

// Mirrors, glass in water, tinted panes, blended and cut-out plates, metal, lamps of three kinds.
inline Scene many_kinds() {
    Scene scene;
    add_dots(scene);
    const auto [mirror, water, flint, metal, veil, leaf] = kinds();
    const int floor = add_material(scene, lambert({0.7f, 0.6f, 0.5f}));
    place(scene, rectangle(4, 4, 0, floor), {0, -1, 0}, toward({0, -1, 0}));
    place(scene, rectangle(2, 2, 0, add_material(scene, mirror)), {0, 0, -2});
    place(scene, sphere(24, add_material(scene, water)), {-0.9f, 0, 0}, {}, {-0.8f, 0.8f, 0.7f});
    place(scene, sphere(24, add_material(scene, flint)), {-0.5f, 0.2f, 0.3f}, {}, {0.5f, 0.5f, 0.5f});
    place(scene, sphere(24, add_material(scene, metal)), {0.9f, -0.4f, 0}, {0.1f, 0.2f, 0.3f, 0.927f},
          {0.6f, -0.4f, 0.5f});
    place(scene, rectangle(0.5f, 0.5f, 0, add_material(scene, veil)), {0.7f, 0.3f, 1}, {0, 0.2f, 0, 0.98f});
    place(scene, rectangle(0.5f, 0.5f, 0, add_material(scene, leaf)), {0.2f, 0.8f, 0.5f}, {0.2f, 0.1f, 0, 0.97f});
    place(scene, rectangle(0.4f, 0.4f, 0, add_material(scene, pane({1, 0.6f, 0.6f}))), {0.3f, -0.4f, 1.2f});
    add_sun(scene, {0.3f, 1, 0.6f});
    Light lamp;
    lamp.intensity = 10;
    add_light(scene, lamp, {-1, 2, 2});
    lamp.type = LightType::kSpot;
    add_light(scene, lamp, {2, 1.5f, 2}, toward(normalize(Vec3{-2, -1.5f, -2})));
    return scene;
}

inline RenderOptions of_many_kinds(Engine engine) {
    RenderOptions o = quick(engine, 160, 120);
    o.view = look({0.3f, 0.5f, 3.5f}, {0, -0.1f, 0});
    return o;
}

}  // namespace tessera::test
