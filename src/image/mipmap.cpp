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

template <class V>
std::int16_t fixed15(V v) {
    return static_cast<std::int16_t>(clamp(v, V(0), V(1)) * V(kTexelOne) + V(0.5));
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

// The rows of an image, decoded when asked for.
class RowDecoder {
  public:
    RowDecoder(const Image& image, bool srgb)
        : image_(image),
          wide_(image.format() == PixelFormat::kRgba16),
          color_(wide_ ? 65536 : 256, srgb),
          alpha_(wide_ ? 65536 : 256, false),
          row_(4 * static_cast<std::size_t>(image.width())) {}

    // Four floats a pixel. The last row is kept, because odd heights ask twice.
    const float* operator()(int y) {
        if (y != y_) decode(y, color_.linear, alpha_.linear, [this](std::size_t i, float v) { row_[i] = v; });
        y_ = y;
        return row_.data();
    }
    void store(int y, Texel* to) const {
        decode(y, color_.fixed, alpha_.fixed, [to](std::size_t i, std::int16_t v) { to[i / 4].c[i % 4] = v; });
    }

  private:
    // put(number of the channel in the row, its value)
    template <class Table, class Put>
    void decode(int y, const Table& color, const Table& alpha, const Put& put) const {
        const std::size_t count = row_.size(), first = static_cast<std::size_t>(y) * count;
        const auto all = [&](const auto* in) {
            for (std::size_t i = 0; i < count; i += 4) {
                for (std::size_t c = 0; c < 3; ++c) put(i + c, color[in[i + c]]);
                put(i + 3, alpha[in[i + 3]]);
            }
        };
        if (wide_)
            all(image_.data<std::uint16_t>() + first);
        else
            all(image_.data<std::uint8_t>() + first);
    }

    const Image& image_;
    bool wide_;
    ChannelTable color_, alpha_;
    std::vector<float> row_;
    int y_ = -1;
};

// Row y of a level from as many times four floats.
void store_row(const float* pixels, const MipLevel& level, int y, std::span<Texel> texels) {
    Texel* to = &texels[level.index(0, y)];
    for (int x = 0; x < level.width; ++x, ++to, pixels += 4)
        *to = {{fixed15(pixels[0]), fixed15(pixels[1]), fixed15(pixels[2]), fixed15(pixels[3])}};
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
    RowDecoder rows(image, srgb);
    for (int y = 0; y < image.height(); ++y) rows.store(y, &chain.texels[chain.levels[0].index(0, y)]);

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
