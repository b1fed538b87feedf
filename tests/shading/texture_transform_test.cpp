// TEX1: KHR_texture_transform and uv sets, from a scene's material to the sampled texel.
#include "render/shading_scene.h"

#include "shading/support.h"

#include <tessera/scene.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace tessera {
namespace {

using test::Real;

// A triangle whose material reads a 2 x 2 texture through the given reference.
class TexturedTriangle {
  public:
    explicit TexturedTriangle(const TextureRef& ref) {
        auto image = std::make_shared<Image>(2, 2, PixelFormat::kRgba8);
        scene_.pictures.push_back({});
        scene_.pictures[0].pixels = image;
        scene_.textures.push_back({});
        scene_.textures[0].picture = 0;
        Material m;
        m.texture(TextureSlot::kBaseColor) = ref;
        m.texture(TextureSlot::kBaseColor).texture = 0;
        scene_.materials.push_back(m);
        frame_.instances.push_back({});  // drawn with material 0
        frame_.projection.width = frame_.projection.height = 64;
        Arena arena(1);
        shading_ = std::make_unique<ShadingScene>(scene_, frame_, RenderOptions{}, arena, warnings_);
    }
    const TextureInput& input() const { return shading_->context().materials[0].input(TextureSlot::kBaseColor); }
    std::size_t warnings() const { return warnings_.size(); }

  private:
    Scene scene_;
    Frame frame_;
    std::vector<std::string> warnings_;
    std::unique_ptr<ShadingScene> shading_;
};

Vec2T<float> apply(const TextureInput& in, float u, float v) {
    const float* r = in.transform;
    return {u * r[0] + v * r[1] + r[2], u * r[3] + v * r[4] + r[5]};
}

// The extension's own example: offset (0, 1), a quarter turn, scale 1/2 is "the lower left quadrant of
// the source image, rotated clockwise 90 degrees": the picture's upper left corner shows the
// quadrant's lower left one, its upper right corner the upper left one.
TEST(TEX1_Transform, ExampleOfTheExtension) {
    TextureRef ref;
    ref.offset = {0, 1};
    ref.rotation = 1.57079632679f;
    ref.scale = {0.5f, 0.5f};
    const TexturedTriangle t(ref);
    ASSERT_NE(t.input().texture, nullptr);
    const float corners[4][4] = {{0, 0, 0, 1}, {1, 0, 0, 0.5f}, {1, 1, 0.5f, 0.5f}, {0, 1, 0.5f, 1}};
    for (const auto& [u, v, want_u, want_v] : corners) {
        EXPECT_NEAR(apply(t.input(), u, v).x, want_u, 1e-6);
        EXPECT_NEAR(apply(t.input(), u, v).y, want_v, 1e-6);
    }
}

// Scaled first, then turned, then moved.
TEST(TEX1_Transform, ScaleThenRotationThenOffset) {
    test::Random random(61);
    for (int i = 0; i < 50; ++i) {
        TextureRef ref;
        ref.offset = {random.in(-2, 2), random.in(-2, 2)};
        ref.scale = {random.in(-3, 3), random.in(-3, 3)};
        ref.rotation = random.in(-7, 7);
        const TexturedTriangle t(ref);
        const float u = random.in(-2, 2), v = random.in(-2, 2);
        const Real su = static_cast<Real>(ref.scale.x) * u, sv = static_cast<Real>(ref.scale.y) * v;
        const Real c = std::cos(static_cast<Real>(ref.rotation)), s = std::sin(static_cast<Real>(ref.rotation));
        EXPECT_NEAR(apply(t.input(), u, v).x, static_cast<double>(c * su + s * sv + ref.offset.x), 3e-6);
        EXPECT_NEAR(apply(t.input(), u, v).y, static_cast<double>(c * sv - s * su + ref.offset.y), 3e-6);
    }
}

TEST(TEX1_Transform, FlippedAxisOfTheExtension) {
    TextureRef ref;
    ref.offset = {0, 1};
    ref.scale = {1, -1};
    const TexturedTriangle t(ref);
    EXPECT_EQ(apply(t.input(), 0.25f, 0.25f).x, 0.25f);
    EXPECT_EQ(apply(t.input(), 0.25f, 0.25f).y, 0.75f);
}

TEST(TEX1_UvSets, AMaterialReadsTheSetItNames) {
    for (int set = 0; set < kMaxUvSets; ++set) {
        TextureRef ref;
        ref.uv_set = set;
        EXPECT_EQ(TexturedTriangle(ref).input().uv_set, set);
    }
    TextureRef beyond;
    beyond.uv_set = kMaxUvSets;
    const TexturedTriangle t(beyond);
    EXPECT_EQ(t.input().texture, nullptr);
    EXPECT_EQ(t.warnings(), 1u);
}

// The transform moves the footprint too: a texture scaled by 4 is sampled two levels further down.
TEST(TEX1_UvSets, ReadInputTransformsTheFootprintOfItsSet) {
    test::TestTexture texture(64, 64, 7, 1);
    for (int level = 0; level < 7; ++level) texture.fill(level, test::grey_texel(20 * level));
    MaterialView m = test::plain_material(ShadingModel::kMetallicRoughness);
    SurfacePoint<float> s = test::plain_point({0, 0, -1}, {0, 0, 1});
    s.footprint[2] = {1.0f / 64, 0, 0, 1.0f / 64};
    TextureInput& in = m.inputs[static_cast<int>(TextureSlot::kBaseColor)];
    in = {&texture.view(), 2, {4, 0, 0, 0, 4, 0}};
    EXPECT_NEAR(read_input(m, TextureSlot::kBaseColor, s).x * 255 / 20, 2, 1e-4);
    in = {&texture.view(), 2, {0, 2, 0, -2, 0, 0}};  // a quarter turn and a scale of 2
    EXPECT_NEAR(read_input(m, TextureSlot::kBaseColor, s).x * 255 / 20, 1, 1e-4);
    in.uv_set = 1;
    EXPECT_NEAR(read_input(m, TextureSlot::kBaseColor, s).x, 0, 1e-4);
}

}  // namespace
}  // namespace tessera
