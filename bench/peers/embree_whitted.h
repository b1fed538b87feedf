// How a tile of a Whitted frame is drawn straight on Embree: primary rays, hard shadows and one mirror bounce with its
// shadows. Either ray by ray, as the textbook's recursion, or by packets in waves, where the rays that live on are
// moved together between the waves. Both do the same work. Colors are linear; a pixel is stored with a square root as
// gamma.
#pragma once

#include "bench/peers/embree_runs.h"

namespace peers {

inline constexpr int kTileSide = 16, kTilePixels = kTileSide * kTileSide;
inline constexpr float kAmbient = 0.1f, kDiffuse = 0.7f, kMirror = 0.25f;
inline const vec3 kBackground(0.6f, 0.7f, 0.9f);
inline const vec3 kColors[2] = {{0.8f, 0.4f, 0.3f}, {0.7f, 0.7f, 0.7f}};  // of mesh and ground

struct Pixel {
    std::uint8_t r, g, b;
};

struct Work {
    RTCScene scene;
    const Frame& frame;
    bool coherent;
    std::vector<Pixel>& pixels;

    // Pixel i of the tile whose first pixel is (x, y).
    void store(int x, int y, int i, vec3 color) const {
        const auto byte = [](float f) {
            return static_cast<std::uint8_t>(std::sqrt(std::min(1.f, std::max(0.f, f))) * 255 + 0.5f);
        };
        const int at = (y + tile_y(kTileSide, i)) * kWidth + x + tile_x(kTileSide, i);
        pixels[static_cast<std::size_t>(at)] = {byte(color.r), byte(color.g), byte(color.b)};
    }
};

// --- one ray after the other -------------------------------------------------------------------

inline vec3 radiance(const Work& work, vec3 origin, vec3 direction, int bounces, std::size_t& rays) {
    RTCIntersectContext context = make_context(false);
    const RTCRayHit query = intersect(work.scene, context, origin, direction);
    ++rays;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return kBackground;
    const vec3 normal = facing_normal(query);
    const vec3 point = origin + query.ray.tfar * direction + kOffset * normal;
    const vec3 to_light = work.frame.light - point;
    const float facing = glm::dot(normal, to_light);
    float light = kAmbient;
    if (facing > 0) {
        RTCRay shadow = single_ray(point, to_light, 0, 1);
        rtcOccluded1(work.scene, &context, &shadow);
        ++rays;
        if (shadow.tfar >= 0) light += kDiffuse * facing / glm::length(to_light);
    }
    const vec3 color = light * kColors[query.hit.geomID];
    if (bounces == 0) return color;
    const vec3 mirrored = direction + -2 * glm::dot(direction, normal) * normal;
    return color + kMirror * radiance(work, point, mirrored, bounces - 1, rays);
}

inline std::size_t draw_tile_by_rays(const Work& work, int tile) {
    static thread_local Rays<kTilePixels> primary;
    const int count = work.frame.generate(Kind::kPrimary, tile, primary);
    const int x = work.frame.pixel_x(tile, 0), y = work.frame.pixel_y(tile, 0);
    std::size_t rays = 0;
    for (int i = 0; i < count; ++i) {
        const vec3 direction(primary.dir_x[i], primary.dir_y[i], primary.dir_z[i]);
        work.store(x, y, i, radiance(work, work.frame.camera.eye, direction, 1, rays));
    }
    return rays;
}

// --- waves of packets --------------------------------------------------------------------------

// Rays of a tile, whose pixels they belong to, and what they hit.
struct alignas(64) Wave {
    Rays<kTilePixels> rays;
    float normal_x[kTilePixels], normal_y[kTilePixels], normal_z[kTilePixels], light[kTilePixels];
    std::uint32_t mesh[kTilePixels];
    int pixel[kTilePixels];
    int count = 0;
};

struct TileColors {
    float r[kTilePixels] = {}, g[kTilePixels] = {}, b[kTilePixels] = {};

