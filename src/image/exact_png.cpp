// Numbers as PNG without loss: 16-bit grey, depth in parts of a metre, and ids in the bytes of RGB or RGBA.
#include "core/fp_environment.h"
#include "core/parallel.h"
#include "image/codecs.h"
#include "image/png_stream.h"

#include <tessera/error.h>
#include <tessera/planes.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tessera {
namespace {

constexpr std::uint32_t kLargestGrey = 65535;

void check_format(const Image& plane, PixelFormat format, const char* what) {
    if (plane.empty()) throw Error(ErrorCode::kUsage, "an empty image cannot be written");
    if (plane.format() != format) throw Error(ErrorCode::kUsage, what);
}

std::span<const std::uint32_t> numbers(const Image& plane) {
    return {plane.data<std::uint32_t>(), plane.bytes().size() / sizeof(std::uint32_t)};
}

std::vector<std::byte> write_grey(const Image& plane, const std::vector<std::uint16_t>& values,
                                  const PngOptions& options) {
    PngRows rows;
    rows.width = plane.width(), rows.height = plane.height();
    rows.bits = 16;
    rows.color = PngColor::kGrey;
    rows.is_picture = false;
    rows.pack = [&values, width = static_cast<std::size_t>(rows.width)](std::size_t y, std::uint8_t* out) {
        for (std::size_t x = 0; x < width; ++x) {
            const std::uint16_t v = values[y * width + x];
            *out++ = static_cast<std::uint8_t>(v >> 8), *out++ = static_cast<std::uint8_t>(v & 0xff);
        }
    };
    Arena arena(options.threads);
    return write_png(rows, options.level, arena);
}

// The shortest decimal that tells the number.
std::string shown(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Of 0 .. 65536, half to even.
std::uint32_t rounded(double value) {
    const auto whole = static_cast<std::uint32_t>(value);
    const double rest = value - whole;
    return whole + (rest > 0.5 || (rest == 0.5 && whole % 2 == 1) ? 1 : 0);
}

}  // namespace

std::vector<std::byte> encode_grey_png(const Image& plane, const PngOptions& options) {
    check_format(plane, PixelFormat::kU32, "a 16-bit grey PNG takes a plane of 32-bit numbers");
    const auto values = numbers(plane);
    const std::uint32_t largest = *std::max_element(values.begin(), values.end());
    if (largest > kLargestGrey)
        throw Error(ErrorCode::kLimit, "the largest value, " + std::to_string(largest) + ", does not fit 16 bits");
    std::vector<std::uint16_t> grey(values.size());
    std::transform(values.begin(), values.end(), grey.begin(), [](auto v) { return static_cast<std::uint16_t>(v); });
    return write_grey(plane, grey, options);
}

std::vector<std::byte> encode_depth_png(const Image& depth, double scale, const PngOptions& options) {
    check_format(depth, PixelFormat::kF32, "a depth PNG takes a plane of floats");
    if (!(scale > 0) || !std::isfinite(scale))
        throw Error(ErrorCode::kUsage, "the scale of a depth PNG must be positive and finite");
    const FpEnvironment exact;
    const std::span<const float> metres(depth.data<float>(), depth.bytes().size() / sizeof(float));
    double nearest = 0, farthest = 0;
    std::vector<std::uint16_t> grey(metres.size());
    for (std::size_t i = 0; i < metres.size(); ++i) {
        const double m = metres[i];
        if (!std::isfinite(m)) continue;
        nearest = std::min(nearest, m), farthest = std::max(farthest, m);
        const std::uint32_t value = rounded(std::clamp(m * scale, 0.0, kLargestGrey + 1.0));
        grey[i] = static_cast<std::uint16_t>(std::clamp<std::uint32_t>(value, 1, kLargestGrey));
    }
    if (nearest < 0) throw Error(ErrorCode::kLimit, "a depth of " + shown(nearest) + " m is negative");
    // 65535.5 is rounded to the even number above.
    if (farthest * scale >= kLargestGrey + 0.5)
        throw Error(ErrorCode::kLimit, "the largest depth, " + shown(farthest) + " m, does not fit 16 bits at " +
                                           shown(scale) + " per metre");
    return write_grey(depth, grey, options);
}

std::vector<std::byte> encode_id_png(const Image& ids, const PngOptions& options) {
    check_format(ids, PixelFormat::kU32, "an id PNG takes a plane of 32-bit numbers");
    const auto values = numbers(ids);
    const bool wide = *std::max_element(values.begin(), values.end()) >> 24 != 0;
    PngRows rows;
    rows.width = ids.width(), rows.height = ids.height();
    rows.color = wide ? PngColor::kRgba : PngColor::kRgb;
    rows.is_picture = false;
    rows.pack = [&](std::size_t y, std::uint8_t* out) {
        const auto width = static_cast<std::size_t>(rows.width);
        for (const std::uint32_t id : values.subspan(y * width, width))
            for (int shift = 0; shift < (wide ? 32 : 24); shift += 8) *out++ = static_cast<std::uint8_t>(id >> shift);
    };
    Arena arena(options.threads);
    return write_png(rows, options.level, arena);
}

Image decode_id_png(std::span<const std::byte> file, std::uint64_t max_pixels) {
    const ImageInfo info = read_png_info(file);
    if (info.bits > 8 || info.channels < 3) throw Error(ErrorCode::kInput, "ids are read from 8-bit RGB or RGBA PNG");
    const Image packed = decode_png(file, max_pixels, false);
    Image ids(packed.width(), packed.height(), PixelFormat::kU32);
    const auto* in = packed.data<std::uint8_t>();
    auto* out = ids.data<std::uint32_t>();
    for (std::size_t i = 0, n = ids.bytes().size() / sizeof(std::uint32_t); i < n; ++i, in += 4) {
        out[i] = in[0] | static_cast<std::uint32_t>(in[1]) << 8 | static_cast<std::uint32_t>(in[2]) << 16;
        if (info.channels == 4) out[i] |= static_cast<std::uint32_t>(in[3]) << 24;
    }
    return ids;
}

}  // namespace tessera
