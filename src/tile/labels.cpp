// Labels of a tile, at the pixel centre: of the nearest surface with alpha of at least one half.
#include "shading/shape_surface.h"
#include "tile/tile.h"

#include <algorithm>

namespace tessera {

// `seen`: the centre is the sample whose visibility stands.
void Tile::label(bool something, bool seen, TileVisibility& visibility) {
    clear_surface_labels();
    if (!something) return write_labels(false);
    // Where colours are drawn the counters are theirs.
    if (!seen) visibility.find({128, 128}, !task_->targets.colors(), visible_);
    if (!visible_.fragments.empty()) choose_label_fragments();
    if (!task_->targets.colors())
        for (const std::uint32_t o : visible_.ordinal) pixels_covered += o != 0;
    write_labels(true);
    if (task_->labels.any()) label_surfaces();
}

// Lets transparent fragments that are solid enough hide what is behind them.
void Tile::choose_label_fragments() {
    make_records(task_->shading_batches.layouts);
    point_pixel_.clear();
    point_ordinal_.clear();
    for (const TileFragment& f : visible_.fragments) {
        point_pixel_.push_back(f.pixel);
        point_ordinal_.push_back(f.ordinal);
    }
    if (task_->frame.has_exact_shapes && task_->settings.shaders) {
        std::unique_ptr<PointShader> shader = task_->settings.shaders->take();
        shade_list({128, 128}, shader.get());
        task_->settings.shaders->give(std::move(shader));
    } else {
        shade_list({128, 128}, nullptr);
    }
    for (std::size_t i = 0; i < visible_.fragments.size(); ++i) {  // the last one that is solid enough stays
        if (!(point_color_[3][i] >= 0.5f)) continue;
        visible_.ordinal[visible_.fragments[i].pixel] = visible_.fragments[i].ordinal;
        visible_.depth[visible_.fragments[i].pixel] = visible_.fragments[i].depth;
    }
    visible_.fragments.clear();
}

// From the tile's first pixel on.
LabelPlanes Tile::label_planes() const {
    const std::size_t first = picture_place(0);
    LabelPlanes p = task_->targets.labels;
    for (std::uint32_t** plane : {&p.triangle, &p.primitive, &p.node, &p.material})
        if (*plane) *plane += first;
    if (p.distance) p.distance += first;
    for (float** plane : {&p.normal, &p.shading_normal, &p.position, &p.albedo})
        if (*plane) *plane += 3 * first;
    if (p.uv) p.uv += 2 * first;
    return p;
}

void Tile::write_labels(bool something) const {
    LabelJob job{};
    job.projection = task_->frame.projection;
    job.x0 = area_.x0;
    job.y0 = area_.y0;
    job.euclidean = task_->targets.euclidean;
    job.depth = visible_.depth.data();
    job.ordinal = something ? visible_.ordinal.data() : nullptr;
    job.triangles = visible_.triangles.data();
    job.instances = task_->frame.instances.data();
    job.planes = label_planes();
    const LabelPlanes& p = job.planes;
    job.window = window({p.distance, p.triangle, p.primitive, p.node, p.material});
    task_->kernels.label(job);
}

void Tile::clear_surface_labels() const {
    const LabelPlanes p = label_planes();
    const auto stride = static_cast<std::size_t>(task_->frame.projection.width);
    const auto clear = [&](float* plane, std::size_t numbers) {
        for (std::size_t y = 0; plane && y < static_cast<std::size_t>(area_.height); ++y)
            std::fill_n(plane + numbers * stride * y, numbers * static_cast<std::size_t>(area_.width), 0.0f);
    };
    for (float* plane : {p.normal, p.shading_normal, p.position, p.albedo}) clear(plane, 3);
    clear(p.uv, 2);
}

// In batches of triangles that share a layout and, where it has a say, the material.
void Tile::label_surfaces() {
    const TileTask::Batches& batches = task_->label_batches;
    make_records(batches.layouts);
    std::vector<std::uint32_t>& shown = shown_batches_;
    shown.clear();
    for (const std::uint32_t* o = list_.data(); *o != 0; ++o) {
        const std::uint32_t batch = batches.batch_of[visible_.triangles[*o - 1].instance];
        if (shown.empty() || shown.back() != batch) shown.push_back(batch);
    }
    std::sort(shown.begin(), shown.end());
    shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
    for (const std::uint32_t batch : shown) {
        LabelSurfaceJob job{};
        job.source = &task_->source;
        job.material = &task_->shading.materials[task_->frame.instances[batch].material];
        job.labels = task_->labels;
        job.layout = batches.layouts[batch];
        job.records = records_.data();
        job.record_of = record_of_.data();
        job.x0 = area_.x0;
        job.y0 = area_.y0;
        job.side = area_.side;
        job.label_from_camera = task_->targets.label_from_camera;
        job.picture_width = static_cast<std::size_t>(task_->frame.projection.width);
        job.planes = label_planes();
        job.depth = visible_.depth.data();
        job.ordinal = visible_.ordinal.data();
        if (shown.size() > 1) {
            std::uint32_t* const own = batch_ordinals_.reserve(visible_.ordinal.size());
            for (std::size_t i = 0; i < visible_.ordinal.size(); ++i) {
                const std::uint32_t o = visible_.ordinal[i];
                own[i] = o != 0 && batches.batch_of[visible_.triangles[o - 1].instance] == batch ? o : 0;
            }
            job.ordinal = own;
        }
        task_->kernels.label_surfaces(job);
    }
    if (task_->frame.has_exact_shapes) label_shapes();
}

// Of what is drawn by its formula, in place of what its triangles said.
void Tile::label_shapes() {
    const ProjectionView& projection = task_->frame.projection;
    const LabelPlanes planes = label_planes();
    const auto store = [](float* plane, std::size_t at, const Vec3T<float>& v) {
        if (plane) plane[3 * at] = v.x, plane[3 * at + 1] = v.y, plane[3 * at + 2] = v.z;
    };
    for (std::uint32_t pixel = 0; pixel < visible_.ordinal.size(); ++pixel) {
        if (visible_.ordinal[pixel] == 0) continue;
        const TileTriangle& seen = visible_.triangles[visible_.ordinal[pixel] - 1];
        const InstanceView& instance = task_->frame.instances[seen.instance];
        if (!instance.shape) continue;
        const TilePixel p(pixel, area_.side);
        const LabelPoint<float> label =
            shape_label(task_->labels, instance, task_->shading.materials[instance.material], projection,
                        task_->targets.label_from_camera, seen.triangle == kLeavingSphere, visible_.depth[pixel],
                        {256 * (area_.x0 + p.x) + 128, 256 * (area_.y0 + p.y) + 128});
        const std::size_t at =
            static_cast<std::size_t>(p.y) * static_cast<std::size_t>(projection.width) + static_cast<std::size_t>(p.x);
        store(planes.normal, at, label.normal);
        store(planes.shading_normal, at, label.shading_normal);
        store(planes.position, at, label.position);
        store(planes.albedo, at, label.albedo);
        if (planes.uv) planes.uv[2 * at] = label.uv.x, planes.uv[2 * at + 1] = label.uv.y;
    }
}

}  // namespace tessera
