// What the options say about a scene that has been loaded: its materials, its up axis, the view, the moment.
#pragma once

#include "cli/render_arguments.h"

#include <tessera/scene.h>

namespace tessera::cli {

// Changes both: the scene by --variant and --up z, the job's view and moment to what they mean in it. Throws kUsage,
// naming the option, for what the scene does not have.
void set_up(RenderJob& job, Scene& scene);

}  // namespace tessera::cli
