// Animations: samplers and channels. Channels that drive nothing that we have are left out.
#include "load/gltf_accessor.h"
#include "load/gltf_parts.h"

#include <algorithm>

namespace tessera {
namespace {

Accessor referred(GltfDocument& document, const Json& json) {
    return open_accessor(document,
                         static_cast<std::size_t>(json.reference(document.size(GltfArray::kAccessors), "accessor")));
}

// Keys must be in order. Files whose keys repeat a time exist; of such keys the first is kept.
void drop_late_keys(LoadContext& context, const Json& json, AnimationSampler& sampler) {
    std::vector<float>&times = sampler.times, &values = sampler.values;
    const std::size_t per_key = values.size() / times.size();
    std::size_t kept = 1;
    for (std::size_t k = 1; k < times.size(); ++k) {
        if (!(times[k] > times[kept - 1])) continue;
        if (kept != k && (k + 1) * per_key <= values.size()) {
            const auto key = [&](std::size_t i) { return values.begin() + static_cast<std::ptrdiff_t>(i * per_key); };
            std::copy(key(k), key(k + 1), key(kept));
        }
        times[kept++] = times[k];
    }
    if (kept == times.size()) return;
    if (values.size() != times.size() * per_key)
        json.fail(std::to_string(values.size()) + " values for " + std::to_string(times.size()) + " keys");
    context.warn(json.place() + ": " + std::to_string(times.size() - kept) +
                 " keys are ignored, they are not later than the ones before");
    times.resize(kept);
    values.resize(kept * per_key);
}

AnimationSampler read_sampler(GltfDocument& document, const Json& json) {
    AnimationSampler sampler;
    document.note_extensions(json);
    const Json input = json.at("input"), output = json.at("output");
    const Accessor times = referred(document, input);
    expect_format(input, times, "SCALAR", kFloats);
    sampler.times = read_floats<float>(document, times);
    const Accessor values = referred(document, output);
    expect_format(output, values, "", kFloats | kNormalizedSigned | kNormalizedUnsigned);
    sampler.values = read_floats<float>(document, values);
    const std::string mode = json.string_or("interpolation", "LINEAR");
    if (mode == "STEP")
        sampler.interpolation = Interpolation::kStep;
    else if (mode == "CUBICSPLINE")
        sampler.interpolation = Interpolation::kCubicSpline;
    else if (mode != "LINEAR")
        json.at("interpolation").fail("there is no interpolation " + json.at("interpolation").raw());
    drop_late_keys(document.context(), json, sampler);
    return sampler;
}

std::optional<AnimationPath> read_path(LoadContext& context, const Json& json) {
    if (json.string() == "translation") return AnimationPath::kTranslation;
    if (json.string() == "rotation") return AnimationPath::kRotation;
    if (json.string() == "scale") return AnimationPath::kScale;
    if (json.string() == "weights") return AnimationPath::kWeights;
    context.warn(json.place() + ": channels of path " + json.raw() + " are ignored");
    return std::nullopt;
}

bool has_morph_targets(const Scene& scene, int node) {
    const int mesh = scene.nodes[static_cast<std::size_t>(node)].mesh;
    if (mesh == kNone) return false;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(mesh)].primitives)
        if (!p.targets.empty()) return true;
    return false;
}

void read_channel(GltfDocument& document, const Json& json, const Scene& scene, Animation& animation) {
    const Json target = json.at("target");
    document.note_extensions(json);
    document.note_extensions(target);
    AnimationChannel channel;
    const Json sampler = json.at("sampler");
    channel.sampler = sampler.reference(animation.samplers.size(), "sampler");
    channel.node = target.reference_or_none("node", scene.nodes.size(), "node");
    const std::optional<AnimationPath> path = read_path(document.context(), target.at("path"));
    if (!path || channel.node == kNone) return;
    channel.path = *path;
    if (channel.path == AnimationPath::kWeights && !has_morph_targets(scene, channel.node)) {
        document.context().warn(target.place() + ": the node has no morph targets, the channel is ignored");
        return;
    }
    animation.channels.push_back(channel);
}

}  // namespace

void read_animations(GltfDocument& document, Scene& scene) {
    make_room(document, GltfArray::kAnimations, scene.animations);
    document.each(GltfArray::kAnimations, [&](const Json& json, std::size_t i) {
        Animation& animation = scene.animations[i];
        document.note_extensions(json);
        animation.name = json.string_or("name");
        animation.extras = json.raw_or_empty("extras");
        json.at("samplers").each([&](const Json& sampler, std::size_t) {
            document.context().charge(sizeof(AnimationSampler), sampler.place());
            animation.samplers.push_back(read_sampler(document, sampler));
        });
        json.at("channels").each([&](const Json& channel, std::size_t) {
            read_channel(document, channel, scene, animation);
        });
    });
}

}  // namespace tessera
