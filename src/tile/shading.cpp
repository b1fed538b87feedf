// Shading of a tile: surface records of what is seen, batches by material, transparent fragments.
#include "tile/tile.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace tessera {
namespace {

// The squares that list_opaque() goes by.
constexpr std::uint32_t kSquare = 4, kSquarePixels = kSquare * kSquare;
constexpr std::uint32_t kSquareEnd = (kSquare - 1) * kBlockSide + kSquare - 1;  // from its first pixel to its last
constexpr std::uint64_t kSquareBits = 0x0f0f0f0f;
constexpr std::uint32_t kPlaces[kSquarePixels] = {0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27};
static_assert(kBlockSide == 8);

}  // namespace

// The ordinals that need a surface record, in order, to list_, with 0 at the end; their count.
std::uint32_t Tile::list_visible() {
    std::uint32_t* const list = list_.reserve(visible_.triangle_count + 1);
    std::uint32_t count = 0;
    if (visible_.triangle_count == 0) {
        list[0] = 0;
        return 0;
    }
    // Few triangles of one instance: to prepare them all costs less than to look for those that are seen.
    const auto pixels = static_cast<std::uint32_t>(area_.side * area_.side);
    const TileTriangle* const triangles = visible_.triangles.data();
    if (visible_.triangle_count <= pixels / 64 &&
        triangles[0].instance == triangles[visible_.triangle_count - 1].instance) {
        while (count < visible_.triangle_count) list[count] = count + 1, ++count;
        list[count] = 0;
        return count;
    }
    VisibleJob visible{};
    visible.ordinal = visible_.ordinal.data();
    visible.pixels = area_.side * area_.side;
    visible.triangle_count = visible_.triangle_count;
    visible.seen = seen_.reserve(visible_.triangle_count + 1);
    visible.list = list;
    task_->kernels.find_visible(visible);
    count = visible.count;
    if (!visible_.fragments.empty()) {
        for (const TileFragment& f : visible_.fragments) seen_[f.ordinal] = 1;
        count = 0;
        for (std::uint32_t i = 1; i <= visible_.triangle_count; ++i)
            if (seen_[i]) list[count++] = i;
    }
    list[count] = 0;
    return count;
}

// Surface records of everything seen, in runs of one instance.
void Tile::make_records(const std::vector<SurfaceLayout>& layouts) {
    const std::uint32_t count = seen_count_ = list_visible();
    std::uint32_t* record_of = record_of_.reserve(visible_.triangle_count + 1);
    record_of[0] = 0;
    batch_.reserve(count);
    std::size_t used = 0;
    for (std::uint32_t first = 0; first < count;) {
        const std::uint32_t instance = visible_.triangles[list_[first] - 1].instance;
        SurfaceJob job{};
        job.source = &task_->source;
        job.instance = instance;
        job.layout = layouts[instance];
        const auto floats = static_cast<std::size_t>(surface_floats(job.layout));
        std::uint32_t end = first;
        for (; end < count && visible_.triangles[list_[end] - 1].instance == instance; ++end) {
            batch_[end - first] = visible_.triangles[list_[end] - 1].triangle;
            record_of[list_[end]] = static_cast<std::uint32_t>(used + (end - first) * floats);
        }
        job.triangles = batch_.data();
        job.count = end - first;
        job.records = records_.reserve(used + (job.count + kMaxLanes) * floats, used) + used;
        task_->kernels.make_surfaces(job);
        used += job.count * floats;
        first = end;
    }
}

ShadeJob Tile::shade_job(std::uint32_t instance) const {
    ShadeJob job{};
    job.source = &task_->source;
    job.material = &task_->shading.materials[task_->frame.instances[instance].material];
    job.layout = task_->shading_batches.layouts[instance];
    job.records = records_.data();
    job.record_of = record_of_.data();
    return job;
}

