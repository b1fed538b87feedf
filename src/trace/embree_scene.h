// The frame as Embree traces it: the one home of Embree (version 3.13). Meshes that stand still in one space are one
// hierarchy; several are instances of a scene in camera space. Embree decides which triangle a ray hits; everything
// else about the hit is computed by the surface functions of shading/.
#pragma once

#include "core/parallel.h"
#include "geometry/frame.h"
#include "trace/ray_packet.h"

#include <tessera/isa.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace tessera {

// How rays treat an instance, by its material.
struct TraceClass {
    std::uint32_t mask = kMeetsSolid;  // one of the kMeets... bits
    bool culled = false;               // its back is not seen
    bool seen_inside = false;          // but by rays that the camera did not cast (glass)
    bool undecided = false;            // its alpha says where it is at all (cut-outs and blended surfaces)
    friend bool operator==(const TraceClass&, const TraceClass&) = default;
};

// A surface that a ray passed.
struct SheerHit {
    std::uint32_t lane, instance, triangle;
    float t;
};

// In an order of their own, by lane, instance and triangle, each once: hierarchies may name a surface more than once.
void sort_by_triangle(std::vector<SheerHit>& hits);

struct BuildStatistics {
    std::uint32_t groups = 0, built = 0, refitted = 0, duplicates = 0;  // hierarchies: all, made and refitted this time
    std::uint64_t bytes = 0;                                            // that Embree holds
};

class EmbreeScene {
  public:
    // Embree uses the instructions of `isa` (resolved). Throws kInternal when Embree cannot start, kLimit when it
    // needs more than `max_bytes`, then and later.
    EmbreeScene(Isa isa, std::uint64_t max_bytes);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    // Brings the hierarchies to a frame, whose meshes are read until the next update: what is new is built, what
    // changed its shape is refitted, the rest stays. Meshes are known by their addresses and lengths, so another scene
    // needs another EmbreeScene. After an error nothing is hit until the next update. `classes` by instance. Runs in
    // the arena, isolated from the host's tasks.
    void update(const Frame& frame, const std::vector<TraceClass>& classes, Arena& arena);

    const BuildStatistics& statistics() const;
    // 3x4 rows: rays that are made in camera space are traced in this one. Lengths along them stay.
    const float* trace_from_camera() const;

    // The nearest solid surface that shows a side which is drawn, per lane of `valid` (-1: traced, 0: not) within
    // t_near .. t_far, both finite or t_far infinite. Undecided surfaces are no obstacles: those in front of it, and
    // maybe some behind, are appended to `sheer` in no order and maybe twice; without `sheer` they are not looked for.
    // `coherent`: the rays lie close together. `from_camera`: seen_inside does not count. Lanes whose numbers are not
    // finite or beyond 1.8e18, whose t_near is negative, or whose direction is zero, hit nothing; other lanes are not
    // touched. Rays cannot pass between triangles that share an edge, but some of those at the very vertex can. The
    // normal stays in the hierarchy's space. W is 1, 4, 8 or 16. Any number of threads at a time.
    // `checked`: only usable lanes are valid, and time, id (the lane) and flags are set; then Embree's numbers of the
    // packet may be used again.
    template <int W>
    void nearest(const int* valid, RayPacket<W>& rays, bool coherent, bool from_camera, std::vector<SheerHit>* sheer,
                 bool checked = false) const;
    // Whether anything solid is in the way; faces stop light from both sides. Sheer surfaces are not; those along rays
    // that nothing stops are appended to `sheer`, as above, and maybe others.
    template <int W>
    void occluded(const int* valid, RayPacket<W>& rays, bool coherent, std::vector<SheerHit>* sheer = nullptr,
                  bool checked = false) const;

    bool has_sheer() const;
    bool has_undecided() const;

    struct Impl;  // embree_scene_impl.h

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace tessera
