// Animations: key times and the number of values that a channel's path asks for.
#include "scene/check.h"

namespace tessera {
namespace {

std::size_t morph_targets(const Scene& scene, const Node& node) {
    if (node.mesh == kNone) return 0;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives)
        if (!p.positions.empty() && !p.targets.empty()) return p.targets.size();
    return 0;
}

void check_sampler(const AnimationSampler& sampler, const Place& place, bool values) {
    if (sampler.times.empty()) place.child("times").fail("an animation sampler needs at least one key");
    place.child("times").finite(sampler.times.data(), sampler.times.size());
    for (std::size_t k = 1; k < sampler.times.size(); ++k)
        if (!(sampler.times[k] > sampler.times[k - 1]))
            place.child("times").fail("key " + std::to_string(k) + " is not later than the one before it");
    if (values) place.child("values").finite(sampler.values.data(), sampler.values.size());
}

void check_channel(const Scene& scene, const Animation& animation, const AnimationChannel& channel,
                   const Place& place) {
    if (channel.sampler == kNone) place.child("sampler").fail("the channel has no sampler");
    if (channel.node == kNone) place.child("node").fail("the channel has no node");
    place.reference(channel.sampler, animation.samplers.size(), "sampler");
    place.reference(channel.node, scene.nodes.size(), "node");
    const AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(channel.sampler)];
    std::size_t numbers = 3;
    if (channel.path == AnimationPath::kRotation) numbers = 4;
    if (channel.path == AnimationPath::kWeights) {
        numbers = morph_targets(scene, scene.nodes[static_cast<std::size_t>(channel.node)]);
        if (numbers == 0) place.child("node").fail("the node has no morph targets");
    }
    if (sampler.interpolation == Interpolation::kCubicSpline) numbers *= 3;
    if (sampler.values.size() != sampler.times.size() * numbers)
        place.child("sampler").fail(std::to_string(sampler.values.size()) + " values for " +
                                    std::to_string(sampler.times.size()) + " keys of " + std::to_string(numbers) +
                                    " numbers");
}

}  // namespace

void check_animations(const Scene& scene, bool values) {
    for (std::size_t i = 0; i < scene.animations.size(); ++i) {
        const Animation& animation = scene.animations[i];
        const Place place{nullptr, "animations", i};
        for (std::size_t s = 0; s < animation.samplers.size(); ++s)
            check_sampler(animation.samplers[s], place.child("samplers", s), values);
        for (std::size_t c = 0; c < animation.channels.size(); ++c)
            check_channel(scene, animation, animation.channels[c], place.child("channels", c));
    }
}

}  // namespace tessera
