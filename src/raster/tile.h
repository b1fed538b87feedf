// One tile from binned triangles to pixels: for every sample visibility, surface records of what is
// seen, shading in batches, transparency from far to near; then the film. A Tile is scratch memory
// that one task at a time uses, and is used again for other tiles and frames.
#pragma once

#include "raster/engine.h"

#include <array>
#include <initializer_list>
#include <vector>

namespace tessera {

// What the tiles of a frame share.
struct TileTask {
    TileTask(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
             const RasterTargets& targets, const TileGrid& grid, const FrontEnd& front);

    const Frame& frame;
    const ShadingContext& shading;
    const RasterSettings& settings;
    const RasterTargets& targets;
    const TileGrid& grid;
    const FrontEnd& front;
    const RasterKernels& kernels;
    const SurfaceSource source;
    // By instance: the planes that it needs, and which instances may share a batch (equal numbers: equal layout,
    // and equal material where it has a say).
    struct Batches {
        std::vector<SurfaceLayout> layouts;
        std::vector<std::uint32_t> batch_of;
    };
    Batches shading_batches;
    const SurfaceLabels labels;
    Batches label_batches;  // where labels of the surface are wanted
};

// Where a pixel of a tile is, whose pixels lie as blocks.
struct TilePixel {
    int x, y;
    TilePixel(std::uint32_t pixel, int side) {
        const int blocks = side / kBlockSide, block = static_cast<int>(pixel) / kBlockPixels,
                  at = static_cast<int>(pixel) % kBlockPixels;
        x = block % blocks * kBlockSide + at % kBlockSide;
        y = block / blocks * kBlockSide + at / kBlockSide;
    }
};

class Tile {
  public:
    Tile();

    // Draws tile `index` of the grid.
    void draw(const TileTask& task, int index);

    TileCounters counters;
    std::uint64_t pixels_covered = 0;
    void reset_counters() { counters = {}, pixels_covered = 0; }

  private:
    struct Fragment {
        std::uint32_t pixel, ordinal;
        float depth;
    };
    using Planes = std::array<std::vector<float>, 4>;  // red, green, blue, alpha by pixel

    void clear_depth();
    void find_visible(SamplePosition offset);
    void sort_fragments();
    std::uint32_t list_visible();
    void make_records(const std::vector<SurfaceLayout>& layouts);
    void take_sample(SamplePosition offset, bool first);
    void shade_opaque(SamplePosition offset, bool first, Planes& planes);
    void shade_list(SamplePosition offset);
    void compose_fragments(SamplePosition offset);
    void label(bool seen);
    void choose_label_fragments();
    void write_labels(bool something) const;
    void clear_surface_labels() const;
    void label_surfaces();
    LabelPlanes label_planes() const;
    void estimate_cost();
    void inspect();
    void finish_colors();
    void fill_background();
    TileWindow window(std::initializer_list<const void*> planes) const;
    DevelopJob develop_job() const;
    std::uint32_t number(std::uint32_t ordinal) const;
    std::size_t picture_place(std::uint32_t pixel) const;
    ShadeJob shade_job(std::uint32_t instance) const;
    static void add_fragment(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth);

    const TileTask* task_ = nullptr;
    int side_ = 0, x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;  // width and height: within the picture
    std::uint32_t triangle_count_ = 0;
    std::uint64_t cost_ = 0;  // of this tile so far
    TileCounters costed_;     // counters at the last estimate
    bool developed_ = false;  // the colours are in the picture already
    std::vector<TileBin> bins_;
    PixelArray<float> depth_, floor_;
    PixelArray<std::uint32_t> ordinal_, overdraw_;
    std::vector<std::uint64_t> hit_;
    std::vector<Fragment> fragments_;
    Buffer<TileTriangle> triangles_;
    Buffer<std::uint8_t> seen_;
    Buffer<std::uint32_t> visible_, record_of_, batch_, batch_ordinals_;
    Buffer<float> records_;
    Planes sum_, sample_;
    // Points of shade_list: the request, and the answer.
    std::vector<std::uint32_t> point_pixel_, point_ordinal_, order_, batch_ordinal_, shown_batches_;
    std::vector<std::int32_t> batch_x_, batch_y_;
    std::array<std::vector<float>, 4> batch_color_, point_color_;
};

}  // namespace tessera
