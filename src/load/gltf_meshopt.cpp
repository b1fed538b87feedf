#include "load/gltf_meshopt.h"

#include <meshoptimizer.h>

#include <string_view>

namespace tessera {
namespace {

void decode(const Json& json, std::string_view mode, Bytes& bytes, std::size_t count, std::size_t stride,
            std::span<const std::byte> packed) {
    const auto* const from = reinterpret_cast<const unsigned char*>(packed.data());
    int error = 0;
    if (mode == "ATTRIBUTES") {
        if (stride % 4 != 0 || stride > 256)
            json.at("byteStride").fail("attributes are packed in multiples of 4 bytes up to 256");
        error = meshopt_decodeVertexBuffer(bytes.data(), count, stride, from, packed.size());
    } else if (mode == "TRIANGLES" || mode == "INDICES") {
        if (stride != 2 && stride != 4) json.at("byteStride").fail("indices have 2 or 4 bytes");
        if (mode == "TRIANGLES" && count % 3 != 0) json.at("count").fail("triangles have three indices each");
        error = mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, from, packed.size())
                                    : meshopt_decodeIndexSequence(bytes.data(), count, stride, from, packed.size());
    } else {
        json.at("mode").fail("there is no mode " + json.at("mode").raw());
    }
    if (error != 0) json.fail("the packed data are damaged");
}

void filter(const Json& json, std::string_view name, Bytes& bytes, std::size_t count, std::size_t stride) {
    if (name == "NONE") return;
    if (name == "OCTAHEDRAL") {
        if (stride != 4 && stride != 8) json.at("byteStride").fail("octahedral vectors have 4 or 8 bytes");
        meshopt_decodeFilterOct(bytes.data(), count, stride);
    } else if (name == "QUATERNION") {
        if (stride != 8) json.at("byteStride").fail("packed quaternions have 8 bytes");
        meshopt_decodeFilterQuat(bytes.data(), count, stride);
    } else if (name == "EXPONENTIAL") {
        meshopt_decodeFilterExp(bytes.data(), count, stride);
    } else {
        json.at("filter").fail("there is no filter " + json.at("filter").raw());
    }
}

}  // namespace

Bytes unpack_meshopt(LoadContext& context, const Json& json, std::span<const std::byte> packed) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
    const std::uint64_t count = json.at("count").integer(kMost), stride = json.at("byteStride").integer(256);
    if (count == 0 || stride == 0) json.fail("nothing is packed");
    context.charge(count * stride, json.place());
    Bytes bytes(static_cast<std::size_t>(count * stride));
    const std::string mode = json.string_or("mode"), name = json.string_or("filter", "NONE");
    decode(json, mode, bytes, static_cast<std::size_t>(count), static_cast<std::size_t>(stride), packed);
    if (name != "NONE" && mode != "ATTRIBUTES") json.at("filter").fail("only attributes are filtered");
    filter(json, name, bytes, static_cast<std::size_t>(count), static_cast<std::size_t>(stride));
    return bytes;
}

}  // namespace tessera
