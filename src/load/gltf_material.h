// What the readers of materials share: factors within their ranges, texture references, and the
// extensions that add data to a material.
#pragma once

#include "load/gltf_document.h"

#include <tessera/material.h>

#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace tessera {

inline constexpr float kNoMaximum = std::numeric_limits<float>::max();

// The member `key` of the object, a number or as many numbers as `out` has, clamped to least .. most with a
// warning. Without the member `out` stays.
void read_factor(GltfDocument& document, const Json& object, std::string_view key, std::span<float> out, float most = 1,
                 float least = 0);
inline void read_factor(GltfDocument& document, const Json& object, std::string_view key, float& out, float most = 1,
                        float least = 0) {
    read_factor(document, object, key, std::span(&out, 1), most, least);
}
inline void read_factor(GltfDocument& document, const Json& object, std::string_view key, Vec3& out, float most = 1) {
    read_factor(document, object, key, std::span(&out.x, 3), most);
}

// The member `key` of the object as a texture information object, KHR_texture_transform included; returns
// it when it is there.
std::optional<Json> read_texture(GltfDocument& document, const Json& object, std::string_view key, TextureRef& ref);

// KHR_materials_clearcoat, sheen, transmission, volume, anisotropy, iridescence and dispersion.
void read_material_extensions(GltfDocument& document, const Json& material, Material& m);

}  // namespace tessera
