// Reconstruction filters against their definitions in other words, and the weights over sample patterns.
#include "image/reconstruction_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr PixelFilter kFilters[] = {PixelFilter::kBox, PixelFilter::kTent, PixelFilter::kGaussian,
                                    PixelFilter::kMitchell};

std::vector<SampleOffset> pattern(int count) {
    std::vector<SampleOffset> samples;
    for (int i = 0; i < count; ++i) samples.push_back(sample_offset(i, count));
    return samples;
}

TEST(ReconstructionFilter, RAS7_MitchellHasItsKnownValues) {
    const auto k = [](double x) { return filter_value(PixelFilter::kMitchell, x); };
    EXPECT_NEAR(k(0), 8.0 / 9, 1e-15);
    EXPECT_NEAR(k(1), 1.0 / 18, 1e-15);
    EXPECT_NEAR(k(8.0 / 7), 0, 1e-15);
    EXPECT_LT(k(1.5), 0);
    EXPECT_NEAR(k(2 - 1e-9), 0, 1e-15);
    EXPECT_EQ(k(2), 0);
    // The family is affine in B and C: one third of the cubic B-spline and two thirds of Catmull and Rom's.
    for (double x = 0; x < 2; x += 1.0 / 64) {
        const double spline = x < 1 ? 2.0 / 3 - x * x + x * x * x / 2 : (2 - x) * (2 - x) * (2 - x) / 6;
        const double catmull_rom = x < 1 ? 1.5 * x * x * x - 2.5 * x * x + 1 : (x - 1) * (x - 2) * (x - 2) / -2;
        EXPECT_NEAR(k(x), spline / 3 + 2 * catmull_rom / 3, 1e-14) << x;
    }
}

TEST(ReconstructionFilter, RAS7_GaussianEndsWithoutAStep) {
    for (double x = 0; x < 1.5; x += 1.0 / 64)
        EXPECT_NEAR(filter_value(PixelFilter::kGaussian, x), std::exp(-2 * x * x) - std::exp(-4.5), 1e-15) << x;
    EXPECT_EQ(filter_value(PixelFilter::kGaussian, 1.5), 0);
}

TEST(ReconstructionFilter, RAS7_FiltersAreEvenAndEndAtTheirRadius) {
    for (const PixelFilter filter : kFilters) {
        const double radius = filter_radius(filter);
        for (double x = 0; x < 3; x += 1.0 / 128) {
            EXPECT_EQ(filter_value(filter, x), filter_value(filter, -x));
            if (x > radius) {
                EXPECT_EQ(filter_value(filter, x), 0);
            }
        }
        EXPECT_GT(filter_value(filter, 0), 0);
    }
}

// Copies of the filter one pixel apart add up to a constant: what is flat stays flat, wherever samples lie.
TEST(ReconstructionFilter, RAS7_ShiftedFiltersAddUp) {
    const auto ripple = [](PixelFilter filter) {
        double least = 1e9, most = 0;
        for (double x = -0.5; x < 0.5; x += 1.0 / 256) {
            double sum = 0;
            for (int i = -3; i <= 3; ++i) sum += filter_value(filter, x + i);
            least = std::min(least, sum), most = std::max(most, sum);
        }
        return (most - least) / (most + least);
    };
    EXPECT_LT(ripple(PixelFilter::kTent), 1e-14);
    EXPECT_LT(ripple(PixelFilter::kMitchell), 1e-14);
    // By Poisson's sum twice what passes at the sampling frequency, exp(-pi^2 / 2), and the offset's part.
    EXPECT_NEAR(ripple(PixelFilter::kGaussian), 2 * std::exp(-0.5 * 3.14159265 * 3.14159265), 5e-3);
}

