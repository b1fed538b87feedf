#include "load/obj_materials.h"

#include "load/mesh_scene.h"
#include "load/text.h"

#include <algorithm>
#include <memory>

namespace tessera {
namespace {

bool is_black(const Vec3& c) { return c.x == 0 && c.y == 0 && c.z == 0; }

bool lie_alike(const MtlTexture& a, const MtlTexture& b) {
    return a.scale == b.scale && a.offset == b.offset && a.clamp == b.clamp;
}

// A channel of a pixel, 0 .. 65535.
std::uint32_t channel_of(const Image& image, std::size_t pixel, char channel) {
    std::uint32_t c[4];
    for (std::size_t i = 0; i < 4; ++i)
        c[i] = image.format() == PixelFormat::kRgba16 ? image.data<std::uint16_t>()[4 * pixel + i]
                                                      : image.data<std::uint8_t>()[4 * pixel + i] * 257u;
    switch (channel) {
        case 'r':
            return c[0];
        case 'g':
            return c[1];
        case 'b':
            return c[2];
        case 'm':
            return c[3];
        default:
            return (c[0] * 2126 + c[1] * 7152 + c[2] * 722) / 10000;
    }
}

bool has_alpha(const Image& image) {
    const std::size_t pixels = static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height());
    for (std::size_t i = 0; i < pixels; ++i)
        if (channel_of(image, i, 'm') != 65535) return true;
    return false;
}

}  // namespace

ObjMaterials::ObjMaterials(LoadContext& context, const SceneFiles& files, Scene& scene)
    : context_(context), files_(files), scene_(scene) {}

void ObjMaterials::warn_once(const std::string& what) {
    if (warned_.size() < 64 && warned_.insert(what).second) context_.warn(what);
}

int ObjMaterials::plain() {
    if (plain_ == kNone) {
        plain_ = static_cast<int>(scene_.materials.size());
        scene_.materials.push_back(plain_material());
    }
    return plain_;
}

int ObjMaterials::find(const std::string& name) {
    const auto found = materials_.find(name);
    if (found != materials_.end()) return found->second;
    warn_once("the material " + quoted(name) + " is not defined");
    return plain();
}

// By the definition blanks part several names; by habit they are part of one.
void ObjMaterials::read_libraries(const std::string& names) {
    if (names.find(' ') == std::string::npos || read_library(names, false)) {
        if (names.find(' ') == std::string::npos) read_library(names, true);
        return;
    }
    for (std::size_t at = 0; at < names.size();) {
        const std::size_t end = std::min(names.find(' ', at), names.size());
        if (end > at) read_library(names.substr(at, end - at), true);
        at = end + 1;
    }
}

// Returns whether it was there; says so otherwise, unless it was only an attempt.
bool ObjMaterials::read_library(const std::string& name, bool must_be_there) {
    std::string path = name;
    std::replace(path.begin(), path.end(), '\\', '/');
    try {
        Bytes bytes = files_.read(context_, path, UINT64_MAX, "mtllib");
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        for (const MtlMaterial& m : read_mtl_text(context_, text, path.substr(0, 60)))
            if (!materials_.contains(m.name)) materials_[m.name] = add_material(m);
        return true;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::kInput) throw;
        if (must_be_there) context_.warn("mtllib: " + error.message());
        return false;
    }
}

int ObjMaterials::add_material(const MtlMaterial& m) {
    const int number = static_cast<int>(scene_.materials.size());
    context_.charge(sizeof(Material) + m.name.size());
    scene_.materials.push_back(plain_material());
    Material& material = scene_.materials.back();
    material.name = m.name;
    material.base_color = {m.diffuse.x, m.diffuse.y, m.diffuse.z, m.opacity};
    material.ambient = m.ambient.value_or(m.diffuse);
    material.diffuse = m.diffuse;
    material.specular = m.specular;
    material.shininess = m.shininess;
    material.emissive = m.emission;
    material.model = m.illumination == 0   ? ShadingModel::kUnlit
                     : m.illumination == 1 ? ShadingModel::kLambert
                                           : ShadingModel::kBlinnPhong;
    material.texture(TextureSlot::kBaseColor) = texture(m.map_diffuse);
    material.texture(TextureSlot::kEmissive) = texture(m.map_emission);
    if (const int picture = this->picture(m.map_emission); picture != kNone && is_black(m.emission)) {
        material.emissive = {1, 1, 1};
        without_picture_.push_back({picture, number, [](Material& dark) { dark.emissive = {}; }});
    }
    material.texture(TextureSlot::kNormal) = texture(m.map_normal);
    material.normal_scale = m.map_normal.bump;
    set_opacity(m, number);
    set_physical(m, number);
    set_highlight(m, number);
    set_glass(m, number);
    if (!m.map_bump.file.empty()) warn_once("bump maps of heights are not drawn");
    if (!m.map_other.file.empty()) warn_once("disp, decal and refl are not drawn");
    return number;
}

