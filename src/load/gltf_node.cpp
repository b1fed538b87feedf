// Nodes, scenes and skins.
#include "load/gltf_accessor.h"
#include "load/gltf_parts.h"

#include <algorithm>

namespace tessera {
namespace {

std::vector<int> references(const Json& json, std::size_t size, std::string_view what) {
    std::vector<int> numbers;
    json.each([&](const Json& number, std::size_t) { numbers.push_back(number.reference(size, what)); });
    return numbers;
}

// The tool that wrote the file may have rounded: what is near a unit quaternion is left alone.
void make_unit(LoadContext& context, const Json& json, Quat& q) {
    const float squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (squared > 0.998f && squared < 1.002f) return;
    if (!(squared > 1e-30f && squared < 1e30f)) {
        context.warn(json.place() + ": the rotation has no direction and is ignored");
        q = {};
        return;
    }
    context.warn(json.place() + ": the rotation is not a unit quaternion and is normalised");
    const float length = std::sqrt(squared);
    q = {q.x / length, q.y / length, q.z / length, q.w / length};
}

void read_placement(LoadContext& context, const Json& json, Node& node) {
    if (const std::optional<Json> matrix = json.find("matrix")) {
        node.matrix.emplace();
        matrix->numbers(node.matrix->m);
        std::array<float, 16>& m = node.matrix->m;
        if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) {
            context.warn(matrix->place() + ": the last row is taken as 0 0 0 1");
            m[3] = m[7] = m[11] = 0, m[15] = 1;
        }
    }
    json.numbers_or_keep("translation", {&node.translation.x, 3});
    json.numbers_or_keep("scale", {&node.scale.x, 3});
    if (const std::optional<Json> rotation = json.find("rotation")) {
        rotation->numbers({&node.rotation.x, 4});
        make_unit(context, *rotation, node.rotation);
    }
}

// EXT_mesh_gpu_instancing: as many instances as its accessors have elements.
void read_instances(GltfDocument& document, const Json& json, Node& node) {
    std::size_t count = 0;
    const auto open = [&](std::string_view name, const Json& value, std::string_view type, unsigned formats) {
        const int number = value.reference(document.size(GltfArray::kAccessors), "accessor");
        Accessor accessor = open_accessor(document, static_cast<std::size_t>(number));
        expect_format(value, accessor, type, formats);
        if (count != 0 && accessor.count != count)
            value.fail(std::string(name) + " has " + std::to_string(accessor.count) + " elements, others have " +
                       std::to_string(count));
        if (count == 0) {
            count = accessor.count;
            document.context().charge(std::uint64_t{count} * sizeof(MeshInstance), value.place());
            node.instances.resize(count);
        }
        return accessor;
    };
    json.at("attributes").each_member([&](std::string_view name, const Json& value) {
        if (name == "TRANSLATION") {
            const std::vector<Vec3> values = read_floats<Vec3>(document, open(name, value, "VEC3", kFloats));
            for (std::size_t i = 0; i < count; ++i) node.instances[i].translation = values[i];
        } else if (name == "SCALE") {
            const std::vector<Vec3> values = read_floats<Vec3>(document, open(name, value, "VEC3", kFloats));
            for (std::size_t i = 0; i < count; ++i) node.instances[i].scale = values[i];
        } else if (name == "ROTATION") {
            const std::vector<Vec4> values =
                read_floats<Vec4>(document, open(name, value, "VEC4", kFloats | kNormalizedSigned));
            for (std::size_t i = 0; i < count; ++i)
                node.instances[i].rotation = {values[i].x, values[i].y, values[i].z, values[i].w};
        }  // others are the application's own
    });
    if (count == 0) json.fail("instances need TRANSLATION, ROTATION or SCALE");
}

Node read_node(GltfDocument& document, const Json& json, const std::vector<int>& lights) {
    Node node;
    document.note_extensions(json);
    node.name = json.string_or("name");
    node.extras = json.raw_or_empty("extras");
    if (const std::optional<Json> children = json.find("children"))
        node.children = references(*children, document.size(GltfArray::kNodes), "node");
    read_placement(document.context(), json, node);
    node.mesh = json.reference_or_none("mesh", document.size(GltfArray::kMeshes), "mesh");
    node.camera = json.reference_or_none("camera", document.size(GltfArray::kCameras), "camera");
    node.skin = json.reference_or_none("skin", document.size(GltfArray::kSkins), "skin");
    if (const std::optional<Json> weights = json.find("weights")) node.weights = weights->numbers();
    if (const std::optional<Json> instancing = find_extension(json, "EXT_mesh_gpu_instancing"))
        read_instances(document, *instancing, node);
    if (const std::optional<Json> punctual = find_extension(json, "KHR_lights_punctual"))
        node.light = lights[static_cast<std::size_t>(punctual->at("light").reference(lights.size(), "light"))];
    return node;
}

Skin read_skin(GltfDocument& document, const Json& json) {
    Skin skin;
    document.note_extensions(json);
    skin.name = json.string_or("name");
    skin.extras = json.raw_or_empty("extras");
    skin.joints = references(json.at("joints"), document.size(GltfArray::kNodes), "node");
    skin.skeleton = json.reference_or_none("skeleton", document.size(GltfArray::kNodes), "node");
    if (const std::optional<Json> matrices = json.find("inverseBindMatrices")) {
        const int number = matrices->reference(document.size(GltfArray::kAccessors), "accessor");
        const Accessor accessor = open_accessor(document, static_cast<std::size_t>(number));
        expect_format(*matrices, accessor, "MAT4", kFloats);
        if (accessor.count < skin.joints.size())
            matrices->fail(std::to_string(accessor.count) + " matrices for " + std::to_string(skin.joints.size()) +
                           " joints");
        skin.inverse_bind = read_floats<Mat4>(document, accessor);
        skin.inverse_bind.resize(skin.joints.size());
    }
    return skin;
}

}  // namespace

