// What the programs that time Embree by itself trace: meshes, camera, 1920x1080 rays by kind and the order of pixels,
// without a ray tracer. World space, y up. Every number is a formula, so another ray tracer can be given the same rays.
// A frame is traced in square tiles; its secondary rays start at the hits of its primary rays, which the caller stores
// once. Reading is safe from several threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

using glm::vec3;

struct Mesh {
    std::vector<vec3> positions;
    std::vector<std::uint32_t> indices;

    std::size_t triangles() const { return indices.size() / 3; }
};

// Radius 1 around (0, 1, 0): 2 * around * (down - 1) triangles.
inline Mesh uv_sphere(int around, int down) {
    constexpr double kPi = 3.14159265358979323846;
    Mesh mesh;
    for (int j = 0; j <= down; ++j)
        for (int k = 0; k < around; ++k) {
            const double theta = kPi * j / down, phi = 2 * kPi * k / around;
            mesh.positions.emplace_back(std::sin(theta) * std::cos(phi), 1 + std::cos(theta),
                                        std::sin(theta) * std::sin(phi));
        }
    for (int j = 0; j < down; ++j)
        for (int k = 0; k < around; ++k) {
            const auto row = static_cast<std::uint32_t>(around);
            const auto a = static_cast<std::uint32_t>(j * around + k);
            const auto b = static_cast<std::uint32_t>(j * around + (k + 1) % around);
            if (j > 0) mesh.indices.insert(mesh.indices.end(), {a, b, b + row});
            if (j < down - 1) mesh.indices.insert(mesh.indices.end(), {a, b + row, a + row});
        }
    return mesh;
}

inline float height(float x, float z) {
    return 0.40f * std::sin(1.7f * x) * std::cos(1.3f * z) + 0.15f * std::sin(5.1f * x + 1.3f) * std::sin(4.3f * z) +
           0.05f * std::sin(17.f * x) * std::cos(19.f * z);
}

// n x n cells on [-5, 5]^2: 2 * n * n triangles.
inline Mesh height_field(int n) {
    Mesh mesh;
    const auto coordinate = [n](int i) { return -5 + 10.f * static_cast<float>(i) / static_cast<float>(n); };
    for (int j = 0; j <= n; ++j)
        for (int k = 0; k <= n; ++k) {
            const float x = coordinate(k), z = coordinate(j);
            mesh.positions.emplace_back(x, height(x, z), z);
        }
    for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) {
            const auto a = static_cast<std::uint32_t>(j * (n + 1) + k), c = a + static_cast<std::uint32_t>(n) + 1;
            mesh.indices.insert(mesh.indices.end(), {a, c, a + 1, a + 1, c, c + 1});
        }
    return mesh;
}

struct Scene {
    std::string name;
    Mesh mesh, ground;  // the spheres stand on a ground of two triangles
    vec3 eye{0, 1.6f, 3.6f}, at{0, 0.9f, 0}, light{4, 6, 3};
};

inline Scene make_scene(const std::string& name) {
    Scene scene;
    scene.name = name;
    if (name == "sphere100k" || name == "sphere1m") {
        scene.mesh = name == "sphere1m" ? uv_sphere(1000, 501) : uv_sphere(316, 159);  // 1,000,000 and 99,856
        scene.ground.positions = {{-20, 0, -20}, {20, 0, -20}, {20, 0, 20}, {-20, 0, 20}};
        scene.ground.indices = {0, 2, 1, 0, 3, 2};
    } else if (name == "hf100k" || name == "hf1m") {
        scene.mesh = height_field(name == "hf1m" ? 708 : 224);  // 1,002,528 and 100,352
        scene.eye = {0, 3, 6};
        scene.at = {0, 0, 0};
    } else {
        throw std::invalid_argument("no such scene: " + name + "; there are sphere100k, sphere1m, hf100k and hf1m");
    }
    return scene;
}

inline constexpr int kWidth = 1920, kHeight = 1080;

struct Camera {
    vec3 eye, right, down, corner;  // the ray of pixel (x, y) goes along corner + x * right + y * down

