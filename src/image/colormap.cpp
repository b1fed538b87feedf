// Numbers as colours: the maps' tables, colours of ids, and planes drawn through them.
#include "core/fp_environment.h"
#include "image/colormap_data.h"

#include <tessera/error.h>
#include <tessera/planes.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

using Entries = std::array<Rgba8, 256>;

constexpr std::uint8_t hex_byte(std::string_view hex, std::size_t at) {
    const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
    return static_cast<std::uint8_t>(16 * digit(hex[at]) + digit(hex[at + 1]));
}

constexpr Entries from_hex(std::string_view hex) {
    Entries entries;
    for (std::size_t i = 0; i < entries.size(); ++i)
        entries[i] = {hex_byte(hex, 6 * i), hex_byte(hex, 6 * i + 2), hex_byte(hex, 6 * i + 4)};
    return entries;
}

constexpr Rgba8 color_of_id(std::uint32_t id) {
    if (id == 0) return {0, 0, 0};
    std::uint32_t mixed = id;
    mixed = (mixed ^ mixed >> 16) * 0x85ebca6bu;
    mixed = (mixed ^ mixed >> 13) * 0xc2b2ae35u;
    mixed ^= mixed >> 16;

    // Hue, saturation and value as in Smith 1978, in 1/255: `rise` along one of the six edges of the circle.
    const std::uint64_t turn = std::uint64_t{id * 0x9e3779b9u} * 6;
    const auto edge = static_cast<unsigned>(turn >> 32), rise = static_cast<unsigned>(turn >> 24 & 0xff);
    const unsigned high = 150 + 105 * (mixed & 0xff) / 255, low = high * (mixed >> 8 & 0xff) / 510;
    const auto up = static_cast<std::uint8_t>(low + (high - low) * rise / 255);
    const auto down = static_cast<std::uint8_t>(high - (high - low) * rise / 255);
    const auto h = static_cast<std::uint8_t>(high), l = static_cast<std::uint8_t>(low);
    const Rgba8 edges[6]{{h, up, l}, {down, h, l}, {l, h, up}, {l, down, h}, {up, l, h}, {h, l, down}};
    return edges[edge];
}

template <class Function>
constexpr Entries from_index(Function color) {
    Entries entries;
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i] = color(static_cast<std::uint8_t>(i));
    return entries;
}

constexpr Entries kGreyEntries = from_index([](std::uint8_t i) { return Rgba8{i, i, i}; });
constexpr Entries kViridisEntries = from_hex(kViridisHex);
constexpr Entries kMagmaEntries = from_hex(kMagmaHex);
constexpr Entries kTurboEntries = from_hex(kTurboHex);
constexpr Entries kIdEntries = from_index([](std::uint8_t i) { return color_of_id(i); });

struct NamedMap {
    const char* name;
    const Entries* entries;
};
// By Colormap.
constexpr std::array<NamedMap, 5> kMaps{{{"grey", &kGreyEntries},
                                         {"viridis", &kViridisEntries},
                                         {"magma", &kMagmaEntries},
                                         {"turbo", &kTurboEntries},
                                         {"ids", &kIdEntries}}};

const NamedMap& find(Colormap map) {
    const auto i = static_cast<std::size_t>(map);
    if (i >= kMaps.size()) throw Error(ErrorCode::kUsage, "unknown colormap");
    return kMaps[i];
}

// Calls use(i, value) for every pixel, the value as a double, which is exact.
template <class Use>
void for_each_value(const Image& plane, const Use& use) {
    const std::size_t count = plane.bytes().size() / 4;
    if (plane.format() == PixelFormat::kF32)
        for (std::size_t i = 0; i < count; ++i) use(i, static_cast<double>(plane.data<float>()[i]));
    else if (plane.format() == PixelFormat::kU32)
        for (std::size_t i = 0; i < count; ++i) use(i, static_cast<double>(plane.data<std::uint32_t>()[i]));
    else
        throw Error(ErrorCode::kUsage, "a colormap takes a plane of floats or of 32-bit numbers");
}

// Which of `count` equal steps of the range a value lies in; beyond it the first or the last.
class Steps {
  public:
    Steps(const Image& plane, const std::optional<ValueRange>& given, unsigned count)
        : range_(given ? *given : finite_range(plane).value_or(ValueRange{})), count_(count) {
        if (!std::isfinite(range_.high - range_.low) || range_.low > range_.high)
            throw Error(ErrorCode::kUsage, "the range of a colormap must be finite and must not run backwards");
    }
    unsigned operator()(double value) const {
        const double at = (value - range_.low) / (range_.high - range_.low) * count_;
        // Not so for NaN either, of an empty range.
        if (!(at > 0) || range_.low == range_.high) return 0;
        return at < count_ ? static_cast<unsigned>(at) : count_ - 1;
    }

