// Copying the elements of an accessor. Tightly packed numbers of the wanted type go by block copies;
// everything else through one loop per component type.
#include "load/gltf_accessor.h"

#include "scene/numbers.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace tessera {
namespace {

// Elements copied at once and then scanned while they are still in the nearest cache.
constexpr std::size_t kBlockBytes = 32 * 1024;

// How a stored component becomes a number (glTF 2.0, section 3.6.2.2).
template <class C>
float to_float(C value, bool normalized) {
    const auto plain = static_cast<float>(value);
    if constexpr (std::is_floating_point_v<C> || sizeof(C) == 4) {
        return plain;
    } else {
        if (!normalized) return plain;
        const float scaled = plain / static_cast<float>(std::numeric_limits<C>::max());
        return scaled > -1.0f ? scaled : -1.0f;
    }
}

template <class C>
C component_at(const std::byte* data) {
    C value;
    std::memcpy(&value, data, sizeof value);
    return value;
}

template <class C>
void copy_element(const Accessor& a, const Elements& from, std::size_t i, float* out) {
    for (std::size_t column = 0; column < a.columns; ++column)
        for (std::size_t row = 0; row < a.rows; ++row)
            *out++ =
                to_float(component_at<C>(from.data + i * from.stride + column * from.column_stride + row * sizeof(C)),
                         a.normalized);
}

template <class C>
void copy_all(const Accessor& a, float* out) {
    const std::size_t n = a.components();
    if (a.base.data)
        for (std::size_t i = 0; i < a.count; ++i) copy_element<C>(a, a.base, i, out + i * n);
    for (std::size_t i = 0; i < a.sparse_indices.size(); ++i)
        copy_element<C>(a, a.sparse_values, i, out + a.sparse_indices[i] * n);
}

void copy_any(const Accessor& a, float* out) {
    switch (a.component) {
        case ComponentType::kByte:
            return copy_all<std::int8_t>(a, out);
        case ComponentType::kUnsignedByte:
            return copy_all<std::uint8_t>(a, out);
        case ComponentType::kShort:
            return copy_all<std::int16_t>(a, out);
        case ComponentType::kUnsignedShort:
            return copy_all<std::uint16_t>(a, out);
        case ComponentType::kUnsignedInt:
            return copy_all<std::uint32_t>(a, out);
        case ComponentType::kFloat:
            return copy_all<float>(a, out);
    }
}

[[noreturn]] void fail_not_finite(const Accessor& a, std::span<const float> numbers) {
    a.json.fail("element " + std::to_string(first_not_finite(numbers) / a.components()) + " is not finite");
}

// Whether the elements lie in memory as an array of T would, aligned for it.
template <class T>
bool is_array_of(const Accessor& a) {
    return a.base.data && a.sparse_indices.empty() && a.base.stride == sizeof(T) &&
           reinterpret_cast<std::uintptr_t>(a.base.data) % alignof(T) == 0;
}

// Appends n values without first filling them with zeros.
template <class T, class Block>
std::vector<T> copy_blocks(const std::byte* data, std::size_t n, Block&& after_block) {
    std::vector<T> values;
    values.reserve(n);
    const auto* const from = reinterpret_cast<const T*>(data);
    constexpr std::size_t kBlock = kBlockBytes / sizeof(T);
    for (std::size_t begin = 0; begin < n; begin += kBlock) {
        const std::size_t size = std::min(kBlock, n - begin);
        values.insert(values.end(), from + begin, from + begin + size);
        after_block(std::span<const T>(values).subspan(begin, size));
    }
    return values;
}

// Interleaved floats: the common case beside tightly packed ones.
template <class T>
void copy_strided(const Accessor& a, std::vector<T>& values) {
    for (std::size_t i = 0; i < a.count; ++i) std::memcpy(&values[i], a.base.data + i * a.base.stride, sizeof(T));
}

}  // namespace

template <class T>
std::vector<T> read_floats(GltfDocument& document, const Accessor& a) {
    const std::size_t n = std::is_same_v<T, float> ? a.count * a.components() : a.count;
    document.context().charge(std::uint64_t{n} * sizeof(T), a.json.place());
    const bool floats = a.component == ComponentType::kFloat;
    if (floats && a.components() * sizeof(float) == sizeof(T) && is_array_of<T>(a)) {
        bool finite = true;
        std::vector<T> values = copy_blocks<T>(a.base.data, n, [&](std::span<const T> block) {
            finite = all_finite({reinterpret_cast<const float*>(block.data()), block.size_bytes() / 4}) && finite;
        });
        if (!finite) fail_not_finite(a, as_floats(values));
        return values;
    }
    std::vector<T> values(n);
    if (floats && a.components() * sizeof(float) == sizeof(T) && a.base.data && a.sparse_indices.empty())
        copy_strided(a, values);
    else if (!values.empty())
        copy_any(a, reinterpret_cast<float*>(values.data()));
    if (floats && !all_finite(as_floats(values))) fail_not_finite(a, as_floats(values));
    return values;
}

template std::vector<float> read_floats<float>(GltfDocument&, const Accessor&);
template std::vector<Vec2> read_floats<Vec2>(GltfDocument&, const Accessor&);
template std::vector<Vec3> read_floats<Vec3>(GltfDocument&, const Accessor&);
template std::vector<Vec4> read_floats<Vec4>(GltfDocument&, const Accessor&);
template std::vector<Mat4> read_floats<Mat4>(GltfDocument&, const Accessor&);

namespace {

// Unsigned integers of type C, `n` per element, widened or copied to Out.
template <class C, class Out>
void copy_integers(const Accessor& a, Out* out) {
    const std::size_t n = a.components();
    const auto copy = [&](const Elements& from, std::size_t i, std::size_t to) {
        for (std::size_t c = 0; c < n; ++c)
            out[to * n + c] = static_cast<Out>(component_at<C>(from.data + i * from.stride + c * sizeof(C)));
    };
    if (a.base.data)
        for (std::size_t i = 0; i < a.count; ++i) copy(a.base, i, i);
    for (std::size_t i = 0; i < a.sparse_indices.size(); ++i) copy(a.sparse_values, i, a.sparse_indices[i]);
}

}  // namespace

std::vector<std::uint32_t> read_indices(GltfDocument& document, const Accessor& a) {
    document.context().charge(std::uint64_t{a.count} * sizeof(std::uint32_t), a.json.place());
    if (a.component == ComponentType::kUnsignedInt && is_array_of<std::uint32_t>(a))
        return copy_blocks<std::uint32_t>(a.base.data, a.count, [](std::span<const std::uint32_t>) {});
    std::vector<std::uint32_t> indices(a.count);
    if (a.component == ComponentType::kUnsignedByte)
        copy_integers<std::uint8_t>(a, indices.data());
    else if (a.component == ComponentType::kUnsignedShort)
        copy_integers<std::uint16_t>(a, indices.data());
    else
        copy_integers<std::uint32_t>(a, indices.data());
    return indices;
}

std::vector<std::array<std::uint16_t, 4>> read_joints(GltfDocument& document, const Accessor& a) {
    document.context().charge(std::uint64_t{a.count} * 8, a.json.place());
    std::vector<std::array<std::uint16_t, 4>> joints(a.count);
    if (a.component == ComponentType::kUnsignedByte)
        copy_integers<std::uint8_t>(a, joints.data()->data());
    else
        copy_integers<std::uint16_t>(a, joints.data()->data());
    return joints;
}

}  // namespace tessera
