// Wavefront OBJ with its MTL libraries. Objects (or groups, where there are none) become meshes at nodes,
// materials their primitives. Polygons are split into triangles. Normals that the file lacks follow its
// smoothing groups: the mean of the faces around, weighted by angle, or flat where smoothing is off; files
// without any statement of smoothing are smooth but for edges of more than 60 degrees.
#pragma once

#include "load/context.h"
#include "load/scene_files.h"

#include <tessera/scene.h>

#include <string_view>

namespace tessera {

// `files`: where libraries and textures lie. Throws kInput for damaged geometry; damaged or
// missing materials and textures are warnings.
Scene read_obj(LoadContext& context, std::string_view text, const SceneFiles& files);

}  // namespace tessera