void ObjMaterials::set_opacity(const MtlMaterial& m, int number) {
    Material& material = scene_.materials[static_cast<std::size_t>(number)];
    if (m.opacity < 1) material.alpha_mode = AlphaMode::kBlend;
    const int opacity = picture(m.map_opacity);
    if (opacity == kNone) return;
    const char channel = m.map_opacity.channel != 0 ? m.map_opacity.channel : '?';
    const int color = picture(m.map_diffuse);
    const int both = combined(color, opacity, channel, 3);
    if (color != kNone && !lie_alike(m.map_opacity, m.map_diffuse))
        warn_once("the options -s, -o and -clamp of map_d are not those of map_Kd, which count for both");
    material.texture(TextureSlot::kBaseColor) = texture_of(both, color == kNone ? m.map_opacity : m.map_diffuse);
    masked_.push_back(number);
}

// With Pr, Pm or their maps the material is metallic-roughness; glTF's texture has roughness in green and
// metal in blue.
void ObjMaterials::set_physical(const MtlMaterial& m, int number) {
    const int roughness = picture(m.map_roughness), metallic = picture(m.map_metallic);
    if (!m.roughness && !m.metallic && roughness == kNone && metallic == kNone) return;
    Material& material = scene_.materials[static_cast<std::size_t>(number)];
    material.model = ShadingModel::kMetallicRoughness;
    material.roughness = m.roughness.value_or(roughness == kNone ? 0.5f : 1.0f);
    material.metallic = m.metallic.value_or(metallic == kNone ? 0.0f : 1.0f);
    if (!m.roughness && roughness != kNone)
        without_picture_.push_back({roughness, number, [](Material& plain) { plain.roughness = 0.5f; }});
    if (!m.metallic && metallic != kNone)
        without_picture_.push_back({metallic, number, [](Material& plain) { plain.metallic = 0; }});
    if (roughness != kNone && metallic != kNone && !lie_alike(m.map_roughness, m.map_metallic))
        warn_once("the options -s, -o and -clamp of map_Pm are not those of map_Pr, which count for both");
    int packed = kNone;
    const auto channel = [](const MtlTexture& t) { return t.channel != 0 ? t.channel : 'l'; };
    if (roughness != kNone) packed = combined(packed, roughness, channel(m.map_roughness), 1);
    if (metallic != kNone) packed = combined(packed, metallic, channel(m.map_metallic), 2);
    if (packed != kNone)
        material.texture(TextureSlot::kMetallicRoughness) =
            texture_of(packed, roughness != kNone ? m.map_roughness : m.map_metallic);
}

// The highlight of the Phong models: Ks times a colour, Ns times a number, which the slot has as alpha.
void ObjMaterials::set_highlight(const MtlMaterial& m, int number) {
    Material& material = scene_.materials[static_cast<std::size_t>(number)];
    if (material.model != ShadingModel::kBlinnPhong) return;
    material.texture(TextureSlot::kSpecularColor) = texture(m.map_specular);
    const int shininess = picture(m.map_shininess);
    if (shininess == kNone) return;
    const char channel = m.map_shininess.channel != 0 ? m.map_shininess.channel : 'l';
    material.texture(TextureSlot::kSpecular) = texture_of(combined(kNone, shininess, channel, 3), m.map_shininess);
}

