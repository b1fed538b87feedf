// A stage of the tile rasterizer in the place of the picture: RenderOptions::show.
#pragma once

#include <tessera/render.h>

#include "raster/engine.h"

namespace tessera {

// The plane of numbers that the shown stage needs, made in result.stage unless it is there already, and
// where the rasterizer writes it. Without a stage to show the plane is let go, and all is null.
RasterInspection make_stage_plane(const RenderOptions& options, RenderResult& result);

// Paints result.color with the numbers of result.stage, from black for 0 to white for their maximum
// (image/false_color.h), opaque. Numbers that belong to whole tiles get the borders of the tiles, half as
// bright.
void paint_stage(Stage stage, int tile_side, RenderResult& result);

}  // namespace tessera
