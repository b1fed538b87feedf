// Scenes in motion: what a moment of an animation makes of the nodes' placements and of the morph
// weights. Samplers as glTF 2.0, appendix C: step, linear (rotations by slerp) and cubic Hermite
// splines; before the first key and after the last their values hold. In double, without libm.
#pragma once

#include <tessera/render.h>

#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

namespace tessera {

struct Pose {
    std::vector<glm::dmat4> local;            // per node: to its parent
    std::vector<std::vector<float>> weights;  // per node: of its mesh's morph targets; may be empty
};

// Throws kUsage for an animation that does not exist.
Pose pose_of(const Scene& scene, const Moment& moment);

// The sampler's value at a time, `components` numbers of it. Rotations are unit quaternions (x, y, z, w).
void sample_animation(const AnimationSampler& sampler, double time, bool rotation, std::span<double> out);

}  // namespace tessera