  private:
    ValueRange range_;
    unsigned count_;
};

void check_is_plane_of_ids(const Image& plane) {
    if (plane.format() != PixelFormat::kU32)
        throw Error(ErrorCode::kUsage, "the colormap 'ids' takes a plane of 32-bit numbers");
}

IndexedImage plane_of_ids(const Image& plane, IndexedImage result) {
    check_is_plane_of_ids(plane);
    const auto count = std::uint32_t{1} << result.bits;
    for (std::uint32_t id = 0; id < count; ++id) result.colormap.push_back(id_color(id));
    const auto* ids = plane.data<std::uint32_t>();
    for (std::size_t i = 0; i < result.indices.size(); ++i) {
        if (ids[i] >= count)
            throw Error(ErrorCode::kLimit, "the number " + std::to_string(ids[i]) + " does not fit an index of " +
                                               std::to_string(result.bits) + " bits");
        result.indices[i] = static_cast<std::uint8_t>(ids[i]);
    }
    return result;
}

}  // namespace

const char* name(Colormap map) { return find(map).name; }

std::optional<Colormap> colormap_named(std::string_view name) {
    for (std::size_t i = 0; i < kMaps.size(); ++i)
        if (name == kMaps[i].name) return static_cast<Colormap>(i);
    return {};
}

const std::array<Rgba8, 256>& entries(Colormap map) { return *find(map).entries; }

Rgba8 id_color(std::uint32_t id) { return color_of_id(id); }

std::optional<ValueRange> finite_range(const Image& plane) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    ValueRange range{kInfinity, -kInfinity};
    for_each_value(plane, [&](std::size_t, double value) {
        if (!std::isfinite(value)) return;
        range.low = std::min(range.low, value), range.high = std::max(range.high, value);
    });
    if (range.low > range.high) return {};
    return range;
}

Image apply_colormap(const Image& plane, Colormap map, std::optional<ValueRange> range) {
    if (plane.empty()) throw Error(ErrorCode::kUsage, "an empty plane has no colours");
    const FpEnvironment exact;
    Image result(plane.width(), plane.height(), PixelFormat::kRgba8);
    auto* out = result.data<std::uint8_t>();
    const auto put = [out](std::size_t i, Rgba8 c) {
        out[4 * i] = c.r, out[4 * i + 1] = c.g, out[4 * i + 2] = c.b, out[4 * i + 3] = c.a;
    };
    if (map == Colormap::kIds) {
        check_is_plane_of_ids(plane);
        const auto* ids = plane.data<std::uint32_t>();
        for (std::size_t i = 0; i < plane.bytes().size() / 4; ++i) put(i, id_color(ids[i]));
        return result;
    }
    const Entries& colors = entries(map);
    const Steps steps(plane, range, 256);
    for_each_value(plane, [&](std::size_t i, double value) {
        put(i, std::isfinite(value) ? colors[steps(value)] : Rgba8{0, 0, 0, 0});
    });
    return result;
}

IndexedImage index_plane(const Image& plane, Colormap map, int bits, std::optional<ValueRange> range) {
    if (plane.empty()) throw Error(ErrorCode::kUsage, "an empty plane has no colours");
    if (bits < 1 || bits > 8)
        throw Error(ErrorCode::kUsage, "an index plane of " + std::to_string(bits) + " bits: 1 to 8 are possible");
    const FpEnvironment exact;
    IndexedImage result;
    result.width = plane.width(), result.height = plane.height();
    result.bits = bits;
    result.indices.resize(plane.bytes().size() / bytes_per_pixel(plane.format()));
    if (map == Colormap::kIds) return plane_of_ids(plane, std::move(result));

    bool all_finite = true;
    for_each_value(plane, [&](std::size_t, double value) { all_finite = all_finite && std::isfinite(value); });
    const unsigned first = all_finite ? 0 : 1, count = (1u << bits) - first;
    if (!all_finite) result.colormap.push_back({0, 0, 0, 0});
    for (unsigned i = 0; i < count; ++i)
        result.colormap.push_back(entries(map)[count == 1 ? 0 : (2 * 255 * i + count - 1) / (2 * (count - 1))]);
    const Steps steps(plane, range, count);
    for_each_value(plane, [&](std::size_t i, double value) {
        result.indices[i] = static_cast<std::uint8_t>(std::isfinite(value) ? first + steps(value) : 0);
    });
    return result;
}

}  // namespace tessera
