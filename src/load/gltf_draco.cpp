#include "load/gltf_draco.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>

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

// What is packed, from the first bytes.
struct DracoHeader {
    bool edgebreaker;
    std::uint64_t triangles, points;
    std::uint64_t seams;  // tables of attributes with corners of their own
};

// Draco takes memory for as many triangles as the data say before it has seen one; so they are looked at
// first. Bitstream 2.2, which the extension asks for: five letters, two bytes of version, kind, method, two
// bytes of flags; then (edgebreaker: after a byte) vertices, triangles and a byte of tables, or triangles and points.
DracoHeader read_header(const Json& json, std::span<const std::byte> packed, DracoTriangles promised) {
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
    if (promised.strip ? faces > promised.count : faces != promised.count)
        json.fail(std::to_string(faces) + " triangles are packed, the accessors promise " +
                  std::to_string(promised.count));
    if (points > 3 * faces) json.fail(std::to_string(points) + " vertices for " + std::to_string(faces) + " triangles");
    if (rest.empty()) json.fail("the data of Draco are cut off");
    return {edgebreaker, faces, points, edgebreaker ? static_cast<std::uint64_t>(rest.front()) : 0};
}

// Draco's decoders, which say what they are about to take memory for: the headers may name many attributes of up
// to 255 components, whether the primitive uses them or not.
template <class Decoder>
class ChargedDecoder : public Decoder {
  public:
    ChargedDecoder(LoadContext& context, const Json& json, std::uint64_t points)
        : context_(context), place_(json.place()), points_(points) {}

    std::unique_ptr<draco::Mesh> decode(std::span<const std::byte> packed) {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
        auto mesh = std::make_unique<draco::Mesh>();
        const bool fine = Decoder::Decode(draco::DecoderOptions(), &buffer, mesh.get()).ok();
        if (refused_) std::rethrow_exception(refused_);
        return fine ? std::move(mesh) : nullptr;
    }

  protected:
    // Once the triangles and points are known, for each of up to 255 groups of attributes.
    bool CreateAttributesDecoder(int id) override {
        constexpr std::uint64_t kBytesPerPoint = 24;  // order of the values, and the way back
        return charge(kBytesPerPoint * points()) && Decoder::CreateAttributesDecoder(id);
    }
    // Once the headers of all attributes are known, before their values: as packed integers, as what they stand
    // for, and which point has which.
    bool DecodeAllAttributes() override {
        std::uint64_t bytes = 0;
        for (int i = 0; i < this->point_cloud()->num_attributes(); ++i) {
            const draco::PointAttribute& a = *this->point_cloud()->attribute(i);
            const auto width = static_cast<std::uint64_t>(std::max(draco::DataTypeLength(a.data_type()), 1));
            bytes += (width + sizeof(std::int32_t)) * static_cast<std::uint64_t>(a.num_components()) + 8;
        }
        return charge(bytes * points()) && Decoder::DecodeAllAttributes();
    }

  private:
    // Attributes that fold add points to those of the header.
    std::uint64_t points() const { return std::max<std::uint64_t>(this->point_cloud()->num_points(), points_); }
    // Nothing is thrown through Draco.
    bool charge(std::uint64_t bytes) {
        try {
            context_.charge(bytes, place_);
            return true;
        } catch (...) {
            refused_ = std::current_exception();
            return false;
        }
    }

    LoadContext& context_;
    std::string place_;
    std::uint64_t points_;
    std::exception_ptr refused_;
};

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

DracoPrimitive::DracoPrimitive(GltfDocument& document, const Json& json, DracoTriangles promised)
    : context_(document.context()), json_(json), unpacked_(std::make_shared<Unpacked>()), strip_(promised.strip) {
    const int number = json.at("bufferView").reference(document.size(GltfArray::kBufferViews), "buffer view");
    const std::span<const std::byte> packed = document.view(static_cast<std::size_t>(number)).bytes;
    const DracoHeader header = read_header(json, packed, promised);
    // Of Draco's tables, measured from above.
    constexpr std::uint64_t kBytesPerTriangle = 160, kBytesOfSeams = 64;
    const std::uint64_t triangles = header.triangles;
    context_.charge((kBytesPerTriangle + kBytesOfSeams * header.seams) * triangles, json.place());
    unpacked_->mesh = header.edgebreaker
                          ? ChargedDecoder<draco::MeshEdgebreakerDecoder>(context_, json, header.points).decode(packed)
                          : ChargedDecoder<draco::MeshSequentialDecoder>(context_, json, header.points).decode(packed);
    if (!unpacked_->mesh) json.fail("the data of Draco are damaged");
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
    if (strip_) accessor.count = indices_.size();
    if (accessor.count != indices_.size())
        json_.fail(std::to_string(indices_.size()) + " indices are packed, the accessor has " +
                   std::to_string(accessor.count));
    if (!accessor.sparse_indices.empty()) json_.fail("packed indices are not sparse");
    accessor.component = ComponentType::kUnsignedInt;
    accessor.base = {reinterpret_cast<const std::byte*>(indices_.data()), sizeof(std::uint32_t), sizeof(std::uint32_t)};
}

}  // namespace tessera
