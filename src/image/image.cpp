// The Image value type, its hash, and reduction to N-plane true colour.
#include <tessera/error.h>
#include <tessera/image.h>

#include <array>
#include <new>

#include "core/huge_pages.h"
#include "image/srgb.h"

namespace tessera {

std::size_t bytes_per_pixel(PixelFormat format) {
    switch (format) {
        case PixelFormat::kRgba8:
        case PixelFormat::kF32:
        case PixelFormat::kU32:
            return 4;
        case PixelFormat::kRgba16:
        case PixelFormat::kRg32f:
            return 8;
        case PixelFormat::kRgb32f:
            return 12;
        case PixelFormat::kRgba32f:
            return 16;
    }
    throw Error(ErrorCode::kUsage, "unknown pixel format");
}

void* allocate_pixels(std::size_t bytes) {
    void* const pixels = ::operator new (bytes, std::align_val_t{64});
    prefer_huge_pages(pixels, bytes);
    return pixels;
}

void free_pixels(void* pixels) { ::operator delete (pixels, std::align_val_t{64}); }

Image::Image(int width, int height, PixelFormat format) : width_(width), height_(height), format_(format) {
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
        throw Error(ErrorCode::kLimit, "an image of " + std::to_string(width) + " x " + std::to_string(height) +
                                           " pixels: each side must be 1 to " + std::to_string(kMaxImageSide));
    try {
        data_.resize(row_bytes() * static_cast<std::size_t>(height));
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::kLimit, "not enough memory for an image of " + std::to_string(width) + " x " +
                                           std::to_string(height) + " pixels");
    }
}

std::uint64_t hash_pixels(const Image& image) {
    // Fowler, Noll, Vo: offset basis and prime of the 64-bit variant.
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const std::byte b : image.bytes()) {
        hash ^= static_cast<std::uint64_t>(b);
        hash *= 0x100000001b3u;
    }
    return hash;
}

Image display_picture(const Image& linear) {
    if (linear.format() != PixelFormat::kRgb32f)
        throw Error(ErrorCode::kUsage, "a display picture is made of three linear channels");
    Image picture(linear.width(), linear.height(), PixelFormat::kRgba8);
    const float* in = linear.data<float>();
    auto* out = picture.data<std::uint8_t>();
    for (std::size_t i = 0, n = picture.bytes().size() / 4; i < n; ++i, in += 3, out += 4) {
        for (int c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(srgb8_from_linear(in[c]));
        out[3] = 255;
    }
    return picture;
}

Image quantize_true_color(const Image& image, int red_bits, int green_bits, int blue_bits) {
    const std::array<int, 3> bits{red_bits, green_bits, blue_bits};
    if (image.format() != PixelFormat::kRgba8) throw Error(ErrorCode::kUsage, "true colour needs an 8-bit RGBA image");

    // Level l of 2^b stands for the value l * 255 / (2^b - 1), rounded.
    std::array<std::array<std::uint8_t, 256>, 3> nearest{};
    for (std::size_t c = 0; c < 3; ++c) {
        if (bits[c] < 1 || bits[c] > 8)
            throw Error(ErrorCode::kUsage, "true colour needs 1 to 8 bits per channel, not " + std::to_string(bits[c]));
        const int top = (1 << bits[c]) - 1;
        for (int v = 0; v < 256; ++v) {
            const int level = (2 * v * top + 255) / 510;
            nearest[c][static_cast<std::size_t>(v)] = static_cast<std::uint8_t>((2 * level * 255 + top) / (2 * top));
        }
    }
    Image result = image;
    auto* pixels = result.data<std::uint8_t>();
    for (std::size_t i = 0, n = result.bytes().size(); i < n; i += 4)
        for (std::size_t c = 0; c < 3; ++c) pixels[i + c] = nearest[c][pixels[i + c]];
    return result;
}

}  // namespace tessera
