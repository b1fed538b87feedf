// Filtering of 15-bit texels: the definition in integers wide enough to be plain, the same bits on every
// instruction set, and no reading beyond the four texels of each lane.
#include "simd/texel_kernels.h"

#include "simd/guarded_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace tessera {
namespace {

using test::GuardedArray;

constexpr int kMostLanes = 16;

// The nearest integer to a + (b - a) w / 32768, halves upwards, by division.
std::int64_t mixed(std::int64_t a, std::int64_t b, std::int64_t w) {
    const std::int64_t twice = 2 * (b - a) * w + 32768;  // in 1/65536, the half added
    return a + (twice >= 0 ? twice / 65536 : -((-twice + 65535) / 65536));
}

// mix15 is what the vectors' rounding multiplication does (pmulhrsw), for every difference and the weights that matter.
TEST(Texels, MixIsTheRoundedWeightedMeanAndStaysBetween) {
    for (int a = 0; a <= 32767; a += 31)
        for (const int b : {0, 1, 2, 16383, 16384, 32766, 32767})
            for (const int w : {0, 1, 2, 3, 8191, 16383, 16384, 16385, 32766, 32767}) {
                const int got = mix15(static_cast<std::int16_t>(a), static_cast<std::int16_t>(b), w);
                ASSERT_EQ(got, mixed(a, b, w)) << a << " " << b << " " << w;
                ASSERT_GE(got, std::min(a, b));
                ASSERT_LE(got, std::max(a, b));
                ASSERT_LE(std::fabs(got - (a + (b - a) * (w / 32768.0))), 0.5);
            }
    EXPECT_EQ(mix15(123, 30000, 0), 123);
}

TEST(Texels, ChannelsAreExactAtBothEndsAndRise) {
    float last = -1;
    for (int c = 0; c <= 32767; ++c) {
        const auto channel = static_cast<std::int16_t>(c);
        float r, g, b, a;
        channels(Texel{{channel, 0, 32767, channel}}, r, g, b, a);
        ASSERT_NEAR(r, c / 32767.0, 0x1p-24);
        ASSERT_GT(r, last);
        ASSERT_EQ(g, 0);
        ASSERT_EQ(b, 1);
        ASSERT_EQ(a, r);
        last = r;
    }
}

class TexelsTest : public testing::TestWithParam<Isa> {
  protected:
    struct Lanes {
        std::int32_t first[kMostLanes], stride[kMostLanes], across[kMostLanes], down[kMostLanes], between[kMostLanes];
    };

    void SetUp() override {
        if (!isa_supported(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not supported here";
    }
    const TexelTable& table() const { return texel_table(GetParam()); }
    int lanes() const { return table().lanes; }
    std::int32_t below(std::size_t n) { return static_cast<std::int32_t>(random_() % n); }
    std::int32_t weight() {
        static constexpr std::int32_t kOdd[] = {0, 1, 16383, 16384, 16385, 32766, 32767};
        return random_() % 2 ? below(32768) : kOdd[random_() % 7];
    }
    void fill(GuardedArray<Texel>& texels) {
        static constexpr std::int16_t kOdd[] = {0, 1, 16384, 32766, 32767};
        for (std::size_t i = 0; i < texels.size(); ++i)
            for (std::int16_t& c : texels[i].c)
                c = random_() % 2 ? static_cast<std::int16_t>(below(32768)) : kOdd[random_() % 5];
    }
    // Anywhere in the array, its first and last texels often.
    Lanes make_lanes(std::size_t size) {
        Lanes l{};
        for (int i = 0; i < kMostLanes; ++i) {
            l.stride[i] = 2 + below(size - 3);
            const auto last = static_cast<std::int32_t>(size) - l.stride[i] - 2;
            l.first[i] = random_() % 4 == 0 ? last : random_() % 4 == 0 ? 0 : below(static_cast<std::size_t>(last) + 1);
            l.across[i] = weight();
            l.down[i] = weight();
            l.between[i] = weight();
        }
        return l;
    }
    static std::int64_t bilinear(const Texel* t, const Lanes& l, int i, int c) {
        const std::ptrdiff_t at = l.first[i], next = at + l.stride[i];
        return mixed(mixed(t[at].c[c], t[next].c[c], l.down[i]), mixed(t[at + 1].c[c], t[next + 1].c[c], l.down[i]),
                     l.across[i]);
    }
    std::mt19937 random_{11};
};

// The array ends where memory ends.
TEST_P(TexelsTest, FiltersByTheDefinitionToTheLastTexel) {
    for (const std::size_t size : {5u, 9u, 100u, 5000u}) {
        GuardedArray<Texel> lower(size), upper(size);
        for (int round = 0; round < 500; ++round) {
            fill(lower);
            fill(upper);
            const Lanes l = make_lanes(size);
            float planes[4 * kMostLanes], one[4 * kMostLanes];
            table().filter(lower.data(), upper.data(), l.first, l.stride, l.across, l.down, l.between, planes);
            table().load(lower.data(), l.first, l.stride, l.across, l.down, one);
            for (int i = 0; i < lanes(); ++i)
                for (int c = 0; c < 4; ++c) {
                    const std::int64_t a = bilinear(lower.data(), l, i, c), b = bilinear(upper.data(), l, i, c);
                    constexpr float kStep = 1.0f / 32767;
                    ASSERT_EQ(one[c * lanes() + i], static_cast<float>(a) * kStep) << "lane " << i;
                    ASSERT_EQ(planes[c * lanes() + i], static_cast<float>(mixed(a, b, l.between[i])) * kStep)
                        << "lane " << i;
                }
        }
        EXPECT_FALSE(lower.changed());
    }
}

TEST_P(TexelsTest, LooksUpEveryEntryInEveryLane) {
    GuardedArray<float> floats(16);
    GuardedArray<std::int32_t> integers(16);
    for (std::size_t i = 0; i < 16; ++i) {
        integers[i] = static_cast<std::int32_t>(random_());
        const std::int32_t bits = static_cast<std::int32_t>(random_());
        std::memcpy(&floats[i], &bits, sizeof bits);
    }
    for (int round = 0; round < 500; ++round) {
        std::int32_t index[kMostLanes], got[kMostLanes];
        float number[kMostLanes];
        for (std::int32_t& i : index) i = below(16);
        table().lookup_integers(integers.data(), index, got);
        table().lookup_floats(floats.data(), index, number);
        for (int i = 0; i < lanes(); ++i) {
            const auto at = static_cast<std::size_t>(index[i]);
            ASSERT_EQ(got[i], integers[at]);
            ASSERT_EQ(std::memcmp(&number[i], &floats[at], sizeof(float)), 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Simd, TexelsTest, testing::Values(Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512),
                         [](const auto& instance) { return std::string(name(instance.param)); });

}  // namespace
}  // namespace tessera
