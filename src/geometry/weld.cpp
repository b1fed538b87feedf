#include "geometry/weld.h"

#include "geometry/buckets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

namespace tessera {
namespace {

using Key = std::array<std::uint32_t, 8>;

std::uint32_t bits(float x) { return x == 0 ? 0 : std::bit_cast<std::uint32_t>(x); }

std::uint64_t hash(const Key& key) {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const std::uint32_t word : key) {  // multiply and fold: the high half carries the mixing
        h = (h ^ word) * 0xd6e8feb86659fd93u;
        h ^= h >> 32;
    }
    return h;
}

}  // namespace

std::vector<std::uint32_t> weld_vertices(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                         std::span<const Vec2> uv) {
    const auto count = static_cast<std::uint32_t>(positions.size());
    const auto key = [&](std::uint32_t v) {
        const Vec3 p = positions[v], n = normals[v];
        const Vec2 t = uv.empty() ? Vec2{} : uv[v];
        return Key{bits(p.x), bits(p.y), bits(p.z), bits(n.x), bits(n.y), bits(n.z), bits(t.x), bits(t.y)};
    };
    const std::size_t bucket_count = std::bit_ceil(static_cast<std::size_t>(count) + 1);
    std::vector<std::uint32_t> bucket_of(count);
    for (std::uint32_t v = 0; v < count; ++v)
        bucket_of[v] = static_cast<std::uint32_t>(hash(key(v)) & (bucket_count - 1));
    Buckets buckets = fill_buckets(count, bucket_count, [&](std::uint32_t v) { return bucket_of[v]; });

    std::vector<std::uint32_t> representative(count);
    std::vector<std::pair<Key, std::uint32_t>> keyed;
    for (std::size_t b = 0; b < bucket_count; ++b) {
        keyed.clear();
        for (const std::uint32_t v : buckets[b]) keyed.emplace_back(key(v), v);
        if (keyed.size() > 1) std::sort(keyed.begin(), keyed.end());
        for (std::size_t i = 0; i < keyed.size(); ++i) {
            const bool same = i > 0 && keyed[i].first == keyed[i - 1].first;
            representative[keyed[i].second] = same ? representative[keyed[i - 1].second] : keyed[i].second;
        }
    }
    return representative;
}

}  // namespace tessera
