#include "image/color_kernels.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace tessera {
namespace {

constexpr int kCount = 1 << 16;

// Random bits, so every kind of float, and values of the range that pictures have.
std::vector<float> inputs() {
    std::mt19937 random(9);
    std::vector<float> v(3 * kCount);
    for (std::size_t i = 0; i < v.size(); ++i)
        v[i] = i % 2 == 0 ? std::bit_cast<float>(static_cast<std::uint32_t>(random()))
                          : static_cast<float>(random() % 1000000) * 2e-6f;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const float special[] = {0.0f,
                             -0.0f,
                             kInfinity,
                             -kInfinity,
                             std::numeric_limits<float>::quiet_NaN(),
                             1e-42f,
                             std::numeric_limits<float>::max(),
                             1.0f,
                             0.76f,
                             0.08f};
    std::copy(std::begin(special), std::end(special), v.begin());
    return v;
}

std::vector<std::uint32_t> bits_of(const std::vector<float>& v) {
    std::vector<std::uint32_t> bits;
    for (const float f : v) bits.push_back(std::isnan(f) ? 0x7fc00000u : std::bit_cast<std::uint32_t>(f));
    return bits;
}

TEST(ColorKernels, EveryInstructionSetGivesTheBitsOfOneLane) {
    const std::vector<float> in = inputs();
    const ColorKernels& one = color_kernels(Isa::kScalar);
    std::vector<std::int32_t> expected_codes(in.size());
    one.encode(in.data(), expected_codes.data(), kCount);
    for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
        if (!isa_supported(isa)) continue;
        const ColorKernels& kernels = color_kernels(isa);
        std::vector<std::int32_t> codes(in.size());
        kernels.encode(in.data(), codes.data(), kCount);
        EXPECT_EQ(codes, expected_codes) << name(isa);
        for (const auto map : {&ColorKernels::none, &ColorKernels::neutral, &ColorKernels::aces}) {
            std::vector<float> expected = in, got = in;
            (one.*map)(expected.data(), kCount);
            (kernels.*map)(got.data(), kCount);
            EXPECT_EQ(bits_of(got), bits_of(expected)) << name(isa);
        }
        std::vector<float> expected(kCount), got(kCount);
        one.luminance(in.data(), expected.data(), kCount);
        kernels.luminance(in.data(), got.data(), kCount);
        EXPECT_EQ(bits_of(got), bits_of(expected)) << name(isa);
    }
}

}  // namespace
}  // namespace tessera