void read_nodes(GltfDocument& document, Scene& scene, const std::vector<int>& lights) {
    const std::uint64_t most = document.context().options().max_nodes;
    if (document.size(GltfArray::kNodes) > most)
        document.root().at("nodes").fail(
            std::to_string(document.size(GltfArray::kNodes)) + " nodes, the limit is " + std::to_string(most),
            ErrorCode::kLimit);
    make_room(document, GltfArray::kNodes, scene.nodes);
    make_room(document, GltfArray::kScenes, scene.scenes);
    scene.skins.resize(document.size(GltfArray::kSkins));  // read_skins() fills them
    document.each(GltfArray::kNodes,
                  [&](const Json& json, std::size_t i) { scene.nodes[i] = read_node(document, json, lights); });
    const auto skinned = std::find_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& node) {
        return node.skin != kNone && node.mesh != kNone && !node.instances.empty();
    });
    if (skinned != scene.nodes.end())
        document.context().warn("/nodes/" + std::to_string(skinned - scene.nodes.begin()) +
                                ": EXT_mesh_gpu_instancing of a skinned mesh has no effect");
    document.each(GltfArray::kScenes, [&](const Json& json, std::size_t i) {
        document.note_extensions(json);
        scene.scenes[i].name = json.string_or("name");
        scene.scenes[i].extras = json.raw_or_empty("extras");
        if (const std::optional<Json> nodes = json.find("nodes"))
            scene.scenes[i].nodes = references(*nodes, scene.nodes.size(), "node");
    });
    scene.active_scene = document.root().reference_or_none("scene", scene.scenes.size(), "scene");
    if (scene.active_scene == kNone && !scene.scenes.empty()) scene.active_scene = 0;
    if (scene.active_scene == kNone) document.context().warn("the file has no scene: there is nothing to draw");
}

void read_skins(GltfDocument& document, Scene& scene) {
    make_room(document, GltfArray::kSkins, scene.skins);
    document.each(GltfArray::kSkins,
                  [&](const Json& json, std::size_t i) { scene.skins[i] = read_skin(document, json); });
}

}  // namespace tessera
