// What is visible in a tile, found by rays: packets of 4x4 pixels, of which Embree names the triangles. Depth, cut-outs
// and the order of transparent surfaces are decided by the same functions of the picture position as the rasterizer's.
// Scratch memory of one tile at a time.
#pragma once

#include "tile/visible_tile.h"
#include "trace/embree_scene.h"
#include "trace/kernels.h"
#include "trace/sheer_surface.h"

#include <optional>
#include <vector>

namespace tessera {

// What all tiles of a frame share.
struct TraceSource {
    const EmbreeScene* scene;
    const Frame* frame;
    const ShadingContext* shading;
    const TraceKernels* kernels;
    bool depths;  // of opaque surfaces are wanted, for labels
    std::size_t max_fragments;
};

class TraceVisibility final : public TileVisibility {
  public:
    // Before a frame.
    void begin(const TraceSource& source);

    bool enter(const TileArea& area) override;
    void find(SamplePosition offset, bool counted, VisibleTile& tile) override;

    std::uint64_t rays = 0, hits = 0;  // so far

  private:
    // Ordinals of the triangles that were named, by a table of their numbers in the frame.
    std::uint32_t ordinal_of(std::uint32_t instance, std::uint32_t triangle, VisibleTile& tile);
    void forget_triangles();
    void grow_table(const VisibleTile& tile);
    void gather_instances(VisibleTile& tile);
    void see_square(int x, int y, SamplePosition offset, VisibleTile& tile);
    void see_sheer(int x, int y, SamplePosition offset, VisibleTile& tile);
    std::uint32_t place(int x, int y) const;
    void find_depths(SamplePosition offset, VisibleTile& tile);
    std::uint32_t number(const TileTriangle& t) const {
        return source_->frame->instances[t.instance].first_triangle + t.triangle;
    }

    const TraceSource* source_ = nullptr;
    std::optional<PictureRays> rays_;
    std::optional<SheerSurface> surface_, sheer_surface_;
    TileArea area_{};
    struct Slot {
        std::uint32_t number = 0, ordinal = 0;  // 0: free
    };
    std::vector<Slot> table_;
    std::uint32_t last_instance_ = kNoHit, last_triangle_ = 0, last_ordinal_ = 0;
    bool gathered_ = true;  // instances follow each other
    WavePacket packet_{kMeetsAll};
    std::vector<SheerHit> sheer_;
    std::vector<std::uint32_t> instance_count_, new_ordinal_;
    std::vector<TileTriangle> sorted_;
};

}  // namespace tessera
