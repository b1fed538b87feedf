// Extensions of glTF beyond the core: instances, variants, specular-glossiness.
#include "gltf_text.h"
#include "test_files.h"

#include <tessera/render.h>

#include <cmath>

namespace tessera {
namespace {

std::string instanced(std::size_t translations, std::size_t scales) {
    std::vector<float> numbers;
    for (const float x : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) numbers.push_back(x);
    for (std::size_t i = 0; i < 3 * translations; ++i) numbers.push_back(static_cast<float>(i));
    for (std::size_t i = 0; i < 3 * scales; ++i) numbers.push_back(2);
    const std::vector<std::uint8_t> buffer = bytes_of(numbers);
    const auto accessor = [](std::size_t offset, std::size_t count) {
        return "{\"bufferView\":0,\"byteOffset\":" + std::to_string(offset) +
               ",\"componentType\":5126,\"type\":\"VEC3\",\"count\":" + std::to_string(count) + "}";
    };
    return gltf_text(
        "\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],\"bufferViews\":[{\"buffer\":0,\"byteLength\":" +
            std::to_string(buffer.size()) + "}],\"accessors\":[" + accessor(0, 3) + "," + accessor(36, translations) +
            "," + accessor(36 + 12 * translations, scales) +
            "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,"
            "\"translation\":[0,0,10],\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{"
            "\"TRANSLATION\":1,\"SCALE\":2,\"_ID\":1}}}}],\"scenes\":[{\"nodes\":[0]}]",
        buffer);
}

TEST(Instancing, InstancesStayInstances) {
    const Scene scene = load_text(instanced(4, 4));
    ASSERT_EQ(scene.nodes.size(), 1u);
    ASSERT_EQ(scene.nodes[0].instances.size(), 4u);
    EXPECT_EQ(scene.nodes[0].instances[2].translation, (Vec3{6, 7, 8}));
    EXPECT_EQ(scene.nodes[0].instances[3].scale, (Vec3{2, 2, 2}));
    // Triangle (0,0,0) (1,0,0) (0,1,0), twice as large, at (0,1,2) to (9,10,11), ten behind.
    const Bounds3 bounds = visible_bounds(scene);
    EXPECT_EQ(bounds.min, (Vec3{0, 1, 12}));
    EXPECT_EQ(bounds.max, (Vec3{11, 12, 21}));
    RenderOptions options;
    options.width = options.height = 32;
    EXPECT_EQ(render(scene, options).stats.triangles, 4u);
    LoadOptions three;
    three.max_triangles = 3;
    EXPECT_NE(load_error(instanced(4, 4), three, ErrorCode::kLimit).find("4 triangles"), std::string::npos);
    EXPECT_NE(load_error(instanced(4, 3)).find("SCALE has 3 elements, others have 4"), std::string::npos);
}

TEST(Instancing, ASkinnedMeshIsNamed) {
    std::string text = instanced(4, 4);
    EXPECT_FALSE(warned(load_text(text), "skinned"));
    text.insert(text.find("\"mesh\":0,"), "\"skin\":0,");
    text.insert(text.find("\"scenes\""), "\"skins\":[{\"joints\":[0]}],");
    EXPECT_TRUE(warned(load_text(text), "/nodes/0: EXT_mesh_gpu_instancing of a skinned mesh has no effect"));
}

TEST(Instancing, ALightStaysAtItsNode) {
    Scene scene = load_text(instanced(4, 4));
    scene.lights.emplace_back();
    scene.nodes[0].light = 0;
    scene.nodes[0].instances[0].translation = {50, 0, 0};
    Scene without = scene;
    without.nodes[0].instances.clear();
    RenderOptions options;
    options.width = options.height = 48;
    options.view.eye = Vec3{0.3f, 0.3f, 14};
    options.view.target = Vec3{0.3f, 0.3f, 10};
    options.exposure_ev = 0.0f;
    options.want_linear = true;
    // The triangle at the node would be lit from the node; one that an instance puts there is lit as it.
    scene.nodes[0].instances[1] = {};
    scene.nodes[0].instances.resize(2);
    EXPECT_EQ(hash_pixels(render(scene, options).linear), hash_pixels(render(without, options).linear));
}

// The same scene with a node for each instance.
TEST(Instancing, ADrawsWhatNodesDraw) {
    if (all_gltf_models().empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    const Scene instanced = load_scene(gltf_model("simple-instancing.glb").string());
    Scene nodes = instanced;
    ASSERT_EQ(nodes.nodes.size(), 1u);
    const std::vector<MeshInstance> instances = std::move(nodes.nodes[0].instances);
    nodes.nodes[0].instances.clear();
    const int mesh = nodes.nodes[0].mesh;
    nodes.nodes[0].mesh = kNone;
    for (const MeshInstance& i : instances) {
        Node node;
        node.mesh = mesh;
        node.translation = i.translation, node.rotation = i.rotation, node.scale = i.scale;
        nodes.nodes[0].children.push_back(static_cast<int>(nodes.nodes.size()));
        nodes.nodes.push_back(node);
    }
    RenderOptions options;
    options.width = 160, options.height = 120;
    const RenderResult a = render(instanced, options), b = render(nodes, options);
    EXPECT_EQ(a.stats.triangles, 1500u);
    EXPECT_EQ(a.stats.color_hash, b.stats.color_hash);
}

TEST(Variants, ChooseMaterials) {
    const std::string text = gltf_text(
        "\"extensions\":{\"KHR_materials_variants\":{\"variants\":[{\"name\":\"red\"},{\"name\":\"blue\"}]}},"
        "\"materials\":[{\"name\":\"a\"},{\"name\":\"b\"},{\"name\":\"c\"}],\"accessors\":[{\"componentType\":5126,"
        "\"type\":\"VEC3\",\"count\":3}],\"meshes\":[{\"primitives\":[{\"material\":0,\"attributes\":{\"POSITION\":0},"
        "\"extensions\":{\"KHR_materials_variants\":{\"mappings\":[{\"material\":2,\"variants\":[1]},{\"material\":1,"
        "\"variants\":[0]}]}}},{\"material\":0,\"attributes\":{\"POSITION\":0}}]}]");
    Scene scene = load_text(text);
    EXPECT_EQ(scene.variants, (std::vector<std::string>{"red", "blue"}));
    EXPECT_EQ(scene.meshes[0].primitives[0].material, 0);
    choose_variant(scene, 1);
    EXPECT_EQ(scene.meshes[0].primitives[0].material, 2);
    EXPECT_EQ(scene.meshes[0].primitives[1].material, 0);
    choose_variant(scene, 0);
    EXPECT_EQ(scene.meshes[0].primitives[0].material, 1);
    EXPECT_NO_THROW(validate(scene));
    // A primitive that one variant leaves alone goes back to its own.
    scene.variants.emplace_back("none");
    choose_variant(scene, 2);
    EXPECT_EQ(scene.meshes[0].primitives[0].material, 0);
    EXPECT_THROW(choose_variant(scene, 3), Error);
    scene.meshes[0].primitives[0].variants.push_back({0, 99});
    EXPECT_THROW(validate(scene), Error);
    std::string wrong = text;
    wrong.replace(wrong.find("\"variants\":[1]"), 14, "\"variants\":[7]");
    EXPECT_NE(load_error(wrong).find("variant"), std::string::npos);
}

Material material(const std::string& extension, const std::string& members) {
    return load_text(gltf_text("\"materials\":[{\"extensions\":{\"" + extension + "\":{" + members + "}}}]"))
        .materials[0];
}

TEST(SpecularGlossiness, IsRead) {
    const Material m =
        material("KHR_materials_pbrSpecularGlossiness",
                 "\"diffuseFactor\":[0.5,0.25,0,0.5],\"specularFactor\":[0.25,0.5,1],\"glossinessFactor\":0.75");
    EXPECT_EQ(m.base_color, (Vec4{0.5f, 0.25f, 0, 0.5f}));
    EXPECT_EQ(m.metallic, 0.0f);
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.model, ShadingModel::kSpecularGlossiness);
    EXPECT_EQ(m.specular_color, (Vec3{0.25f, 0.5f, 1}));
}

TEST(IorAndSpecular, AreRead) {
    EXPECT_EQ(material("KHR_materials_ior", "\"ior\":1.33").ior, 1.33f);
    EXPECT_EQ(material("KHR_materials_ior", "\"ior\":0.5").ior, 1.0f);
    const Material m = material("KHR_materials_specular", "\"specularFactor\":0.5,\"specularColorFactor\":[1,2,0]");
    EXPECT_EQ(m.specular_strength, 0.5f);
    EXPECT_EQ(m.specular_color, (Vec3{1, 2, 0}));
}

// A black dielectric seen from ahead mirrors the light by ((n - 1) / (n + 1))^2: without roughness the whole of a
// uniform surrounding, so the picture's radiance is that reflectance.
TEST(IorAndSpecular, DecideWhatIsReflected) {
    const auto radiance = [](const std::string& extensions) {
        const std::vector<float> corners{-9, -9, 0, 9, -9, 0, 9, 9, 0, -9, -9, 0, 9, 9, 0, -9, 9, 0};
        const std::vector<std::uint8_t> buffer = bytes_of(corners);
        const Scene scene =
            load_text(gltf_text("\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1],"
                                "\"metallicFactor\":0,\"roughnessFactor\":0}," +
                                    ("\"extensions\":{" + extensions) +
                                    "}}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":72}],\"accessors\":[{"
                                    "\"bufferView\":0,\"componentType\":5126,"
                                    "\"type\":\"VEC3\",\"count\":6}],\"meshes\":[{\"primitives\":[{\"material\":0,"
                                    "\"attributes\":{\"POSITION\":0}}]}],"
                                    "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]",
                                buffer));
        RenderOptions options;
        options.width = options.height = 9;
        options.samples = 1;
        options.view.eye = Vec3{0, 0, 5};
        options.view.target = Vec3{0, 0, 0};
        options.view.yfov = 0.1f;
        options.lighting = Lighting::kScene;
        options.ambient = 1.0f;
        options.exposure_ev = 0.0f;
        options.want_linear = true;
        const RenderResult r = render(scene, options);
        const float* middle = r.linear.data<float>() + 4 * (9 * 4 + 4);
        return Vec3{middle[0], middle[1], middle[2]};
    };
    const Vec3 glass = radiance("");
    EXPECT_NEAR(glass.x, 0.04f, 0.007f);  // the fit of ambient light is that exact
    const Vec3 diamond = radiance("\"KHR_materials_ior\":{\"ior\":2.4}");
    EXPECT_NEAR(diamond.x, 0.1696f, 0.007f);
    const Vec3 tinted = radiance(
        "\"KHR_materials_ior\":{\"ior\":2.4},\"KHR_materials_specular\":{\"specularColorFactor\":[1,0.5,0],"
        "\"specularFactor\":0.5}");
    EXPECT_NEAR(tinted.x, 0.0848f, 0.004f);
    EXPECT_NEAR(tinted.y, 0.0424f, 0.004f);
    EXPECT_NEAR(tinted.z, 0.0f, 0.004f);
}

}  // namespace
}  // namespace tessera
