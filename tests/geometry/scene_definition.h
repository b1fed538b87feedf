// An animated scene by its definition, in long double: where its vertices are at a moment.
#pragma once

#include "geometry/animation_definition.h"

#include <array>

namespace tessera::test {

using Matrix = std::array<std::array<Real, 4>, 4>;

inline Matrix multiply(const Matrix& a, const Matrix& b) {
    Matrix m{};
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t k = 0; k < 4; ++k) m[r][c] += a[r][k] * b[k][c];
    return m;
}
inline std::array<Real, 3> moved_by(const Matrix& m, const std::array<Real, 3>& p) {
    std::array<Real, 3> q;
    for (std::size_t r = 0; r < 3; ++r) q[r] = m[r][0] * p[0] + m[r][1] * p[1] + m[r][2] * p[2] + m[r][3];
    return q;
}
inline Matrix matrix_of(const Mat4& m) {
    Matrix r;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) r[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = m(i, j);
    return r;
}
inline Matrix matrix_of(const std::vector<Real>& t, const std::vector<Real>& q, const std::vector<Real>& s) {
    const Real x = q[0], y = q[1], z = q[2], w = q[3];
    return {{{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - w * z) * s[1], 2 * (x * z + w * y) * s[2], t[0]},
             {2 * (x * y + w * z) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - w * x) * s[2], t[1]},
             {2 * (x * z - w * y) * s[0], 2 * (y * z + w * x) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]},
             {0, 0, 0, 1}}};
}

// An evaluation that shares nothing with Tessera's but the scene: recursive, in long double.
class Evaluation {
  public:
    Evaluation(const Scene& scene, int animation, Real time) : scene_(scene), world_(scene.nodes.size()) {
        for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
            const Node& n = scene.nodes[i];
            std::vector<Real> t{n.translation.x, n.translation.y, n.translation.z}, s{n.scale.x, n.scale.y, n.scale.z};
            std::vector<Real> q{n.rotation.x, n.rotation.y, n.rotation.z, n.rotation.w};
            bool moved = false;
            std::vector<Real> w(n.weights.begin(), n.weights.end());
            if (w.empty() && n.mesh != kNone)
                for (const float x : scene.meshes[static_cast<std::size_t>(n.mesh)].weights) w.push_back(x);
            if (animation != kNone)
                for (const AnimationChannel& c : scene.animations[static_cast<std::size_t>(animation)].channels) {
                    if (c.node != static_cast<int>(i)) continue;
                    const AnimationSampler& sampler = scene.animations[static_cast<std::size_t>(animation)]
                                                          .samplers[static_cast<std::size_t>(c.sampler)];
                    const std::size_t parts = sampler.interpolation == Interpolation::kCubicSpline ? 3 : 1;
                    const std::size_t count = sampler.values.size() / sampler.times.size() / parts;
                    std::vector<Real> v = definition(sampler, time, count, c.path == AnimationPath::kRotation);
                    if (c.path == AnimationPath::kWeights) {
                        w = v;
                        continue;
                    }
                    moved = true;
                    (c.path == AnimationPath::kTranslation ? t : c.path == AnimationPath::kRotation ? q : s) = v;
                }
            const Real length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            for (Real& x : q) x /= length;
            local_.push_back(n.matrix && !moved ? matrix_of(*n.matrix) : matrix_of(t, q, s));
            weights_.push_back(w);
        }
        Matrix identity{};
        for (std::size_t i = 0; i < 4; ++i) identity[i][i] = 1;
        for (const int root : scene.scenes[static_cast<std::size_t>(scene.active_scene)].nodes) descend(root, identity);
    }

    // World space.
    std::array<Real, 3> vertex(int node, const Primitive& p, std::size_t v) const {
        const Node& n = scene_.nodes[static_cast<std::size_t>(node)];
        std::array<Real, 3> at{p.positions[v].x, p.positions[v].y, p.positions[v].z};
        const std::vector<Real>& w = weights_[static_cast<std::size_t>(node)];
        for (std::size_t t = 0; t < p.targets.size() && t < w.size(); ++t) {
            if (p.targets[t].positions.empty()) continue;
            const Vec3& d = p.targets[t].positions[v];
            at[0] += w[t] * d.x, at[1] += w[t] * d.y, at[2] += w[t] * d.z;
        }
        if (n.skin == kNone || p.joints.empty()) return moved_by(world_[static_cast<std::size_t>(node)], at);
        const Skin& skin = scene_.skins[static_cast<std::size_t>(n.skin)];
        std::array<Real, 3> sum{};
        Real weight_sum = 0;
        for (std::size_t s = 0; s < p.joints.size(); ++s) {
            const Vec4& jw = p.weights[s][v];
            const Real weights[4] = {jw.x, jw.y, jw.z, jw.w};
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t joint = p.joints[s][v][k];
                Matrix m = world_[static_cast<std::size_t>(skin.joints[joint])];
                if (!skin.inverse_bind.empty()) m = multiply(m, matrix_of(skin.inverse_bind[joint]));
                const std::array<Real, 3> q = moved_by(m, at);
                for (std::size_t i = 0; i < 3; ++i) sum[i] += weights[k] * q[i];
                weight_sum += weights[k];
            }
        }
        for (Real& x : sum) x /= weight_sum;
        return sum;
    }

  private:
    void descend(int node, const Matrix& parent) {
        const auto i = static_cast<std::size_t>(node);
        world_[i] = multiply(parent, local_[i]);
        for (const int child : scene_.nodes[i].children) descend(child, world_[i]);
    }
    const Scene& scene_;
    std::vector<Matrix> local_, world_;
    std::vector<std::vector<Real>> weights_;
};

}  // namespace tessera::test
