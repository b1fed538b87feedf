// Median cut, and the search for the nearest entry of a palette.
#include "image/palette.h"

#include <algorithm>
#include <tuple>

namespace tessera {
namespace {

__extension__ using Uint128 = unsigned __int128;

// Colours `begin` to `end`, and along which axis they spread how much.
struct Box {
    std::size_t begin = 0, end = 0;
    std::size_t axis = 0;
    std::uint64_t spread = 0;
    std::uint64_t pixels = 0;
    std::array<std::uint64_t, 4> sums{};
};

// Sums of squares stay below 2^28 pixels * 65025^2 < 2^60.
Box make_box(std::span<const CountedColor> colors, std::size_t begin, std::size_t end) {
    Box box;
    box.begin = begin, box.end = end;
    std::array<std::uint64_t, 4> squares{};
    for (const CountedColor& c : colors.subspan(begin, end - begin)) {
        box.pixels += c.pixels;
        for (std::size_t k = 0; k < 4; ++k) {
            const auto value = static_cast<std::uint64_t>(c.point[k]);
            box.sums[k] += value * c.pixels, squares[k] += value * value * c.pixels;
        }
    }
    for (std::size_t k = 0; k < 4; ++k) {
        // sum (x - mean)^2 = sum x^2 - (sum x)^2 / n
        const Uint128 scaled = Uint128{squares[k]} * box.pixels - Uint128{box.sums[k]} * box.sums[k];
        const auto spread = static_cast<std::uint64_t>(scaled / box.pixels);
        if (spread > box.spread) box.spread = spread, box.axis = k;
    }
    return box;
}

// Where the second half of a box's pixels begins, once its colours are sorted along the axis.
std::size_t median(std::span<CountedColor> colors, const Box& box) {
    const auto first = colors.begin() + static_cast<std::ptrdiff_t>(box.begin);
    std::sort(first, colors.begin() + static_cast<std::ptrdiff_t>(box.end),
              [k = box.axis](const CountedColor& a, const CountedColor& b) {
                  return std::tie(a.point[k], a.point) < std::tie(b.point[k], b.point);
              });
    std::size_t cut = box.begin;
    std::uint64_t below = 0;
    while (2 * below < box.pixels) below += colors[cut++].pixels;
    return std::clamp(cut, box.begin + 1, box.end - 1);
}

}  // namespace

Rgba8 mean_color(const std::array<std::uint64_t, 4>& sums, std::uint64_t pixels) {
    const std::uint64_t alpha = (2 * sums[3] + 255 * pixels) / (2 * 255 * pixels);
    if (alpha == 0) return {0, 0, 0, 0};
    // The sum of c a over the sum of a, which is sums[3] / 255.
    const auto channel = [&](std::size_t k) {
        return static_cast<std::uint8_t>((2 * 255 * sums[k] + sums[3]) / (2 * sums[3]));
    };
    return {channel(0), channel(1), channel(2), static_cast<std::uint8_t>(alpha)};
}

std::vector<Rgba8> median_cut(std::span<CountedColor> colors, std::size_t count) {
    std::vector<Box> boxes{make_box(colors, 0, colors.size())};
    while (boxes.size() < count) {
        const auto widest = std::max_element(boxes.begin(), boxes.end(),
                                             [](const Box& a, const Box& b) { return a.spread < b.spread; });
        if (widest->end - widest->begin < 2) break;
        const std::size_t cut = median(colors, *widest), end = widest->end;
        *widest = make_box(colors, widest->begin, cut);
        boxes.push_back(make_box(colors, cut, end));
    }
    std::vector<Rgba8> means;
    for (const Box& box : boxes) means.push_back(mean_color(box.sums, box.pixels));
    return means;
}

PaletteSearch::PaletteSearch(std::span<const Rgba8> entries) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const ColorPoint p = point_of(entries[i]);
        sorted_.push_back({p[0] + p[1] + p[2] + p[3], static_cast<std::uint8_t>(i), p});
    }
    std::stable_sort(sorted_.begin(), sorted_.end(), [](const Entry& a, const Entry& b) { return a.sum < b.sum; });
}

std::uint8_t PaletteSearch::nearest(const ColorPoint& point) const {
    const std::int64_t sum = std::int64_t{point[0]} + point[1] + point[2] + point[3];
    std::size_t up =
        static_cast<std::size_t>(std::lower_bound(sorted_.begin(), sorted_.end(), sum,
                                                  [](const Entry& e, std::int64_t s) { return e.sum < s; }) -
                                 sorted_.begin());
    std::size_t down = up;  // entries below it are still to be seen
    std::int64_t best = INT64_MAX;
    std::uint8_t number = 0;
    const auto try_entry = [&](const Entry& e) {
        const std::int64_t apart = e.sum - sum;
        if (apart * apart / 4 > best) return false;
        const std::int64_t distance = squared_distance(e.point, point);
        if (distance < best || (distance == best && e.number < number)) best = distance, number = e.number;
        return true;
    };
    while (up < sorted_.size() || down > 0) {
        if (up < sorted_.size() && !try_entry(sorted_[up++])) up = sorted_.size();
        if (down > 0 && !try_entry(sorted_[--down])) down = 0;
    }
    return number;
}

}  // namespace tessera
