// Arrays of a wave that end where memory ends, filled at random with numbers of all kinds; shared by the tests of the
// ray tracer's kernels.
#pragma once

#include "raster/kernel_world.h"
#include "trace/kernels.h"

#include <bit>
#include <iterator>
#include <limits>

namespace tessera::test {

// Kernels of one instruction set beside the one-lane ones.
class TraceKernelTest : public KernelTest {
  protected:
    const TraceKernels& traced() const { return trace_kernels(GetParam()); }
    static const TraceKernels& one_lane() { return trace_kernels(Isa::kScalar); }
};

inline float odd_number(Random& random) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kOdd[] = {0.0f, -0.0f, 1.0f,   -1.0f,     1e-42f,     1e-30f,
                              1e9f, 1e20f, -3e38f, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()};
    return kOdd[random.below(std::size(kOdd))];
}

// `numbers` arrays of `count` floats, each with the room that kernels may touch beyond its end.
class GuardedWave {
  public:
    GuardedWave(int numbers, std::uint32_t count)
        : count_(count), stride_(count + kMaxLanes), memory_(static_cast<std::size_t>(numbers) * stride_) {
        for (std::size_t i = 0; i < memory_.size(); ++i) memory_[i] = -7.0f;
    }
    GuardedWave(int numbers, const GuardedWave& like) : GuardedWave(numbers, like.count_) {}

    WaveArrays arrays() { return {memory_.data(), stride_}; }
    float* operator[](int number) { return arrays()[number]; }
    void set3(int number, std::uint32_t at, const Vec3T<float>& v) {
        (*this)[number][at] = v.x, (*this)[number + 1][at] = v.y, (*this)[number + 2][at] = v.z;
    }
    bool changed() const { return memory_.changed(); }
    std::size_t size() const { return memory_.size(); }
    std::uint32_t count() const { return count_; }

    // Whether the first `count` of each of `numbers` arrays are equal.
    bool same(GuardedWave& other, int numbers, std::uint32_t count) {
        for (int n = 0; n < numbers; ++n)
            if (!same_floats((*this)[n], other[n], count)) return false;
        return true;
    }

  private:
    std::uint32_t count_;
    std::size_t stride_;
    GuardedArray<float> memory_;
};

// Surface points as a wave has them; `odd`: one number in 16 is any.
inline void fill_points(GuardedWave& points, Random& random, bool odd) {
    for (std::uint32_t i = 0; i < points.count(); ++i) {
        const Vec3T<float> flat = random.unit(),
                           normal = random.below(3) ? normalize_or(flat + random.box(0.5f), flat) : flat;
        const Vec3T<float> view = normalize_or(flat + random.box(1), flat);
        points.set3(kPositionX, i, random.box(random.below(4) ? 3.0f : 1e4f));
        points.set3(kViewX, i, view);
        points.set3(kNormalX, i, normal);
        points.set3(kFlatX, i, flat);
        points[kFacing][i] = random.below(3) ? 1.0f : -1.0f;
        points[kFootprint][i] = random.in(0, 0.1f);
        points[kRounding][i] = random.in(0, 100);
        for (int c = 0; c < 3; ++c) points[kEtaR + c][i] = random.below(4) ? random.in(0.4f, 2.5f) : 1.0f;
        points[kTimes][i] = random.in(0, 1);
        for (int n = kColorR; n < kPointNumbers; ++n)
            points[n][i] = n < kUv ? random.in(0, 1) : random.in(-2, 2) * ((n - kUv) % 6 < 2 ? 1.0f : 0.02f);
        if (!odd) continue;
        for (int n = 0; n < kPointNumbers; ++n)
            if (random.below(16) == 0) points[n][i] = odd_number(random);
        if (random.below(8) == 0) points.set3(kViewX, i, {0, 0, 0});
        if (random.below(8) == 0) points.set3(kNormalX, i, points[kFlatX][i] > 0 ? Vec3T<float>{0, 0, 0} : -view);
    }
}

inline void fill_rays(GuardedWave& rays, Random& random, bool odd) {
    for (std::uint32_t i = 0; i < rays.count(); ++i) {
        rays.set3(kOriginX, i, random.box(5));
        rays.set3(kDirectionX, i, random.unit());
        for (int n = kConeWidth; n < kRayNumbers; ++n) rays[n][i] = random.in(0, 1);
        if (!odd) continue;
        for (int n = 0; n < kRayNumbers; ++n)
            if (random.below(16) == 0) rays[n][i] = odd_number(random);
        if (random.below(8) == 0) rays.set3(kDirectionX, i, {0, 0, 0});
    }
}

}  // namespace tessera::test
