// Textures, samplers and pictures. The bytes of the pictures are gathered first; then they are decoded
// in parallel. Only pictures that a material uses are read.
#include "load/gltf_parts.h"
#include "load/pictures.h"
#include "load/uri.h"

#include <utility>

namespace tessera {
namespace {

// WebGL's numbers (glTF 2.0, section 5.26).
Wrap read_wrap(LoadContext& context, const Json& sampler, std::string_view key) {
    const std::uint64_t value = sampler.integer_or(key, 10497);
    if (value == 33071) return Wrap::kClamp;
    if (value == 33648) return Wrap::kMirror;
    if (value != 10497) context.warn(sampler.place() + ": an unknown wrap mode is taken as repeat");
    return Wrap::kRepeat;
}

void read_min_filter(LoadContext& context, const Json& json, Sampler& sampler) {
    switch (json.integer_or("minFilter", 9987)) {
        case 9728:
            sampler.min_filter = Filter::kNearest, sampler.mip_filter = MipFilter::kNone;
            break;
        case 9729:
            sampler.min_filter = Filter::kLinear, sampler.mip_filter = MipFilter::kNone;
            break;
        case 9984:
            sampler.min_filter = Filter::kNearest, sampler.mip_filter = MipFilter::kNearest;
            break;
        case 9985:
            sampler.min_filter = Filter::kLinear, sampler.mip_filter = MipFilter::kNearest;
            break;
        case 9986:
            sampler.min_filter = Filter::kNearest, sampler.mip_filter = MipFilter::kLinear;
            break;
        case 9987:
            break;
        default:
            context.warn(json.place() + ": an unknown minFilter is taken as trilinear");
    }
}

Sampler read_sampler(GltfDocument& document, const Json& json) {
    Sampler sampler;
    LoadContext& context = document.context();
    document.note_extensions(json);
    sampler.name = json.string_or("name");
    const std::uint64_t mag = json.integer_or("magFilter", 9729);
    if (mag == 9728)
        sampler.mag_filter = Filter::kNearest;
    else if (mag != 9729)
        context.warn(json.place() + ": an unknown magFilter is taken as linear");
    read_min_filter(context, json, sampler);
    sampler.wrap_s = read_wrap(context, json, "wrapS");
    sampler.wrap_t = read_wrap(context, json, "wrapT");
    return sampler;
}

// Of the pictures that a texture offers: WebP first, as EXT_texture_webp wants it. There is no decoder of
// KTX2 pictures (KHR_texture_basisu); the plain source stands in.
int read_source(LoadContext& context, const Json& texture, std::size_t pictures) {
    const int plain = texture.reference_or_none("source", pictures, "image");
    if (const std::optional<Json> webp = find_extension(texture, "EXT_texture_webp")) {
        const int source = webp->reference_or_none("source", pictures, "image");
        if (source != kNone) return source;
    }
    if (find_extension(texture, "KHR_texture_basisu")) {
        constexpr std::string_view kNotRead = ": pictures in KTX2 (KHR_texture_basisu) are not read";
        context.warn(texture.place() + std::string(kNotRead) +
                     (plain == kNone ? "; the texture is left out" : "; its plain source is used"));
    } else if (plain == kNone) {
        context.warn(texture.place() + ": the texture has no picture we can read");
    }
    return plain;
}

PictureFile gather(GltfDocument& document, std::size_t index) {
    const Json json = document.item(GltfArray::kImages, index);
    PictureFile file{index, json.place(), {}, {}, {}};
    if (const std::optional<Json> uri = json.find("uri")) {
        file.name = uri->string().substr(0, 60);
        file.owned = document.read_uri(*uri);
        file.bytes = file.owned.span();
    } else {
        const Json view = json.at("bufferView");
        const int number = view.reference(document.size(GltfArray::kBufferViews), "buffer view");
        file.bytes = document.view(static_cast<std::size_t>(number)).bytes;
    }
    return file;
}

std::vector<char> used_pictures(const Scene& scene) {
    std::vector<char> used(scene.pictures.size(), 0);
    for (const Material& material : scene.materials)
        for (const TextureRef& ref : material.textures) {
            if (ref.texture == kNone) continue;
            const int picture = scene.textures[static_cast<std::size_t>(ref.texture)].picture;
            if (picture != kNone) used[static_cast<std::size_t>(picture)] = 1;
        }
    return used;
}

}  // namespace

void read_textures(GltfDocument& document, Scene& scene) {
    make_room(document, GltfArray::kSamplers, scene.samplers);
    make_room(document, GltfArray::kTextures, scene.textures);
    make_room(document, GltfArray::kImages, scene.pictures);
    document.each(GltfArray::kSamplers,
                  [&](const Json& json, std::size_t i) { scene.samplers[i] = read_sampler(document, json); });
    document.each(GltfArray::kTextures, [&](const Json& json, std::size_t i) {
        Texture& texture = scene.textures[i];
        document.note_extensions(json);
        texture.name = json.string_or("name");
        texture.extras = json.raw_or_empty("extras");
        texture.sampler = json.reference_or_none("sampler", scene.samplers.size(), "sampler");
        texture.picture = read_source(document.context(), json, scene.pictures.size());
    });
    document.each(GltfArray::kImages, [&](const Json& json, std::size_t i) {
        Picture& picture = scene.pictures[i];
        document.note_extensions(json);
        picture.name = json.string_or("name");
        picture.extras = json.raw_or_empty("extras");
        const std::optional<Json> uri = json.find("uri");
        if (uri && !is_data_uri(uri->string())) picture.uri = uri->string();
    });
}

void read_pictures(GltfDocument& document, Scene& scene) {
    if (!document.context().options().load_pictures) return;
    const std::vector<char> used = used_pictures(scene);
    std::vector<PictureFile> files;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) files.push_back(gather(document, i));
    decode_pictures(document.context(), std::move(files), scene, PictureFaults::kFail);
}

}  // namespace tessera
