// EmbreeScene's calls beside bare Embree's on an identical scene: the same rays in the same packets, a few thousand at
// a time, each of the two the first every other time. Only the calls are timed.
#include "trace_kernel_cases.h"
#include "traced_meshes.h"

#include "bench/peers/embree_builds.h"

#include <map>

namespace tessera::bench {
namespace {

using peers::Kind;

constexpr int kTilesAtOnce = 4, kTileSide = peers::kMaxTileSide;

struct Scenes {
    peers::Device device{1};
    peers::Scene scene = peers::make_scene("sphere100k");
    peers::Frame frame{scene, kTileSide};
    TracedMeshes meshes{{&scene.mesh, &scene.ground}, false, false};
    Arena arena{1};
    EmbreeScene ours{best_isa(), kPlenty};
    peers::BareHierarchy bare{device};

    Scenes() {
        peers::pad_vertices(scene.mesh);
        peers::pad_vertices(scene.ground);
        ours.update(meshes.frame, meshes.classes, arena);
        bare.build({&scene.mesh, &scene.ground}, false);
        device.check();
        peers::find_points(bare.scene(), frame);
    }
    static const Scenes& get() {
        static const Scenes scenes;
        return scenes;
    }
};

// --- ours ---------------------------------------------------------------------------------------

template <int W>
struct OurPackets {
    struct Packet {
        alignas(64) int valid[W];
        RayPacket<W> rays;
    };
    std::vector<Packet> all;
    std::size_t used = 0;

    void add(const peers::RayTile& rays, int count) {
        for (int first = 0; first < count; first += W) {
            if (used == all.size()) all.emplace_back();
            Packet& p = all[used++];
            const auto copy = [first](float* to, const float* from) {
                std::memcpy(to, from + first, W * sizeof(float));
            };
            RayPacket<W>& r = p.rays;
            copy(r.org_x, rays.org_x), copy(r.org_y, rays.org_y), copy(r.org_z, rays.org_z);
            copy(r.dir_x, rays.dir_x), copy(r.dir_y, rays.dir_y), copy(r.dir_z, rays.dir_z);
            copy(r.t_near, rays.t_near), copy(r.t_far, rays.t_far);
            for (int i = 0; i < W; ++i) {
                p.valid[i] = first + i < count ? -1 : 0;
                r.time[i] = 0;
                r.mask[i] = kMeetsAll, r.id[i] = static_cast<std::uint32_t>(i), r.flags[i] = 0;
            }
        }
    }
    void trace(Kind kind, bool coherent) {
        const EmbreeScene& scene = Scenes::get().ours;
        for (std::size_t n = 0; n < used; ++n) {
            Packet& p = all[n];
            if (kind == Kind::kShadow)
                scene.occluded<W>(p.valid, p.rays, coherent, nullptr, true);
            else
                scene.nearest<W>(p.valid, p.rays, coherent, kind == Kind::kPrimary, nullptr, true);
        }
    }
    void tally(Kind kind, peers::Totals& sum) const {
        for (std::size_t n = 0; n < used; ++n)
            for (int i = 0; i < W; ++i) {
                const RayPacket<W>& r = all[n].rays;
                if (!all[n].valid[i]) continue;
                ++sum.rays;
                const bool hit = kind == Kind::kShadow ? r.t_far[i] < 0 : r.instance[i] != kNoHit;
                sum.hits += hit;
                if (hit && kind != Kind::kShadow) sum.distance += static_cast<double>(r.t_far[i]);
            }
    }
};

// --- bare Embree --------------------------------------------------------------------------------

template <int W>
struct BarePackets {
    struct Packet {
        alignas(64) int valid[W];
        peers::RayHitPacket<W> query;
    };
    std::vector<Packet> all;
    std::size_t used = 0;

    void add(const peers::RayTile& rays, int count) {
        for (int first = 0; first < count; first += W) {
            if (used == all.size()) all.emplace_back();
            Packet& p = all[used++];
            peers::load_rays<W>(rays, first, count, p.query.ray, p.valid);
            peers::clear_hits<W>(p.query);
        }
    }
    void trace(Kind kind, bool coherent) {
        RTCIntersectContext context = peers::make_context(coherent);
        RTCScene scene = Scenes::get().bare.scene();
        for (std::size_t n = 0; n < used; ++n) {
            Packet& p = all[n];
            if (kind == Kind::kShadow)
                peers::occluded(p.valid, scene, context, p.query.ray);
            else
                peers::intersect(p.valid, scene, context, p.query);
        }
    }
    void tally(Kind kind, peers::Totals& sum) const {
        for (std::size_t n = 0; n < used; ++n)
            for (int i = 0; i < W; ++i) {
                if (!all[n].valid[i]) continue;
                const float t_far = all[n].query.ray.tfar[i];
                ++sum.rays;
                const bool hit =
                    kind == Kind::kShadow ? t_far < 0 : all[n].query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
                sum.hits += hit;
                if (hit && kind != Kind::kShadow) sum.distance += static_cast<double>(t_far);
            }
    }
};

template <>
struct BarePackets<1> {
    std::vector<RTCRayHit> all;
    std::size_t used = 0;

