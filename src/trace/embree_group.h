// One hierarchy: the triangles of instances that share a space, one Embree geometry for each. The geometries read the
// meshes' own arrays wherever they can. Built, refitted and read from one thread at a time; traced by many.
#pragma once

#include "trace/duplicates.h"
#include "trace/embree_device.h"
#include "trace/embree_scene.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

enum class GroupKind : std::uint8_t {
    kStatic,    // as long as its meshes are drawn
    kDeformed,  // one mesh, whose vertices are written over
    kStrokes,   // of one frame
    kBaked,     // of one frame, in camera space: its matrix has no good inverse
};

// What makes one hierarchy as good as another: the same arrays, traced in the same way. Arrays of equal address and
// length have equal contents, but for the vertices of kDeformed.
struct GroupMember {
    const float* positions;
    const std::uint32_t* triangles;
    const DrawnMesh* mesh;
    std::uint32_t vertex_count, triangle_count;
    TraceClass type;
    ShapeView::Kind shape = ShapeView::Kind::kTriangles;  // in place of the triangles
    float radius = 0;
    friend bool operator==(const GroupMember&, const GroupMember&) = default;
};
struct GroupKey {
    GroupKind kind = GroupKind::kStatic;
    std::vector<GroupMember> members;  // in the order of the frame's instances
    friend bool operator==(const GroupKey&, const GroupKey&) = default;
};
struct GroupKeyHash {
    std::size_t operator()(const GroupKey& key) const;
};

class Group {
  public:
    Group(EmbreeDevice& device, const GroupKey& key) : device_(device), key_(key), claim_(device) {}
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;

    // `to_camera` (3x4 rows): for kBaked, else null.
    void build(Arena& arena, const float* to_camera);
    // After the vertices of kDeformed were written over, maybe with the same.
    enum class Change { kUnchanged, kRefitted, kBuilt };
    Change refit(Arena& arena);

    RTCScene scene() const { return scene_.get(); }
    GroupKind kind() const { return key_.kind; }
    std::uint32_t mask() const { return mask_; }  // of all members
    std::uint32_t duplicates() const { return duplicates_; }
    // From Embree's triangle numbers in a member to the mesh's; null where they are the same.
    const std::uint32_t* triangle_numbers(std::size_t member) const;

    bool in_use = false;  // the scene's mark while it updates

  private:
    // What a member has of its own; empty where it shares the mesh's.
    struct Part {
        std::vector<float> positions;                 // in camera space, or padded for Embree; of shapes theirs
        std::vector<std::uint32_t> triangles;         // without duplicates
        std::vector<std::uint32_t> triangle_numbers;  // of those
    };

    void copy_positions(const GroupMember& member, const float* to_camera, Part& part);
    std::vector<std::vector<std::uint32_t>> duplicate_triangles(Arena& arena) const;
    std::vector<bool> hidden_shapes() const;
    void leave_out(const GroupMember& member, const std::vector<std::uint32_t>& dropped, Part& part);
    void attach(std::uint32_t member);
    void attach_shape(std::uint32_t member);
    void add_geometry(const GeometryHandle& geometry, std::uint32_t member);
    void commit(Arena& arena);
    const float* positions(std::size_t member) const {
        return parts_[member].positions.empty() ? key_.members[member].positions : parts_[member].positions.data();
    }

    EmbreeDevice& device_;
    const GroupKey key_;
    MemoryClaim claim_;
    std::vector<Part> parts_;  // by member
    SceneHandle scene_;        // reads the parts
    std::vector<std::vector<std::uint32_t>> dropped_;
    std::uint32_t mask_ = 0, duplicates_ = 0;
    std::uint64_t fingerprint_ = 0;  // of the vertices of kDeformed
};

}  // namespace tessera
