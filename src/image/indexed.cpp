// Index planes: their checks, their colours, entries of fewer bits.
#include "image/indexed.h"

#include <tessera/error.h>

#include <algorithm>

namespace tessera {

void check_indexed(const IndexedImage& image) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::kUsage, "an index plane " + why); };
    if (image.width < 1 || image.height < 1 || image.width > kMaxImageSide || image.height > kMaxImageSide)
        refuse("of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels");
    if (image.indices.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
        refuse("whose indices are not one a pixel");
    if (image.bits < 1 || image.bits > 8) refuse("of " + std::to_string(image.bits) + " bits: 1 to 8 are possible");
    if (image.colormap.empty() || image.colormap.size() > std::size_t{1} << image.bits)
        refuse("of " + std::to_string(image.bits) + " bits with " + std::to_string(image.colormap.size()) + " entries");
    const std::uint8_t largest = *std::max_element(image.indices.begin(), image.indices.end());
    if (largest >= image.colormap.size())
        refuse("with index " + std::to_string(largest) + " beyond its " + std::to_string(image.colormap.size()) +
               " entries");
}

Image to_rgba8(const IndexedImage& image) {
    check_indexed(image);
    Image result(image.width, image.height, PixelFormat::kRgba8);
    auto* out = result.data<std::uint8_t>();
    for (const std::uint8_t index : image.indices) {
        const Rgba8 entry = image.colormap[index];
        *out++ = entry.r, *out++ = entry.g, *out++ = entry.b, *out++ = entry.a;
    }
    return result;
}

IndexedImage quantize_entries(IndexedImage image, int red_bits, int green_bits, int blue_bits) {
    check_indexed(image);
    // As a picture of one row, so that there is one rule for levels.
    Image row(static_cast<int>(image.colormap.size()), 1, PixelFormat::kRgba8);
    auto* values = row.data<std::uint8_t>();
    for (const Rgba8& entry : image.colormap) {
        *values++ = entry.r, *values++ = entry.g, *values++ = entry.b, *values++ = entry.a;
    }
    row = quantize_true_color(row, red_bits, green_bits, blue_bits);
    const auto* rounded = row.data<std::uint8_t>();
    for (Rgba8& entry : image.colormap) {
        entry = {rounded[0], rounded[1], rounded[2], entry.a};
        rounded += 4;
    }
    return image;
}

}  // namespace tessera