void Tile::take_sample(SamplePosition offset, bool first) {
    make_records(task_->shading_batches.layouts);
    if (visible_.fragments.empty()) return shade_opaque(offset, first, sum_);
    shade_opaque(offset, true, sample_);
    compose_fragments(offset);
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t i = 0; i < visible_.depth.size(); ++i)
            sum_[c][i] = (first ? 0.0f : sum_[c][i]) + sample_[c][i];
}

// The nearest opaque surface of every pixel: at once where the tile shows one material, else as a list.
void Tile::shade_opaque(SamplePosition offset, bool first, Planes& planes) {
    std::uint32_t batch = 0;
    bool one = true, any = false;
    for (const std::uint32_t* o = list_.data(); *o != 0 && one; ++o) {
        const std::uint32_t instance = visible_.triangles[*o - 1].instance;
        const AlphaMode mode = task_->shading.materials[task_->frame.instances[instance].material].alpha_mode;
        if (mode == AlphaMode::kBlend) continue;
        one = !any || batch == task_->shading_batches.batch_of[instance];
        batch = task_->shading_batches.batch_of[instance];
        any = true;
    }
    if (one && any && !shader_) {
        const bool at_once =
            task_->settings.samples.size() == 1 && visible_.fragments.empty() && !task_->targets.linear;
        const DevelopJob film = develop_job();
        ShadeJob job = shade_job(batch);
        job.x0 = area_.x0;
        job.y0 = area_.y0;
        job.side = area_.side;
        job.offset = offset;
        job.ordinal = visible_.ordinal.data();
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
    list_opaque();
    shade_list(offset, shader_.get());
    const bool full = point_pixel_.size() == visible_.ordinal.size();
    if (first && !full)
        for (std::vector<float>& plane : planes) std::fill(plane.begin(), plane.end(), 0.0f);
    add_points(first && full, planes);
}

// Adds the colours of what list_opaque() listed, or stores them; squares of which all is listed row by row.
void Tile::add_points(bool first, Planes& planes) {
    const auto count = static_cast<std::uint32_t>(point_pixel_.size());
    for (std::uint32_t i = 0; i < count;) {
        const std::uint32_t pixel = point_pixel_[i];
        std::uint64_t& hit = hit_[pixel / kBlockPixels];
        const bool corner = pixel % kSquare == 0 && pixel / kBlockSide % kSquare == 0;
        if (corner && i + kSquarePixels <= count && point_pixel_[i + kSquarePixels - 1] == pixel + kSquareEnd) {
            for (std::size_t c = 0; c < 4; ++c) {
                float* __restrict to = planes[c].data() + pixel;
                const float* __restrict from = point_color_[c].data() + i;
                for (std::uint32_t row = 0; row < kSquare; ++row, to += kBlockSide, from += kSquare) {
                    if (first)
                        std::memcpy(to, from, kSquare * sizeof *to);
                    else
                        for (std::uint32_t k = 0; k < kSquare; ++k) to[k] += from[k];
                }
            }
            hit |= kSquareBits << pixel % kBlockPixels;
            i += kSquarePixels;
            continue;
        }
        for (std::size_t c = 0; c < 4; ++c) planes[c][pixel] += point_color_[c][i];
        hit |= std::uint64_t{1} << pixel % kBlockPixels;
        ++i;
    }
}

// All pixels that show something opaque, by squares of 4x4: packets of rays should be square.
void Tile::list_opaque() {
    point_pixel_.resize(visible_.ordinal.size());
    point_ordinal_.resize(visible_.ordinal.size());
    std::uint32_t* const pixels = point_pixel_.data();
    std::uint32_t* const ordinals = point_ordinal_.data();
    std::size_t count = 0;
    for (std::uint32_t corner = 0; corner < visible_.ordinal.size();) {
        const std::uint32_t* const seen = visible_.ordinal.data() + corner;
        std::uint32_t *const to = ordinals + count, *const where = pixels + count;
        for (std::uint32_t row = 0; row < kSquare; ++row)
            std::memcpy(to + row * kSquare, seen + row * kBlockSide, kSquare * sizeof *to);
        for (std::uint32_t i = 0; i < kSquarePixels; ++i) where[i] = corner + kPlaces[i];
        std::uint32_t missing = 0;
        for (std::uint32_t i = 0; i < kSquarePixels; ++i) missing += to[i] == 0;
        if (missing == 0) {
            count += kSquarePixels;
        } else if (missing < kSquarePixels) {
            const std::size_t end = count + kSquarePixels;
            for (std::size_t i = count; i < end; ++i) {
                pixels[count] = pixels[i];
                ordinals[count] = ordinals[i];
                count += ordinals[i] != 0;
            }
        }
        // The square to the right, or the first one of the next row of squares.
        corner += corner / kSquare % 2 == 0 ? kSquare : kSquare * kBlockSide - kSquare;
    }
    point_pixel_.resize(count);
    point_ordinal_.resize(count);
}

// The same with traced light.
void Tile::shade_list_traced(SamplePosition offset, PointShader& shader) {
    const std::size_t count = point_ordinal_.size();
    for (std::vector<float>& plane : point_color_) plane.resize(count);
    if (count == 0) return;
    batch_x_.resize(count + kMaxLanes);
    batch_y_.resize(count + kMaxLanes);
    const std::uint32_t last = point_ordinal_.back();
    point_ordinal_.resize(count + kMaxLanes, last);
    const auto columns = static_cast<std::uint32_t>(area_.side / kBlockSide);  // a power of two
    const int shift = std::countr_zero(columns);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t pixel = point_pixel_[i], block = pixel / kBlockPixels;
        const std::uint32_t x = (block & (columns - 1)) * kBlockSide + pixel % kBlockSide,
                            y = (block >> shift) * kBlockSide + pixel / kBlockSide % kBlockSide;
        batch_x_[i] = 256 * (area_.x0 + static_cast<std::int32_t>(x)) + offset.x;
        batch_y_[i] = 256 * (area_.y0 + static_cast<std::int32_t>(y)) + offset.y;
    }
    SampleList samples{};
    samples.x = batch_x_.data();
    samples.y = batch_y_.data();
    samples.ordinal = point_ordinal_.data();
    samples.count = static_cast<std::uint32_t>(count);
    samples.triangles = visible_.triangles.data();
    samples.seen = list_.data();
    samples.seen_count = seen_count_;
    samples.records = records_.data();
    samples.record_of = record_of_.data();
    shader.shade(*task_, samples,
                 {point_color_[0].data(), point_color_[1].data(), point_color_[2].data(), point_color_[3].data()});
    point_ordinal_.resize(count);
}

