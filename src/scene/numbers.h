// Scans over plain numbers that vectorise: finiteness and the largest index. The vector types of the
// scene are tightly packed floats, so a vector of any of them can be scanned as floats.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// The numbers of a vector of float, Vec2, Vec3, Vec4 or Mat4.
template <class T>
std::span<const float> as_floats(const std::vector<T>& values) {
    static_assert(sizeof(T) % sizeof(float) == 0);
    return {reinterpret_cast<const float*>(values.data()), values.size() * (sizeof(T) / sizeof(float))};
}

// A float is finite when its exponent is not all ones: as an integer without the sign it is then
// below the bits of infinity. One integer maximum over everything decides.
inline bool all_finite(std::span<const float> values) {
    std::int32_t largest = 0;
    for (const float value : values) {
        const std::int32_t magnitude = std::bit_cast<std::int32_t>(value) & 0x7fffffff;
        largest = magnitude > largest ? magnitude : largest;
    }
    return largest < 0x7f800000;
}

inline std::size_t first_not_finite(std::span<const float> values) {
    std::size_t i = 0;
    while (i < values.size() && (std::bit_cast<std::uint32_t>(values[i]) & 0x7f800000u) != 0x7f800000u) ++i;
    return i;
}

// 0 for an empty span.
inline std::uint32_t largest_index(std::span<const std::uint32_t> indices) {
    std::uint32_t largest = 0;
    for (const std::uint32_t index : indices) largest = index > largest ? index : largest;
    return largest;
}

}  // namespace tessera
