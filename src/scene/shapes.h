// What the tessellation of a shape has, and what is wrong with a shape, before it is made.
#pragma once

#include <tessera/shape.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace tessera {

// A plane without end is drawn as far as this on each side of its middle.
inline constexpr float kPlaneReach = 0x1p24f;

inline bool is_endless(const Shape& shape) {
    return shape.type == Shape::Type::kPlane && shape.size.x == 0 && shape.size.y == 0;
}

struct ShapeFault {
    std::string_view field, message;
};
// Looks only at the numbers that count for the type.
std::optional<ShapeFault> find_fault(const Shape& shape);

// Of shape_primitive(); the shape must be without fault.
struct ShapeCounts {
    std::uint64_t vertices, triangles;
};
ShapeCounts shape_counts(const Shape& shape);

}  // namespace tessera
