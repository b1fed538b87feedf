#include "tile/visible_tile.h"

#include <tessera/error.h>

#include <algorithm>
#include <bit>

namespace tessera {

TileGrid::TileGrid(int width, int height, int tile_side)
    : side(tile_side),
      shift(std::countr_zero(static_cast<unsigned>(tile_side))),
      columns((width + side - 1) / side),
      rows((height + side - 1) / side) {}

TileArea::TileArea(const TileGrid& grid, int tile, const ProjectionView& picture)
    : index(tile),
      side(grid.side),
      x0(tile % grid.columns * side),
      y0(tile / grid.columns * side),
      width(std::min(side, static_cast<int>(picture.width) - x0)),
      height(std::min(side, static_cast<int>(picture.height) - y0)) {}

void VisibleTile::resize(int side) {
    const auto pixels = static_cast<std::size_t>(side * side);
    depth.resize(pixels);
    ordinal.resize(pixels);
}

void VisibleTile::refuse_fragments() {
    throw Error(ErrorCode::kLimit, "transparent surfaces need more memory than the limit allows");
}

void VisibleTile::sort_fragments(const InstanceView* instances) {
    if (fragments.empty()) return;
    const auto number = [&](std::uint32_t o) {
        const TileTriangle& t = triangles[o - 1];
        return instances[t.instance].first_triangle + t.triangle;
    };
    std::erase_if(fragments, [&](const TileFragment& f) {
        const float z = depth[f.pixel];
        const std::uint32_t opaque = ordinal[f.pixel];
        return f.depth < z || (f.depth == z && opaque != 0 && number(opaque) <= number(f.ordinal));
    });
    std::sort(fragments.begin(), fragments.end(), [&](const TileFragment& a, const TileFragment& b) {
        if (a.pixel != b.pixel) return a.pixel < b.pixel;
        if (a.depth != b.depth) return a.depth < b.depth;
        return number(a.ordinal) > number(b.ordinal);
    });
}

}  // namespace tessera
