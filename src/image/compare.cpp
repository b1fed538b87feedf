// How far two images are apart: counts and errors for people and scripts, and a picture of where.
#include <tessera/error.h>
#include <tessera/image_files.h>
#include <tessera/planes.h>

#include <algorithm>
#include <bit>
#include <cmath>
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
class Comparison {
  public:
    Comparison(std::size_t pixels, double tolerance) : differs_(pixels, 0), tolerance_(tolerance) {}

    template <class T>
    void add(std::span<const std::byte> a, std::span<const std::byte> b, std::size_t channels, double peak) {
        const T *p = reinterpret_cast<const T*>(a.data()), *q = reinterpret_cast<const T*>(b.data());
        for (std::size_t i = 0; i < differs_.size(); ++i, p += channels, q += channels) {
            double worst = 0;
            for (std::size_t c = 0; c < channels; ++c) {
                const double e = channel_error(p[c], q[c]);
                sum_ += e;
                squares_ += (e / peak) * (e / peak);
                if (e > worst) worst = e;
            }
            if (worst > worst_) worst_ = worst;
            if (worst > tolerance_) differs_[i] = 1;
        }
        samples_ += channels * differs_.size();
    }

    void add(const Image& a, const Image& b) {
        const auto p = a.bytes(), q = b.bytes();
        switch (a.format()) {
            case PixelFormat::kRgba8:
                return add<std::uint8_t>(p, q, 4, 255);
            case PixelFormat::kRgba16:
                return add<std::uint16_t>(p, q, 4, 65535);
            case PixelFormat::kRgba32f:
                return add<float>(p, q, 4, 1);
            case PixelFormat::kRgb32f:
                return add<float>(p, q, 3, 1);
            case PixelFormat::kRg32f:
                return add<float>(p, q, 2, 1);
            case PixelFormat::kF32:
                return add<float>(p, q, 1, 1);
            case PixelFormat::kU32:
                return add<std::uint32_t>(p, q, 1, std::numeric_limits<std::uint32_t>::max());
        }
        throw Error(ErrorCode::kUsage, "unknown pixel format");
    }

    ImageDifference result() const {
        ImageDifference d;
        for (const char differs : differs_) d.differing_pixels += differs != 0;
        d.max_error = worst_;
        if (samples_ > 0) d.mean_error = sum_ / static_cast<double>(samples_);
        d.psnr = squares_ > 0 ? 10 * std::log10(static_cast<double>(samples_) / squares_)
                              : std::numeric_limits<double>::infinity();
        return d;
    }

  private:
    std::vector<char> differs_;  // one per pixel
    double tolerance_, sum_ = 0, squares_ = 0, worst_ = 0;
    std::size_t samples_ = 0;
};

std::size_t pixels_of(const Image& image) {
    return static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height());
}

void check_tolerance(double tolerance) {
    if (!(tolerance >= 0)) throw Error(ErrorCode::kUsage, "the tolerance must not be negative");
}

// Small differences must be seen too: from half bright upwards. What does not differ is pale grey, so that
// nothing but differences is saturated. `error` and the luma are 0 .. 255.
void paint(bool differs, int error, int luma, std::uint8_t* out) {
    if (differs)
        out[0] = static_cast<std::uint8_t>(128 + error / 2);
    else
        out[0] = out[1] = out[2] = static_cast<std::uint8_t>(128 + luma / 2);
    out[3] = 255;
}

// Rec. 709 luma in 1/256.
int luma_of(int r, int g, int b) { return (54 * r + 183 * g + 19 * b) / 256; }

// 0 .. 255 for the values 0 .. 1, those beyond clamped; linear, which does for a backdrop.
int code_of(double value) { return value >= 1 ? 255 : value > 0 ? static_cast<int>(255 * value) : 0; }

}  // namespace

ImageDifference compare_images(const Image& a, const Image& b, double tolerance) {
    check_same_shape(a, b);
    check_tolerance(tolerance);
    Comparison comparison(pixels_of(a), tolerance);
    comparison.add(a, b);
    return comparison.result();
}

ImageDifference compare_planes(std::span<const ImagePlane> a, std::span<const ImagePlane> b, double tolerance) {
    check_tolerance(tolerance);
    if (a.size() != b.size())
        throw Error(ErrorCode::kUsage,
                    "lists of " + std::to_string(a.size()) + " and " + std::to_string(b.size()) + " channels");
    Comparison comparison(a.empty() ? 0 : pixels_of(a[0].pixels), tolerance);
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i].name != b[i].name)
            throw Error(ErrorCode::kUsage, "the channels " + a[i].name + " and " + b[i].name + " are compared");
        check_same_shape(a[i].pixels, b[i].pixels);
        if (pixels_of(a[i].pixels) != pixels_of(a[0].pixels))
            throw Error(ErrorCode::kUsage, "channels of different size");
        comparison.add(a[i].pixels, b[i].pixels);
    }
    return comparison.result();
}

ImageDifference compare_arrays(const NpyArray& a, const NpyArray& b, double tolerance) {
    if (a.width != b.width || a.height != b.height || a.components != b.components || a.type != b.type)
        throw Error(ErrorCode::kUsage, "arrays of different shape or type");
    const auto components = static_cast<std::size_t>(a.components);
    const std::size_t bytes =
        static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height) * components * bytes_per_value(a.type);
    if (a.values.size() != bytes || b.values.size() != bytes)
        throw Error(ErrorCode::kUsage, "arrays whose values do not fill their shape");
    check_tolerance(tolerance);
    Comparison c(static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height), tolerance);
    switch (a.type) {
        case NpyType::kU1:
            c.add<std::uint8_t>(a.values, b.values, components, 255);
            break;
        case NpyType::kU2:
            c.add<std::uint16_t>(a.values, b.values, components, 65535);
            break;
        case NpyType::kU4:
            c.add<std::uint32_t>(a.values, b.values, components, std::numeric_limits<std::uint32_t>::max());
            break;
        case NpyType::kF2:
            c.add<Half>(a.values, b.values, components, 1);
            break;
        case NpyType::kF4:
            c.add<float>(a.values, b.values, components, 1);
            break;
    }
    return c.result();
}

Image difference_picture(const Image& a, const Image& b, double tolerance) {
    check_same_shape(a, b);
    const bool floating = a.format() == PixelFormat::kRgba32f;
    if (a.format() != PixelFormat::kRgba8 && !floating)
        throw Error(ErrorCode::kUsage, "a picture of differences needs RGBA images of 8 bits or of floats");
    check_tolerance(tolerance);
    Image picture(a.width(), a.height(), PixelFormat::kRgba8);
    auto* out = picture.data<std::uint8_t>();
    for (std::size_t i = 0, n = 4 * pixels_of(a); i < n; i += 4, out += 4) {
        double worst = 0;
        for (std::size_t c = i; c < i + 4; ++c)
            worst = std::max(worst, floating ? channel_error(a.data<float>()[c], b.data<float>()[c])
                                             : channel_error(a.data<std::uint8_t>()[c], b.data<std::uint8_t>()[c]));
        const float* f = a.data<float>() + i;
        const std::uint8_t* p = a.data<std::uint8_t>() + i;
        if (floating)
            paint(worst > tolerance, code_of(worst), luma_of(code_of(f[0]), code_of(f[1]), code_of(f[2])), out);
        else
            paint(worst > tolerance, static_cast<int>(worst), luma_of(p[0], p[1], p[2]), out);
    }
    return picture;
}

}  // namespace tessera
