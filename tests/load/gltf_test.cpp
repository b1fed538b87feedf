// What the reader makes of each part of a document: nodes, scenes, materials, lights, cameras, skins,
// morphs, animations, extensions, limits.
#include "gltf_text.h"

#include "test_files.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tessera {
namespace {

TEST(Sniffing, ContentDecides) {
    EXPECT_EQ(load_error("\xef\xbb\xbf \n" + gltf_text("")), "");
    EXPECT_NE(load_error("").find("empty"), std::string::npos);
    EXPECT_NE(load_error("[1]"), "");
    EXPECT_NE(load_error("{"), "");
    const std::string fbx = "Kaydara FBX Binary";
    try {
        load_scene_from_memory(as_file(fbx), "", {}, "a.fbx");
        FAIL() << "FBX is not read";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kInput);
        EXPECT_EQ(error.message().substr(0, 39), "not a scene format that Tessera reads (");
    }
    EXPECT_THROW(load_scene("no such file.gltf"), Error);
}

TEST(Header, VersionsAndExtensions) {
    EXPECT_NE(load_error(R"({"asset":{"version":"1.0"}})"), "");
    EXPECT_NE(load_error(R"({"asset":{"version":"3.0"}})"), "");
    EXPECT_NE(load_error(R"({"asset":{}})"), "");
    EXPECT_NE(load_error(R"({})"), "");
    EXPECT_EQ(load_error(R"({"asset":{"version":"2.7"}})"), "");
    EXPECT_NE(load_error(gltf_text(R"("extensionsRequired":["EXT_none_such"])")).find("EXT_none_such"),
              std::string::npos);
    EXPECT_EQ(load_error(gltf_text(R"("extensionsRequired":["KHR_materials_unlit"])")), "");

    const Scene scene = load_text(
        gltf_text(R"("extensionsUsed":["EXT_a","EXT_b","EXT_a"],"materials":[{"extensions":{"EXT_a":{},"EXT_c":{}}}],)"
                  R"("extras":{"k":[1, 2]})"));
    EXPECT_EQ(scene.extensions_ignored, (std::vector<std::string>{"EXT_a", "EXT_b", "EXT_c"}));
    EXPECT_EQ(std::count_if(scene.warnings.begin(), scene.warnings.end(),
                            [](const std::string& w) { return w.find("EXT_a") != std::string::npos; }),
              1);
    EXPECT_EQ(scene.extras, R"({"k":[1,2]})");
}

TEST(Nodes, PlacementAndHierarchy) {
    const Scene scene = load_text(gltf_text(
        R"("scene":1,"scenes":[{},{"nodes":[0]}],"nodes":[{"name":"a","children":[1,2],"extras":"x"},)"
        R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]},{"translation":[1,2,3],"rotation":[0,2,0,0],"scale":[4,5,6]}])"));
    EXPECT_EQ(scene.active_scene, 1);
    EXPECT_EQ(scene.nodes[0].children, (std::vector<int>{1, 2}));
    EXPECT_EQ(scene.nodes[0].extras, "\"x\"");
    ASSERT_TRUE(scene.nodes[1].matrix);
    EXPECT_EQ((*scene.nodes[1].matrix)(1, 3), 6);
    EXPECT_EQ(scene.nodes[2].translation, (Vec3{1, 2, 3}));
    EXPECT_EQ(scene.nodes[2].rotation, (Quat{0, 1, 0, 0}));
    EXPECT_TRUE(warned(scene, "/nodes/2/rotation"));
    EXPECT_EQ(scene.nodes[2].scale, (Vec3{4, 5, 6}));
}

TEST(Nodes, MustBeAForest) {
    const auto error = [](const std::string& nodes, const std::string& roots = "0") {
        return load_error(gltf_text("\"scenes\":[{\"nodes\":[" + roots + "]}],\"nodes\":[" + nodes + "]"));
    };
    EXPECT_EQ(error(R"({"children":[1]},{})"), "");
    EXPECT_NE(error(R"({"children":[0]})"), "");
    EXPECT_NE(error(R"({"children":[1]},{"children":[2]},{"children":[1]})"), "");
    EXPECT_NE(error(R"({},{"children":[2]},{"children":[1]})").find("its own ancestor"), std::string::npos);
    EXPECT_NE(error(R"({"children":[1,1]},{})").find("two parents"), std::string::npos);
    EXPECT_NE(error(R"({"children":[7]},{})"), "");
    EXPECT_NE(error("{}", "0,0").find("drawn twice"), std::string::npos);
    EXPECT_NE(error(R"({"children":[1]},{"children":[2]},{})", "0,2").find("drawn twice"), std::string::npos);
    EXPECT_EQ(error(R"({"children":[1]},{"children":[2]},{})", "1"), "");
}

