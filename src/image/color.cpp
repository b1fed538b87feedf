#include "image/color.h"

#include "image/srgb.h"

#include <bit>
#include <stdexcept>

namespace tessera {
namespace {

// a^(1/5) for a in (0, 1] by Newton's method from above: the error shrinks by at least a fifth in each
// step until it is small, then is squared. 24 steps are enough from 1 down to 10^-3.
constexpr double fifth_root(double a) {
    double y = 1;
    for (int step = 0; step < 24; ++step) {
        const double y4 = (y * y) * (y * y);
        y = y - (y4 * y - a) / (5 * y4);
    }
    return y;
}

constexpr double decode(double encoded) {
    if (encoded <= 0.04045) return encoded / 12.92;
    const double s = (encoded + 0.055) / 1.055;
    return (s * s) * fifth_root(s * s);  // s^2.4
}

// Bits of the smallest float whose encoding is nearest to `code` (1 .. 255).
constexpr std::int32_t threshold_bits(int code) {
    const double threshold = decode((code - 0.5) / 255);
    const float nearest = static_cast<float>(threshold);
    const auto bits = std::bit_cast<std::int32_t>(nearest);
    return static_cast<double>(nearest) < threshold ? bits + 1 : bits;
}

constexpr SrgbTables make_tables() {
    SrgbTables tables{};
    for (int code = 0; code < 256; ++code) tables.linear[code] = static_cast<float>(decode(code / 255.0));

    int code = 0;  // of the first number of the bucket
    std::int32_t next = threshold_bits(1);
    for (int i = 0; i < kSrgb8Buckets; ++i) {
        const std::int32_t first = (kSrgb8FirstBucket + i) * 0x10000, end = first + 0x10000;
        tables.bucket[i] = code * 0x10000;
        if (next >= end) continue;
        tables.bucket[i] += end - next;
        // Beyond the last code there is no threshold; 0x3f800000 are the bits of 1.
        next = ++code < 255 ? threshold_bits(code + 1) : 0x3f800000;
        if (next < end) throw std::logic_error("two thresholds in a bucket");
    }
    return tables;
}

}  // namespace

constinit const SrgbTables kSrgbTables = make_tables();

double linear_from_srgb(double encoded) { return decode(encoded); }

}  // namespace tessera