// Shades point_ordinal_ at point_pixel_ into point_color_, in batches of one material and layout.
void Tile::shade_list(SamplePosition offset, PointShader* shader) {
    if (shader) return shade_list_traced(offset, *shader);
    const std::size_t count = point_ordinal_.size();
    for (std::vector<float>& plane : point_color_) plane.resize(count);
    const auto batch = [&](std::uint32_t point) {
        return task_->shading_batches.batch_of[visible_.triangles[point_ordinal_[point] - 1].instance];
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
            const TilePixel p(point_pixel_[point], area_.side);
            batch_x_[i] = 256 * (area_.x0 + p.x) + offset.x;
            batch_y_[i] = 256 * (area_.y0 + p.y) + offset.y;
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
    for (const TileFragment& f : visible_.fragments) {
        point_pixel_.push_back(f.pixel);
        point_ordinal_.push_back(f.ordinal);
    }
    shade_list(offset, shader_.get());
    for (std::size_t i = 0; i < point_pixel_.size(); ++i) {
        const std::uint32_t pixel = point_pixel_[i];
        const float a = point_color_[3][i];
        for (std::size_t c = 0; c < 3; ++c) sample_[c][pixel] = point_color_[c][i] * a + sample_[c][pixel] * (1.0f - a);
        sample_[3][pixel] = a + sample_[3][pixel] * (1.0f - a);
        hit_[pixel / kBlockPixels] |= std::uint64_t{1} << pixel % kBlockPixels;
    }
}

}  // namespace tessera
