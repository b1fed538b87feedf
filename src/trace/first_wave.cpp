// The first wave: the samples of the picture, whose surface points come from the rasterizer's surface function, or from
// the formula of a shape.
#include "shading/transport.h"
#include "tile/tile.h"
#include "trace/waves.h"

#include <algorithm>

namespace tessera {

void WaveShader::take_samples(const TileTask& task, const SampleList& samples, std::uint32_t first,
                              std::uint32_t count) {
    if (waves_.empty()) waves_.push_back(std::make_unique<Wave>());
    Wave& wave = *waves_[0];
    wave.ray_count = count;
    wave.reserve_rays(count);
    if (!scene_->simple) wave.states.assign(count, RayState{});
    // Triangles of one instance have ordinals that follow each other.
    const std::uint32_t instance = samples.triangles[samples.seen[0] - 1].instance;
    if (instance == samples.triangles[samples.seen[samples.seen_count - 1] - 1].instance) {
        std::fill_n(wave.instance.data(), count, instance);
        const bool exact{task.frame.instances[instance].shape};  // else nobody asks for the triangles
        for (std::uint32_t i = 0; exact && i < count; ++i)
            wave.triangle[i] = samples.triangles[samples.ordinal[first + i] - 1].triangle;
        arrange_one(wave, instance, exact);
        find_picture_points(task, samples, samples.x + first, samples.y + first, samples.ordinal + first);
        return;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const TileTriangle& t = samples.triangles[samples.ordinal[first + i] - 1];
        wave.instance[i] = t.instance;
        wave.triangle[i] = t.triangle;
    }
    arrange(task, wave);
    std::int32_t *const x = x_.reserve(wave.point_count), *const y = y_.reserve(wave.point_count);
    std::uint32_t* const ordinal = ordinal_.reserve(wave.point_count);
    for (std::uint32_t p = 0; p < wave.point_count; ++p) {
        const std::uint32_t from = first + wave.ray[p];
        x[p] = samples.x[from], y[p] = samples.y[from], ordinal[p] = samples.ordinal[from];
    }
    find_picture_points(task, samples, x, y, ordinal);
}

// The surface points of the first wave, which has these positions and ordinals by point.
void WaveShader::find_picture_points(const TileTask& task, const SampleList& samples, const std::int32_t* x,
                                     const std::int32_t* y, const std::uint32_t* ordinal) {
    Wave& wave = *waves_[0];
    std::fill_n(wave.points[kTimes], wave.point_count, 1.0f);
    const ProjectionView& picture = task.frame.projection;
    const float pixel = pixel_width(picture);
    auto run = wave.runs.begin();
    for (const PointBatch& b : wave.batches) {
        // Vectors write beyond the end of a run, so each follows the one before it.
        const auto first_run = run;
        for (; run != wave.runs.end() && run->first < b.first + b.count; ++run)
            std::fill_n(wave.points[kRounding] + run->first, run->count + kMaxLanes,
                        scene_->instance_size[run->instance]);
        if (task.frame.instances[b.instance].shape) {
            for (auto r = first_run; r != run; ++r) find_shape_points(task, wave, *r, x, y);
            continue;
        }
        PrimarySurfacesJob job{};
        job.source = &task.source;
        job.material = &scene_->shading->materials[task.frame.instances[b.instance].material];
        job.layout = task.shading_batches.layouts[b.instance];
        job.records = samples.records;
        job.record_of = samples.record_of;
        job.planes = planes_.data();
        job.plane_of = plane_of_.data();
        job.x = x + b.first;
        job.y = y + b.first;
        job.list = ordinal + b.first;
        job.count = b.count;
        job.first = b.first;
        job.width_at_one = picture.orthographic ? 0.0f : pixel;
        job.width = picture.orthographic ? pixel : 0.0f;
        job.points = wave.points;
        scene_->kernels->primary_surfaces(job);
    }
}

}  // namespace tessera
