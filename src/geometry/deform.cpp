#include "geometry/deform.h"

#include "core/fp_environment.h"
#include "geometry/matrix.h"
#include "geometry/normals.h"
#include "geometry/skin_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

bool has_joints(const Primitive& p) { return !p.joints.empty() && !p.joints[0].empty(); }

// What is drawn of a prepared primitive, without what only deforms it.
Primitive drawn_part(const Primitive& p) {
    Primitive part;
    part.mode = p.mode;
    part.material = p.material;
    part.positions = p.positions;
    part.normals = p.normals;
    part.tangents = p.tangents;
    part.texcoords = p.texcoords;
    part.colors = p.colors;
    part.indices = p.indices;
    return part;
}

void add_scaled(std::vector<Vec3>& values, const std::vector<Vec3>& deltas, float weight) {
    if (deltas.empty()) return;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[i] + deltas[i] * weight;
}

void make_unit(Vec3& n) {
    const float squared = n.x * n.x + n.y * n.y + n.z * n.z;
    if (squared > 1e-37f && squared < 1e37f) n = n * (1.0f / std::sqrt(squared));
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

}  // namespace

bool is_skinned(const Scene& scene, const Node& node, const Primitive& primitive) {
    return node.skin != kNone && has_joints(primitive) &&
           !scene.skins[static_cast<std::size_t>(node.skin)].joints.empty();
}

JointMatrices joint_matrices(const Skin& skin, const std::vector<glm::dmat4>& world) {
    const FpEnvironment exact;
    JointMatrices result;
    const auto world_of = [&](std::size_t j) -> const glm::dmat4& {
        return world[static_cast<std::size_t>(skin.joints[j])];
    };
    const glm::dvec4 origin = world_of(0)[3];
    if (is_finite(glm::dvec3(origin))) result.object_to_world[3] = origin;
    result.rows.reserve(12 * skin.joints.size());
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        glm::dmat4 m = world_of(j);
        if (!skin.inverse_bind.empty()) m = m * to_dmat4(skin.inverse_bind[j]);
        m[3] -= glm::dvec4(glm::dvec3(result.object_to_world[3]), 0);
        if (j == 0) result.mirrored = determinant_sign(m) < 0;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) result.rows.push_back(static_cast<float>(m[c][r]));
    }
    return result;
}

DeformedMesh::DeformedMesh(const PreparedMesh& rest, const Primitive& source)
    : rest_(rest.primitive()),
      flat_(source.normals.empty() && has_triangles(source.mode)),
      mesh_(drawn_part(rest_), source) {
    mesh_.deformed = true;
    if (has_joints(rest_)) set_influences();
}

// Influences as the kernel has them, weights with a sum of 1. A vertex without any follows the first joint.
void DeformedMesh::set_influences() {
    const std::size_t count = rest_.positions.size(), sets = rest_.joints.size();
    joints_.assign(4 * count * sets, 0);
    influences_.assign(4 * count * sets, 0.0f);
    for (std::size_t v = 0; v < count; ++v) {
        double sum = 0;
        for (std::size_t s = 0; s < sets; ++s) {
            if (rest_.weights[s].empty()) continue;
            const Vec4& w = rest_.weights[s][v];
            sum += static_cast<double>(w.x) + static_cast<double>(w.y) + static_cast<double>(w.z) +
                   static_cast<double>(w.w);
        }
        for (std::size_t s = 0; s < sets; ++s) {
            if (rest_.weights[s].empty()) continue;
            const Vec4& w = rest_.weights[s][v];
            const float weights[4] = {w.x, w.y, w.z, w.w};
            for (std::size_t k = 0; k < 4; ++k) {
                joints_[4 * (s * count + v) + k] = rest_.joints[s][v][k];
                influences_[4 * (s * count + v) + k] = sum > 0
                                                           ? static_cast<float>(static_cast<double>(weights[k]) / sum)
                                                       : s + k == 0 ? 1.0f
                                                                    : 0.0f;
            }
        }
    }
}

bool DeformedMesh::update(std::span<const float> weights, const JointMatrices* joints, Isa isa, Arena* arena) {
    const std::span<const float> rows = joints ? std::span<const float>(joints->rows) : std::span<const float>();
    if (made_ && same_bits(weights, weights_) && same_bits(rows, rows_)) return false;
    const FpEnvironment exact;
    const bool same_shape = made_ && same_bits(weights, weights_);
    made_ = false;  // until all of it is done
    if (!same_shape) morph(weights);
    weights_.assign(weights.begin(), weights.end());
    rows_.assign(rows.begin(), rows.end());
    if (joints) {
        skin(*joints, isa, arena);
    } else {
        mesh_.made.positions = positions_;
        mesh_.made.normals = normals_;
        mesh_.made.tangents = tangents_;
    }
    if (flat_) compute_flat_normals(mesh_.made.positions, mesh_.made.normals);
    if (flat_ && joints && joints->mirrored)
        for (Vec3& n : mesh_.made.normals) n = -n;  // what goes the other way round is the front
    mesh_.measure();
    made_ = true;
    return true;
}

// Sums in the order of the targets.
void DeformedMesh::morph(std::span<const float> weights) {
    positions_ = rest_.positions;
    normals_ = rest_.normals;
    tangents_ = rest_.tangents;
    bool turned = false;
    for (std::size_t t = 0; t < rest_.targets.size() && t < weights.size(); ++t) {
        if (weights[t] == 0) continue;
        const MorphTarget& target = rest_.targets[t];
        add_scaled(positions_, target.positions, weights[t]);
        add_scaled(normals_, target.normals, weights[t]);
        turned = turned || !target.normals.empty();
        if (target.tangents.empty()) continue;
        for (std::size_t i = 0; i < tangents_.size(); ++i) {
            const Vec3 d = target.tangents[i] * weights[t];
            tangents_[i] = {tangents_[i].x + d.x, tangents_[i].y + d.y, tangents_[i].z + d.z, tangents_[i].w};
        }
    }
    if (turned)
        for (Vec3& n : normals_) make_unit(n);
}

void DeformedMesh::skin(const JointMatrices& joints, Isa isa, Arena* arena) {
    SkinJob job{};
    job.matrices = joints.rows.data();
    job.joints = joints_.data();
    job.weights = influences_.data();
    job.sets = static_cast<std::uint32_t>(rest_.joints.size());
    job.count = static_cast<std::uint32_t>(positions_.size());
    const auto floats = [](auto& values) { return values.empty() ? nullptr : &values[0].x; };
    Primitive& out = mesh_.made;
    job.positions = floats(positions_);
    job.normals = flat_ ? nullptr : floats(normals_);
    job.tangents = floats(tangents_);
    job.out_positions = floats(out.positions);
    job.out_normals = floats(out.normals);
    job.out_tangents = floats(out.tangents);
    constexpr std::uint32_t kChunk = 4096;
    const auto run = [&](std::size_t chunk) {
        SkinJob part = job;
        part.first = static_cast<std::uint32_t>(chunk) * kChunk;
        part.end = std::min(part.first + kChunk, job.count);
        skin_kernels(isa).skin(part);
    };
    const std::size_t chunks = (job.count + kChunk - 1) / kChunk;
    if (arena && chunks > 1) return arena->for_each(chunks, run);
    for (std::size_t i = 0; i < chunks; ++i) run(i);
}

}  // namespace tessera
