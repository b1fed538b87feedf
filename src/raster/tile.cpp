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
      source{f.instances.data(), &s, f.projection, &make_record} {
    // The first instance that each one may be shaded with, by material.
    std::vector<std::vector<std::uint32_t>> kinds;
    for (std::uint32_t i = 0; i < f.instances.size(); ++i) {
        const InstanceView& instance = f.instances[i];
        layouts.push_back(
            surface_layout(instance.mesh, s.materials[instance.material], f.projection.orthographic));
        if (kinds.size() <= instance.material) kinds.resize(instance.material + 1);
        std::vector<std::uint32_t>& same_material = kinds[instance.material];
        const auto found = std::find_if(same_material.begin(), same_material.end(), [&](std::uint32_t other) {
            return layouts[other] == layouts[i];
        });
        batch_of.push_back(found == same_material.end() ? i : *found);
        if (batch_of[i] == i) same_material.push_back(i);
    }
}

Tile::Tile() = default;

void Tile::draw(const TileTask& task, int index) {
    task_ = &task;
    if (side_ != task.grid.side) {
        side_ = task.grid.side;
        const auto pixels = static_cast<std::size_t>(side_ * side_);
        depth_.resize(pixels);
        ordinal_.resize(pixels);
        floor_.resize(pixels / kBlockPixels + kMaxLanes);
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
    if (task.targets.labels()) label(centre_seen);
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

// --- shading ----------------------------------------------------------------------------------

// Surface records of everything seen, in runs of one instance.
void Tile::make_records() {
    VisibleJob visible{};
    visible.ordinal = ordinal_.data();
    visible.pixels = side_ * side_;
    visible.triangle_count = triangle_count_;
    visible.seen = seen_.reserve(triangle_count_ + 1);
    visible.list = visible_.reserve(triangle_count_ + 1);
    task_->kernels.find_visible(visible);
    std::uint32_t count = visible.count;
    if (!fragments_.empty()) {
        for (const Fragment& f : fragments_) seen_[f.ordinal] = 1;
        count = 0;
        for (std::uint32_t i = 1; i <= triangle_count_; ++i)
            if (seen_[i]) visible_[count++] = i;
    }
    std::uint32_t* record_of = record_of_.reserve(triangle_count_ + 1);
    record_of[0] = 0;
    batch_.reserve(count);
    std::size_t used = 0;
    for (std::uint32_t first = 0; first < count;) {
        const std::uint32_t instance = triangles_[visible_[first] - 1].instance;
        SurfaceJob job{};
        job.source = &task_->source;
        job.instance = &task_->frame.instances[instance];
        job.layout = task_->layouts[instance];
        const auto floats = static_cast<std::size_t>(surface_floats(job.layout));
        std::uint32_t end = first;
        for (; end < count && triangles_[visible_[end] - 1].instance == instance; ++end) {
            batch_[end - first] = triangles_[visible_[end] - 1].triangle;
            record_of[visible_[end]] = static_cast<std::uint32_t>(used + (end - first) * floats);
        }
        job.triangles = batch_.data();
        job.count = end - first;
        job.records = records_.reserve(used + (job.count + kMaxLanes) * floats, used) + used;
        task_->kernels.make_surfaces(job);
        used += job.count * floats;
        first = end;
    }
    visible_[count] = 0;
}

ShadeJob Tile::shade_job(std::uint32_t instance) const {
    ShadeJob job{};
    job.source = &task_->source;
    job.material = &task_->shading.materials[task_->frame.instances[instance].material];
    job.layout = task_->layouts[instance];
    job.records = records_.data();
    job.record_of = record_of_.data();
    return job;
}

void Tile::take_sample(SamplePosition offset, bool first) {
    make_records();
    if (fragments_.empty()) return shade_opaque(offset, first, sum_);
    shade_opaque(offset, true, sample_);
    compose_fragments(offset);
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t i = 0; i < depth_.size(); ++i) sum_[c][i] = (first ? 0.0f : sum_[c][i]) + sample_[c][i];
}

// The nearest opaque surface of every pixel: at once where the tile shows one material, else as a list.
void Tile::shade_opaque(SamplePosition offset, bool first, Planes& planes) {
    std::uint32_t batch = 0;
    bool one = true, any = false;
    for (const std::uint32_t* o = visible_.data(); *o != 0 && one; ++o) {
        const std::uint32_t instance = triangles_[*o - 1].instance;
        const AlphaMode mode = task_->shading.materials[task_->frame.instances[instance].material].alpha_mode;
        if (mode == AlphaMode::kBlend) continue;
        one = !any || batch == task_->batch_of[instance];
        batch = task_->batch_of[instance];
        any = true;
    }
    if (one && any) {
        const bool at_once = task_->settings.samples.size() == 1 && fragments_.empty() && !task_->targets.linear;
        const DevelopJob film = develop_job();
        ShadeJob job = shade_job(batch);
        job.x0 = x0_;
        job.y0 = y0_;
        job.side = side_;
        job.offset = offset;
        job.ordinal = ordinal_.data();
        job.first = first;
        job.develop = at_once ? &film : nullptr;
        job.hit = hit_.data();
        job.r = planes[0].data();
        job.g = planes[1].data();
        job.b = planes[2].data();
        job.alpha = planes[3].data();
        developed_ = at_once;
        task_->kernels.shade_tile(job);
        return;
    }
    if (first)
        for (std::vector<float>& plane : planes) std::fill(plane.begin(), plane.end(), 0.0f);
    point_pixel_.clear();
    point_ordinal_.clear();
    for (std::uint32_t pixel = 0; pixel < ordinal_.size(); ++pixel)
        if (ordinal_[pixel] != 0) {
            point_pixel_.push_back(pixel);
            point_ordinal_.push_back(ordinal_[pixel]);
        }
    shade_list(offset);
    for (std::size_t i = 0; i < point_pixel_.size(); ++i) {
        const std::uint32_t pixel = point_pixel_[i];
        for (std::size_t c = 0; c < 3; ++c) planes[c][pixel] += point_color_[c][i];
        planes[3][pixel] += 1.0f;
        hit_[pixel / kBlockPixels] |= std::uint64_t{1} << pixel % kBlockPixels;
    }
}

// Shades point_ordinal_ at point_pixel_ into point_color_, in batches of one material and layout.
void Tile::shade_list(SamplePosition offset) {
    const std::size_t count = point_ordinal_.size();
    for (std::vector<float>& plane : point_color_) plane.resize(count);
    const auto batch = [&](std::uint32_t point) {
        return task_->batch_of[triangles_[point_ordinal_[point] - 1].instance];
    };
    order_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) order_[i] = i;
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return batch(a) < batch(b); });
    for (std::size_t first = 0; first < count;) {
        const std::uint32_t current = batch(order_[first]);
        std::size_t end = first + 1;
        while (end < count && batch(order_[end]) == current) ++end;
        const std::size_t n = end - first, padded = n + kMaxLanes;
        batch_x_.resize(padded);
        batch_y_.resize(padded);
        batch_ordinal_.resize(padded);
        for (std::vector<float>& plane : batch_color_) plane.resize(padded);
        for (std::size_t i = 0; i < padded; ++i) {
            const std::uint32_t point = order_[first + std::min(i, n - 1)];
            const TilePixel p(point_pixel_[point], side_);
            batch_x_[i] = 256 * (x0_ + p.x) + offset.x;
            batch_y_[i] = 256 * (y0_ + p.y) + offset.y;
            batch_ordinal_[i] = point_ordinal_[point];
        }
        ShadeJob job = shade_job(current);
        job.x = batch_x_.data();
        job.y = batch_y_.data();
        job.list = batch_ordinal_.data();
        job.count = static_cast<std::uint32_t>(n);
        job.r = batch_color_[0].data();
        job.g = batch_color_[1].data();
        job.b = batch_color_[2].data();
        job.alpha = batch_color_[3].data();
        task_->kernels.shade_points(job);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t c = 0; c < 4; ++c) point_color_[c][order_[first + i]] = batch_color_[c][i];
        first = end;
    }
}

