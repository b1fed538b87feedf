// What RasterInspection asks of a tile: its bins, depth tests, floors, and an estimate of its cost.
#include "raster/raster_visibility.h"

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

// Adds what the sample took.
void RasterVisibility::sample_shaded(const VisibleTile& tile, std::uint32_t seen) {
    if (!source_->inspection.cost) return;
    std::uint64_t small = 0, large = 0;
    for (const TileBin& bin : bins_)
        for (std::uint32_t r = 0; r < bin.run_count; ++r) (bin.runs[r].large() ? large : small) += bin.runs[r].size();
    const auto shaded =
        static_cast<std::uint64_t>(tile.ordinal.size()) -
        static_cast<std::uint64_t>(std::count(tile.ordinal.begin(), tile.ordinal.end(), std::uint32_t{0}));
    cost_ += kSmallTriangle * small + kLargeTriangle * large;
    cost_ += kBlockDrawn * (counters.blocks_drawn - costed_.blocks_drawn);
    cost_ += kBlockHidden * (counters.blocks_hidden - costed_.blocks_hidden);
    cost_ += kTriangleSeen * seen + kSampleShaded * shaded + kFragmentShaded * tile.fragments.size();
    costed_ = counters;
}

void RasterVisibility::picture_drawn() {
    const RasterInspection& out = source_->inspection;
    if (!out.bins && !out.overdraw && !out.floor && !out.cost) return;
    const auto cost =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(cost_, std::numeric_limits<std::uint32_t>::max()));
    const auto picture_width = static_cast<std::size_t>(source_->surfaces->projection.width);
    for (std::uint32_t pixel = 0; pixel < static_cast<std::uint32_t>(area_.side * area_.side); ++pixel) {
        const TilePixel p(pixel, area_.side);
        if (p.x >= area_.width || p.y >= area_.height) continue;
        const std::size_t place =
            static_cast<std::size_t>(area_.y0 + p.y) * picture_width + static_cast<std::size_t>(area_.x0 + p.x);
        if (out.bins) out.bins[place] = triangle_count_;
        if (out.overdraw) out.overdraw[place] = overdraw_[pixel];
        if (out.floor) out.floor[place] = triangle_count_ ? floor_[pixel / kBlockPixels] : 0.0f;
        if (out.cost) out.cost[place] = cost;
    }
}

}  // namespace tessera
