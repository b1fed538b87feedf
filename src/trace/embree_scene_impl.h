// What an EmbreeScene holds: hierarchies by what they are made of, and the tables from Embree's numbers to the frame's.
#pragma once

#include "trace/embree_group.h"

#include <unordered_map>

namespace tessera {

struct EmbreeScene::Impl {
    // What a hit on one geometry of one placement is.
    struct Slot {
        const std::uint32_t* triangle_numbers;  // from Embree's; null where they are the same
        std::uint32_t instance;                 // index into Frame::instances
        std::uint32_t checks;                   // Check bits that rays must be put to
        bool sphere;                            // has the names of ShapeView instead
        float front;                            // a ray sees the front where this times (normal . direction) < 0
    };
    enum Check : std::uint32_t { kCulledFromCamera = 1, kCulledOtherwise = 2, kSheer = 4, kUndecided = 8 };
    // A group where it stands in camera space.
    struct Placement {
        Group* group = nullptr;
        GroupKind kind = GroupKind::kStatic;
        std::uint32_t first_slot = 0, count = 0;  // its instances
        float camera_to_object[12] = {};          // not for kBaked, which lies in camera space
    };

    Impl(Isa isa, std::uint64_t max_bytes) : device(isa, max_bytes) {}

    void update(const Frame& frame, const std::vector<TraceClass>& classes, Arena& arena);
    void place(const Frame& frame);
    void fill_slots(const Frame& frame, const std::vector<TraceClass>& classes);
    void find_groups(const Frame& frame, const std::vector<TraceClass>& classes);
    void build_groups(const Frame& frame, Arena& arena);
    void make_top(const Frame& frame, Arena& arena);
    void clear();
    const float* object_to_camera(const Frame& frame, const Placement& placement) const {
        return frame.instances[slots[placement.first_slot].instance].object_to_camera;
    }

    // Embree's numbers of a hit.
    const Slot& slot(std::uint32_t placement, std::uint32_t geometry) const {
        return slots[(top ? placements[placement].first_slot : 0) + geometry];
    }

    EmbreeDevice device;
    std::unordered_map<GroupKey, std::unique_ptr<Group>, GroupKeyHash> kept;
    std::vector<std::unique_ptr<Group>> passing;  // of this frame only
    std::vector<Placement> placements;            // Embree's instances, if there is a top
    std::vector<Slot> slots;                      // by placement, then member
    SceneHandle top;                              // of instances; none where one group is traced by itself
    RTCScene traced = nullptr;                    // either
    float trace_from_camera[12];
    BuildStatistics statistics;
    std::uint32_t checks = 0;  // of all slots
};

}  // namespace tessera
