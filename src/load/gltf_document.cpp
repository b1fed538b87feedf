#include "load/gltf_document.h"

#include "load/gltf_meshopt.h"
#include "load/uri.h"

#include <algorithm>
#include <iterator>

namespace tessera {
namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(GltfArray::kCount)> kArrayNames = {
    "accessors", "animations", "buffers",  "bufferViews", "cameras", "images",  "materials",
    "meshes",    "nodes",      "samplers", "scenes",      "skins",   "textures"};

constexpr std::string_view kKnownExtensions[] = {"KHR_draco_mesh_compression",
                                                 "EXT_meshopt_compression",
                                                 "EXT_mesh_gpu_instancing",
                                                 "KHR_materials_variants",
                                                 "KHR_materials_pbrSpecularGlossiness",
                                                 "KHR_materials_ior",
                                                 "KHR_materials_specular",
                                                 "KHR_lights_punctual",
                                                 "KHR_materials_unlit",
                                                 "KHR_materials_emissive_strength",
                                                 "KHR_texture_transform",
                                                 "EXT_texture_webp",
                                                 "KHR_mesh_quantization",
                                                 "TESSERA_materials_phong",
                                                 "TESSERA_lights",
                                                 "TESSERA_volume",
                                                 "TESSERA_shape",
                                                 "KHR_materials_transmission",
                                                 "KHR_materials_volume",
                                                 "KHR_materials_dispersion"};

// Read as data of the materials, which shading does not use yet.
constexpr std::string_view kUndrawnExtensions[] = {"KHR_materials_clearcoat", "KHR_materials_sheen",
                                                   "KHR_materials_anisotropy", "KHR_materials_iridescence"};

template <class Names>
bool has(const Names& names, std::string_view name) {
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

// What parsing `json` takes: a padded copy and the strings are at most as long as the text, and each
// structural character costs up to three 8-byte words of tape and index.
std::uint64_t parse_bytes(std::string_view json) {
    std::uint64_t structure = 0;
    for (const char c : json) structure += c == ',' || c == ':' || c == '[' || c == '{' || c == ']' || c == '}';
    return 2 * std::uint64_t{json.size()} + 24 * structure;
}

}  // namespace

bool is_known_extension(std::string_view name) { return has(kKnownExtensions, name) || has(kUndrawnExtensions, name); }

std::optional<Json> find_extension(const Json& object, std::string_view name) {
    const std::optional<Json> extensions = object.find("extensions");
    return extensions ? extensions->find(name) : std::nullopt;
}

GltfDocument::GltfDocument(LoadContext& context, std::string_view json,
                           std::optional<std::span<const std::byte>> binary, const SceneFiles& files)
    : context_(context), binary_(binary), files_(files) {
    parse(json);
    check_asset();
    for (std::size_t i = 0; i < kArrayNames.size(); ++i)
        if (const std::optional<Json> array = root().find(kArrayNames[i])) arrays_[i] = array->elements();
    buffers_.resize(size(GltfArray::kBuffers));
    unpacked_.resize(size(GltfArray::kBufferViews));
    if (const std::optional<Json> extension = find_extension(root(), "KHR_materials_variants"))
        variant_count_ = extension->at("variants").elements().size();
    check_references();
}

void GltfDocument::parse(std::string_view json) {
    if (json.starts_with("\xef\xbb\xbf")) json.remove_prefix(3);
    // The chunk of a GLB is padded with spaces; some writers pad with zeros.
    while (json.ends_with('\0')) json.remove_suffix(1);
    context_.charge(parse_bytes(json));
    const simdjson::padded_string padded(json);
    if (const simdjson::error_code error = parser_.parse(padded).get(root_))
        context_.fail(std::string("not valid JSON: ") + simdjson::error_message(error));
}

void GltfDocument::check_asset() const {
    const Json version = root().at("asset").at("version");
    if (!version.string().starts_with("2.")) version.fail("glTF version " + version.raw() + "; version 2 is read");
    const std::optional<Json> least = root().at("asset").find("minVersion");
    if (!least || least->string() == "2.0") return;
    if (!least->string().starts_with("2.")) least->fail("needs glTF " + least->raw() + "; version 2 is read");
    context_.warn("the file asks for glTF " + least->raw() + ", it is read as 2.0");
}

// What nothing uses is not opened, but it must not refer to nothing.
void GltfDocument::check_references() const {
    each(GltfArray::kBufferViews,
         [&](const Json& view, std::size_t) { view.at("buffer").reference(size(GltfArray::kBuffers), "buffer"); });
    each(GltfArray::kAccessors, [&](const Json& accessor, std::size_t) {
        accessor.reference_or_none("bufferView", size(GltfArray::kBufferViews), "buffer view");
    });
}

Json GltfDocument::item(GltfArray array, std::size_t index) const {
    const auto a = static_cast<std::size_t>(array);
    return Json(arrays_[a][index], JsonPath().child(kArrayNames[a]).child(index), context_.file());
}

Bytes GltfDocument::read_uri(const Json& uri) {
    if (is_data_uri(uri.string())) return decode_data_uri(context_, uri.string(), uri.place());
    return read_file(uri, UINT64_MAX);
}

Bytes GltfDocument::read_file(const Json& uri, std::uint64_t most) {
    return files_.read(context_, checked_path(context_, uri.string(), uri.place()), most, uri.place());
}

std::span<const std::byte> GltfDocument::buffer(std::size_t index) {
    Buffer& buffer = buffers_[index];
    if (buffer.ready) return buffer.bytes;
    const Json json = item(GltfArray::kBuffers, index);
    note_extensions(json);
    const std::uint64_t length = json.at("byteLength").integer();
    if (const std::optional<Json> uri = json.find("uri")) {
        if (is_data_uri(uri->string())) {
            buffer.owned = decode_data_uri(context_, uri->string(), uri->place());
        } else {
            buffer.owned = read_file(*uri, length);
        }
        buffer.bytes = buffer.owned.span();
    } else if (index == 0 && binary_) {
        buffer.bytes = *binary_;
    } else {
        json.fail("the buffer has no uri and there is no BIN chunk for it");
    }
    if (buffer.bytes.size() < length)
        json.at("byteLength")
            .fail("the buffer should have " + std::to_string(length) + " bytes, but has " +
                  std::to_string(buffer.bytes.size()));
    buffer.bytes = buffer.bytes.first(static_cast<std::size_t>(length));
    buffer.ready = true;
    return buffer.bytes;
}

std::span<const std::byte> GltfDocument::part_of_buffer(const Json& json) {
    const int number = json.at("buffer").reference(size(GltfArray::kBuffers), "buffer");
    const std::span<const std::byte> bytes = buffer(static_cast<std::size_t>(number));
    const std::uint64_t offset = json.integer_or("byteOffset", 0), length = json.at("byteLength").integer();
    if (offset > bytes.size() || length > bytes.size() - offset)
        json.fail("bytes " + std::to_string(offset) + " + " + std::to_string(length) + " lie outside the buffer of " +
                  std::to_string(bytes.size()) + " bytes");
    return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

BufferView GltfDocument::view(std::size_t index) {
    const Json json = item(GltfArray::kBufferViews, index);
    note_extensions(json);
    BufferView view;
    if (const std::optional<Json> packed = find_extension(json, "EXT_meshopt_compression")) {
        Bytes& unpacked = unpacked_[index];
        if (unpacked.size() == 0) unpacked = unpack_meshopt(context_, *packed, part_of_buffer(*packed));
        const std::uint64_t length = json.at("byteLength").integer();
        if (length > unpacked.size())
            json.fail(std::to_string(length) + " bytes, but " + std::to_string(unpacked.size()) + " when unpacked");
        view.bytes = unpacked.span().first(static_cast<std::size_t>(length));
    } else {
        view.bytes = part_of_buffer(json);
    }
    if (const std::optional<Json> stride = json.find("byteStride")) {
        constexpr std::uint64_t kLargestStride = 252;
        view.stride = static_cast<std::size_t>(stride->integer(kLargestStride));
    }
    return view;
}

void GltfDocument::note_extensions(const Json& object) {
    const std::optional<Json> extensions = object.find("extensions");
    if (!extensions) return;
    extensions->each_member([&](std::string_view name, const Json&) { note_extension(name); });
}

void GltfDocument::note_extension(std::string_view name) {
    constexpr std::size_t kMost = 256;
    if (has(kUndrawnExtensions, name)) {
        if (has(undrawn_, name)) return;
        undrawn_.emplace_back(name);
        context_.warn("extension " + std::string(name) + " is read, but not drawn yet");
        return;
    }
    if (is_known_extension(name) || ignored_.size() >= kMost || has(ignored_, name)) return;
    ignored_.emplace_back(name);
    context_.warn("extension " + std::string(name) + " is ignored");
}

}  // namespace tessera
