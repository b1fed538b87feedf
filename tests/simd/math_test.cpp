// The elementary functions against their definitions: maximum errors over dense samples (for float the
// oracle is the C library in double, for double in long double), special values, and order. With
// TESSERA_EXHAUSTIVE=n in the environment the float functions of one argument are tested on every n-th of
// the 2^32 values (1: all of them, about an hour). Bits on vectors are the subject of operations_test.cpp.
#include "simd/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace tessera {
namespace {

template <class T>
using Wide = std::conditional_t<std::is_same_v<T, float>, double, long double>;

// |got - want| in units in the last place of `want`; infinities and NaN must agree, where an infinity
// may stand for a number that rounds to it.
template <class T>
double error_in_ulp(T got, Wide<T> want) {
    using W = Wide<T>;
    constexpr double kWrong = 1e30;
    if (std::isnan(want)) return std::isnan(got) ? 0 : kWrong;
    if (std::isinf(got) || std::isinf(static_cast<T>(want))) return got == static_cast<T>(want) ? 0 : kWrong;
    constexpr int kLowest = std::numeric_limits<T>::min_exponent - std::numeric_limits<T>::digits;
    int exponent = kLowest;
    if (want != 0) std::frexp(want, &exponent);
    const int unit = std::max(exponent - std::numeric_limits<T>::digits, kLowest);
    return static_cast<double>(std::fabs(static_cast<W>(got) - want) / std::ldexp(W{1}, unit));
}

template <class T>
class MathTest : public testing::Test {
  protected:
    using Sampler = std::function<T()>;

    Sampler uniform(double low, double high) {
        return [=, this] { return static_cast<T>(std::uniform_real_distribution<double>(low, high)(random_)); };
    }
    Sampler any_finite() {
        return [this] {
            for (;;)
                if (const T x = as_float(static_cast<UintOf<T>>(random_())); std::isfinite(x)) return x;
        };
    }
    Sampler any_positive() {
        return [finite = any_finite()] { return std::fabs(finite()); };
    }