TEST(Materials, FactorsTexturesAndTransforms) {
    const Scene scene = load_text(
        gltf_text(
            R"("samplers":[{"magFilter":9728,"minFilter":9985,"wrapS":33071,"wrapT":33648}],"images":[{"uri":"a.png"}],)"
            R"("textures":[{"sampler":0,"source":0}],"materials":[{"name":"m","pbrMetallicRoughness":{)"
            R"("baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0.5,"roughnessFactor":7,"metallicRoughnessTexture":{"index":0}},)"
            R"("normalTexture":{"index":0,"texCoord":1,"scale":-2},"occlusionTexture":{"index":0,"strength":0.25},)"
            R"("emissiveFactor":[0,0.5,1],"emissiveTexture":{"index":0,"texCoord":3,"extensions":{"KHR_texture_transform":)"
            R"({"offset":[0.5,-1],"rotation":1.5,"scale":[2,3],"texCoord":2}}},"alphaMode":"MASK","alphaCutoff":0.75,)"
            R"("doubleSided":true,"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}}},)"
            R"({"alphaMode":"BLEND","extensions":{"KHR_materials_unlit":{}}},{}])"),
        {.load_pictures = false});
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.model, ShadingModel::kMetallicRoughness);
    EXPECT_EQ(m.base_color, (Vec4{0.1f, 0.2f, 0.3f, 0.4f}));
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.roughness, 1.0f);
    EXPECT_TRUE(warned(scene, "/materials/0/pbrMetallicRoughness/roughnessFactor"));
    EXPECT_EQ(m.texture(TextureSlot::kBaseColor).texture, kNone);
    EXPECT_EQ(m.texture(TextureSlot::kMetallicRoughness).texture, 0);
    EXPECT_EQ(m.texture(TextureSlot::kNormal).uv_set, 1);
    EXPECT_EQ(m.normal_scale, -2);
    EXPECT_EQ(m.occlusion_strength, 0.25f);
    EXPECT_EQ(m.texture(TextureSlot::kEmissive), (TextureRef{0, 2, {0.5f, -1}, {2, 3}, 1.5f}));
    EXPECT_EQ(m.emissive, (Vec3{0, 0.5f, 1}));
    EXPECT_EQ(m.emissive_strength, 8);
    EXPECT_EQ(m.alpha_mode, AlphaMode::kMask);
    EXPECT_EQ(m.alpha_cutoff, 0.75f);
    EXPECT_TRUE(m.double_sided);
    EXPECT_EQ(scene.materials[1].model, ShadingModel::kUnlit);
    EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::kBlend);
    EXPECT_EQ(scene.materials[2].metallic, 1);
    const Sampler& s = scene.samplers[0];
    EXPECT_EQ(s.mag_filter, Filter::kNearest);
    EXPECT_EQ(s.min_filter, Filter::kLinear);
    EXPECT_EQ(s.mip_filter, MipFilter::kNearest);
    EXPECT_EQ(s.wrap_s, Wrap::kClamp);
    EXPECT_EQ(s.wrap_t, Wrap::kMirror);
}

