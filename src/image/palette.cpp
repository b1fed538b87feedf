// make_palette(): from the colours of a picture to an index plane.
#include "image/palette.h"

#include "core/parallel.h"

#include <tessera/error.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace tessera {
namespace {

constexpr std::size_t kPiece = 16384;  // pixels or colours of one task

// Colours as numbers, so that they can be sorted: red in the highest byte, alpha in the lowest. All that is
// transparent is one colour, 0, the least.
std::uint32_t key_of(const std::uint8_t* p) {
    if (p[3] == 0) return 0;
    return static_cast<std::uint32_t>(p[0]) << 24 | static_cast<std::uint32_t>(p[1]) << 16 |
           static_cast<std::uint32_t>(p[2]) << 8 | p[3];
}

Rgba8 color_of(std::uint32_t key) {
    return {static_cast<std::uint8_t>(key >> 24), static_cast<std::uint8_t>(key >> 16),
            static_cast<std::uint8_t>(key >> 8), static_cast<std::uint8_t>(key)};
}

// The different colours of a picture, from the least key on, and how many pixels have each.
struct Histogram {
    std::vector<std::uint32_t> keys;
    std::vector<std::uint64_t> pixels;
};

Histogram count_colors(const Image& image) {
    std::vector<std::uint32_t> all(image.bytes().size() / 4);
    const auto* p = image.data<std::uint8_t>();
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = key_of(p + 4 * i);
    std::sort(all.begin(), all.end());
    Histogram histogram;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i == 0 || all[i] != all[i - 1]) histogram.keys.push_back(all[i]), histogram.pixels.push_back(0);
        ++histogram.pixels.back();
    }
    return histogram;
}

// body(begin, end) over pieces of 0 .. count.
template <class Body>
void in_pieces(Arena& arena, std::size_t count, const Body& body) {
    arena.for_each((count + kPiece - 1) / kPiece,
                   [&](std::size_t i) { body(i * kPiece, std::min(count, (i + 1) * kPiece)); });
}

// The entry of every pixel, from the entry of every colour.
std::vector<std::uint8_t> index_pixels(const Image& image, const Histogram& histogram,
                                       const std::vector<std::uint8_t>& entry_of_color, Arena& arena) {
    std::vector<std::uint8_t> indices(image.bytes().size() / 4);
    in_pieces(arena, indices.size(), [&](std::size_t begin, std::size_t end) {
        const auto* p = image.data<std::uint8_t>();
        for (std::size_t i = begin; i < end; ++i) {
            if (i > begin && std::memcmp(p + 4 * i, p + 4 * i - 4, 4) == 0) {
                indices[i] = indices[i - 1];
                continue;
            }
            const auto found = std::lower_bound(histogram.keys.begin(), histogram.keys.end(), key_of(p + 4 * i));
            indices[i] = entry_of_color[static_cast<std::size_t>(found - histogram.keys.begin())];
        }
    });
    return indices;
}

// Entries without pixels go; the others keep their order.
void drop_unused(IndexedImage& image) {
    std::array<bool, 256> used{};
    for (const std::uint8_t index : image.indices) used[index] = true;
    std::array<std::uint8_t, 256> moved{};
    std::size_t kept = 0;
    for (std::size_t i = 0; i < image.colormap.size(); ++i) {
        if (!used[i]) continue;
        moved[i] = static_cast<std::uint8_t>(kept);
        image.colormap[kept++] = image.colormap[i];
    }
    image.colormap.resize(kept);
    for (std::uint8_t& index : image.indices) index = moved[index];
}

std::vector<Rgba8> choose_entries(const Histogram& histogram, const PaletteOptions& options, Arena& arena) {
    std::vector<CountedColor> colors(histogram.keys.size());
    for (std::size_t i = 0; i < colors.size(); ++i)
        colors[i] = {point_of(color_of(histogram.keys[i])), histogram.pixels[i]};
    // The transparent colour, the first where there is one, has its own entry.
    const std::size_t fixed = histogram.keys.front() == 0 ? 1 : 0;
    std::vector<Rgba8> entries(fixed, Rgba8{0, 0, 0, 0});
    const std::span<CountedColor> others = std::span(colors).subspan(fixed);
    const std::vector<Rgba8> means = median_cut(others, static_cast<std::size_t>(options.colors) - fixed);
    entries.insert(entries.end(), means.begin(), means.end());
    refine_palette(others, entries, fixed, options.refinements, arena);
    return entries;
}

void check_options(const Image& image, const PaletteOptions& options) {
    if (image.empty() || image.format() != PixelFormat::kRgba8)
        throw Error(ErrorCode::kUsage, "a palette needs an 8-bit RGBA image");
    if (options.colors < 2 || options.colors > 256)
        throw Error(ErrorCode::kUsage,
                    "a palette of " + std::to_string(options.colors) + " colours: 2 to 256 are possible");
    if (options.refinements < 0 || options.refinements > 64)
        throw Error(ErrorCode::kUsage, "a palette is refined 0 to 64 times");
    if (options.threads < 0) throw Error(ErrorCode::kUsage, "the number of threads must not be negative");
}

}  // namespace

void refine_palette(std::span<const CountedColor> colors, std::vector<Rgba8>& entries, std::size_t fixed, int rounds,
                    Arena& arena) {
    struct Sums {
        std::uint64_t pixels = 0;
        std::array<std::uint64_t, 4> points{};
    };
    std::vector<std::uint8_t> nearest(colors.size());
    for (int round = 0; round < rounds; ++round) {
        const PaletteSearch search(entries);
        in_pieces(arena, colors.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) nearest[i] = search.nearest(colors[i].point);
        });
        std::vector<Sums> sums(entries.size());
        for (std::size_t i = 0; i < colors.size(); ++i) {
            Sums& s = sums[nearest[i]];
            s.pixels += colors[i].pixels;
            for (std::size_t k = 0; k < 4; ++k)
                s.points[k] += static_cast<std::uint64_t>(colors[i].point[k]) * colors[i].pixels;
        }
        const std::vector<Rgba8> before = entries;
        for (std::size_t e = fixed; e < entries.size(); ++e)
            if (sums[e].pixels > 0) entries[e] = mean_color(sums[e].points, sums[e].pixels);
        if (entries == before) return;
    }
}

IndexedImage make_palette(const Image& image, const PaletteOptions& options) {
    check_options(image, options);
    Arena arena(options.threads);
    IndexedImage result;
    result.width = image.width(), result.height = image.height();
    const Histogram histogram = count_colors(image);
    std::vector<std::uint8_t> entry_of_color(histogram.keys.size());
    const bool exact = histogram.keys.size() <= static_cast<std::size_t>(options.colors);
    if (exact) {
        for (std::size_t i = 0; i < histogram.keys.size(); ++i) {
            result.colormap.push_back(color_of(histogram.keys[i]));
            entry_of_color[i] = static_cast<std::uint8_t>(i);
        }
    } else {
        result.colormap = choose_entries(histogram, options, arena);
        const PaletteSearch search(result.colormap);
        in_pieces(arena, histogram.keys.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                entry_of_color[i] = search.nearest(point_of(color_of(histogram.keys[i])));
        });
    }
    result.indices = options.dither && !exact ? dither(image, result.colormap)
                                              : index_pixels(image, histogram, entry_of_color, arena);
    drop_unused(result);
    result.bits = std::max(1, static_cast<int>(std::bit_width(result.colormap.size() - 1)));
    return result;
}

}  // namespace tessera