    // `bound` is in units in the last place, and the figure that the headers state.
    void expect_error(const char* name, double bound, const std::vector<Sampler>& samplers, T (*function)(T),
                      Wide<T> (*oracle)(Wide<T>)) {
        double worst = 0;
        T at = 0;
        const auto check = [&](T x) {
            const double error = error_in_ulp(function(x), oracle(x));
            if (!(error <= worst)) worst = error, at = x;
        };
        for (const Sampler& sampler : samplers)
            for (int i = 0; i < 100'000; ++i) check(sampler());
        const char* exhaustive = std::getenv("TESSERA_EXHAUSTIVE");
        if (const auto step = exhaustive != nullptr ? std::strtoull(exhaustive, nullptr, 10) : 0; kFloat && step > 0)
            for (std::uint64_t bits = 0; bits >> 32 == 0; bits += step)
                if (const T x = as_float(static_cast<UintOf<T>>(bits)); std::isfinite(x)) check(x);
        EXPECT_LE(worst, bound) << name << " at " << std::hexfloat << at;
        this->RecordProperty(std::string(name) + "_ulp", std::to_string(worst));
    }
    void expect_error(const char* name, double bound, const Sampler& xs, const Sampler& ys, T (*function)(T, T),
                      Wide<T> (*oracle)(Wide<T>, Wide<T>)) {
        double worst = 0;
        T at_x = 0, at_y = 0;
        for (int i = 0; i < 200'000; ++i) {
            const T x = xs(), y = ys();
            const double error = error_in_ulp(function(x, y), oracle(x, y));
            if (!(error <= worst)) worst = error, at_x = x, at_y = y;
        }
        EXPECT_LE(worst, bound) << name << " at " << std::hexfloat << at_x << ", " << at_y;
        this->RecordProperty(std::string(name) + "_ulp", std::to_string(worst));
    }

    static constexpr bool kFloat = std::is_same_v<T, float>;
    static constexpr T kInf = std::numeric_limits<T>::infinity();
    static constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
    static constexpr T kMax = std::numeric_limits<T>::max();
    static constexpr T kDenormal = std::numeric_limits<T>::denorm_min();
    static constexpr T kMin = std::numeric_limits<T>::min();
    std::mt19937_64 random_{20240611};
};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(MathTest, Types);

// NOLINTBEGIN(bugprone-macro-parentheses): a name cannot be parenthesised
#define TESSERA_UNARY(name) \
#name, [](TypeParam x) { return math::name(x); }, [](Wide <TypeParam> x) { return std::name(x); }
// NOLINTEND(bugprone-macro-parentheses)

// Equal bits, or both NaN: 0 and -0 differ.
template <class T>
testing::AssertionResult same(T a, T b) {
    if (as_uint(a) == as_uint(b) || (a != a && b != b)) return testing::AssertionSuccess();
    return testing::AssertionFailure() << std::hexfloat << a << " is not " << b;
}

TYPED_TEST(MathTest, ExponentialsStayWithinTheirErrors) {
    const double range = this->kFloat ? 155 : 1085;
    const auto unary = [this](double bound, auto samplers, const char* name, auto f, auto g) {
        this->expect_error(name, bound, samplers, f, g);
    };
    using S = std::vector<typename MathTest<TypeParam>::Sampler>;
    unary(1.1, S{this->uniform(-range, range), this->uniform(-2, 2), this->any_finite()}, TESSERA_UNARY(exp2));
    unary(1.0, S{this->uniform(-range * .7, range * .7), this->uniform(-2, 2), this->any_finite()}, TESSERA_UNARY(exp));
    unary(0.9, S{this->any_positive(), this->uniform(0.5, 2), this->uniform(0.99, 1.01)}, TESSERA_UNARY(log2));
    unary(0.9, S{this->any_positive(), this->uniform(0.5, 2), this->uniform(0.99, 1.01)}, TESSERA_UNARY(log));
    unary(0.55, S{this->any_finite(), this->uniform(-8, 8)}, TESSERA_UNARY(cbrt));
    this->expect_error(
        "rsqrt", 1.5, S{this->any_positive(), this->uniform(0.5, 2)}, [](TypeParam x) { return math::rsqrt(x); },
        [](Wide<TypeParam> x) { return 1 / std::sqrt(x); });
}

TYPED_TEST(MathTest, PowerStaysWithinItsError) {
    using T = TypeParam;
    using W = Wide<T>;
    T (*pow)(T, T) = [](T x, T y) { return math::pow(x, y); };
    W (*oracle)(W, W) = [](W x, W y) { return std::pow(x, y); };
    const auto check = [&](auto xs, auto ys) { this->expect_error("pow", 1.25, xs, ys, pow, oracle); };
    check(this->uniform(0, 2), this->uniform(-20, 20));
    check(this->uniform(0, 1), this->uniform(0, 3));
    check(this->uniform(0.9, 1.1), this->uniform(-1000, 1000));
    check(this->uniform(0.9999, 1.0001), this->uniform(-1e6, 1e6));
    check(this->any_positive(), this->uniform(-2, 2));
    check(this->any_positive(), this->uniform(-30, 30));
    check(this->any_finite(), this->any_finite());
    check(this->any_finite(), [i = 0]() mutable { return static_cast<T>(++i % 41 - 20); });
}

TYPED_TEST(MathTest, TrigonometryStaysWithinItsErrors) {
    using S = std::vector<typename MathTest<TypeParam>::Sampler>;
    const double fast = this->kFloat ? 102943 : 1647099;
    const auto unary = [this](double bound, auto samplers, const char* name, auto f, auto g) {
        this->expect_error(name, bound, samplers, f, g);
    };
    const S angles{this->uniform(-1, 1),       this->uniform(-10, 10),   this->uniform(-1000, 1000),
                   this->uniform(-fast, fast), this->uniform(-1e9, 1e9), this->any_finite()};
    unary(0.85, angles, TESSERA_UNARY(sin));
    unary(0.85, angles, TESSERA_UNARY(cos));
    unary(1.1, angles, TESSERA_UNARY(tan));
    unary(1.65, S{this->uniform(-1, 1), this->any_finite()}, TESSERA_UNARY(asin));
    unary(1.15, S{this->uniform(-1, 1), this->any_finite()}, TESSERA_UNARY(acos));
    unary(1.9, S{this->uniform(-1, 1), this->uniform(-10, 10), this->any_finite()}, TESSERA_UNARY(atan));
}

// The numbers nearest to multiples of pi/2, where the reduction cancels most; past 2^16 quarter turns float
// reduces the slow way.
TYPED_TEST(MathTest, ReductionHoldsNearMultiplesOfAQuarterTurn) {
    using T = TypeParam;
    using W = Wide<T>;
    for (int k = 1; k < 200'000; ++k) {
        const W exact = static_cast<W>(1.570796326794896619231321691639751442L) * static_cast<W>(k);
        const T x = static_cast<T>(exact);
        ASSERT_LE(error_in_ulp(math::sin(x), std::sin(static_cast<W>(x))), 0.85) << k;
        ASSERT_LE(error_in_ulp(math::cos(x), std::cos(static_cast<W>(x))), 0.85) << k;
        ASSERT_LE(error_in_ulp(math::tan(-x), std::tan(static_cast<W>(-x))), 1.1) << k;
    }
}

TYPED_TEST(MathTest, ArcTangentOfTwoStaysWithinItsError) {
    using T = TypeParam;
    using W = Wide<T>;
    T (*atan2)(T, T) = [](T y, T x) { return math::atan2(y, x); };
    W (*oracle)(W, W) = [](W y, W x) { return std::atan2(y, x); };
    this->expect_error("atan2", 1.9, this->uniform(-1, 1), this->uniform(-1, 1), atan2, oracle);
    this->expect_error("atan2", 1.9, this->any_finite(), this->any_finite(), atan2, oracle);
    this->expect_error("atan2", 1.9, this->uniform(-1e-3, 1e-3), this->uniform(-1, 1), atan2, oracle);
}

TYPED_TEST(MathTest, PowersOfTwoAreExact) {
    using T = TypeParam;
    const int lowest = this->kFloat ? -149 : -1074, highest = this->kFloat ? 127 : 1023;
    for (int n = lowest; n <= highest; ++n) {
        const T power = std::ldexp(T{1}, n);
        EXPECT_TRUE(same(math::exp2(static_cast<T>(n)), power)) << n;
        EXPECT_TRUE(same(math::log2(power), static_cast<T>(n))) << n;
        EXPECT_TRUE(same(math::pow(T{2}, static_cast<T>(n)), power)) << n;
    }
}

TYPED_TEST(MathTest, ExponentialsOfSpecialValues) {
    using T = TypeParam;
    const T inf = this->kInf, nan = this->kNan, denormal = this->kDenormal;
    for (T (*exponential)(T) : {+[](T x) { return math::exp2(x); }, +[](T x) { return math::exp(x); }}) {
        EXPECT_TRUE(same(exponential(T{0}), T{1}));
        EXPECT_TRUE(same(exponential(-T{0}), T{1}));
        EXPECT_TRUE(same(exponential(denormal), T{1}));
        EXPECT_TRUE(same(exponential(inf), inf));
        EXPECT_TRUE(same(exponential(-inf), T{0}));
        EXPECT_TRUE(same(exponential(this->kMax), inf));
        EXPECT_TRUE(same(exponential(-this->kMax), T{0}));
        EXPECT_TRUE(same(exponential(nan), nan));
    }
    for (T (*logarithm)(T) : {+[](T x) { return math::log2(x); }, +[](T x) { return math::log(x); }}) {
        EXPECT_TRUE(same(logarithm(T{1}), T{0}));
        EXPECT_TRUE(same(logarithm(T{0}), -inf));
        EXPECT_TRUE(same(logarithm(-T{0}), -inf));
        EXPECT_TRUE(same(logarithm(T{-1}), nan));
        EXPECT_TRUE(same(logarithm(-inf), nan));
        EXPECT_TRUE(same(logarithm(-denormal), nan));
        EXPECT_TRUE(same(logarithm(inf), inf));
        EXPECT_TRUE(same(logarithm(nan), nan));
    }
    for (const T x : {T{0}, -T{0}, inf, -inf, nan}) EXPECT_TRUE(same(math::cbrt(x), x));
    EXPECT_TRUE(same(math::cbrt(T{-27}), T{-3}));
    EXPECT_TRUE(same(math::rsqrt(T{0}), inf));
    EXPECT_TRUE(same(math::rsqrt(-T{0}), -inf));
    EXPECT_TRUE(same(math::rsqrt(inf), T{0}));
    EXPECT_TRUE(same(math::rsqrt(T{-1}), nan));
}

// Every pair of these gives what the C library gives, which follows IEEE 754 (9.2.1).
TYPED_TEST(MathTest, PowersOfSpecialValues) {
    using T = TypeParam;
    const T values[] = {0,          T(0.5),     1,         T(1.5),      2,         3,          4,
                        5,          1e6,        16777215,  T(16777217), T(0x1p53), this->kMin, this->kDenormal,
                        this->kMax, this->kInf, this->kNan};
    for (const T ax : values)
        for (const T ay : values)
            for (const T x : {ax, -ax})
                for (const T y : {ay, -ay}) {
                    const T want = std::pow(x, y);
                    if (want == 0 || want == 1 || !std::isfinite(want))
                        EXPECT_TRUE(same(math::pow(x, y), want)) << x << "^" << y;
                    else
                        EXPECT_LE(error_in_ulp(math::pow(x, y), static_cast<Wide<T>>(std::pow(
                                                                    static_cast<Wide<T>>(x), static_cast<Wide<T>>(y)))),
                                  1.25)
                            << x << "^" << y;
                }
}

TYPED_TEST(MathTest, TrigonometryOfSpecialValues) {
    using T = TypeParam;
    const T inf = this->kInf, nan = this->kNan;
    for (const T x : {T{0}, -T{0}, this->kDenormal, -this->kDenormal, this->kMin}) {
        EXPECT_TRUE(same(math::sin(x), x));
        EXPECT_TRUE(same(math::tan(x), x));
        EXPECT_TRUE(same(math::asin(x), x));
        EXPECT_TRUE(same(math::atan(x), x));
        EXPECT_TRUE(same(math::cos(x), T{1}));
    }
    for (const T x : {inf, -inf, nan}) {
        EXPECT_TRUE(same(math::sin(x), nan));
        EXPECT_TRUE(same(math::cos(x), nan));
        EXPECT_TRUE(same(math::tan(x), nan));
        EXPECT_TRUE(same(math::asin(x), nan));
        EXPECT_TRUE(same(math::acos(x), nan));
    }
    EXPECT_TRUE(same(math::acos(T{1}), T{0}));
    EXPECT_TRUE(same(math::acos(T{-1}), math::kPi<T>));
    EXPECT_TRUE(same(math::asin(T{1}), math::kPi<T> / 2));
    EXPECT_TRUE(same(math::asin(T{-1}), -math::kPi<T> / 2));
    EXPECT_TRUE(same(math::asin(std::nextafter(T{1}, T{2})), nan));
    EXPECT_TRUE(same(math::acos(T{-2}), nan));
    EXPECT_TRUE(same(math::atan(inf), math::kPi<T> / 2));
    EXPECT_TRUE(same(math::atan(-inf), -math::kPi<T> / 2));
    EXPECT_TRUE(same(math::atan(nan), nan));
    EXPECT_TRUE(same(math::radians(T{180}), math::kPi<T>));
    EXPECT_TRUE(same(math::degrees(math::kPi<T>), T{180}));

    const T values[] = {0, this->kDenormal, this->kMin, 1, this->kMax, inf, nan};
    for (const T ay : values)
        for (const T ax : values)
            for (const T y : {ay, -ay})
                for (const T x : {ax, -ax}) {
                    const auto want = std::atan2(static_cast<Wide<T>>(y), static_cast<Wide<T>>(x));
                    const T got = math::atan2(y, x);
                    EXPECT_LE(error_in_ulp(got, want), 1.0) << y << ", " << x;
                    EXPECT_TRUE(std::isnan(want) || std::signbit(got) == std::signbit(want)) << y << ", " << x;
                }
}

// From one number to the next a rising function never falls by more than one unit in the last place, at
// the seams of its pieces either.
TYPED_TEST(MathTest, RisingFunctionsFallByOneUnitAtMost) {
    using T = TypeParam;
    struct Rising {
        const char* name;
        T (*function)(T);
        std::vector<T> seams;
    };
    const T half_ln2 = T(0.34657359027997264), root = T(0.70710678118654752);
    const Rising functions[] = {
        {"exp2", [](T x) { return math::exp2(x); }, {T(-126), T(-1), T(-0.5), T(0.5), T(1.5), T(100.5)}},
        {"exp", [](T x) { return math::exp(x); }, {-half_ln2, half_ln2, 3 * half_ln2, 21 * half_ln2}},
        {"log2", [](T x) { return math::log2(x); }, {root, 1, 2 * root, 2, 4 * root, this->kMin}},
        {"log", [](T x) { return math::log(x); }, {root, 1, 2 * root, 2, 4 * root, this->kMin}},
        {"cbrt", [](T x) { return math::cbrt(x); }, {1, 8, T(0x1p100), this->kMin}},
        {"atan", [](T x) { return math::atan(x); }, {T(0.41421356237309503), 1, T(2.414213562373095), 100}},
        {"asin", [](T x) { return math::asin(x); }, {T(-0.5), T(0.5), T(0.9)}},
        {"-acos", [](T x) { return -math::acos(x); }, {T(-0.5), T(0), T(0.5), T(0.9)}},
    };
    for (const Rising& f : functions)
        for (const T seam : f.seams) {
            T x = seam;
            for (int i = 0; i < 2000; ++i) x = std::nextafter(x, -this->kInf);
            T previous = f.function(x);
            for (int i = 0; i < 4000; ++i) {
                x = std::nextafter(x, this->kInf);
                const T value = f.function(x);
                ASSERT_GE(value, std::nextafter(previous, -this->kInf))
                    << f.name << " near " << seam << " at " << std::hexfloat << x;
                previous = value;
            }
        }
}

}  // namespace
}  // namespace tessera
