// Loading scene files: glTF 2.0 (.gltf with its buffers and pictures, .glb), Wavefront OBJ with MTL, PLY and
// STL, and ZIP archives with one of them. The format is told by
// content first and by extension second. A file is hostile until checked: every count, range and
// reference is verified before memory is taken, only files below the scene's folder are opened, and
// a fault throws tessera::Error (kInput, or kLimit when a limit is exceeded) naming file and place.
#pragma once

#include <tessera/export.h>
#include <tessera/scene.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tessera {

struct LoadOptions {
    std::uint64_t max_bytes = std::uint64_t{1} << 30;      // memory that the scene may take
    std::uint64_t max_triangles = std::uint64_t{1} << 24;  // drawn, lines and points too; instances counted
    std::uint64_t max_nodes = std::uint64_t{1} << 22;
    std::uint64_t max_pixels = std::uint64_t{1} << 26;  // of one picture
    int threads = 0;                                    // for decoding pictures; 0: what the process may use
    bool load_pictures = true;                          // false: Picture::pixels stay null
};

// Loads `path`. Warnings (ignored extensions and the like) are in Scene::warnings.
TESSERA_API Scene load_scene(const std::string& path, const LoadOptions& options = {});
// Loads a scene from memory; `base_folder` is where its relative URIs live ("": none may be used).
// `name` stands for the file in errors.
TESSERA_API Scene load_scene_from_memory(std::span<const std::byte> file, const std::string& base_folder,
                                         const LoadOptions& options = {}, const std::string& name = "<memory>");

}  // namespace tessera
