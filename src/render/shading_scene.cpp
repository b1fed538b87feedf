#include "render/shading_scene.h"

#include "geometry/texture_transform.h"
#include "render/lighting.h"
#include "render/options.h"
#include "shading/texture_view.h"
#include "simd/math.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace tessera {
namespace {

bool is_srgb(TextureSlot slot) {
    return slot == TextureSlot::kBaseColor || slot == TextureSlot::kEmissive || slot == TextureSlot::kSpecularColor;
}

void copy3(const Vec3& v, float scale, float* out) {
    out[0] = v.x * scale;
    out[1] = v.y * scale;
    out[2] = v.z * scale;
}

// What traced light does at the surface and below it.
void set_transport(const Material& m, bool textbook, MaterialView& v) {
    copy3(m.mirror, 1, v.mirror);
    v.transmission = m.transmission;
    if (textbook) copy3({m.base_color.x, m.base_color.y, m.base_color.z}, 1, v.tint);
    v.thin = !(m.volume.thickness > 0);
    v.priority = m.volume.priority;
    // An infinite index is a mirror, which nothing enters. KHR_materials_dispersion: the indices of blue and red light
    // differ by (ior - 1) / V, where V is the Abbe number 20 / dispersion.
    const double ior = m.ior == 0 ? 1e6 : std::max(static_cast<double>(m.ior), 1.0);
    const double spread = (ior - 1) * static_cast<double>(m.dispersion) / 40;
    for (int i = 0; i < 3; ++i) v.ior[i] = static_cast<float>(std::max(ior + (i - 1) * spread, 1.0));
    if (!m.volume.attenuation_distance) return;
    constexpr double kMost = 1e9;  // per metre
    const float color[3] = {m.volume.attenuation_color.x, m.volume.attenuation_color.y, m.volume.attenuation_color.z};
    for (int i = 0; i < 3; ++i)
        v.absorption[i] =
            static_cast<float>(color[i] > 0 ? std::min(-math::log(static_cast<double>(color[i])) /
                                                           static_cast<double>(*m.volume.attenuation_distance),
                                                       kMost)
                                            : kMost);
}

MaterialView convert(const Material& m) {
    MaterialView v{};
    v.model = m.model;
    v.alpha_mode = m.alpha_mode;
    v.alpha_cutoff = m.alpha_cutoff;
    v.double_sided = m.double_sided;
    // The colour factor belongs to metallic-roughness and unlit; the Phong models have ka and kd.
    const bool textbook =
        m.model == ShadingModel::kLambert || m.model == ShadingModel::kPhong || m.model == ShadingModel::kBlinnPhong;
    const Vec4 base = textbook ? Vec4{1, 1, 1, m.base_color.w} : m.base_color;
    v.base_color[0] = base.x, v.base_color[1] = base.y, v.base_color[2] = base.z, v.base_color[3] = base.w;
    // Specular-glossiness is a dielectric of infinite index.
    const bool glossiness = m.model == ShadingModel::kSpecularGlossiness, mirror = glossiness || m.ior == 0;
    v.metallic = glossiness ? 0 : m.metallic;
    v.roughness = m.roughness;
    v.dielectric_edge = glossiness ? 1 : m.specular_strength;
    const double root = mirror ? 1.0 : (static_cast<double>(m.ior) - 1) / (static_cast<double>(m.ior) + 1);
    const Vec3& tint = m.specular_color;
    for (int i = 0; i < 3; ++i) {
        const double colored = root * root * static_cast<double>(i == 0 ? tint.x : i == 1 ? tint.y : tint.z);
        v.reflectance[i] = static_cast<float>(colored);
        v.dielectric[i] = static_cast<float>(std::min(colored, 1.0)) * v.dielectric_edge;
    }
    v.normal_scale = m.normal_scale;
    v.occlusion_strength = m.occlusion_strength;
    copy3(m.emissive, m.emissive_strength, v.emission);
    copy3(m.ambient, 1, v.ambient);
    copy3(m.diffuse, 1, v.diffuse);
    copy3(m.specular, 1, v.specular);
    v.shininess = m.shininess;
    set_transport(m, textbook, v);
    return v;
}

// What nothing gives a colour: to be seen on white and on black.
constexpr float kInk = 0.2f;

// The material where no light counts: its colour.
MaterialView without_lighting(const MaterialView& lit) {
    MaterialView v = lit;
    v.model = ShadingModel::kUnlit;
    if (family_of(lit.model) == ShadingFamily::kTextbook)
        for (int i = 0; i < 3; ++i) v.base_color[i] = lit.diffuse[i];
    return v;
}

// Whether shading reads the slot at all: in specular-glossiness two inputs stand for each other.
bool is_read(const Material& m, std::size_t slot) {
    return m.model != ShadingModel::kSpecularGlossiness ||
           (slot != static_cast<std::size_t>(TextureSlot::kMetallicRoughness) &&
            slot != static_cast<std::size_t>(TextureSlot::kSpecular));
}

// The diffuse part of specular-glossiness lacks what is mirrored. Where a texture says what that is, shading knows
// it sample by sample (read_reflectance), else it is the same everywhere.
void take_mirrored_light_away(MaterialView& m) {
    if (m.model != ShadingModel::kSpecularGlossiness || has_specular_texture(m)) return;
    const float left = 1 - std::max({m.dielectric[0], m.dielectric[1], m.dielectric[2]});
    for (int i = 0; i < 3; ++i) m.base_color[i] *= left;
}

std::vector<bool> materials_of(const Scene& scene, const Frame& frame) {
    std::vector<bool> used(ink_material(scene) + 1, false);
    for (const InstanceView& i : frame.instances) used[i.material] = true;
    return used;
}

}  // namespace

