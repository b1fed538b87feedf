#include "cli/workload_meshes.h"

#include <algorithm>
#include <cmath>

namespace tessera::cli {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kFieldOfView = 60;  // degrees, vertical

Vec3 vec3(double x, double y, double z) {
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

void add_indices(Primitive& p, std::initializer_list<std::uint32_t> indices) {
    p.indices.insert(p.indices.end(), indices);
}

}  // namespace

Primitive sphere_mesh(int n) {
    Primitive p;
    const int columns = 2 * n;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double theta = kPi * j / n, phi = 2 * kPi * i / columns;
            const Vec3 v = vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
            p.positions.push_back(v);
            p.normals.push_back(v);
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i), b = a + 1;
            const std::uint32_t c = a + static_cast<std::uint32_t>(columns) + 1, d = c + 1;
            add_indices(p, {a, b, c, b, d, c});
        }
    return p;
}

Primitive terrain_mesh(int n) {
    Primitive p;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const double x = -1 + 2.0 * i / n, z = -1 + 2.0 * j / n;
            const double y = 0.08 * (std::sin(7 * x + 0.3) * std::cos(9 * z) + 0.5 * std::sin(17 * x + 11 * z));
            const double dx = 0.08 * (7 * std::cos(7 * x + 0.3) * std::cos(9 * z) + 8.5 * std::cos(17 * x + 11 * z));
            const double dz = 0.08 * (-9 * std::sin(7 * x + 0.3) * std::sin(9 * z) + 5.5 * std::cos(17 * x + 11 * z));
            const double l = 1.0 / std::sqrt(dx * dx + dz * dz + 1);
            p.positions.push_back(vec3(x, y, z));
            p.normals.push_back(vec3(-dx * l, l, -dz * l));
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1;
            const std::uint32_t c = a + static_cast<std::uint32_t>(n) + 1, d = c + 1;
            add_indices(p, {a, c, b, b, c, d});
        }
    return p;
}

Primitive soup_mesh(int count, double complexity, int width, int height) {
    Primitive p;
    p.texcoords.emplace_back();
    std::uint32_t state = 12345u;  // a linear congruential generator (Numerical Recipes)
    const auto random = [&] {
        state = state * 1664525u + 1013904223u;
        return static_cast<double>(state >> 8) / 16777216.0;
    };
    const double tangent = std::tan(kFieldOfView * kPi / 360), aspect = static_cast<double>(width) / height;
    const double radius = std::sqrt(complexity * width * height / count / (0.75 * std::sqrt(3.0)));  // pixels
    for (int t = 0; t < count; ++t) {
        const double cx = (2 * random() - 1) * width / 2, cy = (2 * random() - 1) * height / 2;
        const double distance = 2 + 4 * random(), turn = 2 * kPi * random();
        for (int k = 0; k < 3; ++k) {
            const double angle = turn + 2 * kPi * k / 3;
            const double px = cx + radius * std::cos(angle), py = cy + radius * std::sin(angle);
            const double d = distance * (1 + 0.1 * (random() - 0.5));
            p.positions.push_back(
                vec3(px / (width / 2.0) * tangent * aspect * d, py / (height / 2.0) * tangent * d, -d));
            p.normals.push_back(vec3(0.4 * std::cos(angle), 0.4 * std::sin(angle), std::sqrt(1 - 0.16)));
            p.texcoords[0].push_back({static_cast<float>(0.5 + 0.5 * std::cos(angle) + (t % 7)),
                                      static_cast<float>(0.5 + 0.5 * std::sin(angle) + (t % 5))});
            p.indices.push_back(static_cast<std::uint32_t>(3 * t + k));
        }
    }
    return p;
}

Primitive layer_mesh(int layers, bool front_to_back) {
    Primitive p;
    p.colors.emplace_back();
    for (int l = 0; l < layers; ++l) {
        const int k = front_to_back ? l : layers - 1 - l;
        const double z = -0.9 + 1.8 * k / layers;
        for (int c = 0; c < 4; ++c) {
            p.positions.push_back(vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, z));
            p.normals.push_back({0, 0, 1});
            p.colors[0].push_back({static_cast<float>(k & 1), static_cast<float>((k >> 1) & 1),
                                   static_cast<float>((k + 1.0) / layers), 1});
        }
        const auto first = static_cast<std::uint32_t>(4 * l);
        add_indices(p, {first, first + 1, first + 2, first + 1, first + 3, first + 2});
    }
    return p;
}

Image workload_texture(bool srgb) {
    constexpr int kSide = 1024;
    std::uint8_t code[256];
    for (int i = 0; i < 256; ++i) {
        const double v = i / 255.0, e = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        code[i] = static_cast<std::uint8_t>(srgb ? std::lround(255 * e) : i);
    }
    Image image(kSide, kSide, PixelFormat::kRgba8);
    auto* p = image.data<std::uint8_t>();
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x, p += 4) {
            const bool light = (((x >> 4) ^ (y >> 4)) & 1) != 0;
            p[0] = code[light ? 255 : x & 255];
            p[1] = code[(x ^ y) & 255];
            p[2] = code[light ? y & 255 : 64];
            p[3] = 255;
        }
    return image;
}

}  // namespace tessera::cli