// Illumination models 3 to 7 mirror by rays, as much as Ks says; 4, 6, 7 and 9 are those of glass: what passes has the
// colour Tf and is bent by Ni. Elsewhere writers give Ni without a meaning.
void ObjMaterials::set_glass(const MtlMaterial& m, int number) {
    Material& material = scene_.materials[static_cast<std::size_t>(number)];
    if (m.illumination >= 3 && m.illumination <= 7 && material.model == ShadingModel::kBlinnPhong)
        material.mirror = {std::clamp(m.specular.x, 0.0f, 1.0f), std::clamp(m.specular.y, 0.0f, 1.0f),
                           std::clamp(m.specular.z, 0.0f, 1.0f)};
    if (m.illumination != 4 && m.illumination != 6 && m.illumination != 7 && m.illumination != 9) return;
    // Only 6 and 7 refract; any thickness says that there is a volume.
    if (m.illumination == 6 || m.illumination == 7) material.volume.thickness = 1;
    material.ior = std::max(m.ior, 1.0f);
    material.transmission = std::clamp(std::max({m.filter.x, m.filter.y, m.filter.z}), 0.0f, 1.0f);
    // The Phong models have no other use for the base colour, which is the colour of what passes.
    if (material.model == ShadingModel::kBlinnPhong && material.transmission > 0)
        for (const auto& [to, from] :
             {std::pair(&material.base_color.x, m.filter.x), std::pair(&material.base_color.y, m.filter.y),
              std::pair(&material.base_color.z, m.filter.z)})
            *to = std::clamp(from, 0.0f, 1.0f) / material.transmission;
}

TextureRef ObjMaterials::texture(const MtlTexture& t) {
    const int number = picture(t);
    return number == kNone ? TextureRef{} : texture_of(number, t);
}

// Counted from the bottom, v becomes s v + o; counted from the top, s v + 1 - s - o.
TextureRef ObjMaterials::texture_of(int picture, const MtlTexture& t) {
    int& number = textures_.try_emplace({picture, t.clamp}, kNone).first->second;
    if (number == kNone) {
        number = static_cast<int>(scene_.textures.size());
        Texture texture;
        texture.picture = picture;
        if (t.clamp) {
            texture.sampler = static_cast<int>(scene_.samplers.size());
            Sampler sampler;
            sampler.wrap_s = sampler.wrap_t = Wrap::kClamp;
            scene_.samplers.push_back(sampler);
        }
        context_.charge(sizeof(Texture) + sizeof(Sampler));
        scene_.textures.push_back(std::move(texture));
    }
    TextureRef ref;
    ref.texture = number;
    ref.scale = t.scale;
    ref.offset = {t.offset.x, 1 - t.scale.y - t.offset.y};
    return ref;
}

// The picture of a file, opened when it is first named: as it is named, or beside the scene.
int ObjMaterials::picture(const MtlTexture& t) {
    if (t.file.empty()) return kNone;
    const auto known = pictures_.find(t.file);
    if (known != pictures_.end()) return known->second;
    const std::string place = "the texture " + quoted(t.file);
    int& number = pictures_[t.file];
    number = kNone;
    const auto open = [&] {
        return context_.options().load_pictures ? read_beside(context_, files_, t.file, place) : Bytes{};
    };
    try {
        PictureFile file{scene_.pictures.size(), place, {}, open(), {}};
        file.bytes = file.owned.span();
        context_.charge(sizeof(Picture) + t.file.size());
        number = static_cast<int>(scene_.pictures.size());
        Picture entry;
        entry.uri = t.file;
        scene_.pictures.push_back(std::move(entry));
        if (context_.options().load_pictures) picture_files_.push_back(std::move(file));
    } catch (const Error& error) {
        if (error.code() != ErrorCode::kInput) throw;
        context_.warn(place + ": " + error.message());
    }
    return number;
}

int ObjMaterials::combined(int to, int from, char channel, int to_channel) {
    for (const Part& p : parts_)
        if (p.to == to && p.from == from && p.channel == channel && p.to_channel == to_channel) return p.into;
    const int into = static_cast<int>(scene_.pictures.size());
    Picture entry;
    if (to != kNone) entry.uri = scene_.pictures[static_cast<std::size_t>(to)].uri;
    entry.name = "combined";
    scene_.pictures.push_back(std::move(entry));
    context_.charge(sizeof(Picture));
    parts_.push_back({to, from, channel, to_channel, into});
    return into;
}

