#include "load/gltf_draco.h"

#include <draco/compression/decode.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace tessera {

struct DracoPrimitive::Unpacked {
    std::unique_ptr<draco::Mesh> mesh;
};

namespace {

// LEB128, as Draco's bitstream has its numbers.
std::optional<std::uint64_t> take_number(std::span<const std::byte>& bytes) {
    std::uint64_t number = 0;
    for (int shift = 0; shift < 35 && !bytes.empty(); shift += 7) {
        const auto b = static_cast<std::uint64_t>(bytes.front());
        bytes = bytes.subspan(1);
        number |= (b & 127) << shift;
        if ((b & 128) == 0) return number;
    }
    return std::nullopt;
}

// Draco takes memory for as many triangles as the data say before it has seen one; so they are looked at
// first. Bitstream 2.2, which the extension asks for: five letters, two bytes of version, kind, method, two
// bytes of flags; then (edgebreaker: after a byte) vertices and triangles, or triangles and points.
void check_counts(const Json& json, std::span<const std::byte> packed, std::size_t triangles) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned>(packed[i]); };
    if (packed.size() < 12 || std::memcmp(packed.data(), "DRACO", 5) != 0) json.fail("no data of Draco");
    if (byte(5) != 2 || byte(6) != 2)
        json.fail("bitstream " + std::to_string(byte(5)) + "." + std::to_string(byte(6)) + " of Draco; 2.2 is read");
    if (byte(7) != 1) json.fail("no mesh of Draco");
    if (byte(8) > 1) json.fail("there is no such method of Draco");
    if (byte(10) & 0x80) json.fail("metadata of Draco are not read");
    const bool edgebreaker = byte(8) == 1;
    std::span<const std::byte> rest = packed.subspan(edgebreaker ? 12 : 11);
    const std::optional<std::uint64_t> first = take_number(rest), second = take_number(rest);
    if (!first || !second) json.fail("the data of Draco are cut off");
    const std::uint64_t faces = edgebreaker ? *second : *first, points = edgebreaker ? *first : *second;
    if (faces != triangles)
        json.fail(std::to_string(faces) + " triangles are packed, the accessors promise " + std::to_string(triangles));
    if (points > 3 * faces) json.fail(std::to_string(points) + " vertices for " + std::to_string(faces) + " triangles");
}

template <class T, int kComponents>
bool convert(const draco::PointAttribute& attribute, std::size_t points, std::byte* out) {
    for (std::uint32_t p = 0; p < points; ++p) {
        std::array<T, kComponents> values;
        if (!attribute.ConvertValue<T, kComponents>(attribute.mapped_index(draco::PointIndex(p)), values.data()))
            return false;
        std::memcpy(out + p * sizeof values, values.data(), sizeof values);
    }
    return true;
}
template <class T>
bool convert(const draco::PointAttribute& attribute, std::size_t components, std::size_t points, std::byte* out) {
    switch (components) {
        case 1:
            return convert<T, 1>(attribute, points, out);
        case 2:
            return convert<T, 2>(attribute, points, out);
        case 3:
            return convert<T, 3>(attribute, points, out);
        case 4:
            return convert<T, 4>(attribute, points, out);
        default:
            return false;
    }
}

}  // namespace

DracoPrimitive::DracoPrimitive(GltfDocument& document, const Json& json, std::size_t triangles)
    : context_(document.context()), json_(json), unpacked_(std::make_shared<Unpacked>()) {
    const int number = json.at("bufferView").reference(document.size(GltfArray::kBufferViews), "buffer view");
    const std::span<const std::byte> packed = document.view(static_cast<std::size_t>(number)).bytes;
    check_counts(json, packed, triangles);
    constexpr std::uint64_t kBytesPerTriangle = 160;  // of Draco's tables, measured from above
    context_.charge(kBytesPerTriangle * triangles, json.place());
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
    draco::Decoder decoder;
    draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) json.fail("the data of Draco are damaged");
    unpacked_->mesh = std::move(decoded).value();
    const draco::Mesh& mesh = *unpacked_->mesh;
    vertices_ = mesh.num_points();
    if (mesh.num_faces() != triangles) json.fail("the data of Draco are damaged");
    indices_.reserve(3 * triangles);
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (int k = 0; k < 3; ++k)
            indices_.push_back(mesh.face(draco::FaceIndex(f))[static_cast<std::size_t>(k)].value());
    json.at("attributes").each_member([&](std::string_view name, const Json& id) {
        ids_[std::string(name)] = static_cast<std::uint32_t>(id.integer(0xffffffff));
    });
}

void DracoPrimitive::supply(std::string_view attribute, Accessor& accessor) {
    const auto id = ids_.find(attribute);
    if (id == ids_.end()) return;
    const draco::PointAttribute* values = unpacked_->mesh->GetAttributeByUniqueId(id->second);
    if (!values) json_.at("attributes").fail("attribute " + std::to_string(id->second) + " is not packed");
    if (accessor.count != vertices_)
        json_.fail(std::to_string(vertices_) + " vertices are packed, the accessor has " +
                   std::to_string(accessor.count));
    if (static_cast<std::size_t>(values->num_components()) != accessor.components() || accessor.columns != 1)
        json_.at("attributes")
            .fail("the packed attribute has " + std::to_string(values->num_components()) + " components");
    const std::size_t stride = component_bytes(accessor.component) * accessor.components();
    context_.charge(std::uint64_t{stride} * vertices_, json_.place());
    values_.emplace_back(stride * vertices_);
    std::byte* const out = values_.back().data();
    bool fine = false;
    switch (accessor.component) {
        case ComponentType::kByte:
            fine = convert<std::int8_t>(*values, accessor.components(), vertices_, out);
            break;
        case ComponentType::kUnsignedByte:
            fine = convert<std::uint8_t>(*values, accessor.components(), vertices_, out);
            break;
        case ComponentType::kShort:
            fine = convert<std::int16_t>(*values, accessor.components(), vertices_, out);
            break;
        case ComponentType::kUnsignedShort:
            fine = convert<std::uint16_t>(*values, accessor.components(), vertices_, out);
            break;
        case ComponentType::kUnsignedInt:
            fine = convert<std::uint32_t>(*values, accessor.components(), vertices_, out);
            break;
        case ComponentType::kFloat:
            fine = convert<float>(*values, accessor.components(), vertices_, out);
            break;
    }
    if (!fine) json_.at("attributes").fail("the packed attribute does not fit its accessor");
    if (!accessor.sparse_indices.empty()) json_.fail("packed attributes are not sparse");
    accessor.base = {out, stride, stride};
}

void DracoPrimitive::supply_indices(Accessor& accessor) const {
    if (accessor.count != indices_.size())
        json_.fail(std::to_string(indices_.size()) + " indices are packed, the accessor has " +
                   std::to_string(accessor.count));
    if (!accessor.sparse_indices.empty()) json_.fail("packed indices are not sparse");
    accessor.component = ComponentType::kUnsignedInt;
    accessor.base = {reinterpret_cast<const std::byte*>(indices_.data()), sizeof(std::uint32_t), sizeof(std::uint32_t)};
}

}  // namespace tessera