ShadingScene::ShadingScene(const Scene& scene, const std::vector<bool>& used_views, Arena& arena,
                           std::vector<std::string>& warnings) {
    const std::size_t lit = lit_materials(scene);
    std::vector<bool> used(lit);
    for (std::size_t m = 0; m < lit; ++m) used[m] = used_views[m] || used_views[m + lit];
    for (const Material& m : scene.materials) materials_.push_back(convert(m));
    materials_.push_back(convert(Material{}));  // of primitives without one

    // Which pictures are needed in which colour space, and which textures look at them.
    std::map<std::pair<int, bool>, std::size_t> chain_of, view_of;
    std::vector<std::pair<const Image*, bool>> wanted;
    std::vector<std::pair<int, bool>> views;
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        if (!used[m]) continue;
        for (std::size_t slot = 0; slot < kTextureSlots; ++slot) {
            const TextureRef& ref = scene.materials[m].textures[slot];
            if (ref.texture == kNone || !is_read(scene.materials[m], slot)) continue;
            const Texture& texture = scene.textures[static_cast<std::size_t>(ref.texture)];
            const Image* pixels = texture.picture == kNone
                                      ? nullptr
                                      : scene.pictures[static_cast<std::size_t>(texture.picture)].pixels.get();
            if (!pixels || pixels->empty()) continue;
            if (ref.uv_set < 0 || ref.uv_set >= kMaxUvSets) {
                warnings.push_back("material " + std::to_string(m) + ": uv sets above " +
                                   std::to_string(kMaxUvSets - 1) + " are not read; texture left out");
                continue;
            }
            const bool srgb = is_srgb(static_cast<TextureSlot>(slot));
            if (chain_of.emplace(std::pair(texture.picture, srgb), wanted.size()).second)
                wanted.push_back({pixels, srgb});
            if (view_of.emplace(std::pair(ref.texture, srgb), views.size()).second)
                views.push_back({ref.texture, srgb});
        }
    }
    chains_.resize(wanted.size());
    arena.for_each(wanted.size(),
                   [&](std::size_t i) { chains_[i] = make_mip_chain(*wanted[i].first, wanted[i].second); });
    for (const auto& [index, srgb] : views) {
        const Texture& texture = scene.textures[static_cast<std::size_t>(index)];
        const Sampler sampler =
            texture.sampler == kNone ? Sampler{} : scene.samplers[static_cast<std::size_t>(texture.sampler)];
        textures_.push_back(texture_view(chains_[chain_of.at({texture.picture, srgb})], sampler));
    }
    for (std::size_t m = 0; m < scene.materials.size(); ++m)
        for (std::size_t slot = 0; slot < kTextureSlots; ++slot) {
            const TextureRef& ref = scene.materials[m].textures[slot];
            const auto view = view_of.find({ref.texture, is_srgb(static_cast<TextureSlot>(slot))});
            if (!used[m] || view == view_of.end() || ref.uv_set < 0 || ref.uv_set >= kMaxUvSets) continue;
            if (!is_read(scene.materials[m], slot)) continue;
            TextureInput& input = materials_[m].inputs[slot];
            input.texture = &textures_[view->second];
            input.uv_set = ref.uv_set;
            texture_transform(ref, input.transform);
            constexpr float kIdentity[6] = {1, 0, 0, 0, 1, 0};
            input.plain = std::equal(input.transform, input.transform + 6, kIdentity);
        }
    for (std::size_t m = 0; m < lit; ++m) materials_.push_back(without_lighting(materials_[m]));
    MaterialView ink = materials_.back();
    for (int i = 0; i < 3; ++i) ink.base_color[i] = kInk;
    materials_.push_back(ink);
    for (MaterialView& m : materials_) take_mirrored_light_away(m);
}

ShadingScene::ShadingScene(const Scene& scene, const Frame& frame, const RenderOptions& options, Arena& arena,
                           std::vector<std::string>& warnings)
    : ShadingScene(scene, materials_of(scene, frame), arena, warnings) {
    light(scene, frame, options);
}

void ShadingScene::light(const Scene& scene, const Frame& frame, const RenderOptions& options) {
    const bool studio =
        options.lighting == Lighting::kStudio || (options.lighting == Lighting::kAuto && frame.lights.empty());
    lights_ = studio ? studio_lights() : scene_lights(scene, frame);
    all_unlit_ = !frame.instances.empty() &&
                 std::all_of(frame.instances.begin(), frame.instances.end(), [this](const InstanceView& instance) {
                     return materials_[instance.material].model == ShadingModel::kUnlit;
                 });
    context_.materials = materials_.data();
    context_.lights = lights_.data();
    context_.light_count = static_cast<int>(lights_.size());
    context_.bounces = traces_bounces(options);
    context_.footprint_scale = 1.0f / std::sqrt(static_cast<float>(options.samples));

    if (options.exposure_ev)
        exposure_ = math::exp2(static_cast<double>(*options.exposure_ev));
    else
        exposure_ = studio ? 1.0 : metered_exposure(frame, context_);
    context_.unlit_scale = static_cast<float>(1.0 / exposure_);
    const auto grey = [](double radiance) {
        const auto r = static_cast<float>(radiance);
        return uniform_ambient({r, r, r});
    };
    if (options.ambient)
        context_.ambient = grey(static_cast<double>(*options.ambient));
    else if (scene.ambient)
        context_.ambient = uniform_ambient(*scene.ambient);
    else
        context_.ambient = studio ? studio_ambient() : grey(kDefaultAmbient / exposure_);
}

FilmView ShadingScene::film(const RenderOptions& options) const {
    FilmView film = film_view(options, exposure_);
    if (all_unlit_) film.tone_map = ToneMap::kNone;
    return film;
}

}  // namespace tessera
