// PLY (Greg Turk, "The PLY Polygon File Format", 1994): ASCII and binary of both byte orders. Vertices with
// normals, colours and texture coordinates under their usual names; faces, with texture coordinates of
// their corners and the pictures that comments name; triangle strips and edges. Files without faces are point clouds.
// Other elements and properties are skipped, lists too.
#pragma once

#include "load/context.h"
#include "load/scene_files.h"

#include <tessera/scene.h>

#include <cstddef>
#include <span>

namespace tessera {

bool is_ply(std::span<const std::byte> file);
// Throws kInput for a damaged file. Integer colours are sRGB codes, colours in floats are linear. `files`: where
// pictures lie; one that is missing is a warning.
Scene read_ply(LoadContext& context, std::span<const std::byte> file, const SceneFiles& files);

}  // namespace tessera
