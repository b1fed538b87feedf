// What RasterInspection asks of a tile: its bins, depth tests, floors, and an estimate of its cost.
#include "raster/tile.h"

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

// Cycles of the AVX-512 kernels on a Zen 4 core, rounded from measurements of whole scenes. They are
// weights: the same everywhere, so that the picture is, whatever the processor. Vertices and set-up, which
// belong to no tile, are left out, and so is the film, which costs every tile the same.
constexpr std::uint64_t kSmallTriangle = 48;   // its mask, 2 to 4 pixels
constexpr std::uint64_t kLargeTriangle = 60;   // its edges, blocks classified; or a box of few pixels
constexpr std::uint64_t kBlockDrawn = 24;      // 64 samples
constexpr std::uint64_t kBlockHidden = 4;      // left out by hierarchical Z
constexpr std::uint64_t kTriangleSeen = 100;   // its surface record
constexpr std::uint64_t kSampleShaded = 8;     // an opaque one
constexpr std::uint64_t kFragmentShaded = 40;  // a transparent one: sorted, shaded as a point, composed

}  // namespace

// After each sample: adds what it took.
void Tile::estimate_cost() {
    std::uint64_t small = 0, large = 0;
    for (const TileBin& bin : bins_)
        for (std::uint32_t r = 0; r < bin.run_count; ++r) (bin.runs[r].large() ? large : small) += bin.runs[r].size();
    std::uint64_t seen = 0;
    while (visible_[seen] != 0) ++seen;
    const auto shaded = static_cast<std::uint64_t>(ordinal_.size()) -
                        static_cast<std::uint64_t>(std::count(ordinal_.begin(), ordinal_.end(), std::uint32_t{0}));
    cost_ += kSmallTriangle * small + kLargeTriangle * large;
    cost_ += kBlockDrawn * (counters.blocks_drawn - costed_.blocks_drawn);
    cost_ += kBlockHidden * (counters.blocks_hidden - costed_.blocks_hidden);
    cost_ += kTriangleSeen * seen + kSampleShaded * shaded + kFragmentShaded * fragments_.size();
    costed_ = counters;
}

void Tile::inspect() {
    const RasterInspection& out = task_->settings.inspection;
    if (!out.bins && !out.overdraw && !out.floor && !out.cost) return;
    const auto cost =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(cost_, std::numeric_limits<std::uint32_t>::max()));
    for (std::uint32_t pixel = 0; pixel < depth_.size(); ++pixel) {
        const TilePixel p(pixel, side_);
        if (p.x >= width_ || p.y >= height_) continue;
        const std::size_t place = picture_place(pixel);
        if (out.bins) out.bins[place] = triangle_count_;
        if (out.overdraw) out.overdraw[place] = overdraw_[pixel];
        if (out.floor) out.floor[place] = triangle_count_ ? floor_[pixel / kBlockPixels] : 0.0f;
        if (out.cost) out.cost[place] = cost;
    }
}

}  // namespace tessera
