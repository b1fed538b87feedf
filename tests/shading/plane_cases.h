// Triangles for the tests of surface planes, and numbers that carry a bound of what float roundings may
// have added to them.
#pragma once

#include "shading/support.h"
#include "shading/triangle_setup.h"

#include <cmath>
#include <cstring>

namespace tessera::test {

// An exact value and how far the float that was computed in its place may be from it, by the standard
// model fl(a op b) = (a op b)(1 + d), |d| <= 2^-24 (Higham, Accuracy and Stability of Numerical
// Algorithms, section 3.3: running error analysis).
struct Bounded {
    static constexpr Real kUnit = 0x1p-24L;
    Real value, error = 0;

    static Bounded rounded(Real v, Real e) { return {v, e + kUnit * (std::fabs(v) + e)}; }
    friend Bounded operator+(Bounded a, Bounded b) { return rounded(a.value + b.value, a.error + b.error); }
    friend Bounded operator-(Bounded a, Bounded b) { return rounded(a.value - b.value, a.error + b.error); }
    friend Bounded operator*(Bounded a, Bounded b) {
        return rounded(a.value * b.value,
                       std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error);
    }
    // Infinite where the divisor is not known to differ from zero.
    friend Bounded operator/(Bounded a, Bounded b) {
        const Real least = std::fabs(b.value) - b.error, q = a.value / b.value;
        if (!(least > 0)) return {q, INFINITY};
        return rounded(q, (a.error + std::fabs(q) * b.error) / least);
    }
};

// A triangle with all attributes before a lens of 90 degrees (near plane at 0.1, infinitely far).
struct PlaneCase {
    static constexpr float kWidth = 1920, kHeight = 1080;
    static constexpr float kLens[16] = {0.5625f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0.1f, 0, 0, -1, 0};
    static constexpr float kIdentity34[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    static constexpr float kIdentity33[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

    float positions[9], normals[9], tangents[12], colors[12], uvs[kMaxUvSets][6];
    std::uint32_t indices[3] = {0, 1, 2};
    InstanceView instance{};
    ProjectionView projection{};
    SurfaceLayout layout;
    TriangleSetup setup;
    float record[kMaxSurfaceFloats];

    PlaneCase() {
        std::memcpy(instance.object_to_clip, kLens, sizeof kLens);
        std::memcpy(projection.clip_from_camera, kLens, sizeof kLens);
        std::memcpy(instance.object_to_camera, kIdentity34, sizeof kIdentity34);
        std::memcpy(instance.normal_to_camera, kIdentity33, sizeof kIdentity33);
        instance.mesh = {positions, normals, tangents, {uvs[0], uvs[1], nullptr, nullptr}, colors, indices, 1, 3};
        instance.handedness = 1;
        projection.width = kWidth;
        projection.height = kHeight;
        projection.near = 0.1f;
        layout = {.count = 15, .normal = 1, .tangent = 4, .color = 7, .uv = {11, 13, -1, -1}};
    }
    PlaneCase(const PlaneCase&) = delete;
    PlaneCase& operator=(const PlaneCase&) = delete;

    void randomise(Random& random, float far, float size, bool behind) {
        const Vec3T<float> middle{random.in(-1, 1) * far, random.in(-0.6f, 0.6f) * far, -far};
        for (int i = 0; i < 3; ++i) {
            Vec3T<float> v = middle + random.box(size * far);
            if (behind && i == 2) v.z = random.in(0.1f, 3) * far;
            const Vec3T<float> n = random.unit(), t = random.unit();
            const float numbers[] = {v.x, v.y, v.z, n.x, n.y, n.z, t.x, t.y, t.z};
            for (int k = 0; k < 3; ++k) {
                positions[3 * i + k] = numbers[k];
                normals[3 * i + k] = numbers[3 + k];
                tangents[4 * i + k] = numbers[6 + k];
            }
            tangents[4 * i + 3] = -1;
            for (int k = 0; k < 4; ++k) colors[4 * i + k] = random.in(0, 1);
            for (auto& uv : uvs) uv[2 * i] = random.in(-3, 3), uv[2 * i + 1] = random.in(-3, 3);
        }
        setup_triangle(instance, 0, projection, setup);
    }
    void make_record() { make_surface_record(instance, 0, setup, projection, layout, record); }

    SurfacePoint<float> point(float x, float y) const {
        SurfaceSample<float> sample;
        sample_planes(
            layout, x, y, [this](int i) { return record[i]; }, sample);
        return surface_point(layout, PictureRays(projection), sample, x, y, 1.0f);
    }
    // What plane k interpolates, at corner i.
    float number(int k, int i) const {
        const float front = setup.front(instance) ? 1.0f : -1.0f;
        if (k == 0) return 1;
        if (k < 4) return normals[3 * i + k - 1] * front;
        if (k < 7) return tangents[4 * i + k - 4];
        if (k < 11) return colors[4 * i + k - 7];
        return uvs[(k - 11) / 2][2 * i + (k - 11) % 2];
    }
    Plane<float> plane(int k) const {
        const float* p = record + kSurfaceHeader + 3 * k;
        return {p[0], p[1], p[2]};
    }
    // A random position inside a triangle of the polygon, on the grid.
    SamplePosition inside(Random& random) const {
        const int last = setup.vertex_count > 3
                             ? 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(setup.vertex_count) - 2))
                             : 1;
        const SnappedVertex &a = setup.polygon[0], &b = setup.polygon[last], &c = setup.polygon[last + 1];
        const float u = random.in(0, 1), v = random.in(0, 1 - u);
        const auto along = [&](int p, int q, int r) {
            return p + static_cast<std::int32_t>(u * static_cast<float>(q - p) + v * static_cast<float>(r - p));
        };
        return {along(a.x, b.x, c.x), along(a.y, b.y, c.y)};
    }
};

}  // namespace tessera::test
