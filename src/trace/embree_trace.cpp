// The trace calls: rays are handed to Embree in place, and its numbers come back as the frame's.
#include <tessera/error.h>

#include "shading/shape_surface.h"
#include "trace/embree_scene_impl.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace tessera {
namespace {

using Impl = EmbreeScene::Impl;

template <int W>
struct EmbreeRays;
template <>
struct EmbreeRays<1> {
    using Type = RTCRayHit;
    static void intersect(const int*, RTCScene s, RTCIntersectContext* c, Type* r) { rtcIntersect1(s, c, r); }
    static void occluded(const int*, RTCScene s, RTCIntersectContext* c, Type* r) { rtcOccluded1(s, c, &r->ray); }
};
template <>
struct EmbreeRays<4> {
    using Type = RTCRayHit4;
    static void intersect(const int* v, RTCScene s, RTCIntersectContext* c, Type* r) { rtcIntersect4(v, s, c, r); }
    static void occluded(const int* v, RTCScene s, RTCIntersectContext* c, Type* r) { rtcOccluded4(v, s, c, &r->ray); }
};
template <>
struct EmbreeRays<8> {
    using Type = RTCRayHit8;
    static void intersect(const int* v, RTCScene s, RTCIntersectContext* c, Type* r) { rtcIntersect8(v, s, c, r); }
    static void occluded(const int* v, RTCScene s, RTCIntersectContext* c, Type* r) { rtcOccluded8(v, s, c, &r->ray); }
};
template <>
struct EmbreeRays<16> {
    using Type = RTCRayHit16;
    static void intersect(const int* v, RTCScene s, RTCIntersectContext* c, Type* r) { rtcIntersect16(v, s, c, r); }
    static void occluded(const int* v, RTCScene s, RTCIntersectContext* c, Type* r) { rtcOccluded16(v, s, c, &r->ray); }
};

// Whether RayPacket<W> is what Embree takes: its arrays, one after the other.
template <int W>
constexpr bool same_layout() {
    using Ours = RayPacket<W>;
    using Theirs = typename EmbreeRays<W>::Type;
    constexpr std::size_t ray = offsetof(Theirs, ray), hit = offsetof(Theirs, hit);
    using Ray = decltype(Theirs::ray);
    using Hit = decltype(Theirs::hit);
    return sizeof(Ours) == sizeof(Theirs) && alignof(Ours) >= alignof(Theirs) &&
           offsetof(Ours, org_x) == ray + offsetof(Ray, org_x) &&
           offsetof(Ours, t_near) == ray + offsetof(Ray, tnear) &&
           offsetof(Ours, dir_x) == ray + offsetof(Ray, dir_x) && offsetof(Ours, time) == ray + offsetof(Ray, time) &&
           offsetof(Ours, t_far) == ray + offsetof(Ray, tfar) && offsetof(Ours, mask) == ray + offsetof(Ray, mask) &&
           offsetof(Ours, id) == ray + offsetof(Ray, id) && offsetof(Ours, flags) == ray + offsetof(Ray, flags) &&
           offsetof(Ours, ng_x) == hit + offsetof(Hit, Ng_x) && offsetof(Ours, u) == hit + offsetof(Hit, u) &&
           offsetof(Ours, triangle) == hit + offsetof(Hit, primID) &&
           offsetof(Ours, geometry) == hit + offsetof(Hit, geomID) &&
           offsetof(Ours, instance) == hit + offsetof(Hit, instID);
}
static_assert(same_layout<1>() && same_layout<4>() && same_layout<8>() && same_layout<16>());
static_assert(kNoHit == RTC_INVALID_GEOMETRY_ID && kNoHit == ~0u);

template <int W>
struct alignas(64) Lanes {  // -1: traced, 0: not
    int on[W];
};

// What the filter below is to do with the hits of one call. Embree hands the address of its own part on.
struct TraceContext {
    RTCIntersectContext embree;
    const Impl* scene;
    std::uint32_t checks;          // those of a slot that count
    std::uint32_t passed;          // slots with one of these checks are passed and noted
    std::vector<SheerHit>* sheer;  // null: not noted
    bool failed;                   // there was no memory to note them

