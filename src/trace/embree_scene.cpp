// The update to a frame: which instances go together, which hierarchies are new, and where they stand.
#include "trace/embree_scene.h"

#include "geometry/matrix.h"
#include "trace/embree_scene_impl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace tessera {
namespace {

constexpr float kIdentity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// Instances with the same can stand together.
struct Place {
    std::array<std::uint32_t, 12> matrix;  // bits
    bool strokes;
    friend bool operator==(const Place&, const Place&) = default;
};
struct PlaceHash {
    std::size_t operator()(const Place& place) const {
        std::uint64_t h = place.strokes;
        for (const std::uint32_t word : place.matrix) h = (h ^ word) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
        return static_cast<std::size_t>(h);
    }
};

bool is_deformed(const Frame& frame, std::size_t instance) {
    return !frame.instances[instance].mesh.is_stroke() && prepared_mesh(*frame.prepared[instance]).deformed;
}

}  // namespace

EmbreeScene::EmbreeScene(Isa isa, std::uint64_t max_bytes) : impl_(std::make_unique<Impl>(isa, max_bytes)) {
    impl_->clear();
}

EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::update(const Frame& frame, const std::vector<TraceClass>& classes, Arena& arena) {
    try {
        impl_->update(frame, classes, arena);
    } catch (...) {
        impl_->clear();
        throw;
    }
}

const BuildStatistics& EmbreeScene::statistics() const { return impl_->statistics; }
const float* EmbreeScene::trace_from_camera() const { return impl_->trace_from_camera; }
bool EmbreeScene::has_sheer() const { return impl_->checks & Impl::kSheer; }
bool EmbreeScene::has_undecided() const { return impl_->checks & Impl::kUndecided; }

void EmbreeScene::Impl::clear() {
    top.reset();
    traced = nullptr;
    passing.clear();
    kept.clear();
    placements.clear();
    slots.clear();
    statistics = {};
    checks = 0;
    std::copy_n(kIdentity, 12, trace_from_camera);
}

void EmbreeScene::Impl::update(const Frame& frame, const std::vector<TraceClass>& classes, Arena& arena) {
    // First let go, then build: less memory at a time.
    top.reset();
    traced = nullptr;
    passing.clear();
    statistics = {};
    std::copy_n(kIdentity, 12, trace_from_camera);
    place(frame);
    find_groups(frame, classes);
    build_groups(frame, arena);
    fill_slots(frame, classes);
    if (placements.size() == 1) {
        traced = placements[0].group->scene();
        if (placements[0].kind != GroupKind::kBaked) std::copy_n(placements[0].camera_to_object, 12, trace_from_camera);
    } else if (!placements.empty()) {
        make_top(frame, arena);
    }
    statistics.bytes = device.bytes();
}

// Deals the instances out to placements.
void EmbreeScene::Impl::place(const Frame& frame) {
    placements.clear();
    std::unordered_map<Place, std::uint32_t, PlaceHash> found;
    std::vector<std::uint32_t> placement_of(frame.instances.size());
    for (std::uint32_t i = 0; i < frame.instances.size(); ++i) {
        const InstanceView& instance = frame.instances[i];
        const bool deformed = is_deformed(frame, i);
        auto& placement = placement_of[i] = static_cast<std::uint32_t>(placements.size());
        if (!deformed) {
            Place at{{}, instance.mesh.is_stroke()};
            std::memcpy(at.matrix.data(), instance.object_to_camera, sizeof at.matrix);
            placement = found.try_emplace(at, placement).first->second;
        }
        if (placement == placements.size()) {
            Placement& made = placements.emplace_back();
            made.kind = deformed                    ? GroupKind::kDeformed
                        : instance.mesh.is_stroke() ? GroupKind::kStrokes
                                                    : GroupKind::kStatic;
            if (!invert_rows(instance.object_to_camera, made.camera_to_object)) made.kind = GroupKind::kBaked;
        }
        ++placements[placement].count;
    }
    std::uint32_t next = 0;
    for (Placement& placement : placements) {
        placement.first_slot = next;
        next += placement.count;
        placement.count = 0;
    }
    slots.resize(frame.instances.size());
    for (std::uint32_t i = 0; i < frame.instances.size(); ++i) {
        Placement& placement = placements[placement_of[i]];
        slots[placement.first_slot + placement.count++].instance = i;
    }
}

