// MTL libraries: factors, texture options, transparency maps, what is missing.
#include "mesh_files.h"
#include "temporary_folder.h"

#include "load/mtl.h"

#include <tessera/image.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace tessera {
namespace {

std::vector<MtlMaterial> parse(const std::string& text) {
    LoadContext context("x.obj", {});
    return read_mtl_text(context, text, "x.mtl");
}

TEST(Mtl, EveryFactor) {
    const auto m = parse(
        "newmtl first one\nKa 0.1 0.2 0.3\nKd 0.4\nKs 0.5 0.6 0.7\nKe 1 2 3\nNs 96.5\nNi 1.45\nd 0.25\nTf 1 0.5 "
        "0\nillum 7\n"
        "newmtl second\n\tkd xyz 0.9505 1 1.089\n\tTr 0.25\n\tPr 0.3\n\tPm 1\nd -halo 0.5\nillum 1");
    ASSERT_EQ(m.size(), 2u);
    EXPECT_EQ(m[0].name, "first one");
    EXPECT_EQ(m[0].ambient, (Vec3{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(m[0].diffuse, (Vec3{0.4f, 0.4f, 0.4f}));
    EXPECT_EQ(m[0].specular, (Vec3{0.5f, 0.6f, 0.7f}));
    EXPECT_EQ(m[0].emission, (Vec3{1, 2, 3}));
    EXPECT_EQ(m[0].shininess, 96.5f);
    EXPECT_EQ(m[0].ior, 1.45f);
    EXPECT_EQ(m[0].opacity, 0.25f);
    EXPECT_EQ(m[0].filter, (Vec3{1, 0.5f, 0}));
    EXPECT_EQ(m[0].illumination, 7);
    EXPECT_FALSE(m[0].roughness);
    EXPECT_NEAR(m[1].diffuse.x, 1, 1e-3);  // D65 is white
    EXPECT_NEAR(m[1].diffuse.y, 1, 1e-3);
    EXPECT_NEAR(m[1].diffuse.z, 1, 1e-3);
    EXPECT_EQ(m[1].opacity, 0.5f);
    EXPECT_EQ(m[1].roughness, 0.3f);
    EXPECT_EQ(m[1].metallic, 1.0f);
    EXPECT_FALSE(m[1].ambient);
}

TEST(Mtl, DCountsWhereTrSaysOtherwise) {
    EXPECT_EQ(parse("newmtl a\nd 1\nTr 1\n")[0].opacity, 1.0f);
    EXPECT_EQ(parse("newmtl a\nTr 1\nd 0.75\n")[0].opacity, 0.75f);
}

TEST(Mtl, TextureOptionsComeBeforeNamesWithBlanks) {
    const auto m = parse(
        "newmtl a\nmap_Kd -o 0.25 0.5 -s 2 3 1 -clamp on -blendu off -texres 256 dir\\my file.png  \n"
        "map_bump -bm 0.5 -imfchan l bumps.png\nmap_d -imfchan M leaf.png\nnorm -bm 2 n.png\nmap_Kd2 x\n");
    ASSERT_EQ(m.size(), 1u);
    EXPECT_EQ(m[0].map_diffuse.file, "dir/my file.png");
    EXPECT_EQ(m[0].map_diffuse.offset, (Vec2{0.25f, 0.5f}));
    EXPECT_EQ(m[0].map_diffuse.scale, (Vec2{2, 3}));
    EXPECT_TRUE(m[0].map_diffuse.clamp);
    EXPECT_EQ(m[0].map_bump.bump, 0.5f);
    EXPECT_EQ(m[0].map_bump.channel, 'l');
    EXPECT_EQ(m[0].map_opacity.channel, 'm');
    EXPECT_EQ(m[0].map_normal.bump, 2.0f);
}

TEST(Mtl, AStatementWithABadNumberIsLeftOutAndNamed) {
    LoadContext context("x.obj", {});
    const auto m = read_mtl_text(
        context, "newmtl a\nKd red\nNs nan\nd x\nTr 0.25\nmap_Kd -s x y a.png\nKs 1 1 1\nnewmtl b\nKd 0 0 1\n",
        "x.mtl");
    ASSERT_EQ(m.size(), 2u);
    EXPECT_EQ(m[0].diffuse, MtlMaterial().diffuse);
    EXPECT_EQ(m[0].shininess, MtlMaterial().shininess);
    EXPECT_EQ(m[0].opacity, 0.75f);
    EXPECT_EQ(m[0].map_diffuse.file, "");
    EXPECT_EQ(m[0].specular, (Vec3{1, 1, 1}));
    EXPECT_EQ(m[1].diffuse, (Vec3{0, 0, 1}));
    ASSERT_EQ(context.warnings().size(), 4u);
    EXPECT_EQ(context.warnings()[0], "x.mtl, line 2: \"red\" is no number; the statement is left out");
    EXPECT_EQ(context.warnings()[1], "x.mtl, line 3: \"nan\" is no number; the statement is left out");
}

class MtlFiles : public testing::Test {
  protected:
    void write(const std::string& name, const std::string& text) {
        std::ofstream(folder.path() / name, std::ios::binary) << text;
    }
    void write(const std::string& name, const Image& image) { write_image((folder.path() / name).string(), image); }
    Scene load(const std::string& statements) {
        write("m.mtl", statements);
        return load_text("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n",
                         "x.obj", {}, folder.path().string());
    }
    static const Material& material(const Scene& scene) {
        return scene.materials.at(static_cast<std::size_t>(scene.meshes.at(0).primitives.at(0).material));
    }
    static Image image(int width, int height, const std::vector<std::uint8_t>& rgba) {
        Image made(width, height, PixelFormat::kRgba8);
        std::copy(rgba.begin(), rgba.end(), made.data<std::uint8_t>());
        return made;
    }
    TemporaryFolder folder;
};

TEST_F(MtlFiles, ModelsFollowIllum) {
    EXPECT_EQ(material(load("newmtl m\nillum 0")).model, ShadingModel::kUnlit);
    EXPECT_EQ(material(load("newmtl m\nillum 1")).model, ShadingModel::kLambert);
    EXPECT_EQ(material(load("newmtl m\nillum 2")).model, ShadingModel::kBlinnPhong);
    EXPECT_EQ(material(load("newmtl m\nPm 0.5")).model, ShadingModel::kMetallicRoughness);
    const Material m = material(load("newmtl m\nKd 0.1 0.2 0.3\nKs 1 1 1\nNs 10\nd 0.5"));
    EXPECT_EQ(m.diffuse, (Vec3{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(m.ambient, m.diffuse);  // Ka is not there
    EXPECT_EQ(m.specular, (Vec3{1, 1, 1}));
    EXPECT_EQ(m.shininess, 10.0f);
    EXPECT_EQ(m.base_color, (Vec4{0.1f, 0.2f, 0.3f, 0.5f}));
    EXPECT_EQ(m.alpha_mode, AlphaMode::kBlend);
}

TEST_F(MtlFiles, TexturesAreCountedFromTheTop) {
    write("c.png", image(1, 1, {10, 20, 30, 255}));
    const Scene scene = load("newmtl m\nmap_Kd -s 2 4 -o 0.25 0.5 -clamp on textures\\c.png");  // only beside the scene
    const TextureRef& ref = material(scene).texture(TextureSlot::kBaseColor);
    ASSERT_NE(ref.texture, kNone);
    EXPECT_EQ(ref.scale, (Vec2{2, 4}));
    EXPECT_EQ(ref.offset, (Vec2{0.25f, -3.5f}));  // 1 - (4 (1 - v) + 0.5) = 4 v - 3.5
    const Texture& texture = scene.textures[static_cast<std::size_t>(ref.texture)];
    EXPECT_EQ(scene.samplers[static_cast<std::size_t>(texture.sampler)].wrap_s, Wrap::kClamp);
    ASSERT_TRUE(scene.pictures[static_cast<std::size_t>(texture.picture)].pixels);
    EXPECT_EQ(scene.pictures[static_cast<std::size_t>(texture.picture)].pixels->data<std::uint8_t>()[1], 20);
}

TEST_F(MtlFiles, OpacityMapsBecomeAlpha) {
    write("c.png", image(2, 1, {10, 20, 30, 255, 40, 50, 60, 255}));
    write("cut.png", image(2, 1, {255, 255, 255, 255, 0, 0, 0, 255}));
    write("soft.png", image(2, 2, {9, 9, 9, 128, 9, 9, 9, 255, 9, 9, 9, 255, 9, 9, 9, 255}));
    const auto alpha = [](const Scene& scene, std::size_t pixel) {
        const int texture = material(scene).texture(TextureSlot::kBaseColor).texture;
        const int picture = scene.textures.at(static_cast<std::size_t>(texture)).picture;
        return static_cast<int>(
            scene.pictures.at(static_cast<std::size_t>(picture)).pixels->data<std::uint8_t>()[4 * pixel + 3]);
    };
    const Scene cut = load("newmtl m\nmap_Kd c.png\nmap_d cut.png");
    EXPECT_EQ(material(cut).alpha_mode, AlphaMode::kMask);
    EXPECT_EQ(alpha(cut, 0), 255);
    EXPECT_EQ(alpha(cut, 1), 0);
    const Scene soft = load("newmtl m\nmap_d soft.png");  // by its own alpha, over white
    EXPECT_EQ(material(soft).alpha_mode, AlphaMode::kBlend);
    EXPECT_EQ(alpha(soft, 0), 128);
    const Scene all = load("newmtl m\nmap_Kd c.png\nmap_d -imfchan m c.png");
    EXPECT_EQ(material(all).alpha_mode, AlphaMode::kOpaque);
}

TEST_F(MtlFiles, RoughnessAndMetalShareATexture) {
    write("r.png", image(1, 1, {200, 200, 200, 255}));
    write("m.png", image(1, 1, {40, 40, 40, 255}));
    const Scene scene = load("newmtl m\nmap_Pr r.png\nmap_Pm m.png");
    EXPECT_EQ(material(scene).model, ShadingModel::kMetallicRoughness);
    EXPECT_EQ(material(scene).roughness, 1.0f);
    EXPECT_EQ(material(scene).metallic, 1.0f);
    const int texture = material(scene).texture(TextureSlot::kMetallicRoughness).texture;
    const Picture& picture =
        scene.pictures.at(static_cast<std::size_t>(scene.textures.at(static_cast<std::size_t>(texture)).picture));
    EXPECT_EQ(picture.pixels->data<std::uint8_t>()[1], 200);
    EXPECT_EQ(picture.pixels->data<std::uint8_t>()[2], 40);
}

// map_Ks is a colour, map_Ns a number that the shininess is multiplied by.
TEST_F(MtlFiles, HighlightsHaveMaps) {
    write("ks.png", image(1, 1, {10, 20, 30, 77}));
    write("ns.png", image(1, 1, {200, 100, 50, 255}));
    const auto texel = [](const Scene& scene, TextureSlot slot) -> const std::uint8_t* {
        const int texture = material(scene).texture(slot).texture;
        if (texture == kNone) return nullptr;
        const int picture = scene.textures.at(static_cast<std::size_t>(texture)).picture;
        return scene.pictures.at(static_cast<std::size_t>(picture)).pixels->data<std::uint8_t>();
    };
    const Scene scene = load("newmtl m\nKs 1 0.5 0.25\nNs 50\nmap_Ks -s 2 2 ks.png\nmap_Ns -imfchan r ns.png\n");
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    EXPECT_EQ(material(scene).specular, (Vec3{1, 0.5f, 0.25f}));
    EXPECT_EQ(material(scene).shininess, 50);
    EXPECT_EQ(material(scene).texture(TextureSlot::kSpecularColor).scale, (Vec2{2, 2}));
    ASSERT_NE(texel(scene, TextureSlot::kSpecularColor), nullptr);
    EXPECT_EQ(texel(scene, TextureSlot::kSpecularColor)[1], 20);
    ASSERT_NE(texel(scene, TextureSlot::kSpecular), nullptr);
    EXPECT_EQ(texel(scene, TextureSlot::kSpecular)[3], 200);
    // Not where there is no highlight of Phong.
    for (const char* other : {"illum 1\n", "illum 0\n", "Pm 1\n"})
        EXPECT_EQ(texel(load(std::string("newmtl m\nmap_Ks ks.png\n") + other), TextureSlot::kSpecularColor), nullptr);
}

// 4, 6, 7 and 9 are the illumination models of glass (5 and 8 reflect, 3 and below do neither).
TEST_F(MtlFiles, GlassIsTransmission) {
    for (int illum = 0; illum <= 10; ++illum) {
        const Scene scene = load("newmtl m\nKd 1 1 1\nTf 0.25 0.5 0\nNi 1.33\nillum " + std::to_string(illum) + "\n");
        const Material& m = material(scene);
        const bool glass = illum == 4 || illum == 6 || illum == 7 || illum == 9;
        EXPECT_EQ(m.transmission, glass ? 0.5f : 0.0f) << illum;
        EXPECT_EQ(m.ior, glass ? 1.33f : 1.5f) << illum;
        EXPECT_EQ(m.base_color, (glass ? Vec4{0.5f, 1, 0, 1} : Vec4{1, 1, 1, 1})) << illum;
        EXPECT_EQ(m.volume.thickness, illum == 6 || illum == 7 ? 1.0f : 0.0f) << illum;
        EXPECT_EQ(m.mirror, illum >= 3 && illum <= 7 ? m.specular : (Vec3{0, 0, 0})) << illum;
        EXPECT_TRUE(scene.warnings.empty()) << illum;
    }
    EXPECT_EQ(material(load("newmtl m\nillum 7\n")).transmission, 1);
    EXPECT_EQ(material(load("newmtl m\nTf 0 0 0\nillum 7\nNi 0.5\n")).transmission, 0);
}

// A factor is 1 for the sake of a map only where the map is there.
TEST_F(MtlFiles, MapsThatAreMissingOrDamagedChangeNoFactor) {
    write("good.png", image(1, 1, {9, 9, 9, 255}));
    write("damaged.png", "no picture");
    for (const char* name : {"gone.png", "damaged.png"}) {
        const Scene scene = load(std::string("newmtl m\nPr 0.25\nmap_Ke ") + name + "\nmap_Pm " + name + "\n");
        EXPECT_EQ(material(scene).emissive, (Vec3{0, 0, 0})) << name;
        EXPECT_EQ(material(scene).metallic, 0) << name;
        EXPECT_EQ(material(scene).roughness, 0.25f) << name;
        EXPECT_EQ(material(load(std::string("newmtl m\nPm 0.25\nmap_Pr ") + name)).roughness, 0.5f) << name;
        EXPECT_EQ(material(load(std::string("newmtl m\nKe 1 2 3\nmap_Ke ") + name)).emissive, (Vec3{1, 2, 3}));
    }
    const Scene good = load("newmtl m\nmap_Ke good.png\nmap_Pm good.png\nmap_Pr good.png\n");
    EXPECT_EQ(material(good).emissive, (Vec3{1, 1, 1}));
    EXPECT_EQ(material(good).metallic, 1);
    EXPECT_EQ(material(good).roughness, 1);
}

TEST_F(MtlFiles, MapsThatShareATextureShareItsOptions) {
    write("c.png", image(1, 1, {9, 9, 9, 255}));
    const auto count = [](const Scene& scene) {
        return std::count_if(scene.warnings.begin(), scene.warnings.end(),
                             [](const std::string& w) { return w.find("map_d are not those") != std::string::npos; });
    };
    EXPECT_EQ(count(load("newmtl m\nmap_Kd -s 2 2 c.png\nmap_d c.png\nnewmtl n\nmap_Kd -o 1 c.png\nmap_d c.png\n")), 1);
    EXPECT_EQ(count(load("newmtl m\nmap_Kd -s 2 2 c.png\nmap_d -s 2 2 c.png\n")), 0);
    EXPECT_EQ(count(load("newmtl m\nmap_d -s 2 2 c.png\n")), 0);
}

TEST_F(MtlFiles, ATextureWithoutCoordinatesIsNamedOnce) {
    write("c.png", image(1, 1, {9, 9, 9, 255}));
    write("m.mtl", "newmtl m\nmap_Kd c.png\n");
    const std::string shape = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\n";
    const Scene scene = load_text(shape + "o a\nf 1 2 3\no b\nf 1 3 2\n", "x.obj", {}, folder.path().string());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("\"m\" has a texture over the texture coordinates 0"), std::string::npos);
}

TEST_F(MtlFiles, LibrariesMayHaveBlanksOrBeSeveral) {
    write("a.mtl", "newmtl a\nKd 1 0 0\n");
    write("b.mtl", "newmtl b\nKd 0 1 0\n");
    write("my lib.mtl", "newmtl c\nKd 0 0 1\n");
    const std::string shape = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl ";
    for (const auto& [library, name] : {std::pair("a.mtl b.mtl", "b"), {"my lib.mtl", "c"}}) {
        const Scene scene = load_text(std::string("mtllib ") + library + "\n" + shape + name + "\nf 1 2 3\n", "x.obj",
                                      {}, folder.path().string());
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        EXPECT_EQ(material(scene).name, name);
    }
}

TEST_F(MtlFiles, WhatIsMissingIsAWarning) {
    const Scene scene =
        load_text("mtllib none.mtl\nmtllib ../../../etc/passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl what\nf 1 2 3\n",
                  "x.obj", {}, folder.path().string());
    ASSERT_EQ(scene.warnings.size(), 3u);
    EXPECT_NE(scene.warnings[0].find("none.mtl"), std::string::npos);
    EXPECT_NE(scene.warnings[1].find("leaves the scene's folder"), std::string::npos);
    EXPECT_NE(scene.warnings[2].find("\"what\" is not defined"), std::string::npos);
    write("broken.png", "no picture");
    const Scene broken = load("newmtl m\nmap_Kd broken.png\nmap_Ke gone.png\nbump b.png\n");
    EXPECT_EQ(broken.meshes.size(), 1u);
    ASSERT_GE(broken.warnings.size(), 3u);
}

}  // namespace
}  // namespace tessera
