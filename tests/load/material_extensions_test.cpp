// KHR_materials_*: each member of each extension arrives, within its range; what is not drawn is named once.
#include "gltf_text.h"

namespace tessera {
namespace {

// A texture information object with a transform of its own, for texture `number` of five.
std::string info(int number, const std::string& more = {}) {
    return "{\"index\":" + std::to_string(number) + ",\"texCoord\":1,\"extensions\":{\"KHR_texture_transform\":{" +
           "\"offset\":[0.5,0.25],\"scale\":[2,3],\"rotation\":" + std::to_string(number) + "}}" + more + "}";
}
TextureRef ref(int number) { return {number, 1, {0.5f, 0.25f}, {2, 3}, static_cast<float>(number)}; }

Scene load(const std::string& extensions, const std::string& more = {}) {
    return load_text(
        gltf_text("\"images\":[{\"uri\":\"a.png\"}],\"textures\":[{\"source\":0},{\"source\":0},{\"source\":0},"
                  "{\"source\":0},{\"source\":0}],\"materials\":[{\"extensions\":{" +
                  (extensions + "}}]") + more),
        {.load_pictures = false});
}
Material material(const std::string& extensions) { return load(extensions).materials.at(0); }

TEST(MaterialExtensions, Clearcoat) {
    const Clearcoat c =
        material("\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.5,\"clearcoatTexture\":" + info(0) +
                 ",\"clearcoatRoughnessFactor\":0.25,\"clearcoatRoughnessTexture\":" + info(1) +
                 ",\"clearcoatNormalTexture\":" + info(2, ",\"scale\":-2") + "}")
            .clearcoat;
    EXPECT_EQ(c, (Clearcoat{0.5f, 0.25f, -2, ref(0), ref(1), ref(2)}));
}

TEST(MaterialExtensions, Sheen) {
    const Sheen s =
        material("\"KHR_materials_sheen\":{\"sheenColorFactor\":[0.1,0.2,0.3],\"sheenColorTexture\":" + info(3) +
                 ",\"sheenRoughnessFactor\":0.75,\"sheenRoughnessTexture\":" + info(4) + "}")
            .sheen;
    EXPECT_EQ(s, (Sheen{{0.1f, 0.2f, 0.3f}, 0.75f, ref(3), ref(4)}));
}

TEST(MaterialExtensions, TransmissionVolumeAndDispersion) {
    const Material m =
        material("\"KHR_materials_transmission\":{\"transmissionFactor\":0.875,\"transmissionTexture\":" + info(1) +
                 "},\"KHR_materials_volume\":{\"thicknessFactor\":2.5,\"thicknessTexture\":" + info(2) +
                 ",\"attenuationDistance\":0.006,\"attenuationColor\":[0.5,0.25,1]},\"KHR_materials_dispersion\":{"
                 "\"dispersion\":0.33},\"KHR_materials_ior\":{\"ior\":1.6}");
    EXPECT_EQ(m.transmission, 0.875f);
    EXPECT_EQ(m.texture(TextureSlot::kTransmission), ref(1));
    EXPECT_EQ(m.volume, (Volume{2.5f, ref(2), 0.006f, {0.5f, 0.25f, 1}}));
    EXPECT_EQ(m.dispersion, 0.33f);
    EXPECT_EQ(m.ior, 1.6f);
}

TEST(MaterialExtensions, AnisotropyAndIridescence) {
    const Material m = material(
        "\"KHR_materials_anisotropy\":{\"anisotropyStrength\":0.5,\"anisotropyRotation\":-7,\"anisotropyTexture\":" +
        info(0) + "},\"KHR_materials_iridescence\":{\"iridescenceFactor\":1,\"iridescenceTexture\":" + info(1) +
        ",\"iridescenceIor\":1.8,\"iridescenceThicknessMinimum\":500,\"iridescenceThicknessMaximum\":200,"
        "\"iridescenceThicknessTexture\":" +
        info(2) + "}");
    EXPECT_EQ(m.anisotropy, (Anisotropy{0.5f, -7, ref(0)}));
    EXPECT_EQ(m.iridescence, (Iridescence{1, 1.8f, 500, 200, ref(1), ref(2)}));
}

TEST(MaterialExtensions, SpecularTexturesHaveSlots) {
    const Material m = material("\"KHR_materials_specular\":{\"specularFactor\":0.5,\"specularTexture\":" + info(1) +
                                ",\"specularColorFactor\":[1,2,3],\"specularColorTexture\":" + info(2) + "}");
    EXPECT_EQ(m.texture(TextureSlot::kSpecular), ref(1));
    EXPECT_EQ(m.texture(TextureSlot::kSpecularColor), ref(2));
    const Material g = material("\"KHR_materials_pbrSpecularGlossiness\":{\"specularGlossinessTexture\":" + info(3) +
                                ",\"diffuseTexture\":" + info(4) + "}");
    EXPECT_EQ(g.model, ShadingModel::kSpecularGlossiness);
    EXPECT_EQ(g.texture(TextureSlot::kSpecularColor), ref(3));
    EXPECT_EQ(g.texture(TextureSlot::kBaseColor), ref(4));
    EXPECT_EQ(g.roughness, 0);
    EXPECT_EQ(g.specular_color, (Vec3{1, 1, 1}));
}

// The defaults of the extensions' own texts, whether a material has the empty extension or none.
TEST(MaterialExtensions, Defaults) {
    const Material plain;
    EXPECT_EQ(plain.iridescence.ior, 1.3f);
    EXPECT_EQ(plain.iridescence.thickness_at_black, 100);
    EXPECT_EQ(plain.iridescence.thickness_at_white, 400);
    EXPECT_EQ(plain.volume.attenuation_color, (Vec3{1, 1, 1}));
    EXPECT_FALSE(plain.volume.attenuation_distance);
    const Material m = material(
        "\"KHR_materials_clearcoat\":{},\"KHR_materials_sheen\":{},\"KHR_materials_transmission\":{},"
        "\"KHR_materials_volume\":{},\"KHR_materials_anisotropy\":{},\"KHR_materials_iridescence\":{},"
        "\"KHR_materials_dispersion\":{}");
    EXPECT_EQ(m.clearcoat, Clearcoat{});
    EXPECT_EQ(m.sheen, Sheen{});
    EXPECT_EQ(m.transmission, 0);
    EXPECT_EQ(m.volume, Volume{});
    EXPECT_EQ(m.anisotropy, Anisotropy{});
    EXPECT_EQ(m.iridescence, Iridescence{});
    EXPECT_EQ(m.dispersion, 0);
}

TEST(MaterialExtensions, RangesAreKept) {
    const Scene scene = load(
        "\"KHR_materials_clearcoat\":{\"clearcoatFactor\":2,\"clearcoatRoughnessFactor\":-1},\"KHR_materials_volume\":{"
        "\"thicknessFactor\":-3,\"attenuationDistance\":0,\"attenuationColor\":[2,-1,0.5]},\"KHR_materials_"
        "iridescence\":"
        "{\"iridescenceIor\":0.5,\"iridescenceThicknessMinimum\":-4},\"KHR_materials_dispersion\":{\"dispersion\":-1}");
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.clearcoat, (Clearcoat{1, 0, 1, {}, {}, {}}));
    EXPECT_EQ(m.volume, (Volume{0, {}, {}, {1, 0, 0.5f}}));
    EXPECT_EQ(m.iridescence.ior, 1);
    EXPECT_EQ(m.iridescence.thickness_at_black, 0);
    EXPECT_EQ(m.dispersion, 0);
    for (const char* place :
         {"clearcoatFactor: a factor", "clearcoatRoughnessFactor: a factor", "thicknessFactor: a factor",
          "attenuationDistance: a distance", "attenuationColor: a factor", "iridescenceIor: a factor"})
        EXPECT_TRUE(warned(scene, place)) << place;
    const auto error = [](const std::string& extensions) {
        return load_error(gltf_text("\"materials\":[{\"extensions\":{" + extensions + "}}]"));
    };
    EXPECT_NE(error("\"KHR_materials_sheen\":{\"sheenColorFactor\":[1,1]}").find("sheenColorFactor"),
              std::string::npos);
    EXPECT_NE(error("\"KHR_materials_anisotropy\":{\"anisotropyTexture\":{\"index\":3}}").find("texture"),
              std::string::npos);
    EXPECT_NE(error("\"KHR_materials_volume\":{\"attenuationDistance\":1e60}").find("attenuationDistance"),
              std::string::npos);
    EXPECT_NE(error("\"KHR_materials_transmission\":7"), "");
}

TEST(MaterialExtensions, WhatIsNotDrawnIsNamedOnceAndNotRefused) {
    const std::string two =
        "\"KHR_materials_clearcoat\":{},\"KHR_materials_ior\":{}}},{\"extensions\":{\"KHR_materials_clearcoat\":{"
        "}";
    const Scene scene = load(two,
                             ",\"extensionsUsed\":[\"KHR_materials_clearcoat\",\"KHR_materials_ior\"],"
                             "\"extensionsRequired\":[\"KHR_materials_clearcoat\"]");
    ASSERT_EQ(scene.materials.size(), 2u);
    std::size_t named = 0;
    for (const std::string& warning : scene.warnings) named += warning.find("KHR_materials") != std::string::npos;
    EXPECT_EQ(named, 1u);
    EXPECT_TRUE(warned(scene, "KHR_materials_clearcoat is read, but not drawn yet"));
    EXPECT_TRUE(scene.extensions_ignored.empty());
    EXPECT_EQ(scene.extensions_required, (std::vector<std::string>{"KHR_materials_clearcoat"}));
}

}  // namespace
}  // namespace tessera
