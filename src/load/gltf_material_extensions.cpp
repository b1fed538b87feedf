// The extensions of materials that are data of their own: names, ranges and defaults as each defines them.
#include "load/gltf_material.h"

namespace tessera {
namespace {

void read_clearcoat(GltfDocument& d, const Json& json, Material& m) {
    Clearcoat& c = m.clearcoat;
    read_factor(d, json, "clearcoatFactor", c.strength);
    read_factor(d, json, "clearcoatRoughnessFactor", c.roughness);
    read_texture(d, json, "clearcoatTexture", c.strength_texture);
    read_texture(d, json, "clearcoatRoughnessTexture", c.roughness_texture);
    if (const std::optional<Json> info = read_texture(d, json, "clearcoatNormalTexture", c.normal_texture))
        c.normal_scale = info->number_or("scale", 1);
}

void read_sheen(GltfDocument& d, const Json& json, Material& m) {
    read_factor(d, json, "sheenColorFactor", m.sheen.color);
    read_factor(d, json, "sheenRoughnessFactor", m.sheen.roughness);
    read_texture(d, json, "sheenColorTexture", m.sheen.color_texture);
    read_texture(d, json, "sheenRoughnessTexture", m.sheen.roughness_texture);
}

void read_transmission(GltfDocument& d, const Json& json, Material& m) {
    read_factor(d, json, "transmissionFactor", m.transmission);
    read_texture(d, json, "transmissionTexture", m.texture(TextureSlot::kTransmission));
}

void read_volume(GltfDocument& d, const Json& json, Material& m) {
    Volume& v = m.volume;
    read_factor(d, json, "thicknessFactor", v.thickness, kNoMaximum);
    read_texture(d, json, "thicknessTexture", v.thickness_texture);
    read_factor(d, json, "attenuationColor", v.attenuation_color);
    if (const std::optional<Json> ours = find_extension(json, "TESSERA_volume")) {
        constexpr float kMost = 1000;
        const float priority = ours->number_or("priority", 0);
        if (!(priority >= -kMost && priority <= kMost && priority == static_cast<float>(static_cast<int>(priority))))
            ours->fail("a priority is a whole number of -1000 to 1000");
        v.priority = static_cast<int>(priority);
    }
    const std::optional<Json> distance = json.find("attenuationDistance");
    if (!distance) return;
    if (const float metres = distance->number(); metres > 0)
        v.attenuation_distance = metres;
    else
        d.context().warn(distance->place() + ": a distance of no length is taken as infinite");
}

void read_anisotropy(GltfDocument& d, const Json& json, Material& m) {
    read_factor(d, json, "anisotropyStrength", m.anisotropy.strength);
    read_factor(d, json, "anisotropyRotation", m.anisotropy.rotation, kNoMaximum, -kNoMaximum);
    read_texture(d, json, "anisotropyTexture", m.anisotropy.texture);
}

void read_iridescence(GltfDocument& d, const Json& json, Material& m) {
    Iridescence& i = m.iridescence;
    read_factor(d, json, "iridescenceFactor", i.strength);
    read_factor(d, json, "iridescenceIor", i.ior, kNoMaximum, 1);
    read_factor(d, json, "iridescenceThicknessMinimum", i.thickness_at_black, kNoMaximum);
    read_factor(d, json, "iridescenceThicknessMaximum", i.thickness_at_white, kNoMaximum);
    read_texture(d, json, "iridescenceTexture", i.texture);
    read_texture(d, json, "iridescenceThicknessTexture", i.thickness_texture);
}

void read_dispersion(GltfDocument& d, const Json& json, Material& m) {
    read_factor(d, json, "dispersion", m.dispersion, kNoMaximum);
}

struct Extension {
    std::string_view name;
    void (*read)(GltfDocument& document, const Json& json, Material& m);
};
constexpr Extension kExtensions[] = {
    {"KHR_materials_clearcoat", &read_clearcoat},       {"KHR_materials_sheen", &read_sheen},
    {"KHR_materials_transmission", &read_transmission}, {"KHR_materials_volume", &read_volume},
    {"KHR_materials_anisotropy", &read_anisotropy},     {"KHR_materials_iridescence", &read_iridescence},
    {"KHR_materials_dispersion", &read_dispersion},
};

}  // namespace

void read_material_extensions(GltfDocument& document, const Json& material, Material& m) {
    for (const Extension& extension : kExtensions)
        if (const std::optional<Json> json = find_extension(material, extension.name)) {
            document.note_extensions(*json);
            extension.read(document, *json, m);
        }
}

}  // namespace tessera