TEST(Materials, Phong) {
    const Scene scene = load_text(gltf_text(
        R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4]},"emissiveFactor":[1,1,1],)"
        R"("extensions":{"TESSERA_materials_phong":{"model":"blinn-phong","ambient":[1,2,3],"specular":[0.5,0.5,0.5],)"
        R"("shininess":80,"emission":[4,5,6]}}},{"extensions":{"TESSERA_materials_phong":{"model":"lambert","diffuse":[2,0,0]}}},)"
        R"({"extensions":{"TESSERA_materials_phong":{}}}])"));
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.model, ShadingModel::kBlinnPhong);
    EXPECT_EQ(m.ambient, (Vec3{1, 2, 3}));
    EXPECT_EQ(m.diffuse, (Vec3{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(m.specular, (Vec3{0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(m.shininess, 80);
    EXPECT_EQ(m.emissive, (Vec3{4, 5, 6}));
    EXPECT_EQ(m.base_color.w, 0.4f);
    EXPECT_EQ(scene.materials[1].model, ShadingModel::kLambert);
    EXPECT_EQ(scene.materials[1].diffuse, (Vec3{2, 0, 0}));
    EXPECT_EQ(scene.materials[2].model, ShadingModel::kPhong);
    EXPECT_NE(load_error(gltf_text(R"("materials":[{"extensions":{"TESSERA_materials_phong":{"model":"toon"}}}])")),
              "");
}

TEST(Materials, ATextureWithoutCoordinatesIsNamedOnce) {
    const auto load_with = [](const std::string& attributes, const std::string& set) {
        return load_text(
            gltf_text(
                R"("images":[{"uri":"data:,"}],"textures":[{"source":0}],"materials":[{"name":"wood","emissiveTexture":{)"
                R"("index":0,"texCoord":)" +
                    set +
                    R"(}}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[)"
                    R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":3},)"
                    R"({"bufferView":0,"componentType":5126,"type":"VEC2","count":3}],"meshes":[{"primitives":[)"
                    R"({"material":0,"attributes":{"POSITION":0)" +
                    attributes + R"(}},{"material":0,"attributes":{"POSITION":0)" + attributes + "}}]}]",
                std::vector<std::uint8_t>(36)),
            {.load_pictures = false});
    };
    const std::string reason = "material 0 \"wood\" has a texture over the texture coordinates 1";
    const Scene scene = load_with(R"(,"TEXCOORD_0":1)", "1");
    EXPECT_EQ(std::count_if(scene.warnings.begin(), scene.warnings.end(),
                            [&](const std::string& w) { return w.find(reason) != std::string::npos; }),
              1);
    EXPECT_TRUE(warned(load_with("", "0"), "the texture coordinates 0"));
    EXPECT_FALSE(warned(load_with(R"(,"TEXCOORD_0":1)", "0"), "texture coordinates"));
}

// The example of docs/scene-format.md is a file that loads.
TEST(Materials, TheDocumentedExampleLoads) {
    std::ifstream page(std::string(TESSERA_SOURCE_DIR) + "/docs/scene-format.md");
    const std::string text((std::istreambuf_iterator<char>(page)), std::istreambuf_iterator<char>());
    const std::size_t begin = text.find("```json\n"), end = text.find("```", begin + 8);
    ASSERT_NE(end, std::string::npos);
    const Scene scene = load_text(text.substr(begin + 8, end - begin - 8));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.materials.at(0).model, ShadingModel::kBlinnPhong);
    EXPECT_EQ(scene.meshes.at(0).primitives.at(0).positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(scene.lights.at(0).intensity, 60);
    EXPECT_EQ(scene.nodes.at(1).light, 0);
}

TEST(Lights, TypesAndUnknownOnes) {
    const Scene scene = load_text(gltf_text(
        R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"area"},{"type":"spot","color":[1,0.5,0],"intensity":3,)"
        R"("range":9,"spot":{"innerConeAngle":0.1,"outerConeAngle":0.2}},{"type":"directional","intensity":-1}]}},)"
        R"("nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}}},{"extensions":{"KHR_lights_punctual":{"light":1}}}])"));
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.nodes[0].light, kNone);
    EXPECT_EQ(scene.nodes[1].light, 0);
    EXPECT_EQ(scene.lights[0].type, Light::Type::kSpot);
    EXPECT_EQ(scene.lights[0].color, (Vec3{1, 0.5f, 0}));
    EXPECT_EQ(scene.lights[0].range, 9.0f);
    EXPECT_EQ(scene.lights[0].inner_cone, 0.1f);
    EXPECT_EQ(scene.lights[0].outer_cone, 0.2f);
    EXPECT_EQ(scene.lights[1].intensity, 0);
    EXPECT_NE(load_error(gltf_text(R"("nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}}}])")), "");
}

TEST(Cameras, KindsAndBadOnes) {
    const Scene scene = load_text(
        gltf_text(R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.5}},)"
                  R"({"type":"orthographic","orthographic":{"xmag":2,"ymag":3,"znear":0,"zfar":10}},)"
                  R"({"type":"perspective","perspective":{"yfov":4,"znear":1,"zfar":2,"aspectRatio":1.5}}])"));
    EXPECT_FALSE(scene.cameras[0].zfar);
    EXPECT_FALSE(scene.cameras[0].aspect);
    EXPECT_EQ(scene.cameras[1].type, Camera::Type::kOrthographic);
    EXPECT_EQ(scene.cameras[1].ymag, 3);
    EXPECT_LT(scene.cameras[2].yfov, 3.14159f);
    for (const char* lens : {R"("yfov":0,"znear":1)", R"("yfov":1,"znear":0)", R"("yfov":1,"znear":1,"zfar":1)",
                             R"("yfov":1,"znear":1,"aspectRatio":0)", R"("yfov":1)", R"("yfov":1e99,"znear":1)"})
        EXPECT_NE(
            load_error(gltf_text(R"("cameras":[{"type":"perspective","perspective":{)" + std::string(lens) + "}}]")),
            "")
            << lens;
}

