#include "load/gltf_shape.h"

#include "scene/shapes.h"

#include <limits>

namespace tessera {
namespace {

constexpr std::string_view kName = "TESSERA_shape";

struct Type {
    std::string_view name;
    Shape::Type type;
    std::array<std::string_view, 2> members;  // beside "type"
};
constexpr Type kTypes[] = {
    {"sphere", Shape::Type::kSphere, {"radius", "segments"}},
    {"disc", Shape::Type::kDisc, {"radius", "segments"}},
    {"plane", Shape::Type::kPlane, {"size", "size"}},
};

const Type& read_type(const Json& json) {
    for (const Type& type : kTypes)
        if (json.string() == type.name) return type;
    json.fail("there is no shape " + json.raw() + "; there are sphere, disc and plane");
}

void read_member(std::string_view name, const Json& value, Shape& shape) {
    if (name == "radius")
        shape.radius = value.number();
    else if (name == "segments")
        shape.segments = static_cast<int>(value.integer(std::numeric_limits<int>::max()));
    else
        value.numbers({&shape.size.x, 2});
}

}  // namespace

std::optional<Shape> find_shape(const Json& primitive) {
    const std::optional<Json> json = find_extension(primitive, kName);
    if (!json) return {};
    const Type& type = read_type(json->at("type"));
    Shape shape;
    shape.type = type.type;
    json->each_member([&](std::string_view name, const Json& value) {
        if (name == "type" || name == "extensions" || name == "extras") return;
        if (name != type.members[0] && name != type.members[1])
            value.fail("a " + std::string(type.name) + " has no such member");
        read_member(name, value, shape);
    });
    const std::optional<Json> size = json->find("size");
    // Without end is what has no size; one of 0 by 0 is more likely a slip.
    if (size && is_endless(shape)) size->fail("must be finite and above 0");
    if (const std::optional<ShapeFault> fault = find_fault(shape))
        json->at(fault->field).fail(std::string(fault->message));
    return shape;
}

Primitive read_shape_primitive(GltfDocument& document, const Json& primitive, const Shape& shape) {
    if (const std::optional<Json> targets = primitive.find("targets")) targets->fail("a shape has no morph targets");
    if (const std::optional<Json> json = find_extension(primitive, kName)) document.note_extensions(*json);
    const ShapeCounts counts = shape_counts(shape);
    constexpr std::uint64_t kVertex = 2 * sizeof(Vec3) + sizeof(Vec4) + sizeof(Vec2);
    document.context().charge(counts.vertices * kVertex + counts.triangles * 3 * sizeof(std::uint32_t),
                              primitive.place());
    return shape_primitive(shape);
}

}  // namespace tessera
