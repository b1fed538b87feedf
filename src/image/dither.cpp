// Floyd-Steinberg dithering to a palette.
#include "core/fp_environment.h"
#include "image/palette.h"
#include "image/srgb.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::int32_t kWhite = 65535;  // of linear light

using Light = std::array<std::int32_t, 3>;

// Between display codes and linear light in 1/65535.
struct Scale {
    std::array<std::uint16_t, 256> light{};
    std::vector<std::uint8_t> code;

    Scale() : code(kWhite + 1) {
        const FpEnvironment exact;
        for (std::size_t i = 0; i < light.size(); ++i)
            light[i] = static_cast<std::uint16_t>(static_cast<double>(kSrgbTables.linear[i]) * kWhite + 0.5);
        for (std::size_t i = 0; i < code.size(); ++i)
            code[i] = static_cast<std::uint8_t>(srgb8_from_linear(static_cast<float>(i) / kWhite));
    }
    Light light_of(Rgba8 c) const { return {light[c.r], light[c.g], light[c.b]}; }
    Rgba8 color_of(const Light& l) const {
        const auto code_of = [&](std::size_t k) {
            return code[static_cast<std::size_t>(std::clamp(l[k], std::int32_t{0}, kWhite))];
        };
        return {code_of(0), code_of(1), code_of(2), 255};
    }
};

// The nearest entry of opaque colours, with the answers given last: neighbours often ask the same.
class OpaqueSearch {
  public:
    explicit OpaqueSearch(std::span<const Rgba8> entries) : search_(entries), known_(std::size_t{1} << kBits) {}

    std::uint8_t nearest(Rgba8 c) {
        const std::uint32_t key = static_cast<std::uint32_t>(c.r) << 16 | static_cast<std::uint32_t>(c.g) << 8 | c.b;
        Answer& answer = known_[key * 0x9e3779b1u >> (32 - kBits)];
        if (answer.key != key) answer = {key, search_.nearest(point_of(c))};
        return answer.entry;
    }

  private:
    static constexpr int kBits = 15;
    struct Answer {
        std::uint32_t key = UINT32_MAX;
        std::uint8_t entry = 0;
    };
    PaletteSearch search_;
    std::vector<Answer> known_;
};

// The largest step from an entry's light to the next higher, by channel. Where entries can mix a colour,
// errors stay below; where they cannot, error must not pile up without end.
Light largest_gaps(std::span<const Rgba8> entries, const Scale& scale) {
    Light gaps{};
    for (std::size_t k = 0; k < gaps.size(); ++k) {
        std::vector<std::int32_t> values;
        for (const Rgba8& entry : entries) values.push_back(scale.light_of(entry)[k]);
        std::sort(values.begin(), values.end());
        for (std::size_t i = 1; i < values.size(); ++i) gaps[k] = std::max(gaps[k], values[i] - values[i - 1]);
    }
    return gaps;
}

}  // namespace

std::vector<std::uint8_t> dither(const Image& image, std::span<const Rgba8> entries) {
    const Scale scale;
    const Light gaps = largest_gaps(entries, scale);
    const PaletteSearch search(entries);
    OpaqueSearch opaque(entries);
    const auto width = static_cast<std::ptrdiff_t>(image.width());
    const auto* pixels = reinterpret_cast<const Rgba8*>(image.bytes().data());
    std::vector<std::uint8_t> indices(image.bytes().size() / 4);
    // Sixteenths of the error that comes to this row and the next; pixel x at x + 1, so that both ends have a
    // neighbour.
    std::vector<Light> here(static_cast<std::size_t>(width) + 2), below(here.size());

    for (std::ptrdiff_t y = 0; y < image.height(); ++y) {
        std::fill(below.begin(), below.end(), Light{});
        const std::ptrdiff_t step = y % 2 == 0 ? 1 : -1;
        for (std::ptrdiff_t i = 0, x = step > 0 ? 0 : width - 1; i < width; ++i, x += step) {
            const Rgba8 pixel = pixels[y * width + x];
            std::uint8_t& index = indices[static_cast<std::size_t>(y * width + x)];
            if (pixel.a < 255) {
                index = search.nearest(point_of(pixel));
                continue;
            }
            const auto at = static_cast<std::size_t>(x + 1);
            const auto ahead = static_cast<std::size_t>(x + 1 + step), behind = static_cast<std::size_t>(x + 1 - step);
            Light wanted = scale.light_of(pixel);
            for (std::size_t k = 0; k < 3; ++k) wanted[k] += (here[at][k] + 8) >> 4;
            index = opaque.nearest(scale.color_of(wanted));
            const Light given = scale.light_of(entries[index]);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t error = std::clamp(wanted[k] - given[k], -gaps[k], gaps[k]);
                here[ahead][k] += 7 * error;
                below[behind][k] += 3 * error, below[at][k] += 5 * error, below[ahead][k] += error;
            }
        }
        here.swap(below);
    }
    return indices;
}

}  // namespace tessera