void ObjMaterials::combine(const Part& part) {
    const auto pixels_of = [&](int number) {
        return number == kNone ? nullptr : scene_.pictures[static_cast<std::size_t>(number)].pixels;
    };
    const std::shared_ptr<const Image> to = pixels_of(part.to), from = pixels_of(part.from);
    std::shared_ptr<const Image>& into = scene_.pictures[static_cast<std::size_t>(part.into)].pixels;
    into = to;
    if (!from) return;
    const Image& size = to ? *to : *from;
    context_.charge(std::uint64_t{size.row_bytes()} * static_cast<std::uint64_t>(size.height()));
    auto made = std::make_shared<Image>(to ? Image(*to) : Image(from->width(), from->height(), from->format()));
    if (!to) std::fill(made->bytes().begin(), made->bytes().end(), std::byte{0xff});
    char channel = part.channel;
    if (channel == '?') channel = has_alpha(*from) ? 'm' : 'l';
    const auto w = static_cast<std::size_t>(made->width()), h = static_cast<std::size_t>(made->height());
    const auto fw = static_cast<std::size_t>(from->width()), fh = static_cast<std::size_t>(from->height());
    for (std::size_t y = 0; y < h; ++y)
        for (std::size_t x = 0; x < w; ++x) {
            const std::uint32_t value = channel_of(*from, y * fh / h * fw + x * fw / w, channel);
            const std::size_t at = 4 * (y * w + x) + static_cast<std::size_t>(part.to_channel);
            if (made->format() == PixelFormat::kRgba16)
                made->data<std::uint16_t>()[at] = static_cast<std::uint16_t>(value);
            else
                made->data<std::uint8_t>()[at] = static_cast<std::uint8_t>((value + 128) / 257);
        }
    into = std::move(made);
}

void ObjMaterials::choose_alpha_mode(Material& material) {
    const int texture = material.texture(TextureSlot::kBaseColor).texture;
    if (texture == kNone || material.alpha_mode == AlphaMode::kBlend) return;
    material.alpha_mode = alpha_mode_of(scene_.textures[static_cast<std::size_t>(texture)].picture);
}

// Cut out where alpha is all or nothing, else blended.
AlphaMode ObjMaterials::alpha_mode_of(int picture) {
    const auto [known, is_new] = alpha_modes_.try_emplace(picture, AlphaMode::kOpaque);
    const Image* pixels = scene_.pictures[static_cast<std::size_t>(picture)].pixels.get();
    if (!is_new || !pixels) return known->second;
    bool partly = false, clear = false;
    const std::size_t count = static_cast<std::size_t>(pixels->width()) * static_cast<std::size_t>(pixels->height());
    for (std::size_t i = 0; i < count && !partly; ++i) {
        const std::uint32_t alpha = channel_of(*pixels, i, 'm');
        partly = alpha > 0 && alpha < 65535;
        clear = clear || alpha == 0;
    }
    if (partly || clear) known->second = partly ? AlphaMode::kBlend : AlphaMode::kMask;
    return known->second;
}

void ObjMaterials::finish() {
    decode_pictures(context_, std::move(picture_files_), scene_, PictureFaults::kWarn);
    if (context_.options().load_pictures)
        for (const WithoutPicture& w : without_picture_)
            if (!scene_.pictures[static_cast<std::size_t>(w.picture)].pixels)
                w.change(scene_.materials[static_cast<std::size_t>(w.material)]);
    for (const Part& part : parts_) combine(part);
    for (const int number : masked_) choose_alpha_mode(scene_.materials[static_cast<std::size_t>(number)]);
    // What was only part of others is let go.
    std::vector<char> used(scene_.pictures.size(), 0);
    for (const Texture& texture : scene_.textures) used[static_cast<std::size_t>(texture.picture)] = 1;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (!used[i]) scene_.pictures[i].pixels.reset();
}

}  // namespace tessera
