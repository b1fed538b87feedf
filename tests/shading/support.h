// Shared by the shading tests: random numbers, vectors in long double (the precision that results are
// judged with), and the small scenes that the tests shade.
#pragma once

#include "shading/shade.h"
#include "shading/texture_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace tessera::test {

class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float in(float low, float high) {
        return low + (high - low) * (static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f));
    }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_()) % n; }
    Vec3T<float> box(float size) {
        const float x = in(-size, size), y = in(-size, size);
        return {x, y, in(-size, size)};
    }
    Vec3T<float> unit() {
        for (;;) {
            const Vec3T<float> v = box(1);
            const float l = dot(v, v);
            if (l > 0.01f && l < 1) return v * (1 / std::sqrt(l));
        }
    }

  private:
    std::mt19937 engine_;
};

using Real = long double;
inline constexpr Real kRealPi = 3.14159265358979323846264338327950288L;

// Vectors in long double are the same templates' plain data, with arithmetic written out here.
struct Real3 {
    Real x = 0, y = 0, z = 0;
    Real3() = default;
    Real3(Real a, Real b, Real c) : x(a), y(b), z(c) {}
    explicit Real3(const Vec3T<float>& v) : x(v.x), y(v.y), z(v.z) {}
    friend Real3 operator+(Real3 a, Real3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Real3 operator-(Real3 a, Real3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Real3 operator*(Real3 a, Real3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend Real3 operator*(Real3 a, Real s) { return {a.x * s, a.y * s, a.z * s}; }
};
inline Real inner(Real3 a, Real3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Real3 outer(Real3 a, Real3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Real norm(Real3 a) { return std::sqrt(inner(a, a)); }
inline Real3 unit(Real3 a) { return a * (1 / norm(a)); }
inline Real distance(const Vec3T<float>& a, Real3 b) { return norm(Real3(a) - b); }

inline Vec3T<float> to_vec(Real3 a) {
    return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

// A material without textures, of neutral factors.
inline MaterialView plain_material(ShadingModel model) {
    MaterialView m{};
    m.model = model;
    m.alpha_mode = AlphaMode::kOpaque;
    m.alpha_cutoff = 0.5f;
    for (float& c : m.base_color) c = 1;
    m.metallic = 0;
    m.roughness = 1;
    m.normal_scale = m.occlusion_strength = 1;
    for (float& c : m.diffuse) c = 1;
    m.shininess = 32;
    return m;
}

// A point with the given normal (unit), seen from its front, without tangents.
inline SurfacePoint<float> plain_point(const Vec3T<float>& position, const Vec3T<float>& normal) {
    SurfacePoint<float> s{};
    s.position = position;
    s.view = normalize_or(-position, {0, 0, 1});
    s.geometric_normal = s.normal = normal;
    s.side = 1;
    s.color = {1, 1, 1, 1};
    return s;
}

// Nothing but what the caller adds.
inline ShadingContext plain_context(const std::vector<LightView>& lights) {
    ShadingContext c{};
    c.lights = lights.data();
    c.light_count = static_cast<int>(lights.size());
    c.unlit_scale = c.footprint_scale = 1;
    return c;
}

inline ShadedPoint<float> shade_unshadowed(const ShadingContext& c, const MaterialView& m,
                                           const SurfacePoint<float>& s) {
    return shade(c, m, s, [](int, const LightSample<float>&) { return 1.0f; });
}

inline void set3(float (&out)[3], const Vec3T<float>& v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

inline AmbientView even_ambient(float radiance) {
    return {{radiance, radiance, radiance}, {radiance, radiance, radiance}, {0, 1, 0}};
}

inline LightView directional_light(const Vec3T<float>& to_light, float lux) {
    LightView l{};
    l.type = LightType::kDirectional;
    set3(l.to_light, to_light);
    set3(l.intensity, {lux, lux, lux});
    return l;
}

inline LightView point_light(const Vec3T<float>& position, float candela) {
    LightView l{};
    l.type = LightType::kPoint;
    set3(l.position, position);
    set3(l.intensity, {candela, candela, candela});
    return l;
}

// The channel of a texel for the 8-bit value of a data texture.
inline std::int16_t channel15(int code) { return static_cast<std::int16_t>(std::lround(code * 32767 / 255.0)); }
inline Texel grey_texel(int code) {
    const std::int16_t c = channel15(code);
    return {{c, c, c, c}};
}
// What a stored channel stands for.
inline Real value15(std::int16_t channel) { return channel / 32767.0L; }

// Texels of `levels` levels, each a random number of its own; guard texels before, behind, and in place
// of the levels that are left out.
class TestTexture {
  public:
    static constexpr std::int16_t kGuard = 32767;
    static constexpr std::size_t kGuards = 64;

    TestTexture(int width, int height, int levels, std::uint32_t seed)
        : chain_(empty_mip_chain(width, height)),
          texels_(chain_.texels.size() + 2 * kGuards, {{kGuard, kGuard, kGuard, kGuard}}) {
        view_ = texture_view(chain_, {}, levels);
        view_.texels = texels_.data() + kGuards;
        std::mt19937 engine(seed);
        for (int i = 0; i < view_.levels; ++i) {
            for (int y = 0; y < this->height(i); ++y)
                for (int x = 0; x < this->width(i); ++x)
                    for (std::int16_t& c : at(i, x, y).c) c = static_cast<std::int16_t>(engine() & 32767);
            wrap_border(level(i), all());
        }
    }
    TestTexture(const TestTexture&) = delete;
    TestTexture& operator=(const TestTexture&) = delete;

    TextureView& view() { return view_; }
    int width(int i) const { return level(i).width; }
    int height(int i) const { return level(i).height; }
    Texel texel(int i, int x, int y) { return at(i, x, y); }
    // Channel (0 red .. 3 alpha) of a texel as 0 .. 1.
    Real value(int i, int x, int y, int c) { return value15(at(i, x, y).c[c]); }
    void set(int i, int x, int y, Texel texel) {
        at(i, x, y) = texel;
        wrap_border(level(i), all());
    }
    void fill(int i, Texel texel) {
        for (int y = 0; y < height(i); ++y)
            for (int x = 0; x < width(i); ++x) at(i, x, y) = texel;
        wrap_border(level(i), all());
    }
    // Guards in place of the border.
    void spoil_border(int i) {
        for (int y = -1; y <= height(i); ++y)
            for (int x = -1; x <= width(i); ++x)
                if (x < 0 || y < 0 || x == width(i) || y == height(i)) at(i, x, y) = {{kGuard, kGuard, kGuard, kGuard}};
    }

  private:
    const MipLevel& level(int i) const { return chain_.levels[static_cast<std::size_t>(i)]; }
    std::span<Texel> all() { return std::span(texels_).subspan(kGuards, chain_.texels.size()); }
    Texel& at(int i, int x, int y) { return texels_[kGuards + level(i).index(x, y)]; }

    MipChain chain_;
    std::vector<Texel> texels_;
    TextureView view_;
};

}  // namespace tessera::test
