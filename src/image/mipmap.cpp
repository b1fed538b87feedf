#include "image/mipmap.h"

#include "image/color.h"
#include "image/srgb.h"

#include <tessera/error.h>

#include <algorithm>
#include <array>
#include <bit>

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
std::vector<float> halve_rows(int width, int height, const Row& row) {
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

struct ByteTables {
    std::array<float, 256> linear{};
    ByteTables() {
        for (std::size_t i = 0; i < 256; ++i) linear[i] = static_cast<float>(i) / 255;
    }
};

// Rows of an image as floats, decoded when asked for; the last one is kept, because odd heights ask twice.
class RowDecoder {
  public:
    RowDecoder(const Image& image, bool srgb)
        : image_(image),
          row_(4 * static_cast<std::size_t>(image.width())),
          wide_(image.format() == PixelFormat::kRgba16) {
        if (wide_) {
            wide_color_.resize(65536);
            for (std::size_t i = 0; i < wide_color_.size(); ++i) {
                const double v = static_cast<double>(i) / 65535;
                wide_color_[i] = static_cast<float>(srgb ? linear_from_srgb(v) : v);
            }
        }
        color_ = srgb ? kSrgbTables.linear : bytes_.linear.data();
    }

    const float* operator()(int y) {
        if (y == y_) return row_.data();
        y_ = y;
        const std::size_t first = static_cast<std::size_t>(y) * row_.size();
        if (wide_) {
            const auto* in = image_.data<std::uint16_t>() + first;
            for (std::size_t i = 0; i < row_.size(); i += 4) {
                for (std::size_t c = 0; c < 3; ++c) row_[i + c] = wide_color_[in[i + c]];
                row_[i + 3] = static_cast<float>(in[i + 3]) / 65535;
            }
        } else {
            const auto* in = image_.data<std::uint8_t>() + first;
            for (std::size_t i = 0; i < row_.size(); i += 4) {
                for (std::size_t c = 0; c < 3; ++c) row_[i + c] = color_[in[i + c]];
                row_[i + 3] = bytes_.linear[in[i + 3]];
            }
        }
        return row_.data();
    }

  private:
    const Image& image_;
    std::vector<float> row_, wide_color_;
    ByteTables bytes_;
    const float* color_ = nullptr;
    int y_ = -1;
    bool wide_;
};

std::uint32_t byte_of(float v) { return static_cast<std::uint32_t>(clamp(v, 0.0f, 1.0f) * 255 + 0.5f); }

void encode(std::span<const float> pixels, bool srgb, std::uint32_t* to) {
    for (std::size_t i = 0; i < pixels.size(); i += 4) {
        std::uint32_t texel = byte_of(pixels[i + 3]) << 24;
        for (std::size_t c = 0; c < 3; ++c)
            texel |= (srgb ? static_cast<std::uint32_t>(srgb8_from_linear(pixels[i + c])) : byte_of(pixels[i + c]))
                     << (8 * c);
        *to++ = texel;
    }
}

// The image itself: bytes as they are, 16-bit values to the nearest byte.
void copy_base(const Image& image, std::uint32_t* to) {
    const std::size_t count = image.bytes().size() / bytes_per_pixel(image.format());
    const auto* bytes = image.data<std::uint8_t>();
    const auto* words = image.data<std::uint16_t>();
    const bool wide = image.format() == PixelFormat::kRgba16;
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t texel = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            const std::uint32_t v = wide ? (words[4 * i + c] * 255u + 32767u) / 65535u : bytes[4 * i + c];
            texel |= v << (8 * c);
        }
        to[i] = texel;
    }
}

}  // namespace

std::vector<float> halve(std::span<const float> pixels, int width, int height) {
    const std::size_t stride = 4 * static_cast<std::size_t>(width);
    return halve_rows(width, height, [&](int y) { return pixels.data() + static_cast<std::size_t>(y) * stride; });
}

MipChain make_mip_chain(const Image& image, bool srgb) {
    if (image.empty() || (image.format() != PixelFormat::kRgba8 && image.format() != PixelFormat::kRgba16))
        throw Error(ErrorCode::kUsage, "a texture must be an 8-bit or 16-bit RGBA image");
    MipChain chain;
    std::size_t total = 0;
    for (int w = image.width(), h = image.height();; w = half(w), h = half(h)) {
        chain.levels.push_back({total, w, h});
        total += static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
        if (w == 1 && h == 1) break;
    }
    chain.texels.resize(total);
    copy_base(image, chain.texels.data());

    std::vector<float> pixels;
    for (std::size_t i = 1; i < chain.levels.size(); ++i) {
        const MipLevel& from = chain.levels[i - 1];
        if (i == 1) {
            RowDecoder rows(image, srgb);
            pixels = halve_rows(from.width, from.height, [&](int y) { return rows(y); });
        } else {
            pixels = halve(pixels, from.width, from.height);
        }
        encode(pixels, srgb, &chain.texels[chain.levels[i].offset]);
    }
    return chain;
}

}  // namespace tessera
