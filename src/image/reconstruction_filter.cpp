#include "image/reconstruction_filter.h"

#include "simd/math.h"

namespace tessera {
namespace {

constexpr double kGaussianSigma = 0.5;

double gaussian(double x) { return math::exp(x * x * (-0.5 / (kGaussianSigma * kGaussianSigma))); }

// Mitchell and Netravali's family of cubics for 0 <= x < 2.
double mitchell(double x) {
    constexpr double b = 1.0 / 3, c = 1.0 / 3;
    if (x < 1) return (((12 - 9 * b - 6 * c) * x + (-18 + 12 * b + 6 * c)) * x * x + (6 - 2 * b)) / 6;
    return (((((-b - 6 * c) * x + (6 * b + 30 * c)) * x) + (-12 * b - 48 * c)) * x + (8 * b + 24 * c)) / 6;
}

}  // namespace

double filter_radius(PixelFilter filter) {
    switch (filter) {
        case PixelFilter::kBox:
            return 0.5;
        case PixelFilter::kTent:
            return 1;
        case PixelFilter::kGaussian:
            return 1.5;
        case PixelFilter::kMitchell:
            return 2;
    }
    return 0;
}

double filter_value(PixelFilter filter, double x) {
    const double distance = x < 0 ? -x : x, radius = filter_radius(filter);
    if (filter == PixelFilter::kBox) return distance <= radius ? 1 : 0;
    if (!(distance < radius)) return 0;
    switch (filter) {
        case PixelFilter::kTent:
            return 1 - distance;
        case PixelFilter::kGaussian:
            return gaussian(distance) - gaussian(radius);
        default:
            return mitchell(distance);
    }
}

FilterWeights::FilterWeights(PixelFilter filter, std::span<const SampleOffset> samples) : samples_(samples.size()) {
    // The farthest sample that counts is less than the radius away, half a pixel of it within the pixel.
    reach_ = 0;
    while (reach_ + 0.5 < filter_radius(filter)) ++reach_;
    std::vector<double> values;
    double sum = 0;
    for (const SampleOffset& s : samples)
        for (int dy = -reach_; dy <= reach_; ++dy)
            for (int dx = -reach_; dx <= reach_; ++dx) {
                const double x = dx + (s.x - 128) / 256.0, y = dy + (s.y - 128) / 256.0;
                values.push_back(filter_value(filter, x) * filter_value(filter, y));
                sum += values.back();
            }
    weights_.reserve(values.size());
    for (const double v : values) weights_.push_back(static_cast<float>(v / sum));
}

double FilterWeights::sum_within(int left, int right, int up, int down) const {
    double sum = 0;
    for (std::size_t sample = 0; sample < samples_; ++sample)
        for (int dy = -up; dy <= down; ++dy)
            for (int dx = -left; dx <= right; ++dx) sum += static_cast<double>(weight(sample, dx, dy));
    return sum;
}

}  // namespace tessera