// Gives every placement its group, old or still to be built; old ones that none has any more go.
void EmbreeScene::Impl::find_groups(const Frame& frame, const std::vector<TraceClass>& classes) {
    GroupKey key;
    for (Placement& placement : placements) {
        key.kind = placement.kind;
        key.members.clear();
        for (std::uint32_t s = placement.first_slot; s < placement.first_slot + placement.count; ++s) {
            const std::uint32_t i = slots[s].instance;
            const MeshView& mesh = frame.instances[i].mesh;
            key.members.push_back({mesh.positions, mesh.triangles, frame.prepared[i], mesh.vertex_count,
                                   mesh.triangle_count, classes[i], frame.instances[i].shape.kind,
                                   frame.instances[i].shape.radius});
        }
        if (placement.kind == GroupKind::kStrokes || placement.kind == GroupKind::kBaked) {
            placement.group = passing.emplace_back(std::make_unique<Group>(device, key)).get();
        } else {
            std::unique_ptr<Group>& group = kept[key];
            if (!group) group = std::make_unique<Group>(device, key);
            placement.group = group.get();
        }
        placement.group->in_use = true;
    }
    std::erase_if(kept, [](const auto& entry) { return !entry.second->in_use; });
}

void EmbreeScene::Impl::build_groups(const Frame& frame, Arena& arena) {
    for (Placement& placement : placements) {
        Group& group = *placement.group;
        if (!std::exchange(group.in_use, false)) continue;  // another placement's too, and done
        auto change = Group::Change::kUnchanged;
        if (!group.scene()) {
            group.build(arena, placement.kind == GroupKind::kBaked ? object_to_camera(frame, placement) : nullptr);
            change = Group::Change::kBuilt;
        } else if (placement.kind == GroupKind::kDeformed) {
            change = group.refit(arena);
        }
        ++statistics.groups;
        statistics.built += change == Group::Change::kBuilt;
        statistics.refitted += change == Group::Change::kRefitted;
        statistics.duplicates += group.duplicates();
    }
}

void EmbreeScene::Impl::fill_slots(const Frame& frame, const std::vector<TraceClass>& classes) {
    checks = 0;
    for (const Placement& placement : placements) {
        // Embree's normals are right-handed in the space of the hierarchy; handedness is that of camera space.
        const bool turned =
            placement.kind != GroupKind::kBaked && determinant_of_rows(object_to_camera(frame, placement)) < 0;
        for (std::uint32_t m = 0; m < placement.count; ++m) {
            Slot& slot = slots[placement.first_slot + m];
            const TraceClass& type = classes[slot.instance];
            slot.triangle_numbers = placement.group->triangle_numbers(m);
            slot.sphere = frame.instances[slot.instance].shape.kind == ShapeView::Kind::kSphere;
            slot.checks = (type.culled ? kCulledFromCamera : 0u) |
                          (type.culled && !type.seen_inside ? kCulledOtherwise : 0u) |
                          (type.mask & kMeetsSheer ? kSheer : 0u) | (type.undecided ? kUndecided : 0u);
            slot.front = frame.instances[slot.instance].handedness * (turned ? -1.0f : 1.0f);
            checks |= slot.checks;
        }
    }
}

void EmbreeScene::Impl::make_top(const Frame& frame, Arena& arena) {
    top = device.new_scene(RTC_BUILD_QUALITY_MEDIUM);
    for (std::uint32_t p = 0; p < placements.size(); ++p) {
        const Placement& placement = placements[p];
        const GeometryHandle instance = device.new_geometry(RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance.get(), placement.group->scene());
        rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                                placement.kind == GroupKind::kBaked ? kIdentity : object_to_camera(frame, placement));
        rtcSetGeometryMask(instance.get(), placement.group->mask());
        rtcCommitGeometry(instance.get());
        rtcAttachGeometryByID(top.get(), instance.get(), p);
        device.check();
    }
    arena.for_each(1, [&](std::size_t) { rtcCommitScene(top.get()); });
    device.check();
    traced = top.get();
}

}  // namespace tessera