// Three vertices with everything: positions at 0, normals at 36, weights at 72, joints (bytes) at 120.
std::vector<std::uint8_t> skinned_buffer() {
    std::vector<std::uint8_t> buffer = bytes_of<float>(
        {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0});
    for (const int joint : {1, 200, 200, 200, 0, 1, 200, 200, 0, 200, 200, 200})
        buffer.push_back(static_cast<std::uint8_t>(joint));
    return buffer;
}

std::string skinned_text(const std::string& joints, const std::string& more = {}) {
    return gltf_text(
        R"("scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0},{},{}],"skins":[{"joints":[)" + joints +
            R"(]}],"meshes":[{"weights":[0.5],"extras":{"targetNames":["up"]},"primitives":[{"attributes":{"POSITION":0,)"
            R"("NORMAL":1,"WEIGHTS_0":2,"JOINTS_0":3},"targets":[{"POSITION":1}]}]}],"bufferViews":[{"buffer":0,)"
            R"("byteLength":132}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
            R"({"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"},)"
            R"({"bufferView":0,"byteOffset":72,"componentType":5126,"count":3,"type":"VEC4"},)"
            R"({"bufferView":0,"byteOffset":120,"componentType":5121,"count":3,"type":"VEC4"}])" +
            more,
        skinned_buffer());
}

TEST(Meshes, SkinsAndMorphTargets) {
    const Scene scene = load_text(skinned_text("1,2"));
    const Primitive& p = scene.meshes[0].primitives[0];
    // Joint numbers of weight zero mean nothing.
    EXPECT_EQ(p.joints[0][0], (std::array<std::uint16_t, 4>{1, 0, 0, 0}));
    EXPECT_EQ(p.joints[0][1], (std::array<std::uint16_t, 4>{0, 1, 0, 0}));
    EXPECT_EQ(p.weights[0][1], (Vec4{0.5f, 0.5f, 0, 0}));
    EXPECT_EQ(p.targets.at(0).positions, p.normals);
    EXPECT_EQ(scene.meshes[0].weights, (std::vector<float>{0.5f}));
    EXPECT_EQ(scene.meshes[0].extras, R"({"targetNames":["up"]})");
    EXPECT_NE(load_error(skinned_text("1")).find("the mesh uses joint 1, the skin has 1"), std::string::npos);
    EXPECT_NE(load_error(skinned_text("")), "");
    EXPECT_NE(load_error(skinned_text("1,3")), "");
}

TEST(Meshes, IndicesAndColors) {
    std::vector<std::uint8_t> buffer = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
    for (const int byte : {255, 0, 51, 0, 0, 255, 0, 0, 0, 0, 0, 0, 2, 1, 0})
        buffer.push_back(static_cast<std::uint8_t>(byte));
    const auto text = [&](const std::string& indices, const std::string& extra = {}) {
        return gltf_text(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1,"TANGENT":3,"HUE":0},"indices":2)" +
                extra +
                R"(}]}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12,)"
                R"("byteStride":4},{"buffer":0,"byteOffset":48,"byteLength":3}],"accessors":[{"bufferView":0,)"
                R"("componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5121,"normalized":true,)"
                R"("count":3,"type":"VEC3"},{"bufferView":2,"componentType":5121,"type":"SCALAR","count":)" +
                indices + R"(},{"componentType":5126,"count":3,"type":"VEC4"}])",
            buffer);
    };
    const Scene scene = load_text(text("3"));
    const Primitive& p = scene.meshes[0].primitives[0];
    EXPECT_EQ(p.indices, (std::vector<std::uint32_t>{2, 1, 0}));
    EXPECT_EQ(p.colors.at(0)[0], (Vec4{1, 0, 0.2f, 1}));
    EXPECT_EQ(p.colors.at(0)[1], (Vec4{0, 1, 0, 1}));
    EXPECT_TRUE(p.tangents.empty()) << "without normals, tangents are ignored";
    EXPECT_TRUE(warned(scene, "HUE"));
    EXPECT_NE(load_error(text("4")), "");
    EXPECT_NE(load_error(text("3", ",\"mode\":7")), "");
    EXPECT_NE(load_error(text("3", ",\"material\":0")), "");
    buffer.back() = 3;
    EXPECT_NE(load_error(text("3")).find("/meshes/0/primitives/0/indices: index 3 of 3 vertices"), std::string::npos);
}

