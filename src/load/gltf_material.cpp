// Materials: metallic-roughness, specular-glossiness, unlit, and the Phong family of TESSERA_materials_phong.
#include "load/gltf_material.h"

#include "load/gltf_parts.h"

#include <algorithm>

namespace tessera {
namespace {

class MaterialReader {
  public:
    MaterialReader(GltfDocument& document, const Json& json) : document_(document), json_(json) {}

    Material read() {
        document_.note_extensions(json_);
        m_.name = json_.string_or("name");
        m_.extras = json_.raw_or_empty("extras");
        if (const std::optional<Json> pbr = json_.find("pbrMetallicRoughness")) read_metallic_roughness(*pbr);
        if (const auto extension = find_extension(json_, "KHR_materials_ior")) read_ior(*extension);
        // Specular-glossiness has a reflectance of its own.
        if (const auto extension = find_extension(json_, "KHR_materials_pbrSpecularGlossiness"))
            read_specular_glossiness(*extension);
        else if (const auto specular = find_extension(json_, "KHR_materials_specular"))
            read_specular(*specular);
        read_material_extensions(document_, json_, m_);
        read_texture(json_, "emissiveTexture", TextureSlot::kEmissive);
        read_factor(json_, "emissiveFactor", {&m_.emissive.x, 3}, 1);
        if (const std::optional<Json> info = read_texture(json_, "normalTexture", TextureSlot::kNormal))
            m_.normal_scale = info->number_or("scale", 1);
        if (const std::optional<Json> info = read_texture(json_, "occlusionTexture", TextureSlot::kOcclusion))
            read_factor(*info, "strength", {&m_.occlusion_strength, 1}, 1);
        m_.double_sided = json_.boolean_or("doubleSided", false);
        read_alpha();
        if (const auto extension = find_extension(json_, "KHR_materials_emissive_strength"))
            read_factor(*extension, "emissiveStrength", {&m_.emissive_strength, 1}, kNoMaximum);
        if (const auto extension = find_extension(json_, "TESSERA_materials_phong")) read_phong(*extension);
        if (find_extension(json_, "KHR_materials_unlit")) m_.model = ShadingModel::kUnlit;
        return m_;
    }

  private:
    void read_factor(const Json& object, std::string_view key, std::span<float> out, float most) {
        tessera::read_factor(document_, object, key, out, most);
    }
    std::optional<Json> read_texture(const Json& object, std::string_view key, TextureSlot slot) {
        return tessera::read_texture(document_, object, key, m_.texture(slot));
    }

    void read_metallic_roughness(const Json& pbr) {
        document_.note_extensions(pbr);
        read_factor(pbr, "baseColorFactor", {&m_.base_color.x, 4}, 1);
        read_factor(pbr, "metallicFactor", {&m_.metallic, 1}, 1);
        read_factor(pbr, "roughnessFactor", {&m_.roughness, 1}, 1);
        read_texture(pbr, "baseColorTexture", TextureSlot::kBaseColor);
        read_texture(pbr, "metallicRoughnessTexture", TextureSlot::kMetallicRoughness);
    }

    // In place of what pbrMetallicRoughness says.
    void read_specular_glossiness(const Json& pbr) {
        document_.note_extensions(pbr);
        m_.model = ShadingModel::kSpecularGlossiness;
        m_.base_color = {1, 1, 1, 1};
        m_.metallic = 0;
        float glossiness = 1;
        read_factor(pbr, "diffuseFactor", {&m_.base_color.x, 4}, 1);
        read_factor(pbr, "specularFactor", {&m_.specular_color.x, 3}, 1);
        read_factor(pbr, "glossinessFactor", {&glossiness, 1}, 1);
        m_.roughness = 1 - glossiness;
        m_.texture(TextureSlot::kBaseColor) = m_.texture(TextureSlot::kMetallicRoughness) = {};
        read_texture(pbr, "diffuseTexture", TextureSlot::kBaseColor);
        read_texture(pbr, "specularGlossinessTexture", TextureSlot::kSpecularColor);
    }

    void read_ior(const Json& json) {
        read_factor(json, "ior", {&m_.ior, 1}, kNoMaximum);
        if (m_.ior >= 1 || m_.ior == 0) return;
        document_.context().warn(json.place() + ": an index of refraction below 1 is taken as 1");
        m_.ior = 1;
    }

