// All of shading has the same bits on every instruction set as on one lane: every shading model, wrap
// mode, filter and light, on random triangles, on triangles behind the eye, and on values that no
// file should hold.
#include "shading/chain.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace tessera {
namespace {

constexpr int kPoints = 512;
constexpr float kWidth = 640, kHeight = 480;

bool is_nan(std::uint32_t bits) { return (bits & 0x7fffffff) > 0x7f800000; }

// The kinds of numbers that a plane of inputs mixes in.
float odd_number(test::Random& random) {
    static constexpr float kOdd[] = {0.0f,
                                     -0.0f,
                                     1.0f,
                                     -1.0f,
                                     1e-42f,
                                     1e-30f,
                                     1e9f,
                                     -3e9f,
                                     1e20f,
                                     -1e38f,
                                     std::numeric_limits<float>::infinity(),
                                     -std::numeric_limits<float>::infinity(),
                                     std::numeric_limits<float>::quiet_NaN()};
    return kOdd[random.below(sizeof(kOdd) / sizeof(*kOdd))];
}

// Camera-space triangles around the view axis, some of them partly behind the eye; `odd`: one number
// in 16 is replaced.
std::vector<float> make_planes(std::uint32_t seed, bool odd) {
    test::Random random(seed);
    std::vector<float> planes(std::size_t{kChainInputs} * kPoints);
    const auto at = [&](int plane, int point) -> float& {
        return planes[static_cast<std::size_t>(plane) * kPoints + static_cast<std::size_t>(point)];
    };
    for (int p = 0; p < kPoints; ++p) {
        const float size = p % 3 == 0 ? 0.05f : 2.0f;
        const Vec3T<float> middle{random.in(-2, 2), random.in(-2, 2), p % 5 == 0 ? 0.0f : -4.0f};
        for (int i = 0; i < 3; ++i) {
            int plane = i * kChainCornerSize;
            const auto put = [&](float v) { at(plane++, p) = v; };
            const Vec3T<float> v = middle + random.box(size);
            put(v.x), put(v.y), put(v.z);
            const Vec3T<float> n = random.unit();
            put(n.x), put(n.y), put(n.z);
            const Vec3T<float> t = random.unit();
            put(t.x), put(t.y), put(t.z), put(random.below(2) ? 1.0f : -1.0f);
            for (int c = 0; c < 4; ++c) put(random.in(0, 1));
            for (int k = 0; k < 2 * kMaxUvSets; ++k) put(random.in(-3, 3));
        }
        at(kChainSample, p) = static_cast<float>(random.below(static_cast<std::uint32_t>(kWidth) * 256));
        at(kChainSample + 1, p) = static_cast<float>(random.below(static_cast<std::uint32_t>(kHeight) * 256));
    }
    if (odd)
        for (std::size_t i = 0; i < std::size_t{kChainSample} * kPoints; ++i)
            if (random.below(16) == 0) planes[i] = odd_number(random);
    return planes;
}

// Everything else that a chain reads.
class World {
  public:
    World() {
        for (int i = 0; i < 3; ++i) {
            films_[i] = {i == 0 ? 1.0f : 0.3f, static_cast<ToneMap>(i), {0.2f, 0.4f, 0.1f, i == 1 ? 0.0f : 1.0f}};
        }
        // Perspective with reversed depth to infinity, 90 degrees; the object's space is turned a little.
        const float clip[16] = {0.75f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0.1f, 0, 0, -1, 0};
        const float camera[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        const float normals[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        std::memcpy(instance_.object_to_clip, clip, sizeof clip);
        std::memcpy(projection_.clip_from_camera, clip, sizeof clip);
        projection_.width = kWidth;
        projection_.height = kHeight;
        std::memcpy(instance_.object_to_camera, camera, sizeof camera);
        std::memcpy(instance_.normal_to_camera, normals, sizeof normals);
        instance_.handedness = 1;
        // Any address says that the mesh has the attribute; corners come from the planes.
        instance_.mesh.tangents = instance_.mesh.colors = present_;
        for (const float*& uv : instance_.mesh.uvs) uv = present_;

        using test::set3;
        lights_.push_back(test::directional_light({0.6f, 0.8f, 0.0f}, 3));
        lights_.push_back(test::point_light({1, 2, -1}, 20));
        lights_.push_back(test::point_light({-1, 0, -3}, 2));
        lights_.back().falloff = LightFalloff::kConstant;
        lights_.back().inverse_range = 0.2f;
        lights_.push_back(test::point_light({0, 3, -4}, 40));
        lights_.back().type = LightType::kSpot;
        lights_.back().spot_scale = 3;
        lights_.back().spot_offset = -1.5f;
        lights_.back().inverse_range = 0.1f;
        set3(lights_.back().to_light, {0, 1, 0});
        lights_.push_back(lights_.back());
        lights_.back().profile = SpotProfile::kAxis;
        context_ = test::plain_context(lights_);
        context_.ambient = {{0.5f, 0.6f, 0.7f}, {0.1f, 0.2f, 0.1f}, {0, 1, 0}};
        context_.unlit_scale = 0.7f;
        context_.footprint_scale = 0.5f;
    }

    InstanceView& instance() { return instance_; }
    void make_orthographic() { projection_.orthographic = true; }

    std::vector<std::uint32_t> run(const ChainTable& table, const MaterialView& m, const std::vector<float>& planes) {
        constexpr std::size_t kMargin = 19;
        std::vector<std::uint32_t> buffer(std::size_t{kChainResults} * kPoints + kMargin, 0xdeadbeef);
        table.run({&context_, &m, &instance_, films_, &projection_,
                   surface_layout(instance_.mesh, m, projection_.orthographic), planes.data(), buffer.data(), kPoints,
                   kPoints});
        for (std::size_t i = buffer.size() - kMargin; i < buffer.size(); ++i) EXPECT_EQ(buffer[i], 0xdeadbeef);
        return buffer;
    }

  private:
    static constexpr float present_[1] = {0};
    FilmView films_[3]{};
    InstanceView instance_{};
    ProjectionView projection_{};
    ShadingContext context_{};
    std::vector<LightView> lights_;
};

class ChainTest : public testing::TestWithParam<Isa> {
  protected:
    void SetUp() override {
        if (!isa_supported(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not supported here";
    }

    // The first difference of each stage is reported.
    void expect_same(const MaterialView& m, std::uint32_t seed, bool odd, const std::string& what) {
        const std::vector<float> planes = make_planes(seed, odd);
        const std::vector<std::uint32_t> got = world_.run(chain_table(GetParam()), m, planes);
        const std::vector<std::uint32_t> want = world_.run(chain_table(Isa::kScalar), m, planes);
        int plane = 0;
        for (const ChainStage& stage : kChainStages) {
            for (int i = 0; i < stage.results * kPoints; ++i) {
                const std::size_t at = static_cast<std::size_t>(plane * kPoints + i);
                if (got[at] == want[at] || (stage.is_float && is_nan(got[at]) && is_nan(want[at]))) continue;
                ADD_FAILURE() << what << ", " << stage.name << " " << i / kPoints << " of point " << i % kPoints
                              << std::hex << ": 0x" << got[at] << " but 0x" << want[at] << " on one lane";
                break;
            }
            plane += stage.results;
        }
        ASSERT_EQ(plane, kChainResults);
    }

    World world_;
};

constexpr ShadingModel kModels[] = {ShadingModel::kMetallicRoughness, ShadingModel::kUnlit,
                                    ShadingModel::kLambert,           ShadingModel::kPhong,
                                    ShadingModel::kBlinnPhong,        ShadingModel::kSpecularGlossiness};
constexpr Wrap kWraps[] = {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp};
constexpr MipFilter kMips[] = {MipFilter::kNone, MipFilter::kNearest, MipFilter::kLinear};

MaterialView textured(ShadingModel model, std::vector<std::unique_ptr<test::TestTexture>>& textures) {
    MaterialView m = test::plain_material(model);
    m.metallic = 0.8f;
    test::set3(m.emission, {0.1f, 0.0f, 0.3f});
    test::set3(m.ambient, {0.3f, 0.2f, 0.1f});
    test::set3(m.specular, {0.4f, 0.5f, 0.6f});
    m.alpha_mode = AlphaMode::kBlend;
    for (std::size_t slot = 0; slot < kTextureSlots; ++slot) {
        TextureView& view = textures[slot]->view();
        m.inputs[slot].texture = &view;
        m.inputs[slot].uv_set = static_cast<std::int32_t>(slot % kMaxUvSets);
        const float transform[6] = {0.9f, 0.2f, 0.1f, -0.3f, 1.1f, 0.4f};
        std::memcpy(m.inputs[slot].transform, transform, sizeof transform);
    }
    return m;
}

std::vector<std::unique_ptr<test::TestTexture>> make_textures() {
    std::vector<std::unique_ptr<test::TestTexture>> textures;
    constexpr int kSizes[kTextureSlots][3] = {{64, 32, 7}, {1, 1, 1},   {37, 5, 6}, {16, 16, 5},
                                              {128, 1, 8}, {32, 64, 7}, {9, 9, 4}};
    for (std::size_t i = 0; i < kTextureSlots; ++i)
        textures.push_back(std::make_unique<test::TestTexture>(kSizes[i][0], kSizes[i][1], kSizes[i][2],
                                                               static_cast<std::uint32_t>(i + 1)));
    return textures;
}

// Equal bits would prove nothing if they were all zeros or NaNs.
TEST(ChainInputs, ReachEveryKindOfResult) {
    World world;
    auto textures = make_textures();
    const MaterialView m = textured(ShadingModel::kMetallicRoughness, textures);
    const std::vector<std::uint32_t> results = world.run(chain_table(Isa::kScalar), m, make_planes(1, false));
    const auto plane = [&](int i) {
        return std::span(results).subspan(static_cast<std::size_t>(i) * kPoints, kPoints);
    };
    const auto share = [&](int i, auto&& is) {
        return static_cast<double>(std::ranges::count_if(plane(i), is)) / kPoints;
    };
    const auto as_number = [](std::uint32_t bits) { return std::bit_cast<float>(bits); };
    const std::set<std::uint32_t> codes(plane(0).begin(), plane(0).end());
    EXPECT_GE(codes.size(), 12u);
    constexpr int kDistance = chain_plane("position and normals") + 2, kU = chain_plane("uv and footprint"),
                  kRadiance = chain_plane("radiance"), kRed = chain_plane("film");
    EXPECT_GT(share(kDistance, [&](std::uint32_t b) { return as_number(b) < -0.5f && as_number(b) > -20; }), 0.5);
    // The others lie beyond a horizon, farther than anything that is drawn.
    EXPECT_GT(share(kU, [&](std::uint32_t b) { return as_number(b) > -10 && as_number(b) < 10; }), 0.35);
    for (int c = 0; c < 3; ++c)
        EXPECT_GT(share(kRadiance + c, [&](std::uint32_t b) { return as_number(b) > 0 && as_number(b) < 1e4f; }), 0.5);
    EXPECT_EQ(share(kRadiance, is_nan), 0);
    const std::set<std::uint32_t> reds(plane(kRed).begin(), plane(kRed).end());
    EXPECT_GT(reds.size(), 60u);
}

TEST_P(ChainTest, HasTheIsasLanes) {
    EXPECT_EQ(chain_table(GetParam()).lanes, GetParam() == Isa::kSse4 ? 4 : GetParam() == Isa::kAvx2 ? 8 : 16);
    EXPECT_EQ(chain_table(Isa::kScalar).lanes, 1);
}

TEST_P(ChainTest, EveryShadingModelAndAlphaModeWithAndWithoutTextures) {
    auto textures = make_textures();
    for (const ShadingModel model : kModels)
        for (const AlphaMode alpha : {AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend})
            for (const bool with_textures : {false, true}) {
                MaterialView m = with_textures ? textured(model, textures) : test::plain_material(model);
                m.alpha_mode = alpha;
                const std::string what = "model " + std::to_string(static_cast<int>(model)) + ", alpha mode " +
                                         std::to_string(static_cast<int>(alpha)) + (with_textures ? ", textures" : "");
                expect_same(m, 1, false, what);
                expect_same(m, 2, true, what + ", odd numbers");
            }
}

TEST_P(ChainTest, EveryWrapAndFilter) {
    auto textures = make_textures();
    for (const Wrap s : kWraps)
        for (const Wrap t : kWraps)
            for (const MipFilter mip : kMips)
                for (int filters = 0; filters < 4; ++filters) {
                    for (auto& texture : textures) {
                        TextureView& view = texture->view();
                        view.wrap_s = s;
                        view.wrap_t = t;
                        view.mip = mip;
                        view.mag_linear = filters & 1;
                        view.min_linear = filters & 2;
                    }
                    expect_same(textured(ShadingModel::kMetallicRoughness, textures),
                                static_cast<std::uint32_t>(10 + filters), filters % 2 == 1,
                                "wrap " + std::to_string(static_cast<int>(s)) + std::to_string(static_cast<int>(t)) +
                                    ", mip " + std::to_string(static_cast<int>(mip)) + ", filters " +
                                    std::to_string(filters));
                }
}

TEST_P(ChainTest, MirroredInstancesOrthographicViewsAndMissingAttributes) {
    auto textures = make_textures();
    const MaterialView m = textured(ShadingModel::kMetallicRoughness, textures);
    world_.instance().handedness = -1;
    expect_same(m, 31, false, "mirrored");
    world_.make_orthographic();
    expect_same(m, 32, false, "orthographic");
    world_.instance().mesh.tangents = world_.instance().mesh.colors = nullptr;
    world_.instance().mesh.uvs[1] = nullptr;
    expect_same(m, 33, true, "without tangents, colours and the second uv set");
}

INSTANTIATE_TEST_SUITE_P(Shading, ChainTest, testing::Values(Isa::kSse4, Isa::kAvx2, Isa::kAvx512),
                         [](const auto& instance) { return std::string(name(instance.param)); });

}  // namespace
}  // namespace tessera
