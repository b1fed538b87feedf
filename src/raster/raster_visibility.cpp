#include "raster/raster_visibility.h"

#include <algorithm>
#include <limits>

namespace tessera {

bool RasterVisibility::enter(const TileArea& area) {
    area_ = area;
    const auto pixels = static_cast<std::size_t>(area.side * area.side);
    floor_.resize(pixels / kBlockPixels);
    triangle_count_ = source_->front->bins_of(area.index, bins_);
    if (source_->inspection.overdraw) overdraw_.assign(pixels, 0);
    cost_ = 0;
    costed_ = counters;
    return triangle_count_ > 0;
}

// Far everywhere, and infinitely near beyond the picture, where nothing passes.
void RasterVisibility::clear_depth(VisibleTile& tile) {
    std::fill(tile.depth.begin(), tile.depth.end(), 0.0f);
    std::fill(floor_.begin(), floor_.end(), 0.0f);
    if (area_.width == area_.side && area_.height == area_.side) return;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const int blocks = area_.side / kBlockSide;
    for (int block = 0; block < blocks * blocks; ++block) {
        const int columns = area_.width - block % blocks * kBlockSide,
                  rows = area_.height - block / blocks * kBlockSide;
        if (columns >= kBlockSide && rows >= kBlockSide) continue;
        const auto b = static_cast<std::size_t>(block);
        if (columns <= 0 || rows <= 0) floor_[b] = kInfinity;
        float* const depth = tile.depth.data() + b * kBlockPixels;
        for (int i = 0; i < kBlockPixels; ++i)
            if (i % kBlockSide >= columns || i / kBlockSide >= rows) depth[i] = kInfinity;
    }
}

void RasterVisibility::add_fragment(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth) {
    const RasterVisibility& self = *static_cast<RasterVisibility*>(owner);
    self.tile_->add_fragment({pixel, ordinal, depth}, self.source_->max_fragments);
}

void RasterVisibility::find(SamplePosition offset, bool counted, VisibleTile& tile) {
    clear_depth(tile);
    std::fill(tile.ordinal.begin(), tile.ordinal.end(), 0u);
    tile.fragments.clear();
    tile.triangle_count = triangle_count_;
    tile_ = &tile;
    VisibilityJob job{};
    job.x0 = area_.x0;
    job.y0 = area_.y0;
    job.side = area_.side;
    job.offset = offset;
    job.bins = bins_.data();
    job.bin_count = static_cast<std::uint32_t>(bins_.size());
    job.source = source_->surfaces;
    job.hierarchical_z = source_->hierarchical_z;
    job.count = source_->count || source_->inspection.overdraw;
    job.depth = tile.depth.data();
    job.ordinal = tile.ordinal.data();
    job.floor = floor_.data();
    job.triangles = tile.triangles.reserve(triangle_count_);
    job.add_fragment = &add_fragment;
    job.owner = this;
    job.overdraw = source_->inspection.overdraw ? overdraw_.data() : nullptr;
    source_->kernels->visibility(job);
    tile.sort_fragments(source_->surfaces->instances);
    if (!counted) return;
    counters.samples_covered += job.counters.samples_covered;
    counters.fragments_passed += job.counters.fragments_passed;
    counters.blocks_drawn += job.counters.blocks_drawn;
    counters.blocks_hidden += job.counters.blocks_hidden;
}

}  // namespace tessera
