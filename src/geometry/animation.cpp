#include "geometry/animation.h"

#include <tessera/error.h>

#include "core/fp_environment.h"
#include "geometry/matrix.h"
#include "geometry/node_transforms.h"
#include "simd/math.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tessera {
namespace {

void normalize(std::span<double> q) {
    const double squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(squared > 0)) {
        q[0] = q[1] = q[2] = 0, q[3] = 1;
        return;
    }
    const double length = std::sqrt(squared);
    for (double& x : q) x /= length;
}

// Shoemake 1985, "Animating rotation with quaternion curves", along the shorter arc. `a` and `b` are unit.
void slerp(std::span<const double> a, std::span<const double> b, double t, std::span<double> out) {
    double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    const double sign = cosine < 0 ? -1 : 1;
    cosine *= sign;
    double u = 1 - t, v = t;
    // Close together the arc is its chord; the quotient of sines would be 0 / 0.
    if (cosine < 1 - 1e-9) {
        const double sine = std::sqrt(1 - cosine * cosine), angle = math::atan2(sine, cosine);
        u = math::sin(u * angle) / sine;
        v = math::sin(v * angle) / sine;
    }
    for (std::size_t i = 0; i < 4; ++i) out[i] = u * a[i] + v * sign * b[i];
    normalize(out);
}

struct Placement {
    double translation[3], rotation[4], scale[3];
};

Placement placement_of(const Node& n) {
    return {{n.translation.x, n.translation.y, n.translation.z},
            {n.rotation.x, n.rotation.y, n.rotation.z, n.rotation.w},
            {n.scale.x, n.scale.y, n.scale.z}};
}

std::size_t morph_target_count(const Mesh& mesh) {
    std::size_t count = 0;
    for (const Primitive& p : mesh.primitives)
        if (!p.positions.empty()) count = std::max(count, p.targets.size());
    return count;
}

// The weights of a node at rest: its own, else its mesh's; empty without morph targets.
std::vector<float> resting_weights(const Scene& scene, const Node& node) {
    if (node.mesh == kNone) return {};
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(node.mesh)];
    const std::size_t count = morph_target_count(mesh);
    std::vector<float> weights = node.weights.empty() ? mesh.weights : node.weights;
    weights.resize(count, 0.0f);
    return weights;
}

class Poser {
  public:
    Poser(const Scene& scene, Pose& pose) : scene_(scene), pose_(pose), slot_(scene.nodes.size(), kNone) {}

    void apply(const Animation& animation, double time) {
        for (const AnimationChannel& channel : animation.channels) {
            const AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(channel.sampler)];
            if (channel.path == AnimationPath::kWeights) {
                std::vector<float>& weights = pose_.weights[static_cast<std::size_t>(channel.node)];
                values_.resize(weights.size());
                sample_animation(sampler, time, false, values_);
                for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = static_cast<float>(values_[i]);
                continue;
            }
            Placement& placement = placement_for(channel.node);
            if (channel.path == AnimationPath::kTranslation)
                sample_animation(sampler, time, false, placement.translation);
            else if (channel.path == AnimationPath::kRotation)
                sample_animation(sampler, time, true, placement.rotation);
            else
                sample_animation(sampler, time, false, placement.scale);
        }
    }
    void finish() {
        for (std::size_t i = 0; i < moved_.size(); ++i) {
            const Placement& p = placements_[i];
            pose_.local[static_cast<std::size_t>(moved_[i])] =
                compose_matrix(glm::dvec3(p.translation[0], p.translation[1], p.translation[2]),
                               glm::dvec4(p.rotation[0], p.rotation[1], p.rotation[2], p.rotation[3]),
                               glm::dvec3(p.scale[0], p.scale[1], p.scale[2]));
        }
    }

  private:
    Placement& placement_for(int node) {
        int& slot = slot_[static_cast<std::size_t>(node)];
        if (slot == kNone) {
            slot = static_cast<int>(moved_.size());
            moved_.push_back(node);
            placements_.push_back(placement_of(scene_.nodes[static_cast<std::size_t>(node)]));
        }
        return placements_[static_cast<std::size_t>(slot)];
    }

    const Scene& scene_;
    Pose& pose_;
    std::vector<int> slot_, moved_;  // by node: index into moved_, the nodes that channels drive
    std::vector<Placement> placements_;
    std::vector<double> values_;
};

}  // namespace

