// The parts of make_palette() (tessera/planes.h): colours as points, the palette's entries among them, dithering.
// A point is a display colour premultiplied by its alpha, and the alpha, all times 255: exact integers in
// 0 .. 65025. Distances are squared Euclidean ones. A PaletteSearch may be used by any number of threads at once.
#pragma once

#include <tessera/planes.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

class Arena;

using ColorPoint = std::array<std::int32_t, 4>;

inline ColorPoint point_of(Rgba8 c) { return {c.r * c.a, c.g * c.a, c.b * c.a, c.a * 255}; }

inline std::int64_t squared_distance(const ColorPoint& a, const ColorPoint& b) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::int64_t d = a[i] - b[i];
        sum += d * d;
    }
    return sum;
}

// Finds the nearest of up to 256 entries, the lower of two that are equally near.
class PaletteSearch {
  public:
    explicit PaletteSearch(std::span<const Rgba8> entries);
    std::uint8_t nearest(const ColorPoint& point) const;

  private:
    // Sorted by the sum of the coordinates. Sums that differ by s lie at least s / 2 apart (Cauchy-Schwarz), so
    // that the search can begin at the same sum and soon stop.
    struct Entry {
        std::int32_t sum;
        std::uint8_t number;
        ColorPoint point;
    };
    std::vector<Entry> sorted_;
};

// A colour of the picture and its number of pixels (up to 2^28 in all).
struct CountedColor {
    ColorPoint point;
    std::uint64_t pixels;
};

// The mean of pixels from the sums of their points, in straight alpha, rounded half up.
Rgba8 mean_color(const std::array<std::uint64_t, 4>& sums, std::uint64_t pixels);

// At most `count` colours for the given ones, which are reordered: Heckbert, "Color image quantization for frame
// buffer display" (1982). Begins with one box of all colours. The box whose pixels spread most along an axis (their
// squared deviation from its mean; the first of equals) is cut across it at its median pixel, until there are
// enough. A colour is a box's mean.
std::vector<Rgba8> median_cut(std::span<CountedColor> colors, std::size_t count);

// Lloyd's iteration: each entry becomes the mean of the pixels nearest to it; `rounds` times, or until nothing
// changes. The first `fixed` entries and those without pixels stay.
void refine_palette(std::span<const CountedColor> colors, std::vector<Rgba8>& entries, std::size_t fixed, int rounds,
                    Arena& arena);

// Floyd and Steinberg, "An adaptive algorithm for spatial greyscale" (1976), rows to and fro. The error is of linear
// light in 1/65535; the entry is the one nearest to the display code of what is wanted. Pixels that are not
// opaque take their nearest entry, and error that reaches them is gone. Indices of every pixel.
std::vector<std::uint8_t> dither(const Image& image, std::span<const Rgba8> entries);

}  // namespace tessera
