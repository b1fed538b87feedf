#include "geometry/prepared_scene.h"

#include <tessera/error.h>

#include "geometry/animation.h"
#include "geometry/bounds.h"
#include "geometry/matrix.h"

#include <algorithm>
#include <array>
#include <bit>
#include <set>

namespace tessera {
namespace {

// Whether a second copy at the same place would be hidden by the first one, sample by sample.
bool is_solid(const Scene& scene, const Primitive& p) {
    return p.material == kNone || scene.materials[static_cast<std::size_t>(p.material)].alpha_mode != AlphaMode::kBlend;
}

constexpr std::uint64_t kMostPrimitives = 0xfffffffeu;

[[noreturn]] void refuse_primitives() {
    throw Error(ErrorCode::kLimit, "the scene has more than 4294967294 triangles, lines and points");
}

// Where primitives have been placed. An exact duplicate of a solid one loses every depth test against
// the first (equal depth, higher number), so it is dropped before it costs anything.
class PlacesTaken {
  public:
    // False when the primitive was placed there before.
    bool insert(const Primitive* primitive, const glm::dmat4& world) {
        std::array<std::uint64_t, 17> key{};
        key[0] = reinterpret_cast<std::uintptr_t>(primitive);
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                key[static_cast<std::size_t>(1 + 4 * c + r)] = std::bit_cast<std::uint64_t>(world[c][r]);
        return seen_.insert(key).second;
    }