    Camera(vec3 from, vec3 at) : eye(from) {
        constexpr float kFieldOfView = 45;  // vertical, in degrees
        const vec3 forward = glm::normalize(at - from), side = glm::normalize(glm::cross(forward, vec3(0, 1, 0)));
        const float pixel = 2 * std::tan(kFieldOfView * 0.5f * 3.14159265f / 180.f) / kHeight;
        right = pixel * side;
        down = -pixel * glm::cross(side, forward);
        corner = forward + (-0.5f * kWidth + 0.5f) * right + (-0.5f * kHeight + 0.5f) * down;
    }
};

// Within a tile pixels are ordered in 4x4 blocks and these in 2x2 quads, so that 4, 8 or 16 rays in a row are 2x2, 4x2
// or 4x4 pixels.
inline constexpr int kBlockX[16] = {0, 1, 0, 1, 2, 3, 2, 3, 0, 1, 0, 1, 2, 3, 2, 3};
inline constexpr int kBlockY[16] = {0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 3, 3};

// The place of pixel i within a tile.
inline int tile_x(int side, int i) { return i / 16 % (side / 4) * 4 + kBlockX[i % 16]; }
inline int tile_y(int side, int i) { return i / 16 / (side / 4) * 4 + kBlockY[i % 16]; }

enum class Kind { kPrimary, kShadow, kMirror, kDiffuse };
inline constexpr Kind kKinds[] = {Kind::kPrimary, Kind::kShadow, Kind::kMirror, Kind::kDiffuse};
inline const char* name(Kind kind) {
    constexpr const char* kNames[] = {"primary", "shadow", "mirror", "diffuse"};
    return kNames[static_cast<int>(kind)];
}

inline constexpr float kEverything = 1e30f;  // t_far of rays without an end
inline constexpr float kOffset = 1e-3f;      // of secondary rays, along the normal
inline constexpr int kMaxTileSide = 32;

// Up to kCapacity rays, one array per number.
template <int kCapacity>
struct alignas(64) Rays {
    float org_x[kCapacity], org_y[kCapacity], org_z[kCapacity], dir_x[kCapacity], dir_y[kCapacity], dir_z[kCapacity];
    float t_near[kCapacity], t_far[kCapacity];

    void set(int i, vec3 origin, vec3 direction, float near, float far) {
        org_x[i] = origin.x, org_y[i] = origin.y, org_z[i] = origin.z;
        dir_x[i] = direction.x, dir_y[i] = direction.y, dir_z[i] = direction.z;
        t_near[i] = near, t_far[i] = far;
    }
};
using RayTile = Rays<kMaxTileSide * kMaxTileSide>;

// What the primary rays of a tile hit, in the order of the tile; unit normals towards the eye. `pixel` seeds the
// random numbers.
struct SurfacePoints {
    std::vector<float> x, y, z, normal_x, normal_y, normal_z;
    std::vector<std::uint32_t> pixel;

    int size() const { return static_cast<int>(pixel.size()); }
    vec3 position(int i) const { return at(x, y, z, i); }
    vec3 normal(int i) const { return at(normal_x, normal_y, normal_z, i); }
    void add(vec3 p, vec3 n, std::uint32_t seed) {
        x.push_back(p.x), y.push_back(p.y), z.push_back(p.z);
        normal_x.push_back(n.x), normal_y.push_back(n.y), normal_z.push_back(n.z);
        pixel.push_back(seed);
    }

  private:
    static vec3 at(const std::vector<float>& a, const std::vector<float>& b, const std::vector<float>& c, int i) {
        const auto n = static_cast<std::size_t>(i);
        return {a[n], b[n], c[n]};
    }
};

