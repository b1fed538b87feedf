#include "cli/material_summary.h"

#include <cstdio>
#include <string_view>

namespace tessera::cli {
namespace {

const char* model_name(const Material& material) {
    switch (material.model) {
        case ShadingModel::kMetallicRoughness:
            return "metallic-roughness";
        case ShadingModel::kUnlit:
            return "unlit";
        case ShadingModel::kLambert:
            return "lambert";
        case ShadingModel::kPhong:
            return "phong";
        case ShadingModel::kBlinnPhong:
            return "blinn-phong";
        case ShadingModel::kSpecularGlossiness:
            return "specular-glossiness";
    }
    return "";
}

const char* alpha_name(const Material& material) {
    switch (material.alpha_mode) {
        case AlphaMode::kOpaque:
            return "opaque";
        case AlphaMode::kMask:
            return "mask";
        case AlphaMode::kBlend:
            return "blend";
    }
    return "";
}

bool is_textured(const TextureRef& ref) { return ref.texture != kNone; }

// An object of the report, closed at its end. Textures are left out where there are none.
class Part {
  public:
    Part(JsonWriter& json, std::string_view name) : json_(json) { json_.key(name).begin_object(); }
    ~Part() { json_.end_object(); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    Part& number(std::string_view name, float value) {
        json_.member(name, value);
        return *this;
    }
    Part& color(std::string_view name, Vec3 value) {
        json_.key(name);
        write(json_, value);
        return *this;
    }
    Part& texture(std::string_view name, const TextureRef& ref) {
        if (is_textured(ref)) json_.member(name, ref.texture);
        return *this;
    }

  private:
    JsonWriter& json_;
};

// What the model has beside its base colour.
void write_reflection(JsonWriter& json, const Material& m) {
    switch (m.model) {
        case ShadingModel::kUnlit:
            return;
        case ShadingModel::kMetallicRoughness:
            Part(json, "specular")
                .number("strength", m.specular_strength)
                .color("color", m.specular_color)
                .texture("strength_texture", m.texture(TextureSlot::kSpecular))
                .texture("color_texture", m.texture(TextureSlot::kSpecularColor));
            return;
        case ShadingModel::kSpecularGlossiness:
            Part(json, "specular_glossiness")
                .color("specular", m.specular_color)
                .number("glossiness", 1 - m.roughness)
                .texture("texture", m.texture(TextureSlot::kSpecularColor));
            return;
        case ShadingModel::kLambert:
            Part(json, "textbook").color("ambient", m.ambient).color("diffuse", m.diffuse);
            return;
        case ShadingModel::kPhong:
        case ShadingModel::kBlinnPhong:
            Part(json, "textbook")
                .color("ambient", m.ambient)
                .color("diffuse", m.diffuse)
                .color("specular", m.specular)
                .number("shininess", m.shininess)
                .texture("specular_texture", m.texture(TextureSlot::kSpecularColor))
                .texture("shininess_texture", m.texture(TextureSlot::kSpecular));
    }
}

}  // namespace

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

void write(JsonWriter& json, Vec3 v) { json.begin_array().value(v.x).value(v.y).value(v.z).end_array(); }

std::string material_text(const Material& m) {
    const Material plain;
    std::string text = model_name(m);
    text.append(", ").append(alpha_name(m));
    const auto add = [&text](bool there, std::string_view name, float value, std::string_view unit = {}) {
        if (!there) return;
        text.append(", ").append(name).append(" ").append(number(static_cast<double>(value))).append(unit);
    };
    add(m.ior != plain.ior, "ior", m.ior);
    const bool specular = is_textured(m.texture(TextureSlot::kSpecular)) ||
                          is_textured(m.texture(TextureSlot::kSpecularColor)) ||
                          !(m.specular_color == plain.specular_color) || m.specular_strength != plain.specular_strength;
    add(specular && m.model == ShadingModel::kMetallicRoughness, "specular", m.specular_strength);
    add(!(m.clearcoat == plain.clearcoat), "clearcoat", m.clearcoat.strength);
    add(!(m.sheen == plain.sheen), "sheen roughness", m.sheen.roughness);
    add(m.transmission != 0, "transmission", m.transmission);
    add(!(m.volume == plain.volume), "volume", m.volume.thickness, " m");
    add(!(m.anisotropy == plain.anisotropy), "anisotropy", m.anisotropy.strength);
    add(!(m.iridescence == plain.iridescence), "iridescence", m.iridescence.strength);
    add(m.dispersion != 0, "dispersion", m.dispersion);
    return text;
}

void write_material(JsonWriter& json, const Material& m) {
    const Material plain;
    json.member("model", model_name(m)).member("alpha_mode", alpha_name(m)).member("ior", m.ior);
    write_reflection(json, m);
    if (const Clearcoat& c = m.clearcoat; !(c == plain.clearcoat))
        Part(json, "clearcoat")
            .number("strength", c.strength)
            .number("roughness", c.roughness)
            .number("normal_scale", c.normal_scale)
            .texture("strength_texture", c.strength_texture)
            .texture("roughness_texture", c.roughness_texture)
            .texture("normal_texture", c.normal_texture);
    if (const Sheen& s = m.sheen; !(s == plain.sheen))
        Part(json, "sheen")
            .color("color", s.color)
            .number("roughness", s.roughness)
            .texture("color_texture", s.color_texture)
            .texture("roughness_texture", s.roughness_texture);
    if (m.transmission != 0)
        Part(json, "transmission")
            .number("strength", m.transmission)
            .texture("texture", m.texture(TextureSlot::kTransmission));
    if (const Volume& v = m.volume; !(v == plain.volume)) {
        Part part(json, "volume");
        part.number("thickness_m", v.thickness).texture("thickness_texture", v.thickness_texture);
        if (v.attenuation_distance) part.number("attenuation_distance_m", *v.attenuation_distance);
        part.color("attenuation_color", v.attenuation_color);
    }
    if (const Anisotropy& a = m.anisotropy; !(a == plain.anisotropy))
        Part(json, "anisotropy")
            .number("strength", a.strength)
            .number("rotation_rad", a.rotation)
            .texture("texture", a.texture);
    if (const Iridescence& i = m.iridescence; !(i == plain.iridescence))
        Part(json, "iridescence")
            .number("strength", i.strength)
            .number("ior", i.ior)
            .number("thickness_at_black_nm", i.thickness_at_black)
            .number("thickness_at_white_nm", i.thickness_at_white)
            .texture("texture", i.texture)
            .texture("thickness_texture", i.thickness_texture);
    if (m.dispersion != 0) json.member("dispersion", m.dispersion);
}

}  // namespace tessera::cli