    void add(int pixel, float weight, vec3 color) {
        r[pixel] += weight * color.r;
        g[pixel] += weight * color.g;
        b[pixel] += weight * color.b;
    }
};

// Leaves the distance in t_far, the geometry's normal and the mesh.
template <int W>
void find_hits(const Work& work, Wave& wave) {
    RTCIntersectContext context = make_context(work.coherent);
    alignas(64) int valid[W];
    RayHitPacket<W> packet;
    for (int first = 0; first < wave.count; first += W) {
        load_rays<W>(wave.rays, first, wave.count, packet.ray, valid);
        clear_hits<W>(packet);
        intersect(valid, work.scene, context, packet);
        const auto copy = [first](auto* to, const auto* from) { std::memcpy(to + first, from, W * sizeof(*from)); };
        copy(wave.rays.t_far, packet.ray.tfar);
        copy(wave.normal_x, packet.hit.Ng_x), copy(wave.normal_y, packet.hit.Ng_y);
        copy(wave.normal_z, packet.hit.Ng_z);
        copy(wave.mesh, packet.hit.geomID);
    }
}

// Leaves a negative t_far where something is in the way.
template <int W>
void find_shadows(const Work& work, Wave& wave) {
    RTCIntersectContext context = make_context(work.coherent);
    alignas(64) int valid[W];
    RayPacket<W> packet;
    for (int first = 0; first < wave.count; first += W) {
        load_rays<W>(wave.rays, first, wave.count, packet, valid);
        occluded(valid, work.scene, context, packet);
        std::memcpy(wave.rays.t_far + first, packet.tfar, W * sizeof(float));
    }
}

// Rays that hit nothing add the background and go; the others move together, and their origins to the surface.
inline void keep_hits(Wave& wave, float weight, TileColors& colors) {
    Rays<kTilePixels>& r = wave.rays;
    int hits = 0;
    for (int i = 0; i < wave.count; ++i) {
        const bool hit = wave.mesh[i] != RTC_INVALID_GEOMETRY_ID;
        if (!hit) colors.add(wave.pixel[i], weight, kBackground);
        const vec3 origin(r.org_x[i], r.org_y[i], r.org_z[i]), direction(r.dir_x[i], r.dir_y[i], r.dir_z[i]);
        r.set(hits, origin, direction, 0, r.t_far[i]);
        wave.normal_x[hits] = wave.normal_x[i];
        wave.normal_y[hits] = wave.normal_y[i];
        wave.normal_z[hits] = wave.normal_z[i];
        wave.mesh[hits] = wave.mesh[i];
        wave.pixel[hits] = wave.pixel[i];
        hits += hit;
    }
    wave.count = hits;
    for (int i = 0; i < hits; ++i) {
        const vec3 geometric(wave.normal_x[i], wave.normal_y[i], wave.normal_z[i]);
        const vec3 direction(r.dir_x[i], r.dir_y[i], r.dir_z[i]);
        const float inverse = 1 / std::sqrt(glm::dot(geometric, geometric));
        const vec3 normal = (glm::dot(geometric, direction) > 0 ? -inverse : inverse) * geometric;
        wave.normal_x[i] = normal.x, wave.normal_y[i] = normal.y, wave.normal_z[i] = normal.z;
        r.org_x[i] += r.t_far[i] * direction.x + kOffset * normal.x;
        r.org_y[i] += r.t_far[i] * direction.y + kOffset * normal.y;
        r.org_z[i] += r.t_far[i] * direction.z + kOffset * normal.z;
    }
}

// Light at each hit of `wave`. `shadows` is room for the rays towards it.
template <int W>
void find_light(const Work& work, Wave& wave, Wave& shadows) {
    const Rays<kTilePixels>& r = wave.rays;
    const vec3 light = work.frame.light;
    float cosine[kTilePixels];
    for (int i = 0; i < wave.count; ++i) {
        const vec3 to_light = light - vec3(r.org_x[i], r.org_y[i], r.org_z[i]);
        const vec3 normal(wave.normal_x[i], wave.normal_y[i], wave.normal_z[i]);
        cosine[i] = glm::dot(normal, to_light) / std::sqrt(glm::dot(to_light, to_light));
        wave.light[i] = kAmbient;
    }
    shadows.count = 0;
    for (int i = 0; i < wave.count; ++i) {
        const vec3 point(r.org_x[i], r.org_y[i], r.org_z[i]);
        shadows.rays.set(shadows.count, point, light - point, 0, 1);
        shadows.pixel[shadows.count] = i;  // of the wave
        shadows.count += cosine[i] > 0;
    }
    find_shadows<W>(work, shadows);
    for (int k = 0; k < shadows.count; ++k) {
        const int i = shadows.pixel[k];
        if (shadows.rays.t_far[k] >= 0) wave.light[i] += kDiffuse * cosine[i];
    }
}

// The rays of `wave`, which ends as their mirror rays.
template <int W>
std::size_t draw_wave(const Work& work, Wave& wave, Wave& shadows, float weight, TileColors& colors) {
    std::size_t rays = static_cast<std::size_t>(wave.count);
    find_hits<W>(work, wave);
    keep_hits(wave, weight, colors);
    find_light<W>(work, wave, shadows);
    rays += static_cast<std::size_t>(shadows.count);
    Rays<kTilePixels>& r = wave.rays;
    for (int i = 0; i < wave.count; ++i) colors.add(wave.pixel[i], weight * wave.light[i], kColors[wave.mesh[i]]);
    for (int i = 0; i < wave.count; ++i) {
        const vec3 direction(r.dir_x[i], r.dir_y[i], r.dir_z[i]);
        const vec3 normal(wave.normal_x[i], wave.normal_y[i], wave.normal_z[i]);
        const vec3 mirrored = direction + -2 * glm::dot(direction, normal) * normal;
        r.set(i, vec3(r.org_x[i], r.org_y[i], r.org_z[i]), mirrored, 0, kEverything);
    }
    return rays;
}

template <int W>
std::size_t draw_tile_by_waves(const Work& work, int tile) {
    static thread_local Wave wave, shadows;
    TileColors colors;
    const int count = wave.count = work.frame.generate(Kind::kPrimary, tile, wave.rays);
    for (int i = 0; i < count; ++i) wave.pixel[i] = i;
    std::size_t rays = draw_wave<W>(work, wave, shadows, 1, colors);
    rays += draw_wave<W>(work, wave, shadows, kMirror, colors);
    const int x = work.frame.pixel_x(tile, 0), y = work.frame.pixel_y(tile, 0);
    for (int i = 0; i < count; ++i) work.store(x, y, i, {colors.r[i], colors.g[i], colors.b[i]});
    return rays;
}

}  // namespace peers
