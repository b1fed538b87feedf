// Accessors: arrays of numbers inside buffer views, with stride, normalised integers, padded matrix
// columns and sparse replacements (glTF 2.0, section 3.6.2). open_accessor() checks everything; the
// readers then copy without further checks, after charging the memory that they take.
#pragma once

#include "load/gltf_document.h"

#include <tessera/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

enum class ComponentType : std::uint16_t {
    kByte = 5120,
    kUnsignedByte = 5121,
    kShort = 5122,
    kUnsignedShort = 5123,
    kUnsignedInt = 5125,
    kFloat = 5126
};

std::size_t component_bytes(ComponentType type);

// Elements in memory: element i begins at data + i * stride, its columns column_stride apart.
struct Elements {
    const std::byte* data = nullptr;
    std::size_t stride = 0, column_stride = 0;
};

struct Accessor {
    Json json;
    std::string_view type;  // "VEC3"
    ComponentType component = ComponentType::kFloat;
    bool normalized = false;
    std::size_t count = 0;
    std::size_t rows = 1, columns = 1;  // a vector is one column
    Elements base;                      // data null: all zeros
    std::vector<std::uint32_t> sparse_indices;
    Elements sparse_values;

    std::size_t components() const { return rows * columns; }
};

// What a caller accepts, as a set of component formats.
enum ComponentFormats : unsigned {
    kFloats = 1,
    kNormalizedUnsigned = 2,  // 8 and 16 bits
    kNormalizedSigned = 4,
    kPlainUnsigned = 8,  // 8 and 16 bits, as they are
    kPlainSigned = 16,
    kUnsignedInts = 32,  // 32 bits
    kQuantized = kFloats | kNormalizedUnsigned | kNormalizedSigned | kPlainUnsigned | kPlainSigned,
};

// Only the number of elements, for counting before anything is read.
std::uint64_t accessor_count(const GltfDocument& document, std::size_t index);

// An accessor without a buffer view is all zeros. A few bytes of file may not ask for gigabytes of them, unless
// somebody else brings the elements; then check_zeros() comes after that. Both throw kLimit.
enum class Zeros { kLimited, kToBeReplaced };
Accessor open_accessor(GltfDocument& document, std::size_t index, Zeros zeros = Zeros::kLimited);
void check_zeros(const Accessor& accessor);
// Throws kInput, at the place that refers to the accessor, unless type and format are wanted.
void expect_format(const Json& referrer, const Accessor& accessor, std::string_view type, unsigned formats);

// Every number as a float, element by element; normalised integers become -1 .. 1. Throws kInput for
// a number that is not finite. `T` is float or a vector of floats with as many as the accessor has;
// float takes any accessor, flattened.
template <class T>
std::vector<T> read_floats(GltfDocument& document, const Accessor& accessor);

// Unsigned integers (8, 16 or 32 bits) of a SCALAR accessor.
std::vector<std::uint32_t> read_indices(GltfDocument& document, const Accessor& accessor);
// Unsigned integers (8 or 16 bits) of a VEC4 accessor.
std::vector<std::array<std::uint16_t, 4>> read_joints(GltfDocument& document, const Accessor& accessor);

}  // namespace tessera
