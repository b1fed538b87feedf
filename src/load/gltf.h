// From the text of a glTF 2.0 document to a scene.
#pragma once

#include "load/context.h"
#include "load/scene_files.h"

#include <tessera/scene.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace tessera {

// `binary`: the BIN chunk of a GLB. `files`: where relative URIs lead. The scene is
// valid (tessera::validate) when it is returned.
Scene read_gltf(LoadContext& context, std::string_view json, std::optional<std::span<const std::byte>> binary,
                const SceneFiles& files);

}  // namespace tessera
