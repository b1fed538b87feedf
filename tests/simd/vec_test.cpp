// The one-lane back end against the definition of each function: the standard library's exact ones
// where there is one, else C++ itself. operations_test.cpp carries this over to the vectors.
#include "simd/vec.h"

#include "simd/simd_inputs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

namespace tessera {
namespace {

static_assert(std::is_same_v<MaskOf<float>, bool> && std::is_same_v<MaskOf<double>, bool>);
static_assert(std::is_same_v<IntOf<float>, std::int32_t> && std::is_same_v<UintOf<float>, std::uint32_t>);
static_assert(std::is_same_v<IntOf<double>, std::int64_t> && std::is_same_v<UintOf<double>, std::uint64_t>);
static_assert(std::is_same_v<FloatOf<std::int32_t>, float> && std::is_same_v<FloatOf<std::uint64_t>, double>);
static_assert(kLanes<float> == 1 && kLanes<double> == 1 && kLanes<std::uint32_t> == 1);

template <class T>
class PlainTest : public testing::Test {
  protected:
    // Special floats (as doubles: the same values, and the same patterns in the upper half), random ones.
    static std::vector<T> values() {
        std::vector<T> all;
        for (const std::uint32_t bits : make_inputs(20000).a) {
            all.push_back(static_cast<T>(as_float(bits)));
            if constexpr (sizeof(T) == 8) all.push_back(as_float(std::uint64_t{bits} << 32 | (bits * 2654435761u)));
        }
        for (const T x : {T(0.5), T(1.5), T(2.5), T(0x1p22), T(0x1p23), T(0x1p51), T(0x1p52), T(0x1p53)})
            for (const T near : {std::nextafter(x, T(0)), x, std::nextafter(x, 2 * x)})
                all.insert(all.end(), {near, -near});
        return all;
    }
    static bool same(T a, T b) { return as_uint(a) == as_uint(b) || (a != a && b != b); }
};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(PlainTest, Types);

TYPED_TEST(PlainTest, RoundingSignsAndRoots) {
    for (const TypeParam x : this->values()) {
        ASSERT_TRUE(this->same(floor(x), std::floor(x))) << std::hexfloat << x;
        ASSERT_TRUE(this->same(ceil(x), std::ceil(x))) << std::hexfloat << x;
        ASSERT_TRUE(this->same(trunc(x), std::trunc(x))) << std::hexfloat << x;
        ASSERT_TRUE(this->same(round_even(x), std::nearbyint(x))) << std::hexfloat << x;
        ASSERT_TRUE(this->same(abs(x), std::fabs(x))) << std::hexfloat << x;
        ASSERT_TRUE(this->same(sqrt(x), std::sqrt(x))) << std::hexfloat << x;
        ASSERT_TRUE(this->same(copysign(x, TypeParam(-0.0)), -std::fabs(x))) << std::hexfloat << x;
    }
}

TYPED_TEST(PlainTest, ConversionToIntegersSaturates) {
    using Integer = IntOf<TypeParam>;
    using Limits = std::numeric_limits<Integer>;
    for (const TypeParam x : this->values()) {
        const auto wide = std::trunc(static_cast<long double>(x));
        const Integer want = std::isnan(x)             ? 0
                             : wide > Limits::max()    ? Limits::max()
                             : wide < Limits::lowest() ? Limits::lowest()
                                                       : static_cast<Integer>(wide);
        ASSERT_EQ(to_int(x), want) << std::hexfloat << x;
    }
    EXPECT_EQ(to_float(Limits::max()), std::ldexp(TypeParam(1), 8 * int(sizeof(TypeParam)) - 1));
    EXPECT_EQ(to_float(Limits::lowest()), -std::ldexp(TypeParam(1), 8 * int(sizeof(TypeParam)) - 1));
    EXPECT_EQ(to_float(std::numeric_limits<UintOf<TypeParam>>::max()),
              std::ldexp(TypeParam(1), 8 * int(sizeof(TypeParam))));
}

TEST(Plain, NearestAndTruncatedIntegersAreThoseOfTheDefinition) {
    for (const std::uint32_t bits : special_bits()) {
        const float x = as_float(bits);
        if (!(std::fabs(x) < 0x1p31f)) continue;
        EXPECT_EQ(nearest_int(x), static_cast<std::int32_t>(std::nearbyint(x))) << std::hexfloat << x;
        EXPECT_EQ(truncate_int(x), static_cast<std::int32_t>(x)) << std::hexfloat << x;
    }
    for (std::int32_t half = -2001; half < 2002; half += 2) {  // ties
        const float x = 0.5f * static_cast<float>(half);
        EXPECT_EQ(nearest_int(x) % 2, 0) << x;
        EXPECT_EQ(std::fabs(static_cast<float>(nearest_int(x)) - x), 0.5f) << x;
    }
}

TYPED_TEST(PlainTest, MinAndMaxGiveTheSecondOperandForNanAndZeros) {
    using T = TypeParam;
    const T nan = std::numeric_limits<T>::quiet_NaN(), zero = 0;
    EXPECT_EQ(min(nan, T(1)), T(1));
    EXPECT_EQ(max(nan, T(1)), T(1));
    EXPECT_TRUE(std::isnan(min(T(1), nan)));
    EXPECT_TRUE(std::isnan(max(T(1), nan)));
    EXPECT_TRUE(std::signbit(min(zero, -zero)) && !std::signbit(min(-zero, zero)));
    EXPECT_TRUE(std::signbit(max(zero, -zero)) && !std::signbit(max(-zero, zero)));
    EXPECT_EQ(min(T(2), T(3)), T(2));
    EXPECT_EQ(max(T(2), T(3)), T(3));
    EXPECT_EQ(clamp(T(5), T(0), T(1)), T(1));
    EXPECT_EQ(clamp(T(-5), T(0), T(1)), T(0));
    EXPECT_EQ(clamp(T(0.5), T(0), T(1)), T(0.5));
    EXPECT_EQ(clamp(nan, T(0), T(1)), T(0));
    EXPECT_EQ(min(std::int32_t{-1}, std::int32_t{1}), -1);
    EXPECT_EQ(max(std::uint32_t{0xffffffff}, std::uint32_t{1}), 0xffffffffu);
}

TEST(Plain, IntegersMasksAndBits) {
    EXPECT_EQ(abs(std::int32_t{-5}), 5);
    EXPECT_EQ(abs(INT32_MIN), INT32_MIN);
    EXPECT_EQ(shift_right_arithmetic(std::int32_t{-16}, 2), -4);
    EXPECT_EQ(shift_right_logical(std::int32_t{-16}, 28), 15);
    EXPECT_EQ(shift_right_arithmetic(0x80000000u, 31), 0xffffffffu);
    EXPECT_EQ(shift_left(std::int32_t{3}, 30), static_cast<std::int32_t>(0xc0000000));
    EXPECT_EQ(as_uint(1.0f), 0x3f800000u);
    EXPECT_EQ(as_float(0x40490fdbu), 3.14159274f);
    EXPECT_EQ(as_int(-0.0), INT64_MIN);
    EXPECT_TRUE(any(true) && all(true) && !none(true));
    EXPECT_TRUE(!any(false) && !all(false) && none(false));
    EXPECT_EQ(mask_bits(true), 1u);
    EXPECT_EQ(mask_bits(false), 0u);
    EXPECT_EQ(select(true, 1.0f, 2.0f), 1.0f);
    EXPECT_EQ(select(false, 1.0, 2.0), 2.0);
    EXPECT_EQ(select(true, false, true), false);
    EXPECT_TRUE(first_n<float>(1) && !first_n<float>(0));
}

TEST(Plain, Memory) {
    float values[3] = {1, 2, 3};
    EXPECT_EQ(load<float>(values + 1), 2.0f);
    EXPECT_EQ(load_aligned<float>(values + 2), 3.0f);
    EXPECT_EQ(load_n<float>(values, 0), 0.0f);
    EXPECT_EQ(load_n<float>(values, 1), 1.0f);
    EXPECT_EQ(gather(values, std::int32_t{2}), 3.0f);
    store_n(values, 7.0f, 0);
    EXPECT_EQ(values[0], 1.0f);
    store_n(values, 7.0f, 1);
    EXPECT_EQ(values[0], 7.0f);
    store_masked(values + 1, false, 9.0f);
    EXPECT_EQ(values[1], 2.0f);
    store_masked(values + 1, true, 9.0f);
    store_aligned(values + 2, 8.0f);
    EXPECT_EQ(values[1] + values[2], 17.0f);
    EXPECT_EQ(iota<float>(), 0.0f);
    EXPECT_EQ(lane(5u, 0), 5u);
}

}  // namespace
}  // namespace tessera
