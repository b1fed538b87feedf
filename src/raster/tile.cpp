#include "raster/tile.h"

#include <tessera/error.h>

#include <algorithm>
#include <limits>

namespace tessera {

Tile::Tile(const Frame& frame, const ShadingContext& shading, const RasterSettings& settings,
           const RasterTargets& targets, const FrontEndResult& front)
    : frame_(frame),
      shading_(shading),
      settings_(settings),
      targets_(targets),
      front_(front),
      kernels_(raster_kernels(settings.isa)),
      depth_(kTilePixels),
      ordinal_(kTilePixels),
      hit_(kTilePixels) {
    for (std::vector<float>& plane : sum_) plane.resize(kTilePixels);
}

void Tile::draw(const TileGrid& grid, int index) {
    x0_ = index % grid.columns * kTileSide;
    y0_ = index / grid.columns * kTileSide;
    width_ = std::min(kTileSide, static_cast<int>(frame_.projection.width) - x0_);
    height_ = std::min(kTileSide, static_cast<int>(frame_.projection.height) - y0_);
    gather_records(index);
    for (std::vector<float>& plane : sum_) std::fill(plane.begin(), plane.end(), 0.0f);
    std::fill(hit_.begin(), hit_.end(), char{0});
    if (!records_.empty())
        for (const SamplePosition& offset : settings_.samples) {
            find_visible(offset);
            shade_visible(offset);
            add_sample();
        }
    if (targets_.distance || targets_.triangle) label();
    develop();
}

void Tile::gather_records(int tile) {
    records_.clear();
    const auto t = static_cast<std::size_t>(tile);
    for (const BinnedChunk& chunk : front_.chunks) {
        if (chunk.empty()) continue;
        for (std::uint32_t e = chunk.begin[t]; e < chunk.begin[t + 1]; ++e)
            records_.push_back(&chunk.records[chunk.entries[e]]);
    }
}

std::uint32_t Tile::number(std::uint32_t ordinal) const {
    const TriangleRecord& r = *records_[ordinal - 1];
    return frame_.instances[r.instance].first_triangle + r.triangle;
}

void Tile::add_fragment(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth) {
    Tile& tile = *static_cast<Tile*>(owner);
    if (tile.fragments_.size() >= tile.settings_.max_fragments)
        throw Error(ErrorCode::kLimit, "transparent surfaces need more memory than the limit allows");
    tile.fragments_.push_back({pixel, ordinal, depth});
}

void Tile::find_visible(SamplePosition offset) {
    std::fill(depth_.begin(), depth_.end(), 0.0f);
    std::fill(ordinal_.begin(), ordinal_.end(), 0u);
    fragments_.clear();
    VisibilityJob job{};
    job.x0 = x0_;
    job.y0 = y0_;
    job.width = width_;
    job.height = height_;
    job.offset = offset;
    job.records = records_.data();
    job.record_count = static_cast<std::uint32_t>(records_.size());
    job.instances = frame_.instances.data();
    job.shading = &shading_;
    job.projection = frame_.projection;
    job.depth = depth_.data();
    job.ordinal = ordinal_.data();
    job.add_fragment = &add_fragment;
    job.owner = this;
    kernels_.visibility(job);
    fragments_passed += job.fragments_passed;
    sort_fragments();
}

// By pixel, far to near, at equal depth the lower number on top; without what the opaque surface hides.
void Tile::sort_fragments() {
    if (fragments_.empty()) return;
    std::erase_if(fragments_, [&](const Fragment& f) {
        const float z = depth_[f.pixel];
        return f.depth < z ||
               (f.depth == z && ordinal_[f.pixel] != 0 && number(ordinal_[f.pixel]) <= number(f.ordinal));
    });
    std::sort(fragments_.begin(), fragments_.end(), [](const Fragment& a, const Fragment& b) {
        if (a.pixel != b.pixel) return a.pixel < b.pixel;
        if (a.depth != b.depth) return a.depth < b.depth;
        return a.ordinal > b.ordinal;
    });
}

// Asks for the opaque points in the order of the pixels, then for the fragments in theirs.
void Tile::shade_visible(SamplePosition offset) {
    points_.clear();
    const auto ask = [&](std::uint32_t pixel, std::uint32_t ordinal) {
        points_.ordinal.push_back(ordinal);
        points_.x.push_back(256 * (x0_ + static_cast<int>(pixel) % kTileSide) + offset.x);
        points_.y.push_back(256 * (y0_ + static_cast<int>(pixel) / kTileSide) + offset.y);
    };
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const auto pixel = static_cast<std::uint32_t>(y * kTileSide + x);
            if (ordinal_[pixel] != 0) ask(pixel, ordinal_[pixel]);
        }
    for (const Fragment& f : fragments_) ask(f.pixel, f.ordinal);
    shade_points();
}

