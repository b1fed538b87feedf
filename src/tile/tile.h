// One tile from what is visible to pixels: for every sample surface records of what is seen, shading in batches,
// transparency from far to near; then the film, and labels. A Tile is scratch memory that one task at a time uses, and
// is used again for other tiles and frames.
#pragma once

#include "core/parallel.h"
#include "geometry/frame.h"
#include "tile/kernels.h"
#include "tile/picture.h"
#include "tile/visible_tile.h"

#include <array>
#include <atomic>
#include <functional>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <vector>

namespace tessera {

// What the tiles of a frame share.
struct TileTask {
    // `vertices`: of the frame's instances in the picture, where they are known already.
    TileTask(const Frame& frame, const ShadingContext& shading, const PictureSettings& settings,
             const PictureTargets& targets, const TileGrid& grid, const InstanceVertices* vertices);

    const Frame& frame;
    const ShadingContext& shading;
    const PictureSettings& settings;
    const PictureTargets& targets;
    const TileGrid& grid;
    const TileKernels& kernels;
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

class Tile {
  public:
    Tile();

    // Draws tile `index` of the grid, as far as `visibility` sees something in it.
    void draw(const TileTask& task, int index, TileVisibility& visibility);

    std::uint64_t pixels_covered = 0;  // so far

  private:
    using Planes = std::array<std::vector<float>, 4>;  // red, green, blue, alpha by pixel

    std::uint32_t list_visible();
    void make_records(const std::vector<SurfaceLayout>& layouts);
    void take_sample(SamplePosition offset, bool first);
    void shade_opaque(SamplePosition offset, bool first, Planes& planes);
    void list_opaque();
    void add_points(bool first, Planes& planes);
    void shade_list(SamplePosition offset, PointShader* shader);
    void shade_list_traced(SamplePosition offset, PointShader& shader);
    void compose_fragments(SamplePosition offset);
    void label(bool something, bool seen, TileVisibility& visibility);
    void choose_label_fragments();
    void write_labels(bool something) const;
    void clear_surface_labels() const;
    void label_surfaces();
    void label_shapes();
    LabelPlanes label_planes() const;
    void finish_colors();
    void fill_background();
    TileWindow window(std::initializer_list<const void*> planes) const;
    DevelopJob develop_job() const;
    std::size_t picture_place(std::uint32_t pixel) const;
    ShadeJob shade_job(std::uint32_t instance) const;

    const TileTask* task_ = nullptr;
    std::unique_ptr<PointShader> shader_;  // while light is traced
    TileArea area_{};
    std::uint32_t seen_count_ = 0;  // triangles with a record
    bool developed_ = false;        // the colours are in the picture already
    VisibleTile visible_;
    std::vector<std::uint64_t> hit_;
    Buffer<std::uint8_t> seen_;
    Buffer<std::uint32_t> list_, record_of_, batch_, batch_ordinals_;
    Buffer<float> records_;
    Planes sum_, sample_;
    // Points of shade_list: the request, and the answer.
    std::vector<std::uint32_t> point_pixel_, point_ordinal_, order_, batch_ordinal_, shown_batches_;
    std::vector<std::int32_t> batch_x_, batch_y_;
    std::array<std::vector<float>, 4> batch_color_, point_color_;
};

// The tiles of an engine, each with the engine's own visibility: as many as tasks run at a time, kept from frame to
// frame.
template <class Visibility>
class TilePool {
  public:
    struct Worker {
        Tile tile;
        Visibility visibility;
    };

    // Draws all tiles; `begin` prepares every worker's visibility for the frame.
    template <class Begin>
    void draw(const TileTask& task, Arena& arena, Begin&& begin) {
        for (const std::unique_ptr<Worker>& w : idle_) w->tile.pixels_covered = 0, begin(w->visibility);
        const auto count = static_cast<std::size_t>(task.grid.count());
        std::atomic<std::size_t> done{0};
        arena.for_each(count, [&](std::size_t index) {
            task.settings.checkpoint(static_cast<double>(done.load()) / static_cast<double>(count));
            std::unique_ptr<Worker> worker = take(begin);
            worker->tile.draw(task, static_cast<int>(index), worker->visibility);
            give(std::move(worker));
            ++done;
        });
        task.settings.checkpoint(1.0);
    }
    // Of the last frame.
    template <class Visit>
    void visit(Visit&& visit) const {
        for (const std::unique_ptr<Worker>& w : idle_) visit(*w);
    }

  private:
    template <class Begin>
    std::unique_ptr<Worker> take(Begin& begin) {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                std::unique_ptr<Worker> worker = std::move(idle_.back());
                idle_.pop_back();
                return worker;
            }
        }
        auto worker = std::make_unique<Worker>();
        begin(worker->visibility);
        return worker;
    }
    void give(std::unique_ptr<Worker> worker) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(worker));
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<Worker>> idle_;
};

}  // namespace tessera
