// Shared by the geometry tests: random values of chosen ranges and comparisons of vectors and
// matrices, relative to the largest magnitude involved.
#pragma once

#include <tessera/types.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace tessera::test {

class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float in(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f);
    }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_()) % n; }
    Vec2 vec2(float size) { return {in(-size, size), in(-size, size)}; }
    Vec3 vec3(float size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
    Vec3 unit() {
        for (;;) {
            const Vec3 v = vec3(1);
            if (length(v) > 0.1f && length(v) < 1) return normalize(v);
        }
    }
    Quat rotation() {
        for (;;) {
            const Quat q{in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)};
            const float l = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
            if (l > 0.1f && l < 1) return {q.x / l, q.y / l, q.z / l, q.w / l};
        }
    }

  private:
    std::mt19937 engine_;
};

inline void expect_near(Vec3 a, Vec3 b, float tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

// Every element within `relative` of the largest magnitude in either matrix.
inline void expect_near(const Mat4& a, const Mat4& b, float relative = 1e-6f) {
    float peak = 0;
    for (std::size_t i = 0; i < 16; ++i) peak = std::max({peak, std::fabs(a.m[i]), std::fabs(b.m[i])});
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) EXPECT_NEAR(a(r, c), b(r, c), relative * peak) << "row " << r << " column " << c;
}

}  // namespace tessera::test