// Shades the points in batches of one instance.
void Tile::shade_points() {
    const std::size_t count = points_.ordinal.size();
    for (std::vector<float>* plane : {&points_.r, &points_.g, &points_.b, &points_.alpha, &points_.distance})
        plane->resize(count);
    order_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) order_[i] = i;
    const auto instance = [&](std::uint32_t point) { return records_[points_.ordinal[point] - 1]->instance; };
    // Most tiles see few instances: a stable sort only where there is more than one.
    const auto changes = [&](std::uint32_t a, std::uint32_t b) { return instance(a) != instance(b); };
    if (std::adjacent_find(order_.begin(), order_.end(), changes) != order_.end())
        std::stable_sort(order_.begin(), order_.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return instance(a) < instance(b); });

    for (std::size_t first = 0; first < count;) {
        std::size_t end = first + 1;
        while (end < count && instance(order_[end]) == instance(order_[first])) ++end;
        const std::size_t n = end - first, padded = (n + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
        for (std::vector<std::int32_t>* v : {&batch_x_, &batch_y_, &batch_triangle_}) v->resize(padded);
        batch_orientation_.resize(padded);
        for (std::vector<float>& v : batch_) v.resize(padded);
        for (std::size_t i = 0; i < padded; ++i) {
            const std::uint32_t point = order_[first + std::min(i, n - 1)];
            const TriangleRecord& r = *records_[points_.ordinal[point] - 1];
            batch_x_[i] = points_.x[point];
            batch_y_[i] = points_.y[point];
            batch_triangle_[i] = static_cast<std::int32_t>(r.triangle);
            batch_orientation_[i] = r.orientation;
        }
        ShadeJob job{};
        job.instance = &frame_.instances[instance(order_[first])];
        job.shading = &shading_;
        job.projection = frame_.projection;
        job.count = static_cast<std::uint32_t>(n);
        job.x = batch_x_.data();
        job.y = batch_y_.data();
        job.triangle = batch_triangle_.data();
        job.orientation = batch_orientation_.data();
        job.r = batch_[0].data();
        job.g = batch_[1].data();
        job.b = batch_[2].data();
        job.alpha = batch_[3].data();
        job.distance = batch_[4].data();
        kernels_.shade(job);
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t point = order_[first + i];
            points_.r[point] = batch_[0][i];
            points_.g[point] = batch_[1][i];
            points_.b[point] = batch_[2][i];
            points_.alpha[point] = batch_[3][i];
            points_.distance[point] = batch_[4][i];
        }
        first = end;
    }
}

// Composes the points of every pixel and adds them to the sums, in the order that shade_visible asked.
void Tile::add_sample() {
    std::size_t opaque = 0, over = 0;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) opaque += ordinal_[static_cast<std::size_t>(y * kTileSide + x)] != 0;
    std::size_t point = 0, fragment = opaque;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const auto pixel = static_cast<std::size_t>(y * kTileSide + x);
            const bool has_fragments = over < fragments_.size() && fragments_[over].pixel == pixel;
            if (ordinal_[pixel] == 0 && !has_fragments) continue;
            Vec3T<float> c{0, 0, 0};
            float alpha = 0;
            if (ordinal_[pixel] != 0) {
                c = {points_.r[point], points_.g[point], points_.b[point]};
                alpha = 1;
                ++point;
            }
            for (; over < fragments_.size() && fragments_[over].pixel == pixel; ++over, ++fragment) {
                const float a = points_.alpha[fragment];
                const Vec3T<float> s{points_.r[fragment], points_.g[fragment], points_.b[fragment]};
                c = s * a + c * (1.0f - a);
                alpha = a + alpha * (1.0f - a);
            }
            sum_[0][pixel] += c.x;
            sum_[1][pixel] += c.y;
            sum_[2][pixel] += c.z;
            sum_[3][pixel] += alpha;
            hit_[pixel] = 1;
        }
}

// Labels at the pixel centre: of the nearest surface with alpha of at least one half.
void Tile::label() {
    const SamplePosition centre{128, 128};
    const std::uint64_t passed = fragments_passed;
    find_visible(centre);
    fragments_passed = passed;
    shade_visible(centre);
    const auto picture_width = static_cast<std::size_t>(frame_.projection.width);
    std::size_t point = 0;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const auto pixel = static_cast<std::size_t>(y * kTileSide + x);
            const std::size_t out =
                static_cast<std::size_t>(y0_ + y) * picture_width + static_cast<std::size_t>(x0_ + x);
            const bool hit = ordinal_[pixel] != 0;
            if (targets_.distance)
                targets_.distance[out] = hit ? points_.distance[point] : std::numeric_limits<float>::infinity();
            if (targets_.triangle) targets_.triangle[out] = hit ? number(ordinal_[pixel]) + 1 : 0;
            point += hit;
        }
    for (const Fragment& f : fragments_) {  // far to near: the last one that is solid enough stays
        const std::size_t i = point++;
        if (!(points_.alpha[i] >= 0.5f)) continue;
        const std::size_t out = static_cast<std::size_t>(y0_ + static_cast<int>(f.pixel) / kTileSide) * picture_width +
                                static_cast<std::size_t>(x0_ + static_cast<int>(f.pixel) % kTileSide);
        if (targets_.distance) targets_.distance[out] = points_.distance[i];
        if (targets_.triangle) targets_.triangle[out] = number(f.ordinal) + 1;
    }
}

void Tile::develop() {
    const auto picture_width = static_cast<std::size_t>(frame_.projection.width);
    const float weight = 1.0f / static_cast<float>(settings_.samples.size());
    for (int y = 0; y < height_; ++y) {
        const std::size_t row = static_cast<std::size_t>(y * kTileSide);
        const std::size_t out = static_cast<std::size_t>(y0_ + y) * picture_width + static_cast<std::size_t>(x0_);
        const DevelopJob job{settings_.film,
                             weight,
                             static_cast<std::uint32_t>(width_),
                             sum_[0].data() + row,
                             sum_[1].data() + row,
                             sum_[2].data() + row,
                             sum_[3].data() + row,
                             targets_.rgba + 4 * out};
        kernels_.develop(job);
        for (std::size_t x = 0; x < static_cast<std::size_t>(width_); ++x) {
            pixels_covered += hit_[row + x] != 0;
            if (!targets_.linear) continue;
            for (std::size_t c = 0; c < 4; ++c) {
                const float v = sum_[c][row + x] * weight;
                targets_.linear[4 * (out + x) + c] = v == v ? v : 0.0f;
            }
        }
    }
}

}  // namespace tessera
