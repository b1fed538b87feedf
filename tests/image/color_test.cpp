#include "image/color.h"
#include "image/srgb.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

// The definition (IEC 61966-2-1), with 64 bits of mantissa.
long double decode(long double v) { return v <= 0.04045L ? v / 12.92L : std::pow((v + 0.055L) / 1.055L, 2.4L); }

TEST(Srgb, Fb1DecodesEveryCodeCorrectlyRounded) {
    for (int code = 0; code < 256; ++code) {
        const long double exact = decode(static_cast<long double>(code) / 255);
        const float stored = kSrgbTables.linear[code];
        EXPECT_EQ(stored, static_cast<float>(exact)) << code;
        EXPECT_NEAR(static_cast<double>(linear_from_srgb(code / 255.0) / static_cast<double>(exact == 0 ? 1 : exact)),
                    code == 0 ? 0 : 1, 1e-15);
    }
    EXPECT_EQ(kSrgbTables.linear[0], 0);
    EXPECT_EQ(kSrgbTables.linear[255], 1);
}

TEST(Srgb, Fb1EncodesEveryCodeToItself) {
    for (int code = 0; code < 256; ++code) EXPECT_EQ(srgb8_from_linear(kSrgbTables.linear[code]), code);
}

// Between two neighbouring thresholds the code is constant, so checking all floats reduces to checking
// the last float below and the first one above every threshold, and monotony in between.
TEST(Srgb, Fb1EncodesExactlyAtEveryThreshold) {
    for (int code = 1; code < 256; ++code) {
        const long double threshold = decode((code - 0.5L) / 255);
        float above = static_cast<float>(threshold);
        if (above < threshold) above = std::nextafter(above, 2.0f);
        const float below = std::nextafter(above, 0.0f);
        ASSERT_GE(above, threshold);
        ASSERT_LT(below, threshold);
        EXPECT_EQ(srgb8_from_linear(above), code);
        EXPECT_EQ(srgb8_from_linear(below), code - 1);
    }
}

TEST(Srgb, Fb1EncodingIsMonotonous) {
    int last = 0;
    for (std::uint32_t bits = 0; bits <= 0x3f800000u + 1000; bits += 61) {
        const int code = srgb8_from_linear(std::bit_cast<float>(bits));
        ASSERT_TRUE(code == last || code == last + 1) << bits;
        last = code;
    }
    EXPECT_EQ(last, 255);
}

TEST(Srgb, ClampsWhatIsOutOfRange) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const float x : {-0.0f, -1e-40f, -1.0f, -1e30f, -kInfinity, std::numeric_limits<float>::quiet_NaN(),
                          -std::numeric_limits<float>::quiet_NaN(), 1e-40f})
        EXPECT_EQ(srgb8_from_linear(x), 0) << x;
    for (const float x : {1.0f, 1.5f, 1e30f, kInfinity}) EXPECT_EQ(srgb8_from_linear(x), 255) << x;
}

TEST(Srgb, LuminanceOfWhiteIsOne) {
    EXPECT_FLOAT_EQ(luminance(1.0f, 1.0f, 1.0f), 1);
    EXPECT_GT(luminance(0.0f, 1.0f, 0.0f), luminance(1.0f, 0.0f, 0.0f));
}

}  // namespace
}  // namespace tessera