TEST(Animations, ChannelsAndKeys) {
    // Times 0 1 1 2 at 0, translations of four keys at 16.
    const std::vector<std::uint8_t> buffer = bytes_of<float>({0, 1, 1, 2, 0, 0, 0, 1, 1, 1, 9, 9, 9, 2, 2, 2});
    const auto text = [&](const std::string& channel, const std::string& keys = "4") {
        return gltf_text(R"("nodes":[{}],"animations":[{"name":"go","samplers":[{"input":0,"output":1}],"channels":[)" +
                             channel +
                             R"(]}],"bufferViews":[{"buffer":0,"byteLength":64}],"accessors":[{"bufferView":0,)"
                             R"("componentType":5126,"count":4,"type":"SCALAR"},{"bufferView":0,"byteOffset":16,)"
                             R"("componentType":5126,"type":"VEC3","count":)" +
                             keys + "}]",
                         buffer);
    };
    const std::string translate = R"({"sampler":0,"target":{"node":0,"path":"translation"}})";
    const Scene scene = load_text(text(translate));
    const AnimationSampler& sampler = scene.animations[0].samplers[0];
    EXPECT_EQ(sampler.times, (std::vector<float>{0, 1, 2}));
    EXPECT_EQ(sampler.values, (std::vector<float>{0, 0, 0, 1, 1, 1, 2, 2, 2}));
    EXPECT_TRUE(warned(scene, "1 keys are ignored"));
    EXPECT_EQ(scene.animations[0].channels.size(), 1u);
    EXPECT_NE(load_error(text(translate, "3")), "");
    EXPECT_NE(load_error(text(R"({"sampler":1,"target":{"node":0,"path":"translation"}})")), "");
    EXPECT_NE(load_error(text(R"({"sampler":0,"target":{"node":1,"path":"translation"}})")), "");
    EXPECT_NE(load_error(text(R"({"sampler":0,"target":{"node":0,"path":"rotation"}})")), "");
    EXPECT_EQ(load_text(text(R"({"sampler":0,"target":{"node":0,"path":"pointer"}})")).animations[0].channels.size(),
              0u);
    EXPECT_EQ(load_text(text(R"({"sampler":0,"target":{"path":"scale"}})")).animations[0].channels.size(), 0u);
}

TEST(Limits, TrianglesCountInstances) {
    // 30 triangles, drawn by two nodes.
    const std::string text =
        gltf_text(R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1]},{"mesh":0}],"meshes":[{"primitives":[)"
                  R"({"attributes":{"POSITION":0}}]}],"accessors":[{"componentType":5126,"count":90,"type":"VEC3"}])");
    EXPECT_EQ(load_error(text, {.max_triangles = 60}), "");
    EXPECT_EQ(load_error(text, {.max_triangles = 59}, ErrorCode::kLimit),
              "test.gltf: /scenes/0: 60 triangles, the limit is 59");
    // As lines 45 and as a strip 89, twice each.
    const auto with_mode = [&](const char* mode) {
        std::string changed = text;
        return changed.replace(changed.find(R"({"attributes")"), 1, mode);
    };
    EXPECT_EQ(load_error(with_mode(R"({"mode":1,)"), {.max_triangles = 90}), "");
    EXPECT_NE(load_error(with_mode(R"({"mode":1,)"), {.max_triangles = 89}, ErrorCode::kLimit), "");
    EXPECT_EQ(load_error(with_mode(R"({"mode":3,)"), {.max_triangles = 178}), "");
    EXPECT_NE(load_error(with_mode(R"({"mode":3,)"), {.max_triangles = 177}, ErrorCode::kLimit), "");
    EXPECT_EQ(load_error(text, {.max_nodes = 2}), "");
    EXPECT_NE(load_error(text, {.max_nodes = 1}, ErrorCode::kLimit), "");
}

TEST(Pictures, OnlyUsedOnesAreReadAndErrorsNameThem) {
    const std::string bad = R"("images":[{"uri":"data:image/png;base64,Zm9v"}],"textures":[{"source":0}])";
    EXPECT_EQ(load_error(gltf_text(bad)), "");
    const std::string used = bad + R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
    EXPECT_NE(load_error(gltf_text(used)).find("/images/0"), std::string::npos);
    EXPECT_EQ(load_error(gltf_text(used), {.load_pictures = false}), "");
}

}  // namespace
}  // namespace tessera
