// Textures that have no coordinates to be looked up with. They are drawn as at (0, 0), which is rarely meant, so
// that readers say so.
#pragma once

#include "load/context.h"

#include <tessera/scene.h>

namespace tessera {

// One warning for each material with a texture whose set of coordinates a primitive of it lacks. Needs materials and
// meshes whose references were checked.
void warn_of_missing_texcoords(LoadContext& context, const Scene& scene);

}  // namespace tessera