  private:
    std::set<std::array<std::uint64_t, 17>> seen_;
};

}  // namespace

PreparedScene::PreparedScene(const Scene& scene, Arena* arena, Isa isa) : scene_(scene), arena_(arena), isa_(isa) {
    Pose pose = pose_of(scene, moment_);
    weights_ = std::move(pose.weights);
    transforms_ = node_transforms(scene, pose.local);
    place_nodes();
}

void PreparedScene::move_to(const Moment& moment) {
    if (moment == moment_) return;
    Pose pose = pose_of(scene_, moment);
    // Of cameras only those stay that frame all of the same animation.
    if (chosen_ && (chosen_->framed == kUnframed || chosen_->framed != moment.animation)) chosen_.reset();
    weights_ = std::move(pose.weights);
    transforms_ = node_transforms(scene_, pose.local);
    place_nodes();
    moment_ = moment;
}

// Duplicates are sought anew at every moment: what stands at one place now may part later.
void PreparedScene::place_nodes() {
    nodes_.clear();
    placements_.clear();
    PlacesTaken taken;
    std::vector<std::pair<const Primitive*, std::uint64_t>> skinned;
    std::uint64_t primitives = 0;
    for (const int index : transforms_.order) {
        const Node& node = scene_.nodes[static_cast<std::size_t>(index)];
        const glm::dmat4& world = transforms_.world[static_cast<std::size_t>(index)];
        skinned.clear();
        // Instances are nodes of their own as far as drawing goes; a light stays at the node.
        const bool instanced = node.mesh != kNone && !node.instances.empty();
        if (instanced && node.light != kNone) {
            const auto end = static_cast<std::uint32_t>(placements_.size());
            nodes_.push_back({index, node.light, false, end, end, world});
        }
        const std::size_t copies = instanced ? node.instances.size() : 1;
        for (std::size_t copy = 0; copy < copies; ++copy) {
            const auto first = static_cast<std::uint32_t>(placements_.size());
            PreparedNode prepared{index, instanced ? kNone : node.light, node.mesh != kNone, first, first, world};
            if (instanced) prepared.world = world * instance_matrix(node.instances[copy]);
            if (prepared.has_mesh)
                for (const Primitive& p : scene_.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
                    const std::uint64_t number = primitives, elements = element_count(p);
                    if (elements == 0) continue;
                    const bool follows_skin = is_skinned(scene_, node, p);
                    if (!follows_skin || copy == 0) primitives += elements;
                    if (primitives > kMostPrimitives) refuse_primitives();
                    if (follows_skin) {
                        if (copy == 0) skinned.emplace_back(&p, number);
                    } else if (is_morphed(p)) {
                        place(p, deform(index, p, nullptr), number);
                    } else if (!is_solid(scene_, p) || taken.insert(&p, prepared.world)) {
                        place(p, prepare(p), number);
                    }
                }
            prepared.placement_end = static_cast<std::uint32_t>(placements_.size());
            if (prepared.has_mesh || prepared.light != kNone) nodes_.push_back(prepared);
        }
        if (skinned.empty()) continue;
        const JointMatrices joints =
            joint_matrices(scene_.skins[static_cast<std::size_t>(node.skin)], transforms_.world);
        const auto begin = static_cast<std::uint32_t>(placements_.size());
        for (const auto& [p, number] : skinned) place(*p, deform(index, *p, &joints), number);
        nodes_.push_back({index, kNone, true, begin, static_cast<std::uint32_t>(placements_.size()),
                          joints.object_to_world, joints.mirrored});
    }
}

void PreparedScene::place(const Primitive& p, const PreparedMesh& mesh, std::uint64_t first_primitive) {
    std::size_t material = p.material == kNone ? scene_.materials.size() : static_cast<std::size_t>(p.material);
    if (!has_triangles(p.mode) && p.normals.empty())
        material = p.material == kNone && p.colors.empty() ? ink_material(scene_) : material + lit_materials(scene_);
    placements_.push_back({&mesh, static_cast<std::uint32_t>(material), static_cast<std::uint32_t>(first_primitive)});
}

const PreparedMesh& PreparedScene::prepare(const Primitive& p) {
    const PreparedMesh*& mesh = prepared_[&p];
    if (!mesh) {
        const Material* material =
            p.material == kNone ? nullptr : &scene_.materials[static_cast<std::size_t>(p.material)];
        meshes_.push_back(std::unique_ptr<PreparedMesh>(new PreparedMesh(prepare_mesh(p, material))));
        mesh = meshes_.back().get();
    }
    return *mesh;
}

const PreparedMesh& PreparedScene::deform(int node, const Primitive& p, const JointMatrices* joints) {
    std::unique_ptr<DeformedMesh>& mesh = deformed_[{node, &p}];
    if (!mesh) mesh = std::make_unique<DeformedMesh>(prepare(p), p);
    mesh->update(weights_[static_cast<std::size_t>(node)], joints, isa_, arena_);
    return mesh->mesh();
}

std::vector<bool> PreparedScene::used_materials() const {
    std::vector<bool> used(ink_material(scene_) + 1, false);
    for (const Placement& p : placements_) used[p.material] = true;
    return used;
}

const PlacedCamera& PreparedScene::camera(const View& view, double aspect) {
    if (!view.turn) return standing_camera(view, aspect);
    // All of a turntable has one framing.
    View first = view;
    first.turn = 0;
    turned_ = turned(standing_camera(first, aspect), to_dvec3(view.up), *view.turn);
    return turned_;
}

const PlacedCamera& PreparedScene::standing_camera(const View& view, double aspect) {
    if (chosen_ && chosen_->aspect == aspect && chosen_->view == view) return chosen_->camera;
    bool framed = false;
    const PlacedCamera camera = choose_camera(scene_, transforms_, view, aspect, [&](const PointVisitor& visit) {
        framed = true;
        visit_animation(visit);
    });
    chosen_ = {view, aspect, camera, framed ? moment_.animation : kUnframed};
    return chosen_->camera;
}

// At equal steps through the animation that is chosen, wherever in it we are, so that every picture of it is framed
// alike; then back. Without an animation: as it stands.
void PreparedScene::visit_animation(const PointVisitor& visit) {
    if (moment_.animation == kNone) return visit_points(visit);
    double end = 0;
    for (std::size_t i = 0; i < scene_.animations.size(); ++i)
        if (moment_.animation == kEveryAnimation || moment_.animation == static_cast<int>(i))
            end = std::max(end, duration(scene_.animations[i]));
    constexpr int kSteps = 16;
    const Moment now = moment_;
    for (int step = 0; step <= kSteps; ++step) {
        move_to({now.animation, end * step / kSteps});
        visit_points(visit);
    }
    move_to(now);
}

void PreparedScene::visit_points(const PointVisitor& visit) const {
    std::map<const PreparedMesh*, std::vector<Vec3>> used;  // of each mesh, for its many instances
    for (const PreparedNode& node : nodes_)
        for (std::uint32_t i = node.first; i < node.placement_end; ++i) {
            std::vector<Vec3>& points = used[placements_[i].mesh];
            if (points.empty()) points = used_positions(placements_[i].mesh->primitive());
            for (const Vec3& v : points) visit(transform_point(node.world, to_dvec3(v)));
        }
}

}  // namespace tessera
