// M. H. Payne and R. N. Hanek, "Radian reduction for trigonometric functions", 1983: of the product
// x * 2/pi only the bits around the binary point are needed. x is an integer M of 53 bits times 2^e, so
// the 192 bits of 2/pi from position e - 2 on suffice: those before give multiples of four quadrants.
#include "simd/math_reduce.h"

#include "simd/math_core.h"

namespace tessera::math {
namespace {

__extension__ using Uint128 = unsigned __int128;

// 2/pi = 0.[0][1][2]... in base 2^64.
constexpr std::uint64_t kTwoOverPi[20] = {
    0xa2f9836e4e441529, 0xfc2757d1f534ddc0, 0xdb6295993c439041, 0xfe5163abdebbc561, 0xb7246e3a424dd2e0,
    0x06492eea09d1921c, 0xfe1deb1cb129a73e, 0xe88235f52ebb4484, 0xe99c7026b45f7e41, 0x3991d639835339f4,
    0x9c845f8bbdf9283b, 0x1ff897ffde05980f, 0xef2f118b5a0a6d1f, 0x6d367ecf27cb09b7, 0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b, 0x3d0739f78a5292ea, 0x6bfb5fb11f8d5d08, 0x56033046fc7b6bab, 0xf0cfbc209af4361d};

// 64 bits of 2/pi whose first has the weight 2^-(position + 1); position may be negative.
std::uint64_t bits_of_two_over_pi(int position) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 2; ++i) {  // the word that holds the first bit, and the next one
        const int word = (position + 64) / 64 - 1 + i;
        const int shift = 64 * word - position;  // -63 .. 64
        if (word < 0 || word >= 20 || shift == 64) continue;
        bits |= shift <= 0 ? kTwoOverPi[word] << -shift : kTwoOverPi[word] >> shift;
    }
    return bits;
}

}  // namespace

ReducedAngle reduce_angle(double x) {
    if (!(abs(x) < kInfinity<double>)) return {x - x, 0, 0};
    const std::uint64_t bits = as_uint(x);
    const int exponent = static_cast<int>((bits >> 52) & 0x7ff) - 1075;
    const std::uint64_t mantissa = (bits & 0xfffffffffffff) | 0x10000000000000;

    // mantissa * 2/pi * 2^exponent modulo 4, as a fixed-point number of 128 bits with 2 before the point.
    const int position = exponent - 2;
    const std::uint64_t w0 = bits_of_two_over_pi(position), w1 = bits_of_two_over_pi(position + 64);
    const std::uint64_t w2 = bits_of_two_over_pi(position + 128);
    const Uint128 product = (Uint128{mantissa * w0} << 64) + Uint128{mantissa} * w1 + ((Uint128{mantissa} * w2) >> 64);
    const auto top = static_cast<unsigned>(product >> 126);

    // The fraction of a quarter turn, made signed: past one half the next quadrant is nearer.
    Uint128 fraction = product << 2;
    const bool negative = (fraction >> 127) != 0;
    if (negative) fraction = -fraction;
    // Two exact pieces of 53 bits each.
    int exponent_down = 0;
    for (; exponent_down < 120 && (fraction >> 127) == 0; ++exponent_down) fraction <<= 1;
    const double unit = power_of_two<double>(static_cast<std::uint64_t>(-53 - exponent_down));
    const double high = static_cast<double>(static_cast<std::uint64_t>(fraction >> 75)) * unit;
    const double low = static_cast<double>(static_cast<std::uint64_t>((fraction << 53) >> 75)) * unit * 0x1p-53;

    DoubleWord<double> angle = two_product(high, 0x1.921fb54442d18p0);
    angle.low += high * 0x1.1a62633145c07p-54 + low * 0x1.921fb54442d18p0;
    angle = fast_two_sum(angle.high, angle.low);
    const bool flip = negative != (x < 0);
    unsigned quadrant = (top + (negative ? 1u : 0u)) & 3u;
    if (x < 0) quadrant = (4u - quadrant) & 3u;
    return {flip ? -angle.high : angle.high, flip ? -angle.low : angle.low, quadrant};
}

}  // namespace tessera::math
