// A glTF document while it is read: the parsed JSON, its top-level arrays with random access, and the
// bytes of buffers and buffer views. A buffer is opened when the first view of it is used, so that a
// file that nothing uses does no harm. Everything lives as long as the document; one thread at a time.
#pragma once

#include "load/context.h"
#include "load/file.h"
#include "load/json.h"
#include "load/scene_files.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

enum class GltfArray {
    kAccessors,
    kAnimations,
    kBuffers,
    kBufferViews,
    kCameras,
    kImages,
    kMaterials,
    kMeshes,
    kNodes,
    kSamplers,
    kScenes,
    kSkins,
    kTextures,
    kCount
};

struct BufferView {
    std::span<const std::byte> bytes;
    std::size_t stride = 0;  // 0: tightly packed
};

class GltfDocument {
  public:
    // `binary` is the BIN chunk of a GLB; `files` is where relative URIs lead; it outlives this. Throws
    // kInput unless the text is JSON and a glTF 2 asset.
    GltfDocument(LoadContext& context, std::string_view json, std::optional<std::span<const std::byte>> binary,
                 const SceneFiles& files);

    LoadContext& context() { return context_; }
    Json root() const { return Json(root_, JsonPath(), context_.file()); }
    // Of KHR_materials_variants.
    std::size_t variant_count() const { return variant_count_; }
    std::size_t size(GltfArray array) const { return arrays_[static_cast<std::size_t>(array)].size(); }
    Json item(GltfArray array, std::size_t index) const;
    template <class F>
    void each(GltfArray array, F&& f) const {  // f(Json item, std::size_t index)
        for (std::size_t i = 0; i < size(array); ++i) f(item(array, i), i);
    }

    BufferView view(std::size_t index);
    // The bytes that the member "uri" of an image names.
    Bytes read_uri(const Json& uri);

    // Remembers the extensions of an object ("extensions": {...}), so that each that is not known, or read but
    // not drawn, is warned about once.
    void note_extensions(const Json& object);
    void note_extension(std::string_view name);
    const std::vector<std::string>& ignored_extensions() const { return ignored_; }

  private:
    void parse(std::string_view json);
    void check_asset() const;
    void check_references() const;
    std::span<const std::byte> buffer(std::size_t index);
    Bytes read_file(const Json& uri, std::uint64_t most);
    // The bytes that "buffer", "byteOffset" and "byteLength" of an object name.
    std::span<const std::byte> part_of_buffer(const Json& json);

    LoadContext& context_;
    std::optional<std::span<const std::byte>> binary_;
    const SceneFiles& files_;
    simdjson::dom::parser parser_;
    simdjson::dom::element root_;
    std::array<std::vector<simdjson::dom::element>, static_cast<std::size_t>(GltfArray::kCount)> arrays_;

    struct Buffer {
        bool ready = false;
        Bytes owned;
        std::span<const std::byte> bytes;
    };
    std::vector<Buffer> buffers_;
    std::size_t variant_count_ = 0;
    std::vector<Bytes> unpacked_;                 // views that were compressed
    std::vector<std::string> ignored_, undrawn_;  // extensions that were warned about
};

// An extension of glTF that the reader knows.
bool is_known_extension(std::string_view name);

// The member `name` of the object's "extensions".
std::optional<Json> find_extension(const Json& object, std::string_view name);

}  // namespace tessera