double duration(const Animation& animation) {
    float last = 0;
    for (const AnimationSampler& sampler : animation.samplers)
        if (!sampler.times.empty()) last = std::max(last, sampler.times.back());
    return static_cast<double>(last);
}

void sample_animation(const AnimationSampler& sampler, double time, bool rotation, std::span<double> out) {
    const std::vector<float>& times = sampler.times;
    const std::size_t n = out.size();
    const bool cubic = sampler.interpolation == Interpolation::kCubicSpline;
    // Of cubic splines a key holds the tangent that comes in, the value, and the tangent that goes out.
    const auto key = [&](std::size_t k, std::size_t part) {
        return sampler.values.data() + (cubic ? 3 * k + part : k) * n;
    };
    const auto hold = [&](std::size_t k) {
        for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<double>(key(k, 1)[i]);
        if (rotation) normalize(out);
    };
    const auto after = std::upper_bound(times.begin(), times.end(), time,
                                        [](double t, float key_time) { return t < static_cast<double>(key_time); });
    if (after == times.begin()) return hold(0);
    const auto next = static_cast<std::size_t>(after - times.begin());
    const std::size_t k = next - 1;
    if (after == times.end() || sampler.interpolation == Interpolation::kStep) return hold(k);

    const double span = static_cast<double>(times[next]) - static_cast<double>(times[k]);
    const double t = (time - static_cast<double>(times[k])) / span;
    if (cubic) {
        const double t2 = t * t, t3 = t2 * t;
        const double value0 = 2 * t3 - 3 * t2 + 1, value1 = 3 * t2 - 2 * t3;
        const double tangent0 = span * (t3 - 2 * t2 + t), tangent1 = span * (t3 - t2);
        for (std::size_t i = 0; i < n; ++i)
            out[i] = value0 * static_cast<double>(key(k, 1)[i]) + tangent0 * static_cast<double>(key(k, 2)[i]) +
                     value1 * static_cast<double>(key(next, 1)[i]) + tangent1 * static_cast<double>(key(next, 0)[i]);
        if (rotation) normalize(out);
    } else if (rotation) {
        double a[4], b[4];
        for (std::size_t i = 0; i < 4; ++i) {
            a[i] = static_cast<double>(key(k, 1)[i]);
            b[i] = static_cast<double>(key(next, 1)[i]);
        }
        normalize(a), normalize(b);
        slerp(a, b, t, out);
    } else {
        for (std::size_t i = 0; i < n; ++i)
            out[i] = (1 - t) * static_cast<double>(key(k, 1)[i]) + t * static_cast<double>(key(next, 1)[i]);
    }
}

Pose pose_of(const Scene& scene, const Moment& moment) {
    const FpEnvironment exact;
    const int count = static_cast<int>(scene.animations.size());
    if (moment.animation != kNone && moment.animation != kEveryAnimation &&
        (moment.animation < 0 || moment.animation >= count))
        throw Error(ErrorCode::kUsage, "animation " + std::to_string(moment.animation) +
                                           " does not exist: the scene has " + std::to_string(count));
    if (!(moment.time - moment.time == 0)) throw Error(ErrorCode::kUsage, "the time must be finite");
    Pose pose;
    for (const Node& node : scene.nodes) {
        pose.local.push_back(local_matrix(node));
        pose.weights.push_back(resting_weights(scene, node));
    }
    Poser poser(scene, pose);
    for (int i = 0; i < count; ++i)
        if (moment.animation == i || moment.animation == kEveryAnimation)
            poser.apply(scene.animations[static_cast<std::size_t>(i)], moment.time);
    poser.finish();
    return pose;
}

}  // namespace tessera