    TraceContext(const Impl& impl, bool coherent)
        : scene(&impl), checks(0), passed(Impl::kUndecided), sheer(nullptr), failed(false) {
        rtcInitIntersectContext(&embree);
        embree.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
};
static_assert(offsetof(TraceContext, embree) == 0);

// Which checks count for rays.
std::uint32_t checks_for(bool from_camera) {
    return Impl::kUndecided | (from_camera ? Impl::kCulledFromCamera : Impl::kCulledOtherwise);
}

bool back_is_culled(const Impl::Slot& slot, std::uint32_t checks, float normal_along_ray) {
    return (slot.checks & checks & ~std::uint32_t{Impl::kUndecided}) != 0 && !(slot.front * normal_along_ray < 0.0f);
}

std::uint32_t number_of(const Impl::Slot& slot, std::uint32_t triangle, float normal_along_ray) {
    if (slot.sphere) return normal_along_ray > 0.0f ? kLeavingSphere : 0;
    return slot.triangle_numbers ? slot.triangle_numbers[triangle] : triangle;
}

// Lets those hits stand that are solid and show a side that is drawn. Embree may come with any part of the packet; a
// ray's id is its lane. Within instances, ray and normal are in their space.
void filter_hits(const RTCFilterFunctionNArguments* args) {
    TraceContext& context = *reinterpret_cast<TraceContext*>(args->context);
    RTCRayN* ray = args->ray;
    RTCHitN* hit = args->hit;
    const unsigned n = args->N;
    for (unsigned i = 0; i < n; ++i) {
        if (args->valid[i] != -1) continue;
        const Impl::Slot& slot = context.scene->slot(RTCHitN_instID(hit, n, i, 0), RTCHitN_geomID(hit, n, i));
        const float along = RTCHitN_Ng_x(hit, n, i) * RTCRayN_dir_x(ray, n, i) +
                            RTCHitN_Ng_y(hit, n, i) * RTCRayN_dir_y(ray, n, i) +
                            RTCHitN_Ng_z(hit, n, i) * RTCRayN_dir_z(ray, n, i);
        const bool seen = !back_is_culled(slot, context.checks, along);
        const bool sheer = (slot.checks & context.passed) != 0;
        if (seen && !sheer) continue;
        args->valid[i] = 0;
        if (!seen || !sheer || !context.sheer) continue;
        try {
            context.sheer->push_back({RTCRayN_id(ray, n, i), slot.instance,
                                      number_of(slot, RTCHitN_primID(hit, n, i), along), RTCRayN_tfar(ray, n, i)});
        } catch (...) {  // nothing may leave through Embree
            context.failed = true;
        }
    }
}

// Chooses the lanes that Embree can trace, and sets the numbers that are its own. False when there are none.
template <int W>
bool prepare(const int* valid, RayPacket<W>& r, Lanes<W>& lanes) {
    constexpr float kMost = 1.844e18f;  // Embree's own limit, by which squares stay finite
    // Integers rather than bool, so that compilers see vectors.
    int on[W];
    std::copy_n(valid, W, on);
    for (int i = 0; i < W; ++i) {
        const auto in_range = [](float x) { return -static_cast<int>(std::fabs(x) <= kMost); };
        const auto not_zero = [](float x) { return -static_cast<int>(x != 0.0f); };
        on[i] &= in_range(r.org_x[i]) & in_range(r.org_y[i]) & in_range(r.org_z[i]);
        on[i] &= in_range(r.dir_x[i]) & in_range(r.dir_y[i]) & in_range(r.dir_z[i]);
        on[i] &= not_zero(r.dir_x[i]) | not_zero(r.dir_y[i]) | not_zero(r.dir_z[i]);
        on[i] &= -static_cast<int>(r.t_near[i] >= 0.0f) & -static_cast<int>(r.t_near[i] <= FLT_MAX) &
                 -static_cast<int>(r.t_far[i] >= r.t_near[i]);
    }
    int any = 0;
    for (int i = 0; i < W; ++i) {
        lanes.on[i] = on[i];
        any |= on[i];
    }
    for (int i = 0; i < W; ++i) {
        r.time[i] = 0.0f;
        r.id[i] = static_cast<std::uint32_t>(i);
        r.flags[i] = 0;
    }
    return any != 0;
}

// The same for rays whose maker has done it.
template <int W>
bool take_lanes(const int* valid, RayPacket<W>& r, bool checked, Lanes<W>& lanes) {
    if (!checked) return prepare(valid, r, lanes);
    int any = 0;
    for (int i = 0; i < W; ++i) any |= lanes.on[i] = valid[i];
    return any != 0;
}

// Calls `trace` for the packet, or for parts of it that have the width of Embree's vectors: Embree 3.13 ignores which
// lanes of wider ones are on.
template <int W, class Trace>
void in_native_parts(const Lanes<W>& lanes, RayPacket<W>& rays, int native, const Trace& trace) {
    if constexpr (W > 4) {
        if (W > native) {
            for (int first = 0; first < W; first += W / 2) {
                Lanes<W / 2> part_lanes;
                std::copy_n(lanes.on + first, W / 2, part_lanes.on);
                if (std::none_of(part_lanes.on, part_lanes.on + W / 2, [](int on) { return on; })) continue;
                // Both are arrays of numbers of four bytes, one after the other.
                RayPacket<W / 2> part;
                constexpr std::size_t kArrays = sizeof part / (4 * (W / 2));
                auto* whole = reinterpret_cast<unsigned char*>(&rays) + 4 * first;
                auto* half = reinterpret_cast<unsigned char*>(&part);
                for (std::size_t a = 0; a < kArrays; ++a)
                    std::memcpy(half + a * 4 * (W / 2), whole + a * 4 * W, 4 * (W / 2));
                in_native_parts(part_lanes, part, native, trace);
                for (std::size_t a = 0; a < kArrays; ++a)
                    std::memcpy(whole + a * 4 * W, half + a * 4 * (W / 2), 4 * (W / 2));
            }
            return;
        }
    }
    trace(lanes.on, reinterpret_cast<typename EmbreeRays<W>::Type*>(&rays), EmbreeRays<W>{});
}

void throw_if_failed(const TraceContext& context) {
    if (context.failed) throw Error(ErrorCode::kLimit, "there is not enough memory for the surfaces along a ray");
}

template <int W>
void intersect(const Lanes<W>& lanes, RayPacket<W>& rays, TraceContext& context) {
    in_native_parts(lanes, rays, context.scene->device.packet_width(), [&](const int* on, auto* packet, auto embree) {
        embree.intersect(on, context.scene->traced, &context.embree, packet);
    });
    throw_if_failed(context);
}

// For as long as it lives, the rays do not meet the surfaces of some kinds.
template <int W>
class LeaveOut {
  public:
    LeaveOut(RayPacket<W>& rays, bool needed, std::uint32_t kinds) : rays_(rays), needed_(needed) {
        if (!needed_) return;
        std::copy_n(rays_.mask, W, mask_);
        for (std::uint32_t& mask : rays_.mask) mask &= ~kinds;
    }
    ~LeaveOut() {
        if (needed_) std::copy_n(mask_, W, rays_.mask);
    }
    LeaveOut(const LeaveOut&) = delete;
    LeaveOut& operator=(const LeaveOut&) = delete;