    void add(const peers::RayTile& rays, int count) {
        for (int i = 0; i < count; ++i) {
            if (used == all.size()) all.emplace_back();
            RTCRayHit& query = all[used++];
            query.ray = peers::single_ray({rays.org_x[i], rays.org_y[i], rays.org_z[i]},
                                          {rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]}, rays.t_near[i], rays.t_far[i]);
            query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        }
    }
    void trace(Kind kind, bool coherent) {
        RTCIntersectContext context = peers::make_context(coherent);
        RTCScene scene = Scenes::get().bare.scene();
        for (std::size_t n = 0; n < used; ++n) {
            if (kind == Kind::kShadow)
                rtcOccluded1(scene, &context, &all[n].ray);
            else
                rtcIntersect1(scene, &context, &all[n]);
        }
    }
    void tally(Kind kind, peers::Totals& sum) const {
        for (std::size_t n = 0; n < used; ++n) {
            ++sum.rays;
            const bool hit = kind == Kind::kShadow ? all[n].ray.tfar < 0 : all[n].hit.geomID != RTC_INVALID_GEOMETRY_ID;
            sum.hits += hit;
            if (hit && kind != Kind::kShadow) sum.distance += static_cast<double>(all[n].ray.tfar);
        }
    }
};

// --- both ---------------------------------------------------------------------------------------

// body(tile, rays, count) for packs of tiles, and end() after each.
template <class Body, class End>
void for_packs(Kind kind, const Body& body, const End& end) {
    const peers::Frame& frame = Scenes::get().frame;
    static peers::RayTile rays;
    for (int tile = 0; tile < frame.tiles(); ++tile) {
        body(rays, frame.generate(kind, tile, rays));
        if (tile % kTilesAtOnce == kTilesAtOnce - 1 || tile + 1 == frame.tiles()) end(tile / kTilesAtOnce);
    }
}

// What single rays of bare Embree find.
const peers::Totals& truth(Kind kind) {
    static std::map<Kind, peers::Totals> known;
    const auto entry = known.try_emplace(kind);
    peers::Totals& sum = entry.first->second;
    if (entry.second) {
        BarePackets<1> singles;
        for_packs(
            kind, [&](const peers::RayTile& rays, int count) { singles.add(rays, count); },
            [&](int) {
                singles.trace(kind, false);
                singles.tally(kind, sum);
                singles.used = 0;
            });
    }
    return sum;
}

template <int W>
void run_traces(benchmark::State& state, Kind kind, bool coherent) {
    peers::Totals ours, bare;
    double our_time = 0, bare_time = 0;
    OurPackets<W> our_packets;
    BarePackets<W> bare_packets;
    for (auto _ : state) {
        ours = bare = {};
        const double before = our_time;
        const auto end = [&](int pack) {
            const auto trace_ours = [&] { our_time += seconds_of([&] { our_packets.trace(kind, coherent); }); };
            if (pack % 2 == 0) trace_ours();
            bare_time += seconds_of([&] { bare_packets.trace(kind, coherent); });
            if (pack % 2 != 0) trace_ours();
            our_packets.tally(kind, ours);
            bare_packets.tally(kind, bare);
            our_packets.used = bare_packets.used = 0;
        };
        for_packs(
            kind,
            [&](const peers::RayTile& rays, int count) {
                our_packets.add(rays, count);
                bare_packets.add(rays, count);
            },
            end);
        state.SetIterationTime(our_time - before);
    }
    if (!agree(ours, truth(kind)) || !agree(bare, truth(kind))) {
        state.SkipWithError("hits or distances are not those of single rays");
        return;
    }
    const double traced = static_cast<double>(state.iterations()) * static_cast<double>(ours.rays);
    state.SetItemsProcessed(static_cast<std::int64_t>(traced));
    state.counters["bare_items_per_second"] = traced / bare_time;
    state.counters["bare_over_ours"] = bare_time / our_time;
    state.counters["hits"] = static_cast<double>(ours.hits);
    state.counters["mean_distance"] = ours.mean_distance();
}

template <int W>
void add(Kind kind, bool coherent) {
    const std::string title = std::string(kind == Kind::kShadow ? "occluded" : "nearest") + "/sphere100k/" +
                              name(kind) + "/" + std::to_string(W) + (coherent ? "/coherent" : "");
    benchmark::RegisterBenchmark(title.c_str(), run_traces<W>, kind, coherent)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_traces() {
    for (const Kind kind : peers::kKinds) {
        add<1>(kind, false);
        for (const bool coherent : {false, true})
            add<4>(kind, coherent), add<8>(kind, coherent), add<16>(kind, coherent);
    }
}

}  // namespace tessera::bench
