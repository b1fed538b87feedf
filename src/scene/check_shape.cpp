// Primitives with a shape.
#include "scene/check.h"
#include "scene/shapes.h"

#include <cmath>
#include <limits>

namespace tessera {
namespace {

// Far beyond rounding, far below what could be seen.
constexpr double kSlack = 1e-4;

// Up to kSlack of `most`, and the rounding of numbers that are nearly 0.
bool is_within(double distance, double most) {
    return distance <= most * (1 + kSlack) + static_cast<double>(std::numeric_limits<float>::min());
}

bool lies_on(const Shape& shape, const Vec3& p) {
    const double x = static_cast<double>(p.x), y = static_cast<double>(p.y), z = static_cast<double>(p.z);
    const double radius = static_cast<double>(shape.radius);
    switch (shape.type) {
        case Shape::Type::kSphere: {
            const double distance = std::sqrt(x * x + y * y + z * z);
            return is_within(distance, radius) && is_within(radius, distance);
        }
        case Shape::Type::kDisc:
            return y == 0 && is_within(std::sqrt(x * x + z * z), radius);
        case Shape::Type::kPlane:
            break;
    }
    if (is_endless(shape)) return y == 0 && std::abs(p.x) <= kPlaneReach && std::abs(p.z) <= kPlaneReach;
    return y == 0 && is_within(std::abs(x), 0.5 * static_cast<double>(shape.size.x)) &&
           is_within(std::abs(z), 0.5 * static_cast<double>(shape.size.y));
}

}  // namespace

void check_shape(const Primitive& p, const Place& place, bool values) {
    const Shape& shape = *p.shape;
    if (const std::optional<ShapeFault> fault = find_fault(shape))
        place.child(fault->field).fail(std::string(fault->message));
    if (p.mode != PrimitiveMode::kTriangles) place.fail("only triangles can stand for a shape");
    if (!p.targets.empty()) place.fail("a shape has no morph targets");
    if (!p.joints.empty() || !p.weights.empty()) place.fail("a shape has no joints and weights");
    if (!p.colors.empty() || !p.custom.empty()) place.fail("a shape has no colours and no attributes of other names");
    if (p.normals.empty() || p.tangents.empty() || p.texcoords.size() != 1 || p.texcoords[0].empty())
        place.fail("a shape has normals, tangents and one set of texture coordinates");
    const ShapeCounts counts = shape_counts(shape);
    if (p.positions.size() != counts.vertices || p.indices.size() != 3 * counts.triangles)
        place.fail(std::to_string(p.positions.size()) + " vertices and " + std::to_string(p.indices.size()) +
                   " indices; the shape has " + std::to_string(counts.vertices) + " and " +
                   std::to_string(3 * counts.triangles));
    if (!values) return;
    for (std::size_t i = 0; i < p.positions.size(); ++i)
        if (!lies_on(shape, p.positions[i])) place.fail("vertex " + std::to_string(i) + " does not lie on the shape");
}

}  // namespace tessera