    void read_specular(const Json& json) {
        read_factor(json, "specularFactor", {&m_.specular_strength, 1}, 1);
        read_factor(json, "specularColorFactor", {&m_.specular_color.x, 3}, kNoMaximum);
        read_texture(json, "specularTexture", TextureSlot::kSpecular);
        read_texture(json, "specularColorTexture", TextureSlot::kSpecularColor);
    }

    void read_alpha() {
        read_factor(json_, "alphaCutoff", {&m_.alpha_cutoff, 1}, kNoMaximum);
        const std::optional<Json> mode = json_.find("alphaMode");
        if (!mode || mode->string() == "OPAQUE") return;
        if (mode->string() == "MASK")
            m_.alpha_mode = AlphaMode::kMask;
        else if (mode->string() == "BLEND")
            m_.alpha_mode = AlphaMode::kBlend;
        else
            document_.context().warn(mode->place() + ": alpha mode " + mode->raw() + " is taken as OPAQUE");
    }

    void read_phong(const Json& phong) {
        const std::optional<Json> model = phong.find("model");
        const std::string_view name = model ? model->string() : "phong";
        if (name == "lambert")
            m_.model = ShadingModel::kLambert;
        else if (name == "phong")
            m_.model = ShadingModel::kPhong;
        else if (name == "blinn-phong")
            m_.model = ShadingModel::kBlinnPhong;
        else
            model->fail("there is no model " + model->raw() + "; there are lambert, phong and blinn-phong");
        m_.diffuse = {m_.base_color.x, m_.base_color.y, m_.base_color.z};
        read_factor(phong, "ambient", {&m_.ambient.x, 3}, kNoMaximum);
        read_factor(phong, "diffuse", {&m_.diffuse.x, 3}, kNoMaximum);
        read_factor(phong, "specular", {&m_.specular.x, 3}, kNoMaximum);
        read_factor(phong, "shininess", {&m_.shininess, 1}, kNoMaximum);
        read_factor(phong, "emission", {&m_.emissive.x, 3}, kNoMaximum);
        read_factor(phong, "mirror", {&m_.mirror.x, 3}, 1);
        read_texture(phong, "diffuseTexture", TextureSlot::kBaseColor);
    }

    GltfDocument& document_;
    const Json& json_;
    Material m_;
};

}  // namespace

void read_factor(GltfDocument& document, const Json& object, std::string_view key, std::span<float> out, float most,
                 float least) {
    const std::optional<Json> value = object.find(key);
    if (!value) return;
    if (out.size() == 1)
        out[0] = value->number();
    else
        value->numbers(out);
    bool clamped = false;
    for (float& factor : out) {
        const float legal = std::clamp(factor, least, most);
        clamped = clamped || legal != factor;
        factor = legal;
    }
    if (clamped) document.context().warn(value->place() + ": a factor is out of range and is clamped");
}

std::optional<Json> read_texture(GltfDocument& document, const Json& object, std::string_view key, TextureRef& ref) {
    std::optional<Json> info = object.find(key);
    if (!info) return info;
    constexpr std::uint64_t kMostUvSet = 0xffff;
    document.note_extensions(*info);
    ref = {};
    ref.texture = info->at("index").reference(document.size(GltfArray::kTextures), "texture");
    if (const std::optional<Json> set = info->find("texCoord")) ref.uv_set = static_cast<int>(set->integer(kMostUvSet));
    if (const auto transform = find_extension(*info, "KHR_texture_transform")) {
        transform->numbers_or_keep("offset", {&ref.offset.x, 2});
        transform->numbers_or_keep("scale", {&ref.scale.x, 2});
        ref.rotation = transform->number_or("rotation", 0);
        if (const std::optional<Json> set = transform->find("texCoord"))
            ref.uv_set = static_cast<int>(set->integer(kMostUvSet));
    }
    return info;
}

void read_materials(GltfDocument& document, Scene& scene) {
    make_room(document, GltfArray::kMaterials, scene.materials);
    document.each(GltfArray::kMaterials,
                  [&](const Json& json, std::size_t i) { scene.materials[i] = MaterialReader(document, json).read(); });
}

}  // namespace tessera
