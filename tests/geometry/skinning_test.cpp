// The skinning kernels: every instruction set against one lane, over random and odd numbers, with guarded
// memory; and one lane against the definition.
#include "core/fp_environment.h"
#include "geometry/skin_kernels.h"
#include "geometry/support.h"
#include "simd/guarded_memory.h"

#include <tessera/isa.h>

#include <cstring>
#include <limits>

namespace tessera {
namespace {

using test::GuardedArray;
using test::Random;

struct SkinCase {
    std::uint32_t joints, sets, count;
    GuardedArray<float> matrices, weights, positions, normals, tangents;
    GuardedArray<std::uint32_t> numbers;

    SkinCase(Random& random, std::uint32_t j, std::uint32_t s, std::uint32_t n, bool odd)
        : joints(j),
          sets(s),
          count(n),
          matrices(12 * j),
          weights(4 * s * n),
          positions(3 * n),
          normals(3 * n),
          tangents(4 * n),
          numbers(4 * s * n) {
        constexpr float kOdd[] = {0.0f,
                                  -0.0f,
                                  1e-42f,
                                  3e38f,
                                  std::numeric_limits<float>::infinity(),
                                  std::numeric_limits<float>::quiet_NaN()};
        const auto fill = [&](GuardedArray<float>& values, float size) {
            for (std::size_t i = 0; i < values.size(); ++i)
                values[i] = odd && random.below(16) == 0 ? kOdd[random.below(std::size(kOdd))] : random.in(-size, size);
        };
        fill(matrices, 2), fill(weights, 1), fill(positions, 10), fill(normals, 1), fill(tangents, 1);
        for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = random.below(joints);
    }
    SkinJob job() const {
        SkinJob job{};
        job.matrices = matrices.data();
        job.joints = numbers.data();
        job.weights = weights.data();
        job.sets = sets;
        job.count = count;
        job.positions = positions.data();
        return job;
    }
};

struct SkinResult {
    GuardedArray<float> positions, normals, tangents;
    explicit SkinResult(std::uint32_t n) : positions(3 * n), normals(3 * n), tangents(4 * n) {
        for (GuardedArray<float>* a : {&positions, &normals, &tangents}) std::memset(a->data(), 0x33, a->size() * 4);
    }
    void run(const SkinCase& c, const SkinKernels& kernels, bool with_normals, bool with_tangents, std::uint32_t first,
             std::uint32_t end) {
        SkinJob job = c.job();
        job.first = first, job.end = end;
        job.out_positions = positions.data();
        if (with_normals) job.normals = c.normals.data(), job.out_normals = normals.data();
        if (with_tangents) job.tangents = c.tangents.data(), job.out_tangents = tangents.data();
        kernels.skin(job);
    }
    bool operator==(const SkinResult& o) const {
        return same(positions, o.positions) && same(normals, o.normals) && same(tangents, o.tangents);
    }
    // NaN is NaN, whatever its bits: they end as 0 in the film.
    static bool same(const GuardedArray<float>& a, const GuardedArray<float>& b) {
        for (std::size_t i = 0; i < a.size(); ++i)
            if (std::memcmp(&a[i], &b[i], 4) != 0 && (a[i] == a[i] || b[i] == b[i])) return false;
        return true;
    }
    bool changed() const { return positions.changed() || normals.changed() || tangents.changed(); }
};

class SkinKernelTest : public testing::TestWithParam<Isa> {
    void SetUp() override {
        if (!isa_supported(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not supported here";
    }
};

TEST_P(SkinKernelTest, ANI5_GivesTheBitsOfOneLane) {
    const FpEnvironment exact;
    Random random(3);
    for (int round = 0; round < 300; ++round) {
        const std::uint32_t n = 1 + random.below(70), sets = 1 + random.below(3), joints = 1 + random.below(20);
        const SkinCase c(random, joints, sets, n, round % 3 == 0);
        const std::uint32_t first = round % 4 == 0 ? random.below(n) : 0,
                            end = round % 5 == 0 ? first + random.below(n - first + 1) : n;
        SkinResult got(n), want(n);
        got.run(c, skin_kernels(GetParam()), round % 2 != 0, round % 7 < 4, first, end);
        want.run(c, skin_kernels(Isa::kScalar), round % 2 != 0, round % 7 < 4, first, end);
        ASSERT_TRUE(got == want) << round;
        ASSERT_FALSE(got.changed()) << round;
    }
}

std::string isa_name(const testing::TestParamInfo<Isa>& tested) { return name(tested.param); }
INSTANTIATE_TEST_SUITE_P(Kernels, SkinKernelTest, testing::Values(Isa::kSse4, Isa::kAvx2, Isa::kAvx512), isa_name);

TEST(SkinKernel, ANI5_MixesMatricesByWeight) {
    const FpEnvironment exact;
    Random random(4);
    for (int round = 0; round < 200; ++round) {
        const SkinCase c(random, 5, 2, 9, false);
        SkinResult got(9);
        got.run(c, skin_kernels(Isa::kScalar), true, true, 0, 9);
        for (std::size_t v = 0; v < 9; ++v) {
            double m[12] = {};
            for (std::size_t s = 0; s < 2; ++s)
                for (std::size_t k = 0; k < 4; ++k)
                    for (std::size_t i = 0; i < 12; ++i)
                        m[i] += static_cast<double>(c.weights[4 * (s * 9 + v) + k]) *
                                static_cast<double>(c.matrices[12 * c.numbers[4 * (s * 9 + v) + k] + i]);
            const auto at = [](const GuardedArray<float>& a, std::size_t i) { return static_cast<double>(a[i]); };
            for (std::size_t r = 0; r < 3; ++r) {
                double want = m[4 * r + 3];
                for (std::size_t i = 0; i < 3; ++i) want += m[4 * r + i] * at(c.positions, 3 * v + i);
                EXPECT_NEAR(at(got.positions, 3 * v + r), want, 1e-4);
            }
            // A normal stays at right angles to what it was at right angles to.
            double side[3] = {at(c.normals, 3 * v + 1), -at(c.normals, 3 * v), 0}, moved[3], dot = 0, length = 0,
                   unit = 0;
            for (std::size_t r = 0; r < 3; ++r) {
                moved[r] = m[4 * r] * side[0] + m[4 * r + 1] * side[1] + m[4 * r + 2] * side[2];
                dot += moved[r] * at(got.normals, 3 * v + r);
                length += moved[r] * moved[r];
                unit += at(got.normals, 3 * v + r) * at(got.normals, 3 * v + r);
            }
            EXPECT_NEAR(dot / std::sqrt(length), 0, 1e-3);
            EXPECT_NEAR(unit, 1, 1e-5);
            EXPECT_EQ(got.tangents[4 * v + 3], c.tangents[4 * v + 3]);
        }
    }
}

}  // namespace
}  // namespace tessera
