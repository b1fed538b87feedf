// KHR_draco_mesh_compression: primitives whose vertices and indices Draco packed. Accessors keep their
// meaning (type, component, normalised, count) and lose their buffer view; here they get it back.
#pragma once

#include "load/gltf_accessor.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

class DracoPrimitive {
  public:
    // `json`: the extension object of a primitive; `triangles`: what its accessors promise. Throws kInput for what
    // cannot be unpacked, and unless it is as many triangles: memory is bounded by that.
    DracoPrimitive(GltfDocument& document, const Json& json, std::size_t triangles);

    std::size_t vertices() const { return vertices_; }
    // Lets the accessor of an attribute read what was packed of it, if it was.
    void supply(std::string_view attribute, Accessor& accessor);
    void supply_indices(Accessor& accessor) const;

  private:
    struct Unpacked;

    LoadContext& context_;
    Json json_;
    std::shared_ptr<Unpacked> unpacked_;  // Draco's mesh
    std::map<std::string, std::uint32_t, std::less<>> ids_;
    std::vector<std::uint32_t> indices_;
    std::vector<std::vector<std::byte>> values_;
    std::size_t vertices_ = 0;
};

}  // namespace tessera
