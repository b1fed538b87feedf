#include "raster/tile.h"

#include <tessera/error.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace tessera {
namespace {

void make_record(const InstanceView& instance, std::uint32_t triangle, const ProjectionView& projection,
                 const SurfaceLayout& layout, float* record) {
    TriangleSetup setup;
    setup_triangle(instance, triangle, projection, setup);
    if (setup.visible()) make_surface_record(instance, triangle, setup, projection, layout, record);
}

// The first instance that each one may share a batch with.
void find_batches(const std::vector<InstanceView>& instances, bool by_material, TileTask::Batches& batches) {
    std::vector<std::vector<std::uint32_t>> kinds;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        const std::uint32_t kind = by_material ? instances[i].material : 0;
        if (kinds.size() <= kind) kinds.resize(kind + 1);
        const auto found = std::find_if(kinds[kind].begin(), kinds[kind].end(), [&](std::uint32_t other) {
            return batches.layouts[other] == batches.layouts[i];
        });
        batches.batch_of.push_back(found == kinds[kind].end() ? i : *found);
        if (batches.batch_of[i] == i) kinds[kind].push_back(i);
    }
}

}  // namespace

TileTask::TileTask(const Frame& f, const ShadingContext& s, const RasterSettings& o, const RasterTargets& t,
                   const TileGrid& g, const FrontEnd& e)
    : frame(f),
      shading(s),
      settings(o),
      targets(t),
      grid(g),
      front(e),
      kernels(raster_kernels(o.isa)),
      source{f.instances.data(), e.vertices(), &s, f.projection, &make_record},
      labels(t.surface_labels()) {
    const bool orthographic = f.projection.orthographic;
    for (const InstanceView& i : f.instances) {
        const MaterialView& material = s.materials[i.material];
        shading_batches.layouts.push_back(surface_layout(i.mesh, material, orthographic));
        if (labels.any()) label_batches.layouts.push_back(label_layout(i.mesh, material, labels, orthographic));
    }
    find_batches(f.instances, true, shading_batches);
    if (labels.any()) find_batches(f.instances, labels.of_material(), label_batches);
}

Tile::Tile() = default;

void Tile::draw(const TileTask& task, int index) {
    task_ = &task;
    if (side_ != task.grid.side) {
        side_ = task.grid.side;
        const auto pixels = static_cast<std::size_t>(side_ * side_);
        depth_.resize(pixels);
        ordinal_.resize(pixels);
        floor_.resize(pixels / kBlockPixels);
        hit_.resize(pixels / kBlockPixels);
        for (Planes* planes : {&sum_, &sample_})
            for (std::vector<float>& plane : *planes) plane.resize(pixels);
    }
    x0_ = index % task.grid.columns * side_;
    y0_ = index / task.grid.columns * side_;
    width_ = std::min(side_, static_cast<int>(task.frame.projection.width) - x0_);
    height_ = std::min(side_, static_cast<int>(task.frame.projection.height) - y0_);
    triangle_count_ = task.front.bins_of(index, bins_);
    if (task.settings.inspection.overdraw) overdraw_.assign(depth_.size(), 0);
    cost_ = 0;
    costed_ = counters;

    bool centre_seen = false;
    if (task.targets.colors()) {
        if (triangle_count_ == 0) {
            fill_background();
        } else {
            std::fill(hit_.begin(), hit_.end(), 0);
            developed_ = false;
            bool first = true;
            for (const SamplePosition& offset : task.settings.samples) {
                find_visible(offset);
                take_sample(offset, first);
                if (task.settings.inspection.cost) estimate_cost();
                first = false;
            }
            finish_colors();
            const SamplePosition only = task.settings.samples[0];
            centre_seen = task.settings.samples.size() == 1 && only.x == 128 && only.y == 128;
        }
        inspect();
    }
    if (task.targets.labels.any()) label(centre_seen);
}

std::uint32_t Tile::number(std::uint32_t ordinal) const {
    const TileTriangle& t = triangles_[ordinal - 1];
    return task_->frame.instances[t.instance].first_triangle + t.triangle;
}

std::size_t Tile::picture_place(std::uint32_t pixel) const {
    const TilePixel p(pixel, side_);
    return static_cast<std::size_t>(y0_ + p.y) * static_cast<std::size_t>(task_->frame.projection.width) +
           static_cast<std::size_t>(x0_ + p.x);
}

// --- visibility -------------------------------------------------------------------------------

void Tile::add_fragment(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth) {
    Tile& tile = *static_cast<Tile*>(owner);
    if (tile.fragments_.size() >= tile.task_->settings.max_fragments)
        throw Error(ErrorCode::kLimit, "transparent surfaces need more memory than the limit allows");
    tile.fragments_.push_back({pixel, ordinal, depth});
}

