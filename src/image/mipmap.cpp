#include "image/mipmap.h"

#include "image/color.h"

#include <tessera/error.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace tessera {
namespace {

int half(int side) { return std::max(1, side / 2); }

// The pixels that output pixel i of a side covers, and their shares. A side of 2n or 1 pixels: two
// halves, or the whole. A side of 2n + 1: output i covers [i (2 + 1/n), (i + 1) (2 + 1/n)), which is a
// share of three pixels (the polyphase box filter; Guthe and Heckbert, "Non-Power-of-Two Mipmap
// Creation", NVIDIA 2005).
struct Taps {
    int first = 0, count = 1;
    std::array<float, 3> weight{1, 0, 0};
};

Taps taps(int side, int i) {
    if (side == 1) return {};
    const int n = side / 2;
    if (side == 2 * n) return {2 * i, 2, {0.5f, 0.5f, 0}};
    const auto whole = static_cast<float>(side);
    return {2 * i,
            3,
            {static_cast<float>(n - i) / whole, static_cast<float>(n) / whole, static_cast<float>(i + 1) / whole}};
}

// Halves an image whose rows come from row(y): a pointer to 4 * width floats, valid until the next
// call. Rows are asked for in ascending order, some twice. Columns of a row are summed first, from the
// top down, then the pixels of the result, from the left.
template <class Row>
std::vector<float> halve_rows(int width, int height, Row&& row) {
    const int out_width = half(width), out_height = half(height);
    std::vector<float> out(4 * static_cast<std::size_t>(out_width) * static_cast<std::size_t>(out_height));
    const std::size_t channels = 4 * static_cast<std::size_t>(width);
    std::vector<float> column(channels);
    std::vector<Taps> across(static_cast<std::size_t>(out_width));
    for (int x = 0; x < out_width; ++x) across[static_cast<std::size_t>(x)] = taps(width, x);

    float* to = out.data();
    for (int y = 0; y < out_height; ++y) {
        const Taps down = taps(height, y);
        for (int t = 0; t < down.count; ++t) {
            const float* in = row(down.first + t);
            const float weight = down.weight[static_cast<std::size_t>(t)];
            if (t == 0)
                for (std::size_t i = 0; i < channels; ++i) column[i] = weight * in[i];
            else
                for (std::size_t i = 0; i < channels; ++i) column[i] += weight * in[i];
        }
        for (const Taps& tap : across) {
            const float* in = &column[4 * static_cast<std::size_t>(tap.first)];
            for (std::size_t c = 0; c < 4; ++c, ++to) {
                *to = tap.weight[0] * in[c];
                if (tap.count > 1) *to += tap.weight[1] * in[4 + c];
                if (tap.count > 2) *to += tap.weight[2] * in[8 + c];
            }
        }
    }
    return out;
}

// Of 0 .. 1. Means may be off by a rounding, which is less than half a step.
template <class V>
std::int16_t fixed15(V v) {
    return static_cast<std::int16_t>(v * V(kTexelOne) + V(0.5));
}

// What each code of a channel stands for, rounded once: as a float for filtering, and as a texel has it.
struct ChannelTable {
    std::vector<float> linear;
    std::vector<std::int16_t> fixed;

    ChannelTable(std::size_t codes, bool srgb) : linear(codes), fixed(codes) {
        for (std::size_t i = 0; i < codes; ++i) {
            const double v = static_cast<double>(i) / static_cast<double>(codes - 1);
            const double light = srgb ? linear_from_srgb(v) : v;
            linear[i] = static_cast<float>(light);
            fixed[i] = fixed15(light);
        }
    }
};

// The rows of an image, decoded when asked for: as floats, four a pixel, and into the first level of the chain.
class RowDecoder {
  public:
    RowDecoder(const Image& image, bool srgb, MipChain& chain)
        : image_(image),
          chain_(chain),
          wide_(image.format() == PixelFormat::kRgba16),
          color_(wide_ ? 65536 : 256, srgb),
          alpha_(wide_ ? 65536 : 256, false),
          row_(4 * static_cast<std::size_t>(image.width())) {}

