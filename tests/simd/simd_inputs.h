// Operands for the operations of the number layer: every pair of special values, then random ones of
// several kinds. The same on every machine and run.
#pragma once

#include <cstdint>
#include <vector>

namespace tessera {

struct Inputs {
    std::vector<std::uint32_t> a, b, c;
};

// Bits that matter to some operation, as float or as integer.
inline const std::vector<std::uint32_t>& special_bits() {
    static const std::vector<std::uint32_t> kPositive = {
        0x00000000,                                      // 0
        0x00000001, 0x00000002, 0x00400000, 0x007fffff,  // denormals; small integers
        0x00800000, 0x00800001, 0x00ffffff,              // smallest normal
        0x33800000, 0x34000000, 0x38d1b717, 0x39800000,  // 2^-24, 2^-23, 1e-4, 2^-12
        0x3e800000, 0x3eaaaaab, 0x3effffff, 0x3f000000,  // 1/4, 1/3, below 1/2, 1/2
        0x3f000001, 0x3f3504f3, 0x3f490fdb, 0x3f7fffff,  // above 1/2, sqrt(1/2), pi/4, below 1
        0x3f800000, 0x3f800001, 0x3fb504f3, 0x3fc00000,  // 1, above, sqrt(2), 3/2
        0x3fc90fdb, 0x40000000, 0x40200000, 0x40490fdb,  // pi/2, 2, 5/2, pi
        0x40c90fdb, 0x42b17218, 0x42cff1b5, 0x43000000,  // 2 pi, 88.72, 103.97, 128
        0x4315f000, 0x477fff00, 0x47c90fdb, 0x4a800000,  // 149.9, 65535, 2^16 pi/2, 2^22
        0x4affffff, 0x4b000000, 0x4b7fffff, 0x4b800000,  // around 2^23, 2^24
        0x4effffff, 0x4f000000, 0x4f000001, 0x4f7fffff,  // around 2^31, 2^32
        0x5f000000, 0x7e967699, 0x7f7fffff,              // 2^63, 1e38, largest
        0x7f800000, 0x7f800001, 0x7fc00000, 0x7fffffff,  // infinity, NaNs, largest int
    };
    static const std::vector<std::uint32_t> kBoth = [] {
        std::vector<std::uint32_t> all = kPositive;
        for (const std::uint32_t bits : kPositive) all.push_back(bits | 0x80000000);
        return all;
    }();
    return kBoth;
}

// All pairs of special values (and some third), then `random` triples: any bits, floats around 1,
// angles, and small integers in turn.
inline Inputs make_inputs(int random) {
    Inputs in;
    std::uint64_t state = 0x9e3779b97f4a7c15;
    const auto next = [&state] {  // splitmix64
        std::uint64_t z = state += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return static_cast<std::uint32_t>((z ^ (z >> 31)) >> 32);
    };
    const std::vector<std::uint32_t>& special = special_bits();
    for (const std::uint32_t a : special)
        for (const std::uint32_t b : special) {
            in.a.push_back(a);
            in.b.push_back(b);
            in.c.push_back(special[next() % special.size()]);
        }
    const auto operand = [&](int kind) -> std::uint32_t {
        const std::uint32_t bits = next();
        const std::uint32_t sign = bits & 0x80000000, mantissa = bits & 0x7fffff;
        switch (kind) {
            case 0:
                return bits;
            case 1:
                return sign | (0x3e000000 + ((bits >> 24) & 3) * 0x800000) | mantissa;
            case 2:
                return sign | (0x3c000000 + ((bits >> 24) & 31) * 0x800000) | mantissa;
            default:
                return static_cast<std::uint32_t>(static_cast<std::int32_t>(bits) >> 20);
        }
    };
    for (int i = 0; i < random; ++i) {
        in.a.push_back(operand(i % 4));
        in.b.push_back(operand(i % 4));
        in.c.push_back(operand(i % 4));
    }
    return in;
}

}  // namespace tessera