// Cosine-weighted around the normal: the normal plus a point of a sphere that two hashes of the pixel choose.
inline vec3 diffuse_direction(vec3 normal, std::uint32_t pixel) {
    const auto hash = [](std::uint32_t h) {  // "lowbias32" of C. Wellons
        h = (h ^ h >> 16) * 0x7feb352du;
        h = (h ^ h >> 15) * 0x846ca68bu;
        return h ^ h >> 16;
    };
    const auto unit = [](std::uint32_t h) { return static_cast<float>(h >> 8) * (1.f / 16777216.f); };
    const std::uint32_t seed = hash(pixel * 2 + 1);
    const float z = 2 * unit(seed) - 1, angle = 6.2831853f * unit(hash(seed + 0x9e3779b9u));
    const float radius = std::sqrt(std::max(0.f, 1 - z * z));
    constexpr float kInside = 0.999f;  // keeps the sum away from zero
    return glm::normalize(vec3(normal.x + kInside * radius * std::cos(angle),
                               normal.y + kInside * radius * std::sin(angle), normal.z + kInside * z));
}

struct Frame {
    int tile_side, columns, rows;
    Camera camera;
    vec3 light;
    std::vector<SurfacePoints> points;  // by tile; to be filled before secondary rays are made

    Frame(const Scene& scene, int side)
        : tile_side(side),
          columns((kWidth + side - 1) / side),
          rows((kHeight + side - 1) / side),
          camera(scene.eye, scene.at),
          light(scene.light),
          points(static_cast<std::size_t>(columns * rows)) {}

    int tiles() const { return columns * rows; }
    int pixel_x(int tile, int i) const { return tile % columns * tile_side + tile_x(tile_side, i); }
    int pixel_y(int tile, int i) const { return tile / columns * tile_side + tile_y(tile_side, i); }
    const SurfacePoints& points_of(int tile) const { return points[static_cast<std::size_t>(tile)]; }

    // Fills `rays`, which has room for a tile, and returns how many there are. Behind the last one lie inactive rays,
    // up to a multiple of 16.
    template <int N>
    int generate(Kind kind, int tile, Rays<N>& rays) const {
        if (kind == Kind::kPrimary) return generate_primary(tile, rays);
        const SurfacePoints& from = points_of(tile);
        if (kind == Kind::kShadow)
            generate_secondary(from, rays, 1, [this](int, vec3, vec3, vec3 origin) { return light - origin; });
        else if (kind == Kind::kMirror)
            generate_secondary(from, rays, kEverything, [this](int, vec3 position, vec3 normal, vec3) {
                const vec3 in = glm::normalize(position - camera.eye);
                return in + -2 * glm::dot(in, normal) * normal;
            });
        else
            generate_secondary(from, rays, kEverything, [&from](int i, vec3, vec3 normal, vec3) {
                return diffuse_direction(normal, from.pixel[static_cast<std::size_t>(i)]);
            });
        const int count = from.size();
        for (int i = count; i % 16 != 0; ++i) rays.set(i, vec3(0), vec3(0, 0, 1), 1, -1);
        return count;
    }

  private:
    // One ray per point: its direction is direction(index, position, normal, origin). A loop for each kind of ray, so
    // that the compiler can vectorise it.
    template <int N, class Direction>
    static void generate_secondary(const SurfacePoints& from, Rays<N>& rays, float far, const Direction& direction) {
        const int count = from.size();
        for (int i = 0; i < count; ++i) {
            const vec3 position = from.position(i), normal = from.normal(i), origin = position + kOffset * normal;
            rays.set(i, origin, direction(i, position, normal, origin), 0, far);
        }
    }

    // Block by block; the picture's sides are multiples of a block's, so a block lies inside it or outside.
    template <int N>
    int generate_primary(int tile, Rays<N>& rays) const {
        int count = 0;
        for (int first = 0; first < tile_side * tile_side; first += 16) {
            const int x = pixel_x(tile, first), y = pixel_y(tile, first);
            if (x >= kWidth || y >= kHeight) continue;
            for (int i = 0; i < 16; ++i) {
                const auto column = static_cast<float>(x + kBlockX[i]), row = static_cast<float>(y + kBlockY[i]);
                const vec3 direction = glm::normalize(camera.corner + column * camera.right + row * camera.down);
                rays.set(count + i, camera.eye, direction, 0, kEverything);
            }
            count += 16;
        }
        return count;
    }
};

}  // namespace peers