// Lays the transparent fragments over the sample's colours, far to near.
void Tile::compose_fragments(SamplePosition offset) {
    point_pixel_.clear();
    point_ordinal_.clear();
    for (const Fragment& f : fragments_) {
        point_pixel_.push_back(f.pixel);
        point_ordinal_.push_back(f.ordinal);
    }
    shade_list(offset);
    for (std::size_t i = 0; i < point_pixel_.size(); ++i) {
        const std::uint32_t pixel = point_pixel_[i];
        const float a = point_color_[3][i];
        for (std::size_t c = 0; c < 3; ++c)
            sample_[c][pixel] = point_color_[c][i] * a + sample_[c][pixel] * (1.0f - a);
        sample_[3][pixel] = a + sample_[3][pixel] * (1.0f - a);
        hit_[pixel / kBlockPixels] |= std::uint64_t{1} << pixel % kBlockPixels;
    }
}

// --- planes of the picture ----------------------------------------------------------------------

// Labels at the pixel centre: of the nearest surface with alpha of at least one half. `seen`: the
// centre is the sample whose visibility stands.
void Tile::label(bool seen) {
    const SamplePosition centre{128, 128};
    if (!seen) {
        const TileCounters before = counters;
        find_visible(centre);
        // Where colours are drawn the counters are theirs.
        if (task_->targets.colors()) counters = before;
    }
    if (!fragments_.empty()) {
        make_records();
        point_pixel_.clear();
        point_ordinal_.clear();
        for (const Fragment& f : fragments_) {
            point_pixel_.push_back(f.pixel);
            point_ordinal_.push_back(f.ordinal);
        }
        shade_list(centre);
        for (std::size_t i = 0; i < fragments_.size(); ++i) {  // the last one that is solid enough stays
            if (!(point_color_[3][i] >= 0.5f)) continue;
            ordinal_[fragments_[i].pixel] = fragments_[i].ordinal;
            depth_[fragments_[i].pixel] = fragments_[i].depth;
        }
    }
    if (!task_->targets.colors())
        for (const std::uint32_t o : ordinal_) pixels_covered += o != 0;
    LabelJob job{};
    job.projection = task_->frame.projection;
    job.side = side_;
    job.width = width_;
    job.height = height_;
    job.depth = depth_.data();
    job.ordinal = ordinal_.data();
    job.triangles = triangles_.data();
    job.instances = task_->frame.instances.data();
    job.stride = static_cast<std::size_t>(task_->frame.projection.width);
    const std::size_t first = picture_place(0);
    job.distance = task_->targets.distance ? task_->targets.distance + first : nullptr;
    job.triangle = task_->targets.triangle ? task_->targets.triangle + first : nullptr;
    task_->kernels.label(job);
}

// A tile that nothing reaches.
void Tile::fill_background() {
    DevelopJob job = develop_job();
    job.r = nullptr;
    if (job.rgba) task_->kernels.develop(job);
    if (!task_->targets.linear) return;
    const auto picture_width = static_cast<std::size_t>(task_->frame.projection.width);
    for (int y = 0; y < height_; ++y)
        std::fill_n(task_->targets.linear +
                        4 * (picture_place(0) + static_cast<std::size_t>(y) * picture_width),
                    4 * width_, 0.0f);
}

DevelopJob Tile::develop_job() const {
    DevelopJob job{};
    job.film = task_->settings.film;
    job.weight = 1.0f / static_cast<float>(task_->settings.samples.size());
    job.side = side_;
    job.width = width_;
    job.height = height_;
    job.r = sum_[0].data();
    job.g = sum_[1].data();
    job.b = sum_[2].data();
    job.alpha = sum_[3].data();
    job.rgba = task_->targets.rgba ? task_->targets.rgba + 4 * picture_place(0) : nullptr;
    job.stride = 4 * static_cast<std::size_t>(task_->frame.projection.width);
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