// Far everywhere, and infinitely near beyond the picture, where nothing passes.
void Tile::clear_depth() {
    std::fill(depth_.begin(), depth_.end(), 0.0f);
    std::fill(floor_.begin(), floor_.end(), 0.0f);
    if (width_ == side_ && height_ == side_) return;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const int blocks = side_ / kBlockSide;
    for (int block = 0; block < blocks * blocks; ++block) {
        const int columns = width_ - block % blocks * kBlockSide, rows = height_ - block / blocks * kBlockSide;
        if (columns >= kBlockSide && rows >= kBlockSide) continue;
        const auto b = static_cast<std::size_t>(block);
        if (columns <= 0 || rows <= 0) floor_[b] = kInfinity;
        float* const depth = depth_.data() + b * kBlockPixels;
        for (int i = 0; i < kBlockPixels; ++i)
            if (i % kBlockSide >= columns || i / kBlockSide >= rows) depth[i] = kInfinity;
    }
}

void Tile::find_visible(SamplePosition offset) {
    clear_depth();
    std::fill(ordinal_.begin(), ordinal_.end(), 0u);
    fragments_.clear();
    VisibilityJob job{};
    job.x0 = x0_;
    job.y0 = y0_;
    job.side = side_;
    job.offset = offset;
    job.bins = bins_.data();
    job.bin_count = static_cast<std::uint32_t>(bins_.size());
    job.source = &task_->source;
    job.hierarchical_z = task_->settings.hierarchical_z;
    job.count = task_->settings.count || task_->settings.inspection.overdraw;
    job.depth = depth_.data();
    job.ordinal = ordinal_.data();
    job.floor = floor_.data();
    job.triangles = triangles_.reserve(triangle_count_);
    job.add_fragment = &add_fragment;
    job.owner = this;
    job.overdraw = task_->settings.inspection.overdraw ? overdraw_.data() : nullptr;
    task_->kernels.visibility(job);
    counters.samples_covered += job.counters.samples_covered;
    counters.fragments_passed += job.counters.fragments_passed;
    counters.blocks_drawn += job.counters.blocks_drawn;
    counters.blocks_hidden += job.counters.blocks_hidden;
    sort_fragments();
}

// By pixel, far to near, at equal depth the lower number on top; without what the opaque surface hides.
void Tile::sort_fragments() {
    if (fragments_.empty()) return;
    std::erase_if(fragments_, [&](const Fragment& f) {
        const float z = depth_[f.pixel];
        return f.depth < z || (f.depth == z && ordinal_[f.pixel] != 0 && ordinal_[f.pixel] <= f.ordinal);
    });
    std::sort(fragments_.begin(), fragments_.end(), [](const Fragment& a, const Fragment& b) {
        if (a.pixel != b.pixel) return a.pixel < b.pixel;
        if (a.depth != b.depth) return a.depth < b.depth;
        return a.ordinal > b.ordinal;
    });
}

// --- planes of the picture ----------------------------------------------------------------------

// The tile in planes whose first pixels of it are given, or null.
TileWindow Tile::window(std::initializer_list<const void*> planes) const {
    const auto width = static_cast<std::size_t>(task_->frame.projection.width);
    TileWindow w{side_, width_, height_, 4 * width, false};
    // More than that does not stay in the caches until somebody reads it.
    constexpr std::size_t kLine = 64, kStays = std::size_t{4} << 20;
    w.streamed = w.stride % kLine == 0 && w.stride * static_cast<std::size_t>(task_->frame.projection.height) > kStays;
    for (const void* plane : planes) w.streamed &= reinterpret_cast<std::uintptr_t>(plane) % kLine == 0;
    return w;
}

// A tile that nothing reaches.
void Tile::fill_background() {
    DevelopJob job = develop_job();
    job.r = nullptr;
    if (job.rgba) task_->kernels.develop(job);
    if (!task_->targets.linear) return;
    const auto picture_width = static_cast<std::size_t>(task_->frame.projection.width);
    for (int y = 0; y < height_; ++y)
        std::fill_n(task_->targets.linear + 4 * (picture_place(0) + static_cast<std::size_t>(y) * picture_width),
                    4 * width_, 0.0f);
}

DevelopJob Tile::develop_job() const {
    DevelopJob job{};
    job.film = task_->settings.film;
    job.weight = 1.0f / static_cast<float>(task_->settings.samples.size());
    job.r = sum_[0].data();
    job.g = sum_[1].data();
    job.b = sum_[2].data();
    job.alpha = sum_[3].data();
    job.rgba = task_->targets.rgba ? task_->targets.rgba + 4 * picture_place(0) : nullptr;
    job.window = window({job.rgba});
    return job;
}

// Counts what was hit, and writes the colours that are not there yet.
void Tile::finish_colors() {
    for (const std::uint64_t block : hit_)
        if (block) pixels_covered += static_cast<std::uint64_t>(std::popcount(block));
    if (developed_) return;
    const DevelopJob job = develop_job();
    if (job.rgba) task_->kernels.develop(job);
    if (!task_->targets.linear) return;
    for (std::uint32_t pixel = 0; pixel < depth_.size(); ++pixel) {
        const TilePixel p(pixel, side_);
        if (p.x >= width_ || p.y >= height_) continue;
        float* out = task_->targets.linear + 4 * picture_place(pixel);
        for (std::size_t c = 0; c < 4; ++c) {
            const float v = sum_[c][pixel] * job.weight;
            out[c] = v == v ? v : 0.0f;
        }
    }
}

}  // namespace tessera
