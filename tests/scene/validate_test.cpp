// validate(): a scene made in code passes, and each single fault is found and its place named.
#include <tessera/error.h>
#include <tessera/scene.h>

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace tessera {
namespace {

// Two nodes, a triangle with every attribute, a skin, an animation: everything that can be wrong.
Scene good_scene() {
    Scene scene;
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.normals.assign(3, {0, 0, 1});
    p.tangents.assign(3, {1, 0, 0, 1});
    p.texcoords = {{{0, 0}, {1, 0}, {0, 1}}, {}};
    p.colors = {{{1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 1}}};
    p.joints = {{{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 0}}};
    p.weights = {{{0.5f, 0.5f, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}}};
    p.custom = {{"_HEAT", 2, {1, 2, 3, 4, 5, 6}}};
    p.targets = {{{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {}, {}}};
    p.indices = {0, 1, 2};
    p.material = 0;
    scene.meshes = {{"triangle", {p}, {0.25f}, {}}};
    scene.materials.resize(1);
    scene.materials[0].texture(TextureSlot::kBaseColor).texture = 0;
    scene.textures.push_back({"t", 0, 0, ""});
    scene.samplers.resize(1);
    scene.pictures.resize(1);
    scene.pictures[0].pixels = std::make_shared<Image>(2, 2, PixelFormat::kRgba8);
    scene.cameras.resize(2);
    scene.cameras[1].type = Camera::Type::kOrthographic;
    scene.cameras[1].zfar = 10.0f;
    scene.lights.resize(1);
    scene.nodes.resize(3);
    scene.nodes[0].children = {1, 2};
    scene.nodes[0].mesh = 0;
    scene.nodes[0].skin = 0;
    scene.nodes[0].weights = {1};
    scene.nodes[1].camera = 1;
    scene.nodes[2].light = 0;
    scene.skins.push_back({"s", {1, 2}, {Mat4{}, Mat4{}}, 1, ""});
    AnimationSampler moves{{0, 1}, {0, 0, 0, 1, 1, 1}, Interpolation::kLinear};
    AnimationSampler morphs{{0, 1}, {0, 0, 0, 1, 1, 1}, Interpolation::kCubicSpline};
    scene.animations.push_back(
        {"a", {moves, morphs}, {{0, 1, AnimationPath::kTranslation}, {1, 0, AnimationPath::kWeights}}, ""});
    scene.scenes.push_back({"main", {0}, ""});
    return scene;
}

TEST(Validate, AcceptsGoodScenes) {
    EXPECT_NO_THROW(validate(Scene{}));
    EXPECT_NO_THROW(validate(good_scene()));
    Scene nothing = good_scene();
    nothing.active_scene = kNone;
    EXPECT_NO_THROW(validate(nothing));
}

struct Fault {
    const char* place;
    std::function<void(Scene&)> make;
};

Primitive& primitive(Scene& s) { return s.meshes[0].primitives[0]; }
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Validate, NamesThePlaceOfEachFault) {
    const std::vector<Fault> faults = {
        {"nodes/0/children/1", [](Scene& s) { s.nodes[0].children[1] = 3; }},
        {"nodes/0/children/1", [](Scene& s) { s.nodes[0].children[1] = -1; }},
        {"nodes/0/children/1", [](Scene& s) { s.nodes[0].children[1] = 1; }},
        {"nodes/1/children/0", [](Scene& s) { s.nodes[1].children = {2}; }},
        {"nodes/0", [](Scene& s) { s.nodes[1].children = {0}; }},
        {"nodes/2", [](Scene& s) { s.nodes[0].children = {1}, s.nodes[2].children = {2}; }},
        {"nodes/0/mesh", [](Scene& s) { s.nodes[0].mesh = 1; }},
        {"nodes/0/skin", [](Scene& s) { s.nodes[0].skin = 5; }},
        {"nodes/1/camera", [](Scene& s) { s.nodes[1].camera = 2; }},
        {"nodes/2/light", [](Scene& s) { s.nodes[2].light = -2; }},
        {"nodes/1/translation", [](Scene& s) { s.nodes[1].translation.y = kNan; }},
        {"nodes/1/rotation", [](Scene& s) { s.nodes[1].rotation.w = kInfinity; }},
        {"nodes/1/scale", [](Scene& s) { s.nodes[1].scale.z = -kInfinity; }},
        {"nodes/1/matrix", [](Scene& s) { s.nodes[1].matrix.emplace().m[7] = kNan; }},
        {"nodes/0/weights",
         [](Scene& s) {
             s.nodes[0].weights = {1, 2};
         }},
        {"scenes/0/nodes/0", [](Scene& s) { s.scenes[0].nodes = {9}; }},
        {"scenes/0/nodes",
         [](Scene& s) {
             s.scenes[0].nodes = {0, 0};
         }},
        {"scenes/0/nodes",
         [](Scene& s) {
             s.scenes[0].nodes = {2, 0};
         }},
        {"active_scene", [](Scene& s) { s.active_scene = 1; }},
        {"skins/0/joints", [](Scene& s) { s.skins[0].joints.clear(); }},
        {"skins/0/joints/1", [](Scene& s) { s.skins[0].joints[1] = 3; }},
        {"skins/0/skeleton", [](Scene& s) { s.skins[0].skeleton = 3; }},
        {"skins/0/inverse_bind", [](Scene& s) { s.skins[0].inverse_bind.pop_back(); }},
        {"skins/0/inverse_bind", [](Scene& s) { s.skins[0].inverse_bind[1].m[3] = kNan; }},
        {"nodes/0/skin", [](Scene& s) { primitive(s).joints[0][2][3] = 2; }},
        {"meshes/0/primitives/0/material", [](Scene& s) { primitive(s).material = 1; }},
        {"meshes/0/primitives/0/positions", [](Scene& s) { primitive(s).positions[2].z = kNan; }},
        {"meshes/0/primitives/0/normals", [](Scene& s) { primitive(s).normals.pop_back(); }},
        {"meshes/0/primitives/0/tangents", [](Scene& s) { primitive(s).tangents[1].w = kInfinity; }},
        {"meshes/0/primitives/0/texcoords/0", [](Scene& s) { primitive(s).texcoords[0].resize(4); }},
        {"meshes/0/primitives/0/colors/0", [](Scene& s) { primitive(s).colors[0][0].x = kNan; }},
        {"meshes/0/primitives/0/weights", [](Scene& s) { primitive(s).weights.clear(); }},
        {"meshes/0/primitives/0/weights/0", [](Scene& s) { primitive(s).weights[0].clear(); }},
        {"meshes/0/primitives/0/custom/0/components", [](Scene& s) { primitive(s).custom[0].components = 17; }},
        {"meshes/0/primitives/0/custom/0/values", [](Scene& s) { primitive(s).custom[0].values.pop_back(); }},
        {"meshes/0/primitives/0/targets/0/positions", [](Scene& s) { primitive(s).targets[0].positions.pop_back(); }},
        {"meshes/0/primitives/0/indices", [](Scene& s) { primitive(s).indices[1] = 3; }},
        {"meshes/0/primitives/1/targets",
         [](Scene& s) {
             s.meshes[0].primitives.push_back(primitive(s));
             s.meshes[0].primitives[1].targets.clear();
         }},
        {"meshes/0/weights",
         [](Scene& s) {
             s.meshes[0].weights = {1, 2};
         }},
        {"meshes/0/weights", [](Scene& s) { s.meshes[0].weights = {kNan}; }},
        {"materials/0", [](Scene& s) { s.materials[0].shininess = kNan; }},
        {"materials/0/textures/0/texture", [](Scene& s) { s.materials[0].textures[0].texture = 1; }},
        {"materials/0/textures/1/uv_set", [](Scene& s) { s.materials[0].textures[1].uv_set = -1; }},
        {"materials/0/textures/2", [](Scene& s) { s.materials[0].textures[2].rotation = kInfinity; }},
        {"materials/0/clearcoat/strength", [](Scene& s) { s.materials[0].clearcoat.strength = 1.5f; }},
        {"materials/0/clearcoat/normal_scale", [](Scene& s) { s.materials[0].clearcoat.normal_scale = kInfinity; }},
        {"materials/0/clearcoat/normal_texture/texture",
         [](Scene& s) { s.materials[0].clearcoat.normal_texture.texture = 1; }},
        {"materials/0/sheen/color", [](Scene& s) { s.materials[0].sheen.color.z = -0.1f; }},
        {"materials/0/sheen/roughness_texture/uv_set",
         [](Scene& s) { s.materials[0].sheen.roughness_texture.uv_set = -1; }},
        {"materials/0/transmission", [](Scene& s) { s.materials[0].transmission = kNan; }},
        {"materials/0/volume/thickness", [](Scene& s) { s.materials[0].volume.thickness = -1; }},
        {"materials/0/volume/attenuation_distance", [](Scene& s) { s.materials[0].volume.attenuation_distance = 0; }},
        {"materials/0/volume/attenuation_distance",
         [](Scene& s) { s.materials[0].volume.attenuation_distance = kInfinity; }},
        {"materials/0/volume/attenuation_color", [](Scene& s) { s.materials[0].volume.attenuation_color.y = 2; }},
        {"materials/0/anisotropy/rotation", [](Scene& s) { s.materials[0].anisotropy.rotation = kNan; }},
        {"materials/0/iridescence/ior", [](Scene& s) { s.materials[0].iridescence.ior = 0.9f; }},
        {"materials/0/iridescence/thickness_texture",
         [](Scene& s) { s.materials[0].iridescence.thickness_texture.scale.x = kNan; }},
        {"materials/0/dispersion", [](Scene& s) { s.materials[0].dispersion = -1; }},
        {"textures/0/picture", [](Scene& s) { s.textures[0].picture = 1; }},
        {"textures/0/sampler", [](Scene& s) { s.textures[0].sampler = 1; }},
        {"pictures/0/pixels", [](Scene& s) { s.pictures[0].pixels = std::make_shared<Image>(); }},
        {"pictures/0/pixels",
         [](Scene& s) { s.pictures[0].pixels = std::make_shared<Image>(1, 1, PixelFormat::kF32); }},
        {"cameras/0/yfov", [](Scene& s) { s.cameras[0].yfov = 3.15f; }},
        {"cameras/0/znear", [](Scene& s) { s.cameras[0].znear = 0; }},
        {"cameras/0/zfar", [](Scene& s) { s.cameras[0].zfar = 0.05f; }},
        {"cameras/1/xmag", [](Scene& s) { s.cameras[1].xmag = 0; }},
        {"cameras/1/zfar", [](Scene& s) { s.cameras[1].zfar.reset(); }},
        {"lights/0/intensity", [](Scene& s) { s.lights[0].intensity = -1; }},
        {"lights/0/range", [](Scene& s) { s.lights[0].range = 0.0f; }},
        {"lights/0/outer_cone", [](Scene& s) { s.lights[0].type = Light::Type::kSpot, s.lights[0].inner_cone = 1; }},
        {"animations/0/samplers/0/times",
         [](Scene& s) {
             s.animations[0].samplers[0].times = {1, 1};
         }},
        {"animations/0/samplers/0/times", [](Scene& s) { s.animations[0].samplers[0].times.clear(); }},
        {"animations/0/samplers/1/values", [](Scene& s) { s.animations[0].samplers[1].values[5] = kNan; }},
        {"animations/0/channels/0/sampler", [](Scene& s) { s.animations[0].samplers[0].values.pop_back(); }},
        {"animations/0/channels/0/sampler", [](Scene& s) { s.animations[0].channels[0].sampler = 2; }},
        {"animations/0/channels/0/node", [](Scene& s) { s.animations[0].channels[0].node = kNone; }},
        {"animations/0/channels/1/node", [](Scene& s) { s.animations[0].channels[1].node = 1; }},
    };
    for (std::size_t i = 0; i < faults.size(); ++i) {
        SCOPED_TRACE("fault " + std::to_string(i) + " at " + faults[i].place);
        Scene scene = good_scene();
        faults[i].make(scene);
        try {
            validate(scene);
            ADD_FAILURE() << "not found";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kUsage);
            EXPECT_EQ(error.location(), faults[i].place) << error.what();
        }
    }
}

TEST(Validate, DeepChainsNeedNoStack) {
    Scene scene;
    constexpr int kDepth = 1000000;
    scene.nodes.resize(kDepth);
    for (int i = 0; i + 1 < kDepth; ++i) scene.nodes[static_cast<std::size_t>(i)].children = {i + 1};
    scene.scenes.push_back({"", {0}, ""});
    EXPECT_NO_THROW(validate(scene));
    scene.nodes.back().children = {0};
    EXPECT_THROW(validate(scene), Error);
}

TEST(MemoryBytes, CountsWhatIsHeld) {
    Scene scene;
    const std::uint64_t empty = memory_bytes(scene);
    EXPECT_EQ(empty, sizeof(Scene));
    scene.meshes.resize(1);
    scene.meshes[0].primitives.resize(1);
    scene.meshes[0].primitives[0].positions.resize(1000);
    scene.meshes[0].primitives[0].texcoords = {std::vector<Vec2>(10), std::vector<Vec2>(20)};
    scene.meshes[0].name = std::string(100, 'x');
    EXPECT_EQ(memory_bytes(scene), empty + sizeof(Mesh) + sizeof(Primitive) + 1000 * sizeof(Vec3) +
                                       2 * sizeof(std::vector<Vec2>) + 30 * sizeof(Vec2) +
                                       scene.meshes[0].name.capacity());
    scene.pictures.resize(2);
    const std::uint64_t before = memory_bytes(scene);
    scene.pictures[0].pixels = scene.pictures[1].pixels = std::make_shared<Image>(8, 4, PixelFormat::kRgba16);
    EXPECT_EQ(memory_bytes(scene), before + 8 * 4 * 8);
}

}  // namespace
}  // namespace tessera
