#include "render/filter_pass.h"

#include <algorithm>

namespace tessera {
namespace {

FilterWeights weights_for(const RenderOptions& options) {
    std::vector<SampleOffset> samples;
    for (int sample = 0; sample < options.samples; ++sample) samples.push_back(sample_offset(sample, options.samples));
    return {options.filter, samples};
}

// Alpha within 0 .. 1, the straight colour kept; NaN (of infinite radiance in a negative lobe) as 0.
void clamp_alpha(float* rgba) {
    for (int c = 0; c < 4; ++c) rgba[c] = rgba[c] == rgba[c] ? rgba[c] : 0.0f;
    const float alpha = rgba[3];
    if (alpha <= 0.0f) {
        for (int c = 0; c < 4; ++c) rgba[c] = 0.0f;
    } else if (alpha > 1.0f) {
        for (int c = 0; c < 3; ++c) rgba[c] /= alpha;
        rgba[3] = 1.0f;
    }
}

}  // namespace

void for_each_row(int height, Arena* arena, const std::function<void(int)>& body) {
    if (arena)
        arena->for_each(static_cast<std::size_t>(height), [&](std::size_t y) { body(static_cast<int>(y)); });
    else
        for (int y = 0; y < height; ++y) body(y);
}

FilterPass::FilterPass(const RenderOptions& options, Arena* arena)
    : width_(options.width), height_(options.height), arena_(arena), weights_(weights_for(options)) {
    const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    sums_.assign(4 * pixels, 0.0f);
    covered_.assign(pixels, 0);
}

void FilterPass::restart() {
    std::fill(sums_.begin(), sums_.end(), 0.0f);
    std::fill(covered_.begin(), covered_.end(), char{0});
}

void FilterPass::add(int sample, const float* plane, const std::function<void(double)>& checkpoint) {
    for_each_row(height_, arena_, [&](int y) {
        checkpoint(0.0);
        add_row(static_cast<std::size_t>(sample), y, plane);
    });
}

// Row `y` of the sums: all of the sample's pixels that reach into it.
void FilterPass::add_row(std::size_t sample, int y, const float* plane) {
    const auto row_floats = 4 * static_cast<std::size_t>(width_);
    float* const sums = sums_.data() + static_cast<std::size_t>(y) * row_floats;
    const int reach = weights_.reach();
    for (int dy = -std::min(reach, y); dy <= std::min(reach, height_ - 1 - y); ++dy) {
        const float* const row = plane + static_cast<std::size_t>(y + dy) * row_floats;
        for (int dx = -reach; dx <= reach; ++dx) {
            const float weight = weights_.weight(sample, dx, dy);
            const int first = std::max(0, -dx), last = width_ - std::max(0, dx);
            if (weight == 0.0f || first >= last) continue;  // an infinite radiance times 0 would be NaN
            const float* const in = row + 4 * static_cast<std::size_t>(first + dx);
            float* const out = sums + 4 * static_cast<std::size_t>(first);
            const auto count = 4 * static_cast<std::size_t>(last - first);
            for (std::size_t i = 0; i < count; ++i) out[i] += weight * in[i];
        }
    }
    const float* const own = plane + static_cast<std::size_t>(y) * row_floats;
    char* const covered = covered_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (std::size_t x = 0; x < static_cast<std::size_t>(width_); ++x) covered[x] |= own[4 * x + 3] > 0.0f;
}

void FilterPass::finish_row(int y) {
    float* rgba = sums_.data() + 4 * static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    const int reach = weights_.reach(), up = std::min(y, reach), down = std::min(height_ - 1 - y, reach);
    const auto scale_at = [&](int left, int right) {
        return static_cast<float>(1 / weights_.sum_within(left, right, up, down));
    };
    const float inner = scale_at(reach, reach);
    for (int x = 0; x < width_; ++x, rgba += 4) {
        const int left = std::min(x, reach), right = std::min(width_ - 1 - x, reach);
        const float scale = left == reach && right == reach ? inner : scale_at(left, right);
        for (int c = 0; c < 4; ++c) rgba[c] *= scale;
        clamp_alpha(rgba);
    }
}

const float* FilterPass::finish() {
    for_each_row(height_, arena_, [&](int y) { finish_row(y); });
    return sums_.data();
}

std::uint64_t FilterPass::pixels_covered() const {
    return static_cast<std::uint64_t>(std::count(covered_.begin(), covered_.end(), char{1}));
}

}  // namespace tessera
