// TESSERA_lights: textbook lights and ambient light.
#include <tessera/load.h>

#include <gtest/gtest.h>

#include <string>

namespace tessera {
namespace {

Scene load_text(const std::string& text) {
    return load_scene_from_memory(std::as_bytes(std::span(text.data(), text.size())), "");
}

std::string with(const std::string& ours, const std::string& light) {
    return R"({"asset":{"version":"2.0"},"scenes":[{}],"extensionsUsed":["TESSERA_lights","KHR_lights_punctual"],"extensions":{)" +
           ours + R"("KHR_lights_punctual":{"lights":[)" + light + R"(]}}})";
}

TEST(TextbookLights, LIT1_FalloffProfileAndAmbientAreRead) {
    const Scene s = load_text(with(
        R"("TESSERA_lights":{"ambient":[0.1,0.2,0.3]},)",
        R"({"type":"point","extensions":{"TESSERA_lights":{"falloff":"constant"}}},)"
        R"({"type":"spot","spot":{"outerConeAngle":0.5},"extensions":{"TESSERA_lights":{"spotProfile":"axis"}}},{"type":"point"})"));
    EXPECT_TRUE(s.warnings.empty()) << s.warnings[0];
    ASSERT_TRUE(s.ambient);
    EXPECT_EQ(*s.ambient, (Vec3{0.1f, 0.2f, 0.3f}));
    ASSERT_EQ(s.lights.size(), 3u);
    EXPECT_EQ(s.lights[0].falloff, LightFalloff::kConstant);
    EXPECT_EQ(s.lights[1].falloff, LightFalloff::kInverseSquare);
    EXPECT_EQ(s.lights[1].spot_profile, SpotProfile::kAxis);
    EXPECT_EQ(s.lights[2].falloff, LightFalloff::kInverseSquare);
    EXPECT_EQ(s.lights[2].spot_profile, SpotProfile::kCones);
}

TEST(TextbookLights, LIT1_WhatIsUnknownIsWarnedOf) {
    const Scene s = load_text(with(R"("TESSERA_lights":{"ambient":[-1,0,0]},)",
                                   R"({"type":"point","extensions":{"TESSERA_lights":{"falloff":"linear"}}})"));
    EXPECT_FALSE(s.ambient);
    EXPECT_EQ(s.lights[0].falloff, LightFalloff::kInverseSquare);
    EXPECT_EQ(s.warnings.size(), 2u);
}

}  // namespace
}  // namespace tessera