  private:
    RayPacket<W>& rays_;
    const bool needed_;
    std::uint32_t mask_[W];
};

}  // namespace

void sort_by_triangle(std::vector<SheerHit>& hits) {
    std::sort(hits.begin(), hits.end(), [](const SheerHit& a, const SheerHit& b) {
        if (a.lane != b.lane) return a.lane < b.lane;
        return a.instance != b.instance ? a.instance < b.instance : a.triangle < b.triangle;
    });
    const auto end = std::unique(hits.begin(), hits.end(), [](const SheerHit& a, const SheerHit& b) {
        return a.lane == b.lane && a.instance == b.instance && a.triangle == b.triangle;
    });
    hits.erase(end, hits.end());
}

// A hit's normal along its ray, in the space of the hierarchy, where Embree leaves normals.
template <int W>
static float normal_along_ray(const Impl& impl, const RayPacket<W>& r, int i) {
    float x = r.dir_x[i], y = r.dir_y[i], z = r.dir_z[i];
    if (impl.top && impl.placements[r.instance[i]].kind != GroupKind::kBaked) {
        const Vec3T<float> d =
            transform_direction(impl.placements[r.instance[i]].camera_to_object, Vec3T<float>{x, y, z});
        x = d.x, y = d.y, z = d.z;
    }
    return r.ng_x[i] * x + r.ng_y[i] * y + r.ng_z[i] * z;
}

// Embree's numbers of a lane's hit become the frame's.
template <int W>
static void name_hit(const Impl& impl, RayPacket<W>& r, int i, const Impl::Slot& slot) {
    r.triangle[i] = number_of(slot, r.triangle[i], slot.sphere ? normal_along_ray(impl, r, i) : 0.0f);
    r.instance[i] = slot.instance;
}

// Names the hits of a packet where all are on one geometry and stand, as most do: all lanes at a time. False where that
// is not so.
template <int W>
static bool name_hits_on_one(const Impl& impl, const Lanes<W>& lanes, RayPacket<W>& r, std::uint32_t checks) {
    std::uint32_t hit[W];  // all ones, or 0
    for (int i = 0; i < W; ++i)
        hit[i] = static_cast<std::uint32_t>(lanes.on[i] & -static_cast<int>(r.geometry[i] != kNoHit));
    int first = 0;
    while (first < W && !hit[first]) ++first;
    if (first == W) return true;
    const std::uint32_t geometry = r.geometry[first], instance = r.instance[first];
    std::uint32_t others = 0;
    for (int i = 0; i < W; ++i) others |= hit[i] & ((r.geometry[i] ^ geometry) | (r.instance[i] ^ instance));
    if (others) return false;
    const Impl::Slot& slot = impl.slot(instance, geometry);
    checks &= slot.checks;
    if (slot.sphere || (checks & Impl::kUndecided)) return false;
    if (checks) {
        constexpr float kSame[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        const bool moved = impl.top && impl.placements[instance].kind != GroupKind::kBaked;
        const float* const m = moved ? impl.placements[instance].camera_to_object : kSame;
        std::uint32_t back = 0;
        for (int i = 0; i < W; ++i) {
            const Vec3T<float> d = transform_direction(m, Vec3T<float>{r.dir_x[i], r.dir_y[i], r.dir_z[i]});
            const float along = r.ng_x[i] * d.x + r.ng_y[i] * d.y + r.ng_z[i] * d.z;
            back |= hit[i] & ~(0u - static_cast<std::uint32_t>(slot.front * along < 0.0f));
        }
        if (back) return false;
    }
    if (slot.triangle_numbers)
        for (int i = 0; i < W; ++i)
            if (hit[i]) r.triangle[i] = slot.triangle_numbers[r.triangle[i]];
    for (int i = 0; i < W; ++i) r.instance[i] = (slot.instance & hit[i]) | (r.instance[i] & ~hit[i]);
    return true;
}

template <int W>
void EmbreeScene::nearest(const int* valid, RayPacket<W>& rays, bool coherent, bool from_camera,
                          std::vector<SheerHit>* sheer, bool checked) const {
    const Impl& impl = *impl_;
    Lanes<W> lanes;
    const bool any = take_lanes(valid, rays, checked, lanes);
    // kNoHit is all ones.
    std::uint32_t nothing[W];
    for (int i = 0; i < W; ++i) nothing[i] = static_cast<std::uint32_t>(valid[i]);
    for (int i = 0; i < W; ++i) rays.triangle[i] |= nothing[i];
    for (int i = 0; i < W; ++i) rays.geometry[i] |= nothing[i];
    for (int i = 0; i < W; ++i) rays.instance[i] |= nothing[i];
    if (!any || !impl.traced) return;
    TraceContext context(impl, coherent);
    context.checks = checks_for(from_camera);
    const bool check = (context.checks & impl.checks) != 0;
    float t_far[W];
    if (check) std::copy_n(rays.t_far, W, t_far);
    intersect(lanes, rays, context);
    if (name_hits_on_one(impl, lanes, rays, context.checks)) return;

    // Most hits are on the front of something solid and stand. The rest is traced once more, now with the filter,
    // which all hits would otherwise have to go through.
    Lanes<W> again;
    int more = 0;
    for (int i = 0; i < W; ++i) {
        again.on[i] = 0;
        if (!lanes.on[i] || rays.geometry[i] == kNoHit) continue;
        const Impl::Slot& slot = impl.slot(rays.instance[i], rays.geometry[i]);
        if (check && (slot.checks & context.checks) != 0 &&
            ((slot.checks & Impl::kUndecided) ||
             back_is_culled(slot, context.checks, normal_along_ray(impl, rays, i)))) {
            again.on[i] = more = -1;
            rays.t_far[i] = t_far[i];
            rays.triangle[i] = rays.geometry[i] = rays.instance[i] = kNoHit;
        } else {
            name_hit(impl, rays, i, slot);
        }
    }
    if (!more) return;
    context.embree.filter = filter_hits;
    context.sheer = sheer;
    intersect(again, rays, context);
    for (int i = 0; i < W; ++i)
        if (again.on[i] && rays.geometry[i] != kNoHit)
            name_hit(impl, rays, i, impl.slot(rays.instance[i], rays.geometry[i]));
}

template <int W>
void EmbreeScene::occluded(const int* valid, RayPacket<W>& rays, bool coherent, std::vector<SheerHit>* sheer,
                           bool checked) const {
    Lanes<W> lanes;
    if (!take_lanes(valid, rays, checked, lanes) || !impl_->traced) return;
    const LeaveOut<W> leave_out(rays, has_sheer() && !sheer, kMeetsSheer);
    // rtcOccluded16 of Embree 3.13.5 never returns for coherent rays in a scene of instances, with AVX-512.
    TraceContext context(*impl_, coherent && !impl_->top);
    if (sheer) {
        context.embree.filter = filter_hits;
        context.passed = Impl::kSheer;
        context.sheer = sheer;
    }
    in_native_parts(lanes, rays, impl_->device.packet_width(), [&](const int* on, auto* packet, auto embree) {
        embree.occluded(on, impl_->traced, &context.embree, packet);
    });
    throw_if_failed(context);
}

#define TESSERA_PACKETS(W)                                                                                            \
    template void EmbreeScene::nearest<W>(const int*, RayPacket<W>&, bool, bool, std::vector<SheerHit>*, bool) const; \
    template void EmbreeScene::occluded<W>(const int*, RayPacket<W>&, bool, std::vector<SheerHit>*, bool) const;
TESSERA_PACKETS(1)
TESSERA_PACKETS(4)
TESSERA_PACKETS(8)
TESSERA_PACKETS(16)
#undef TESSERA_PACKETS

}  // namespace tessera
