// Texture lookups on lanes: the bits of one lane, whatever the instruction set, the filter and the
// coordinates, and nothing read behind the last texel.
#include "shading/lookup.h"

#include "shading/support.h"
#include "simd/guarded_memory.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace tessera {
namespace {

constexpr int kCount = 4096;

enum class Points { kNear, kBorders, kOdd };

// `kNear`: patches of neighbouring pixels, as pictures have them. `kBorders`: on and beside the borders of
// texels and levels. `kOdd`: what no file should hold, among others.
std::vector<float> make_points(test::Random& random, Points kind, int width, int height) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    static constexpr float kOdd[] = {
        0.0f,    -0.0f,       1.0f,      -1.0f,      1e-42f,
        -1e-30f, 1e9f,        -3e9f,     3e38f,      0.99999994f,
        16384,   -8388607.5f, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()};
    std::vector<float> in(std::size_t{kLookupInputs} * kCount);
    const auto w = static_cast<float>(width), h = static_cast<float>(height);
    float u = 0, v = 0, size = 1;
    for (std::size_t i = 0; i < kCount; ++i) {
        if (i % 32 == 0) u = random.in(-2, 3), v = random.in(-2, 3), size = std::exp2(random.in(-4, 12));
        const float turn = random.in(0, 0.1f);
        float point[kLookupInputs] = {u + static_cast<float>(i % 8) * size / w,
                                      v + static_cast<float>(i / 8 % 4) * size / h,
                                      size * std::cos(turn) / w,
                                      size * std::sin(turn) / h,
                                      -size * std::sin(turn) / w,
                                      size * std::cos(turn) / h};
        if (kind == Points::kBorders) {
            const auto near = [&](float x) {
                const std::uint32_t step = random.below(3);
                return step == 0 ? x : std::nextafter(x, step == 1 ? 1e9f : -1e9f);
            };
            point[0] = near(std::round(random.in(-2, 3) * 4 * w) / (4 * w));
            point[1] = near(std::round(random.in(-2, 3) * 4 * h) / (4 * h));
            point[2] = near(static_cast<float>(1 << random.below(16)) / w);
            point[3] = point[4] = 0;
            point[5] = random.below(2) ? 0 : near(point[2]);
        }
        if (kind == Points::kOdd)
            for (float& x : point)
                if (random.below(3) == 0) x = kOdd[random.below(sizeof kOdd / sizeof *kOdd)];
        for (std::size_t k = 0; k < kLookupInputs; ++k) in[k * kCount + i] = point[k];
    }
    return in;
}

class TextureLanesTest : public testing::TestWithParam<Isa> {
  protected:
    void SetUp() override {
        if (!isa_supported(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not supported here";
    }
};

TEST_P(TextureLanesTest, TEX1_EveryWrapAndFilterHasTheBitsOfOneLane) {
    test::Random random(41);
    for (const auto& [w, h, levels] :
         {std::array{1, 1, 1}, {4, 4, 3}, {7, 3, 3}, {1, 9, 4}, {64, 32, 7}, {100, 99, 7}}) {
        test::TestTexture source(w, h, levels, static_cast<std::uint32_t>(w));
        // A copy of the texels, all of them or as far as the levels go, that ends where memory ends.
        TextureView view = source.view();
        const int last = levels - 1;
        const std::size_t size = static_cast<std::size_t>(view.offset[last]) +
                                 static_cast<std::size_t>((source.width(last) + 2) * (source.height(last) + 2));
        test::GuardedArray<Texel> texels(std::vector<Texel>(view.texels, view.texels + size));
        view.texels = texels.data();
        for (int mode = 0; mode < 9 * 3 * 4; ++mode) {
            view.wrap_s = static_cast<Wrap>(mode % 3);
            view.wrap_t = static_cast<Wrap>(mode / 3 % 3);
            view.mip = static_cast<MipFilter>(mode / 9 % 3);
            view.mag_linear = mode / 27 & 1;
            view.min_linear = mode / 54;
            for (const Points kind : {Points::kNear, Points::kBorders, Points::kOdd}) {
                const std::vector<float> points = make_points(random, kind, w, h);
                std::vector<std::uint32_t> got(std::size_t{kLookupResults} * kCount), want(got.size());
                lookup_table(GetParam()).run({&view, points.data(), got.data(), kCount});
                lookup_table(Isa::kScalar).run({&view, points.data(), want.data(), kCount});
                ASSERT_EQ(got, want) << w << " x " << h << ", mode " << mode << ", points " << static_cast<int>(kind);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Shading, TextureLanesTest, testing::Values(Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512),
                         [](const auto& instance) { return std::string(name(instance.param)); });

}  // namespace
}  // namespace tessera