    // The last row is kept, because odd heights ask twice.
    const float* operator()(int y) {
        if (y != y_) wide_ ? decode<std::uint16_t>(y) : decode<std::uint8_t>(y);
        y_ = y;
        return row_.data();
    }

  private:
    template <class Code>
    void decode(int y) {
        const Code* in = image_.data<Code>() + static_cast<std::size_t>(y) * row_.size();
        const float *color = color_.linear.data(), *alpha = alpha_.linear.data();
        const std::int16_t *color15 = color_.fixed.data(), *alpha15 = alpha_.fixed.data();
        float* row = row_.data();
        Texel* to = &chain_.texels[chain_.levels[0].index(0, y)];
        for (int x = 0; x < image_.width(); ++x, in += 4, row += 4, ++to) {
            row[0] = color[in[0]], row[1] = color[in[1]], row[2] = color[in[2]], row[3] = alpha[in[3]];
            *to = {{color15[in[0]], color15[in[1]], color15[in[2]], alpha15[in[3]]}};
        }
    }

    const Image& image_;
    MipChain& chain_;
    bool wide_;
    ChannelTable color_, alpha_;
    std::vector<float> row_;
    int y_ = -1;
};

// Row y of a level from as many times four floats.
void store_row(const float* pixels, const MipLevel& level, int y, std::span<Texel> texels) {
    Texel* to = &texels[level.index(0, y)];
    for (int x = 0; x < level.width; ++x, ++to, pixels += 4)
        for (int c = 0; c < 4; ++c) to->c[c] = fixed15(pixels[c]);
}

// Lookups count texels in 32 bits. All levels together are less than twice the largest level there is.
static_assert(2ll * (kMaxImageSide + 2) * (kMaxImageSide + 2) < INT32_MAX);

}  // namespace

std::vector<float> halve(std::span<const float> pixels, int width, int height) {
    const std::size_t stride = 4 * static_cast<std::size_t>(width);
    return halve_rows(width, height, [&](int y) { return pixels.data() + static_cast<std::size_t>(y) * stride; });
}

MipChain empty_mip_chain(int width, int height) {
    MipChain chain;
    std::size_t total = 0;
    for (int w = width, h = height;; w = half(w), h = half(h)) {
        const MipLevel& level = chain.levels.emplace_back(MipLevel{total, w, h});
        total = level.index(w, h) + 1;
        if (w == 1 && h == 1) break;
    }
    chain.texels.resize(total);
    return chain;
}

void wrap_border(const MipLevel& level, std::span<Texel> texels) {
    for (int y = 0; y < level.height; ++y) {
        texels[level.index(-1, y)] = texels[level.index(level.width - 1, y)];
        texels[level.index(level.width, y)] = texels[level.index(0, y)];
    }
    const auto copy_row = [&](int from, int to) {
        std::copy_n(&texels[level.index(-1, from)], level.stride(), &texels[level.index(-1, to)]);
    };
    copy_row(level.height - 1, -1);
    copy_row(0, level.height);
}

MipChain make_mip_chain(const Image& image, bool srgb) {
    if (image.empty() || (image.format() != PixelFormat::kRgba8 && image.format() != PixelFormat::kRgba16))
        throw Error(ErrorCode::kUsage, "a texture must be an 8-bit or 16-bit RGBA image");
    MipChain chain = empty_mip_chain(image.width(), image.height());
    RowDecoder rows(image, srgb, chain);
    if (chain.levels.size() == 1) rows(0);
    std::vector<float> pixels;
    for (std::size_t i = 1; i < chain.levels.size(); ++i) {
        const MipLevel &from = chain.levels[i - 1], &to = chain.levels[i];
        pixels = i == 1 ? halve_rows(from.width, from.height, rows) : halve(pixels, from.width, from.height);
        for (int y = 0; y < to.height; ++y)
            store_row(&pixels[4 * static_cast<std::size_t>(y) * static_cast<std::size_t>(to.width)], to, y,
                      chain.texels);
    }
    for (const MipLevel& level : chain.levels) wrap_border(level, chain.texels);
    return chain;
}

}  // namespace tessera