TEST(FilterWeights, RAS7_AddUpToOne) {
    for (const PixelFilter filter : kFilters)
        for (const int count : {1, 2, 3, 4, 5, 8, 16, 64, 256}) {
            const FilterWeights weights(filter, pattern(count));
            const int reach = weights.reach();
            EXPECT_NEAR(weights.sum_within(reach, reach, reach, reach), 1, 1e-6) << count;
            double sum = 0;
            for (int s = 0; s < count; ++s)
                for (int dy = -reach; dy <= reach; ++dy)
                    for (int dx = -reach; dx <= reach; ++dx)
                        sum += static_cast<double>(weights.weight(static_cast<std::size_t>(s), dx, dy));
            EXPECT_NEAR(sum, 1, 1e-6) << count;
            // In the corner of a picture of one pixel, too, there is something to divide by.
            EXPECT_GT(weights.sum_within(0, 0, 0, 0), 0.2) << count;
        }
}

TEST(FilterWeights, RAS7_AreProportionalToTheFilterAtTheSamplesDistance) {
    const std::vector<SampleOffset> samples = pattern(5);
    for (const PixelFilter filter : kFilters) {
        const FilterWeights weights(filter, samples);
        const double unit =
            static_cast<double>(weights.weight(2, 0, 0)) /
            (filter_value(filter, samples[2].x / 256.0 - 0.5) * filter_value(filter, samples[2].y / 256.0 - 0.5));
        for (std::size_t s = 0; s < samples.size(); ++s)
            for (int dy = -3; dy <= 3; ++dy)
                for (int dx = -3; dx <= 3; ++dx) {
                    // From the pixel's centre to sample s of the pixel (dx, dy) away.
                    const double x = dx + samples[s].x / 256.0 - 0.5, y = dy + samples[s].y / 256.0 - 0.5;
                    const double expected = unit * filter_value(filter, x) * filter_value(filter, y);
                    if (std::max(std::abs(dx), std::abs(dy)) > weights.reach()) {
                        EXPECT_EQ(expected, 0) << "within reach after all";
                    } else {
                        EXPECT_NEAR(static_cast<double>(weights.weight(s, dx, dy)), expected, 1e-7);
                    }
                }
    }
}

// With four samples the pattern is its own mirror image in the pixel's centre, sample 3 - s for s.
TEST(FilterWeights, RAS7_AreSymmetricWhereThePatternIs) {
    const std::vector<SampleOffset> samples = pattern(4);
    for (std::size_t s = 0; s < 4; ++s) {
        ASSERT_EQ(samples[s].x + samples[3 - s].x, 256);
        ASSERT_EQ(samples[s].y + samples[3 - s].y, 256);
    }
    for (const PixelFilter filter : kFilters) {
        const FilterWeights weights(filter, samples);
        const int reach = weights.reach();
        for (std::size_t s = 0; s < 4; ++s)
            for (int dy = -reach; dy <= reach; ++dy)
                for (int dx = -reach; dx <= reach; ++dx)
                    EXPECT_EQ(weights.weight(s, dx, dy), weights.weight(3 - s, -dx, -dy));
    }
}

TEST(FilterWeights, RAS7_OneSampleAtTheCentre) {
    const std::vector<SampleOffset> centre = pattern(1);
    for (const PixelFilter filter : {PixelFilter::kBox, PixelFilter::kTent}) {
        const FilterWeights weights(filter, centre);  // the tent is 0 at the neighbours' centres
        for (int dy = -weights.reach(); dy <= weights.reach(); ++dy)
            for (int dx = -weights.reach(); dx <= weights.reach(); ++dx)
                EXPECT_EQ(weights.weight(0, dx, dy), dx == 0 && dy == 0 ? 1.0f : 0.0f);
    }
    const FilterWeights mitchell(PixelFilter::kMitchell, centre);
    EXPECT_FLOAT_EQ(mitchell.weight(0, 0, 0), 64.0f / 81);
    EXPECT_FLOAT_EQ(mitchell.weight(0, 1, 0), 8.0f / 162);
    EXPECT_FLOAT_EQ(mitchell.weight(0, -1, 1), 1.0f / 324);
    EXPECT_EQ(mitchell.weight(0, 2, 0), 0.0f);
    EXPECT_EQ(mitchell.reach(), 2);
}

}  // namespace
}  // namespace tessera
