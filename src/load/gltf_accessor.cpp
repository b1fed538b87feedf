#include "load/gltf_accessor.h"

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

struct AccessorShape {
    std::string_view name;
    std::size_t rows, columns;
};
// Elements of an accessor that is all zeros but for sparse ones.
constexpr std::size_t kMostZeros = std::size_t{1} << 24;

constexpr std::array<AccessorShape, 7> kShapes = {
    {{"SCALAR", 1, 1}, {"VEC2", 2, 1}, {"VEC3", 3, 1}, {"VEC4", 4, 1}, {"MAT2", 2, 2}, {"MAT3", 3, 3}, {"MAT4", 4, 4}}};

ComponentType component_type(const Json& json) {
    const std::uint64_t value = json.integer();
    if (value < 5120 || value > 5126 || value == 5124) json.fail("there is no component type " + std::to_string(value));
    return static_cast<ComponentType>(value);
}

std::uint64_t element_count(const Json& accessor) {
    const Json count = accessor.at("count");
    // 2^40 elements: beyond any memory, and sums of products with strides stay far from 2^64.
    const std::uint64_t value = count.integer(std::uint64_t{1} << 40);
    if (value == 0) count.fail("must be at least 1");
    return value;
}

// Checks that `count` elements of `used` bytes each, `stride` apart, fit into the view from `offset` on.
const std::byte* fit(const Json& json, const BufferView& view, std::uint64_t offset, std::uint64_t count,
                     std::uint64_t stride, std::uint64_t used) {
    const std::uint64_t needed = stride * (count - 1) + used;
    if (offset > view.bytes.size() || needed > view.bytes.size() - offset)
        json.fail(std::to_string(count) + " elements need " + std::to_string(needed) + " bytes from offset " +
                  std::to_string(offset) + ", the buffer view has " + std::to_string(view.bytes.size()));
    return view.bytes.data() + offset;
}

// The indices that a sparse accessor replaces: ascending, below `count`.
std::vector<std::uint32_t> sparse_indices(GltfDocument& document, const Json& json, std::uint64_t replaced,
                                          std::uint64_t count) {
    const auto number = json.at("bufferView").reference(document.size(GltfArray::kBufferViews), "buffer view");
    const ComponentType type = component_type(json.at("componentType"));
    if (type != ComponentType::kUnsignedByte && type != ComponentType::kUnsignedShort &&
        type != ComponentType::kUnsignedInt)
        json.at("componentType").fail("sparse indices must be unsigned integers");
    const std::size_t bytes = component_bytes(type);
    const BufferView view = document.view(static_cast<std::size_t>(number));
    const std::byte* data = fit(json, view, json.integer_or("byteOffset", 0), replaced, bytes, bytes);
    document.context().charge(replaced * sizeof(std::uint32_t), json.place());
    std::vector<std::uint32_t> indices(static_cast<std::size_t>(replaced));
    for (std::size_t i = 0; i < indices.size(); ++i) {
        std::uint32_t index = 0;
        std::memcpy(&index, data + i * bytes, bytes);  // little-endian
        if (index >= count || (i > 0 && index <= indices[i - 1]))
            json.fail("sparse index " + std::to_string(i) + " is " + std::to_string(index) +
                      (index >= count ? ", the accessor has " + std::to_string(count) + " elements"
                                      : ", not above the one before it"));
        indices[i] = index;
    }
    return indices;
}

}  // namespace

std::size_t component_bytes(ComponentType type) {
    switch (type) {
        case ComponentType::kByte:
        case ComponentType::kUnsignedByte:
            return 1;
        case ComponentType::kShort:
        case ComponentType::kUnsignedShort:
            return 2;
        default:
            return 4;
    }
}

std::uint64_t accessor_count(const GltfDocument& document, std::size_t index) {
    return element_count(document.item(GltfArray::kAccessors, index));
}

void check_zeros(const Accessor& a) {
    if (!a.base.data && a.count > kMostZeros)
        a.json.fail(std::to_string(a.count) + " elements without a buffer view: at most " + std::to_string(kMostZeros),
                    ErrorCode::kLimit);
}

Accessor open_accessor(GltfDocument& document, std::size_t index, Zeros zeros) {
    Accessor a{.json = document.item(GltfArray::kAccessors, index),
               .type = {},
               .base = {},
               .sparse_indices = {},
               .sparse_values = {}};
    const Json& json = a.json;
    document.note_extensions(json);
    a.component = component_type(json.at("componentType"));
    a.type = json.at("type").string();
    const auto* const shape =
        std::find_if(kShapes.begin(), kShapes.end(), [&](const AccessorShape& s) { return s.name == a.type; });
    if (shape == kShapes.end()) json.at("type").fail("there is no accessor type \"" + std::string(a.type) + "\"");
    a.rows = shape->rows, a.columns = shape->columns;
    a.normalized = json.boolean_or("normalized", false);
    a.count = static_cast<std::size_t>(element_count(json));

    // Each column of a matrix begins at a multiple of four bytes (section 3.6.2.4).
    const std::size_t column_bytes = a.rows * component_bytes(a.component);
    const std::size_t column_stride = a.columns > 1 ? (column_bytes + 3) / 4 * 4 : column_bytes;
    const std::size_t packed = column_stride * a.columns;
    const std::size_t used = column_stride * (a.columns - 1) + column_bytes;
    if (const std::optional<Json> number = json.find("bufferView")) {
        const BufferView view = document.view(
            static_cast<std::size_t>(number->reference(document.size(GltfArray::kBufferViews), "buffer view")));
        a.base = {nullptr, view.stride ? view.stride : packed, column_stride};
        if (a.base.stride < used)
            number->fail("elements of " + std::to_string(used) + " bytes with a stride of " +
                         std::to_string(a.base.stride));
        a.base.data = fit(json, view, json.integer_or("byteOffset", 0), a.count, a.base.stride, used);
    } else if (zeros == Zeros::kLimited) {
        check_zeros(a);
    }
    if (const std::optional<Json> sparse = json.find("sparse")) {
        const std::uint64_t replaced = sparse->at("count").integer();
        if (replaced == 0 || replaced > a.count)
            sparse->at("count").fail(std::to_string(replaced) + " sparse elements for " + std::to_string(a.count));
        a.sparse_indices = sparse_indices(document, sparse->at("indices"), replaced, a.count);
        const Json values = sparse->at("values");
        const BufferView view = document.view(static_cast<std::size_t>(
            values.at("bufferView").reference(document.size(GltfArray::kBufferViews), "buffer view")));
        a.sparse_values = {fit(values, view, values.integer_or("byteOffset", 0), replaced, packed, used), packed,
                           column_stride};
    }
    return a;
}

void expect_format(const Json& referrer, const Accessor& a, std::string_view type, unsigned formats) {
    if (!type.empty() && a.type != type)
        referrer.fail("needs an accessor of type " + std::string(type) + ", not " + std::string(a.type));
    unsigned format = 0;
    switch (a.component) {
        case ComponentType::kFloat:
            format = kFloats;
            break;
        case ComponentType::kUnsignedInt:
            format = kUnsignedInts;
            break;
        case ComponentType::kByte:
        case ComponentType::kShort:
            format = a.normalized ? kNormalizedSigned : kPlainSigned;
            break;
        default:
            format = a.normalized ? kNormalizedUnsigned : kPlainUnsigned;
    }
    if ((format & formats) == 0)
        referrer.fail("component type " + std::to_string(static_cast<int>(a.component)) +
                      (a.normalized ? ", normalised," : "") + " is not allowed here");
}

}  // namespace tessera
