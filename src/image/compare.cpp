// How far two images are apart: counts and errors for people and scripts, and a picture of where.
#include <tessera/error.h>
#include <tessera/image.h>
#include <tessera/planes.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace tessera {
namespace {

void check_same_shape(const Image& a, const Image& b) {
    if (a.width() == b.width() && a.height() == b.height() && a.format() == b.format()) return;
    throw Error(ErrorCode::kUsage, "images of different size or format: " + std::to_string(a.width()) + " x " +
                                       std::to_string(a.height()) + " and " + std::to_string(b.width()) + " x " +
                                       std::to_string(b.height()));
}

double channel_error(float a, float b) {
    // Equal infinities, and NaN against NaN, are no difference.
    if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
    const double e = std::fabs(static_cast<double>(a) - static_cast<double>(b));
    return std::isnan(e) ? std::numeric_limits<double>::infinity() : e;
}

template <class Integer>
double channel_error(Integer a, Integer b) {
    return a < b ? static_cast<double>(b - a) : static_cast<double>(a - b);
}

// An IEEE half. Every one is a float, too.
struct Half {
    std::uint16_t bits;
};

float value_of(Half half) {
    const std::uint32_t sign = half.bits >> 15, exponent = half.bits >> 10 & 31, mantissa = half.bits & 1023;
    if (exponent == 0) return (sign != 0 ? -0x1p-24f : 0x1p-24f) * static_cast<float>(mantissa);
    const std::uint32_t widened = exponent == 31 ? 255 : exponent + 112;
    return std::bit_cast<float>(sign << 31 | widened << 23 | mantissa << 13);
}

double channel_error(Half a, Half b) { return channel_error(value_of(a), value_of(b)); }

// Sums run in pixel order. `peak` is the largest value of a channel, the signal of the PSNR.
template <class T>
ImageDifference compare(std::span<const std::byte> a, std::span<const std::byte> b, std::size_t channels, double peak,
                        double tolerance) {
    const T *p = reinterpret_cast<const T*>(a.data()), *q = reinterpret_cast<const T*>(b.data());
    const std::size_t count = a.size() / sizeof(T);
    if (!(tolerance >= 0)) throw Error(ErrorCode::kUsage, "the tolerance must not be negative");
    ImageDifference d;
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < count; i += channels) {
        double worst = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            const double e = channel_error(p[i + c], q[i + c]);
            sum += e;
            squares += e * e;
            if (e > worst) worst = e;
        }
        if (worst > d.max_error) d.max_error = worst;
        if (worst > tolerance) ++d.differing_pixels;
    }
    if (count > 0) d.mean_error = sum / static_cast<double>(count);
    d.psnr = squares > 0 ? 10 * std::log10(peak * peak * static_cast<double>(count) / squares)
                         : std::numeric_limits<double>::infinity();
    return d;
}

}  // namespace

ImageDifference compare_images(const Image& a, const Image& b, double tolerance) {
    check_same_shape(a, b);
    const auto p = a.bytes(), q = b.bytes();
    switch (a.format()) {
        case PixelFormat::kRgba8:
            return compare<std::uint8_t>(p, q, 4, 255, tolerance);
        case PixelFormat::kRgba16:
            return compare<std::uint16_t>(p, q, 4, 65535, tolerance);
        case PixelFormat::kRgba32f:
            return compare<float>(p, q, 4, 1, tolerance);
        case PixelFormat::kF32:
            return compare<float>(p, q, 1, 1, tolerance);
        case PixelFormat::kRg32f:
            return compare<float>(p, q, 2, 1, tolerance);
        case PixelFormat::kRgb32f:
            return compare<float>(p, q, 3, 1, tolerance);
        case PixelFormat::kU32:
            return compare<std::uint32_t>(p, q, 1, std::numeric_limits<std::uint32_t>::max(), tolerance);
    }
    throw Error(ErrorCode::kUsage, "unknown pixel format");
}

ImageDifference compare_arrays(const NpyArray& a, const NpyArray& b, double tolerance) {
    if (a.width != b.width || a.height != b.height || a.components != b.components || a.type != b.type)
        throw Error(ErrorCode::kUsage, "arrays of different shape or type");
    const auto components = static_cast<std::size_t>(a.components);
    const std::size_t bytes =
        static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height) * components * bytes_per_value(a.type);
    if (a.values.size() != bytes || b.values.size() != bytes)
        throw Error(ErrorCode::kUsage, "arrays whose values do not fill their shape");
    switch (a.type) {
        case NpyType::kU1:
            return compare<std::uint8_t>(a.values, b.values, components, 255, tolerance);
        case NpyType::kU2:
            return compare<std::uint16_t>(a.values, b.values, components, 65535, tolerance);
        case NpyType::kU4:
            return compare<std::uint32_t>(a.values, b.values, components, std::numeric_limits<std::uint32_t>::max(),
                                          tolerance);
        case NpyType::kF2:
            return compare<Half>(a.values, b.values, components, 1, tolerance);
        case NpyType::kF4:
            return compare<float>(a.values, b.values, components, 1, tolerance);
    }
    throw Error(ErrorCode::kUsage, "unknown type of values");
}

Image difference_picture(const Image& a, const Image& b, double tolerance) {
    check_same_shape(a, b);
    if (a.format() != PixelFormat::kRgba8)
        throw Error(ErrorCode::kUsage, "a picture of differences needs 8-bit RGBA images");
    if (!(tolerance >= 0)) throw Error(ErrorCode::kUsage, "the tolerance must not be negative");
    Image picture(a.width(), a.height(), PixelFormat::kRgba8);
    const auto *p = a.data<std::uint8_t>(), *q = b.data<std::uint8_t>();
    auto* out = picture.data<std::uint8_t>();
    for (std::size_t i = 0, n = a.bytes().size(); i < n; i += 4) {
        int worst = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            const int e = std::abs(p[i + c] - q[i + c]);
            if (e > worst) worst = e;
        }
        out[i + 3] = 255;
        if (worst > tolerance) {
            // Small differences must be seen too: from half bright upwards.
            out[i] = static_cast<std::uint8_t>(128 + worst / 2);
        } else {
            // Pale grey, so that nothing but differences is saturated. Rec. 709 luma in 1/256.
            const int luma = (54 * p[i] + 183 * p[i + 1] + 19 * p[i + 2]) / 256;
            out[i] = out[i + 1] = out[i + 2] = static_cast<std::uint8_t>(128 + luma / 2);
        }
    }
    return picture;
}

}  // namespace tessera
