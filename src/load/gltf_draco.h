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

// How many triangles the accessors of a primitive promise. Those of a strip may be fewer: the packed data hold them
// as a list, without the degenerate ones that turn a strip around.
struct DracoTriangles {
    std::size_t count;
    bool strip;
};

class DracoPrimitive {
  public:
    // `json`: the extension object of a primitive. Throws kInput for what cannot be unpacked, and for other numbers
    // of triangles than promised, kLimit for more memory than allowed: what Draco takes is charged before it does.
    DracoPrimitive(GltfDocument& document, const Json& json, DracoTriangles promised);

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
    bool strip_ = false;
};

}  // namespace tessera
