// Textures, samplers and pictures. The bytes of the pictures are gathered first; then they are decoded
// in parallel. Only pictures that a material uses are read.
#include "core/parallel.h"
#include "load/gltf_parts.h"
#include "load/uri.h"

#include <algorithm>
#include <exception>
#include <memory>

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

// One picture on its way from the file to pixels.
struct PictureJob {
    std::size_t picture = 0;
    Json json;
    Bytes owned;
    std::span<const std::byte> bytes;
    std::shared_ptr<Image> pixels;
    std::exception_ptr failure;
};

bool begins_with(std::span<const std::byte> bytes, std::string_view magic) {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), reinterpret_cast<const char*>(bytes.data()));
}

// Formats that extensions bring; files that use them are drawn without these pictures.
std::string_view foreign_format(std::span<const std::byte> bytes) {
    if (begins_with(bytes, "RIFF") && bytes.size() >= 12 && begins_with(bytes.subspan(8), "WEBP")) return "WebP";
    if (begins_with(bytes, "\xabKTX 20\xbb")) return "KTX2";
    if (begins_with(bytes, "DDS ")) return "DDS";
    if (bytes.size() >= 12 && begins_with(bytes.subspan(4), "ftypavif")) return "AVIF";
    return {};
}

PictureJob gather(GltfDocument& document, std::size_t index) {
    PictureJob job{index, document.item(GltfArray::kImages, index), {}, {}, {}, {}};
    if (const std::optional<Json> uri = job.json.find("uri")) {
        job.owned = document.read_uri(*uri);
        job.bytes = job.owned.span();
    } else {
        const Json view = job.json.at("bufferView");
        const int number = view.reference(document.size(GltfArray::kBufferViews), "buffer view");
        job.bytes = document.view(static_cast<std::size_t>(number)).bytes;
    }
    return job;
}

// What decode_image() throws, with the place of the picture.
template <class F>
auto with_place(const Json& json, F&& f) {
    try {
        return f();
    } catch (const Error& error) {
        const std::optional<Json> uri = json.find("uri");
        const std::string name = uri ? std::string(uri->string().substr(0, 60)) + ": " : std::string();
        json.fail(name + error.message(), error.code());
    }
}

void charge_pixels(LoadContext& context, const PictureJob& job) {
    const ImageInfo info = with_place(job.json, [&] { return read_image_info(job.bytes); });
    const std::uint64_t pixels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
    if (pixels > context.options().max_pixels)
        job.json.fail("a picture of " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                          " pixels, the limit is " + std::to_string(context.options().max_pixels) + " pixels",
                      ErrorCode::kLimit);
    context.charge(pixels * (info.bits > 8 ? 8 : 4), job.json.place());
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
        texture.picture = json.reference_or_none("source", scene.pictures.size(), "image");
        if (texture.picture == kNone)
            document.context().warn(json.place() + ": the texture has no picture we can read");
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
    LoadContext& context = document.context();
    if (!context.options().load_pictures) return;
    const std::vector<char> used = used_pictures(scene);
    std::vector<PictureJob> jobs;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        PictureJob job = gather(document, i);
        if (const std::string_view format = foreign_format(job.bytes); !format.empty()) {
            context.warn(job.json.place() + ": pictures in " + std::string(format) + " are not read");
            continue;
        }
        charge_pixels(context, job);
        jobs.push_back(std::move(job));
    }
    if (jobs.empty()) return;
    Arena arena(context.options().threads);
    arena.for_each(jobs.size(), [&](std::size_t i) {
        PictureJob& job = jobs[i];
        try {
            job.pixels = with_place(job.json, [&] {
                return std::make_shared<Image>(decode_image(job.bytes, context.options().max_pixels, true));
            });
        } catch (...) {
            job.failure = std::current_exception();
        }
    });
    // Of several failures the first in the file is reported, whichever thread was faster.
    for (const PictureJob& job : jobs)
        if (job.failure) std::rethrow_exception(job.failure);
    for (PictureJob& job : jobs) scene.pictures[job.picture].pixels = std::move(job.pixels);
}

}  // namespace tessera
