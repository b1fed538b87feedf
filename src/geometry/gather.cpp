#include "geometry/gather.h"

#include <cstddef>
#include <vector>

namespace tessera {
namespace {

template <class T>
std::vector<T> gather(const std::vector<T>& values, std::span<const std::uint32_t> sources) {
    std::vector<T> result;
    if (values.empty()) return result;  // an absent attribute stays absent
    result.reserve(sources.size());
    for (const std::uint32_t s : sources) result.push_back(values[s]);
    return result;
}

template <class T>
std::vector<std::vector<T>> gather_sets(const std::vector<std::vector<T>>& sets,
                                        std::span<const std::uint32_t> sources) {
    std::vector<std::vector<T>> result;
    result.reserve(sets.size());
    for (const std::vector<T>& set : sets) result.push_back(gather(set, sources));
    return result;
}

CustomAttribute gather_custom(const CustomAttribute& attribute, std::span<const std::uint32_t> sources) {
    CustomAttribute result{attribute.name, attribute.components, {}};
    if (attribute.values.empty()) return result;
    const auto components = static_cast<std::size_t>(attribute.components);
    result.values.reserve(sources.size() * components);
    for (const std::uint32_t s : sources) {
        const auto first = attribute.values.begin() + static_cast<std::ptrdiff_t>(s * components);
        result.values.insert(result.values.end(), first, first + attribute.components);
    }
    return result;
}

}  // namespace

Primitive gather_vertices(const Primitive& primitive, std::span<const std::uint32_t> sources) {
    Primitive result;
    result.mode = PrimitiveMode::kTriangles;
    result.material = primitive.material;
    result.extras = primitive.extras;
    result.positions = gather(primitive.positions, sources);
    result.normals = gather(primitive.normals, sources);
    result.tangents = gather(primitive.tangents, sources);
    result.texcoords = gather_sets(primitive.texcoords, sources);
    result.colors = gather_sets(primitive.colors, sources);
    result.joints = gather_sets(primitive.joints, sources);
    result.weights = gather_sets(primitive.weights, sources);
    for (const CustomAttribute& attribute : primitive.custom)
        result.custom.push_back(gather_custom(attribute, sources));
    for (const MorphTarget& target : primitive.targets)
        result.targets.push_back(
            {gather(target.positions, sources), gather(target.normals, sources), gather(target.tangents, sources)});
    return result;
}

}  // namespace tessera
