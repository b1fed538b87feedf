#include "trace/embree_group.h"

#include "shading/vectors.h"

#include <bit>
#include <cstring>
#include <map>
#include <utility>

namespace tessera {
namespace {

constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15u;

std::uint64_t mix(std::uint64_t h, std::uint64_t value) { return std::rotl((h ^ value) * kOdd, 29); }

std::uint64_t fingerprint(const float* numbers, std::size_t count) {
    std::uint64_t h = count;
    for (std::size_t i = 0; i + 2 <= count; i += 2) {
        std::uint64_t pair;
        std::memcpy(&pair, numbers + i, sizeof pair);
        h = mix(h, pair);
    }
    return count % 2 ? mix(h, std::bit_cast<std::uint32_t>(numbers[count - 1])) : h;
}

// Embree reads vertices by 16 bytes, and with the last one 4 bytes beyond the array. Memory is there
// unless a page ends with the array.
bool needs_padding(const GroupMember& member) {
    return reinterpret_cast<std::uintptr_t>(member.positions + 3 * std::size_t{member.vertex_count}) % 4096 == 0;
}

TriangleSet triangle_set(const GroupMember& member, const float* positions) {
    TriangleSet set{positions, member.triangles, member.vertex_count, member.triangle_count};
    const TraceClass& type = member.type;
    if (member.shape != ShapeView::Kind::kTriangles) set.triangle_count = 0;
    if (type.undecided) return set;  // each of them counts
    // Kinds of rays: from the camera or not, those that meet each kind of instance.
    std::uint8_t kinds = 0;
    for (unsigned i = 0; i < 3; ++i)
        if (type.mask >> i & 1u) kinds = static_cast<std::uint8_t>(kinds | 3u << 2 * i);
    constexpr std::uint8_t kNotFromCamera = 0b101010;
    set.front = kinds;
    set.back = type.culled ? (type.seen_inside ? kinds & kNotFromCamera : 0) : kinds;
    return set;
}

}  // namespace

std::size_t GroupKeyHash::operator()(const GroupKey& key) const {
    std::uint64_t h = static_cast<std::uint64_t>(key.kind);
    for (const GroupMember& m : key.members) {
        h = mix(h, reinterpret_cast<std::uintptr_t>(m.positions));
        h = mix(h, reinterpret_cast<std::uintptr_t>(m.triangles));
        h = mix(h, std::uint64_t{m.triangle_count} << 32 | m.vertex_count);
        h = mix(h, m.type.mask * 4u + m.type.culled * 2u + m.type.seen_inside);
        h = mix(h, static_cast<std::uint64_t>(m.shape));
    }
    return static_cast<std::size_t>(h ^ (h >> 32));
}

const std::uint32_t* Group::triangle_numbers(std::size_t member) const {
    const Part& part = parts_[member];
    return part.triangle_numbers.empty() ? nullptr : part.triangle_numbers.data();
}

void Group::build(Arena& arena, const float* to_camera) {
    scene_.reset();
    parts_.clear();
    claim_.clear();
    parts_.resize(key_.members.size());
    for (std::size_t m = 0; m < parts_.size(); ++m)
        if (key_.members[m].shape == ShapeView::Kind::kTriangles && (to_camera || needs_padding(key_.members[m])))
            copy_positions(key_.members[m], to_camera, parts_[m]);
    dropped_ = duplicate_triangles(arena);
    duplicates_ = 0;
    for (std::size_t m = 0; m < dropped_.size(); ++m) {
        duplicates_ += static_cast<std::uint32_t>(dropped_[m].size());
        if (!dropped_[m].empty()) leave_out(key_.members[m], dropped_[m], parts_[m]);
    }
    // Embree refits nothing but geometries of low-quality scenes, whose first build is as good as others.
    const bool lasting = key_.kind == GroupKind::kStatic;
    scene_ = device_.new_scene(lasting ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_LOW,
                               key_.kind == GroupKind::kDeformed ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE);
    mask_ = 0;
    const std::vector<bool> hidden = hidden_shapes();
    for (std::uint32_t m = 0; m < parts_.size(); ++m) {
        mask_ |= key_.members[m].type.mask;
        if (key_.members[m].shape == ShapeView::Kind::kTriangles)
            attach(m);
        else if (!hidden[m])
            attach_shape(m);
        duplicates_ += hidden[m];
    }
    commit(arena);
    if (key_.kind == GroupKind::kDeformed)
        fingerprint_ = fingerprint(key_.members[0].positions, 3 * std::size_t{key_.members[0].vertex_count});
}

Group::Change Group::refit(Arena& arena) {
    const GroupMember& member = key_.members[0];
    const std::size_t numbers = 3 * std::size_t{member.vertex_count};
    const std::uint64_t now = fingerprint(member.positions, numbers);
    if (now == fingerprint_) return Change::kUnchanged;
    if (!parts_[0].positions.empty()) std::memcpy(parts_[0].positions.data(), member.positions, 4 * numbers);
    // Triangles that came together, or apart, change what is left out.
    if (duplicate_triangles(arena) != dropped_) {
        build(arena, nullptr);
        return Change::kBuilt;
    }
    if (const RTCGeometry geometry = rtcGetGeometry(scene_.get(), 0)) {
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry);
    }
    commit(arena);
    fingerprint_ = now;
    return Change::kRefitted;
}

