#include "tile/tile.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace tessera {
namespace {

void make_record(const InstanceView& instance, std::uint32_t triangle, const ProjectionView& projection,
                 const SurfaceLayout& layout, float* record) {
    TriangleSetup setup;
    setup_triangle(instance, triangle, projection, setup);
    if (setup.visible())
        make_surface_record(instance, triangle, setup, projection, layout, record);
    else
        make_even_record(instance, triangle, projection, layout, record);
}

// The first instance that each one may share a batch with.
void find_batches(const std::vector<InstanceView>& instances, bool by_material, TileTask::Batches& batches) {
    std::vector<std::vector<std::uint32_t>> kinds;
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        const std::uint32_t kind = by_material ? instances[i].material : 0;
        if (kinds.size() <= kind) kinds.resize(kind + 1);
        const auto found = std::find_if(kinds[kind].begin(), kinds[kind].end(), [&](std::uint32_t other) {
            return batches.layouts[other] == batches.layouts[i] &&
                   instances[other].shape.kind == instances[i].shape.kind;
        });
        batches.batch_of.push_back(found == kinds[kind].end() ? i : *found);
        if (batches.batch_of[i] == i) kinds[kind].push_back(i);
    }
}

}  // namespace

TileTask::TileTask(const Frame& f, const ShadingContext& s, const PictureSettings& o, const PictureTargets& t,
                   const TileGrid& g, const InstanceVertices* vertices)
    : frame(f),
      shading(s),
      settings(o),
      targets(t),
      grid(g),
      kernels(tile_kernels(o.isa)),
      source{f.instances.data(), vertices, &s, f.projection, &make_record},
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

void Tile::draw(const TileTask& task, int index, TileVisibility& visibility) {
    task_ = &task;
    const int side_before = area_.side;
    area_ = TileArea(task.grid, index, task.frame.projection);
    if (side_before != area_.side) {
        visible_.resize(area_.side);
        const std::size_t pixels = visible_.ordinal.size();
        hit_.resize(pixels / kBlockPixels);
        for (Planes* planes : {&sum_, &sample_})
            for (std::vector<float>& plane : *planes) plane.resize(pixels);
    }
    const bool something = visibility.enter(area_);
    bool centre_seen = false;
    if (task.targets.colors()) {
        if (!something) {
            fill_background();
        } else {
            std::fill(hit_.begin(), hit_.end(), 0);
            developed_ = false;
            bool first = true;
            if (task.settings.shaders) shader_ = task.settings.shaders->take();
            for (const SamplePosition& offset : task.settings.samples) {
                visibility.find(offset, true, visible_);
                take_sample(offset, first);
                visibility.sample_shaded(visible_, seen_count_);
                first = false;
            }
            if (shader_) task.settings.shaders->give(std::move(shader_));
            finish_colors();
            const SamplePosition only = task.settings.samples[0];
            centre_seen = task.settings.samples.size() == 1 && only.x == 128 && only.y == 128;
        }
        visibility.picture_drawn();
    }
    if (task.targets.labels.any()) label(something, centre_seen, visibility);
}

std::size_t Tile::picture_place(std::uint32_t pixel) const {
    const TilePixel p(pixel, area_.side);
    return static_cast<std::size_t>(area_.y0 + p.y) * static_cast<std::size_t>(task_->frame.projection.width) +
           static_cast<std::size_t>(area_.x0 + p.x);
}

// --- planes of the picture ----------------------------------------------------------------------

// The tile in planes whose first pixels of it are given, or null.
TileWindow Tile::window(std::initializer_list<const void*> planes) const {
    const auto width = static_cast<std::size_t>(task_->frame.projection.width);
    TileWindow w{area_.side, area_.width, area_.height, 4 * width, false};
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
    for (int y = 0; y < area_.height; ++y)
        std::fill_n(task_->targets.linear + 4 * (picture_place(0) + static_cast<std::size_t>(y) * picture_width),
                    4 * area_.width, 0.0f);
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
    for (std::uint32_t pixel = 0; pixel < visible_.ordinal.size(); ++pixel) {
        const TilePixel p(pixel, area_.side);
        if (p.x >= area_.width || p.y >= area_.height) continue;
        float* out = task_->targets.linear + 4 * picture_place(pixel);
        for (std::size_t c = 0; c < 4; ++c) {
            const float v = sum_[c][pixel] * job.weight;
            out[c] = v == v ? v : 0.0f;
        }
    }
}

}  // namespace tessera