void Group::copy_positions(const GroupMember& member, const float* to_camera, Part& part) {
    const std::size_t numbers = 3 * std::size_t{member.vertex_count};
    claim_.add(4 * (numbers + 1));
    part.positions.resize(numbers + 1);
    if (!to_camera) {
        std::memcpy(part.positions.data(), member.positions, 4 * numbers);
        return;
    }
    for (std::size_t i = 0; i < numbers; i += 3) {
        const Vec3T<float> p = transform_point(to_camera, Vec3T<float>::load(member.positions + i));
        part.positions[i] = p.x;
        part.positions[i + 1] = p.y;
        part.positions[i + 2] = p.z;
    }
}

std::vector<std::vector<std::uint32_t>> Group::duplicate_triangles(Arena& arena) const {
    std::vector<TriangleSet> sets;
    for (std::size_t m = 0; m < parts_.size(); ++m) sets.push_back(triangle_set(key_.members[m], positions(m)));
    return find_duplicates(sets, arena);
}

// By member: whether it is a shape that stands exactly where earlier ones do, and hidden by them from all rays.
std::vector<bool> Group::hidden_shapes() const {
    struct Seen {
        std::uint8_t front = 0, back = 0;  // as those of a TriangleSet
    };
    std::map<std::pair<ShapeView::Kind, float>, Seen> found;
    std::vector<bool> hidden(parts_.size());
    for (std::size_t m = 0; m < parts_.size(); ++m) {
        const GroupMember& member = key_.members[m];
        if (member.shape == ShapeView::Kind::kTriangles) continue;
        const TriangleSet own = triangle_set(member, nullptr);
        Seen& seen = found[{member.shape, member.radius}];
        hidden[m] = (own.front | own.back) && !(own.front & ~seen.front) && !(own.back & ~seen.back);
        seen.front |= own.front;
        seen.back |= own.back;
    }
    return hidden;
}

void Group::leave_out(const GroupMember& member, const std::vector<std::uint32_t>& dropped, Part& part) {
    const std::size_t kept = member.triangle_count - dropped.size();
    claim_.add(16 * kept);
    part.triangles.reserve(3 * kept);
    part.triangle_numbers.reserve(kept);
    auto next = dropped.begin();
    for (std::uint32_t t = 0; t < member.triangle_count; ++t) {
        if (next != dropped.end() && *next == t) {
            ++next;
            continue;
        }
        const std::uint32_t* v = member.triangles + 3 * std::size_t{t};
        part.triangles.insert(part.triangles.end(), v, v + 3);
        part.triangle_numbers.push_back(t);
    }
}

void Group::attach(std::uint32_t m) {
    const GroupMember& member = key_.members[m];
    const Part& part = parts_[m];
    const bool shared = dropped_.empty() || dropped_[m].empty();
    const std::size_t count = shared ? member.triangle_count : part.triangle_numbers.size();
    if (count == 0) return;
    const GeometryHandle geometry = device_.new_geometry(RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               shared ? member.triangles : part.triangles.data(), 0, 12, count);
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions(m), 0, 12,
                               member.vertex_count);
    if (key_.kind == GroupKind::kDeformed) rtcSetGeometryBuildQuality(geometry.get(), RTC_BUILD_QUALITY_REFIT);
    add_geometry(geometry, m);
}

// A sphere or disc of Embree's own, in the origin.
void Group::attach_shape(std::uint32_t m) {
    const GroupMember& member = key_.members[m];
    const bool sphere = member.shape == ShapeView::Kind::kSphere;
    std::vector<float>& numbers = parts_[m].positions = {0, 0, 0, member.radius, 0, 1, 0, 0};
    const GeometryHandle geometry =
        device_.new_geometry(sphere ? RTC_GEOMETRY_TYPE_SPHERE_POINT : RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, numbers.data(), 0, 16, 1);
    if (!sphere)
        rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, numbers.data(), 16, 12,
                                   1);
    add_geometry(geometry, m);
}

void Group::add_geometry(const GeometryHandle& geometry, std::uint32_t m) {
    rtcSetGeometryMask(geometry.get(), key_.members[m].type.mask);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene_.get(), geometry.get(), m);
    device_.check();
}

void Group::commit(Arena& arena) {
    arena.for_each(1, [&](std::size_t) { rtcCommitScene(scene_.get()); });
    device_.check();
}

}  // namespace tessera
