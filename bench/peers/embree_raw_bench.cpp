// Rays a second of Embree 3, without a renderer around it: what an engine on top of it can reach at most.
//     tessera_embree_raw_bench [--scene NAME...] [--kind KIND...] [--width N...] [--threads N]
// Every kind of ray (embree_scenes.h) is traced one by one and in packets of 4, 8 and 16, these with and without the
// flag for coherent rays. A line of JSON each; the time includes making the rays. Exit code 1 when packets do not find
// the hits and distances of single rays: then something is wrong, and the speed says nothing.
#include "bench/peers/embree_runs.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <cstdio>
#include <map>

namespace peers {
namespace {

struct Options {
    std::vector<std::string> scenes{"sphere100k", "hf100k", "hf1m"}, kinds{"primary", "shadow", "mirror", "diffuse"};
    std::vector<int> widths{1, 4, 8, 16};
    int threads = 1, tile_side = 16, repeats = 7;
    bool robust = false;
    RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
};

struct Work {
    RTCScene scene;
    const Frame& frame;
    Kind kind;
    bool coherent;
};

// Of a tile.
struct Hits {
    std::size_t count = 0;
    float distance = 0;
};

Hits trace_singles(const Work& work, const RayTile& rays, int count) {
    Hits hits;
    RTCIntersectContext context = make_context(work.coherent);
    for (int i = 0; i < count; ++i) {
        const vec3 origin(rays.org_x[i], rays.org_y[i], rays.org_z[i]);
        const vec3 direction(rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]);
        if (work.kind == Kind::kShadow) {
            RTCRay ray = single_ray(origin, direction, rays.t_near[i], rays.t_far[i]);
            rtcOccluded1(work.scene, &context, &ray);
            hits.count += ray.tfar < 0;
        } else {
            const RTCRayHit query = intersect(work.scene, context, origin, direction, rays.t_near[i], rays.t_far[i]);
            if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
            ++hits.count;
            hits.distance += query.ray.tfar;
        }
    }
    return hits;
}

template <int W>
Hits trace_packets(const Work& work, const RayTile& rays, int count) {
    Hits hits;
    RTCIntersectContext context = make_context(work.coherent);
    alignas(64) int valid[W];
    for (int first = 0; first < count; first += W) {
        if (work.kind == Kind::kShadow) {
            RayPacket<W> packet;
            load_rays<W>(rays, first, count, packet, valid);
            occluded(valid, work.scene, context, packet);
            for (int i = 0; i < W; ++i) hits.count += valid[i] != 0 && packet.tfar[i] < 0;
        } else {
            RayHitPacket<W> packet;
            load_rays<W>(rays, first, count, packet.ray, valid);
            clear_hits<W>(packet);
            intersect(valid, work.scene, context, packet);
            for (int i = 0; i < W; ++i) {
                if (valid[i] == 0 || packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
                ++hits.count;
                hits.distance += packet.ray.tfar[i];
            }
        }
    }
    return hits;
}

Totals trace_frame(const Work& work, int width) {
    const auto trace = width == 1   ? trace_singles
                       : width == 4 ? trace_packets<4>
                       : width == 8 ? trace_packets<8>
                                    : trace_packets<16>;
    return for_tiles(work.frame, [&work, trace](int tile, RayTile& rays, Totals& totals) {
        const int count = work.frame.generate(work.kind, tile, rays);
        const Hits hits = trace(work, rays, count);
        totals.rays += static_cast<std::size_t>(count);
        totals.hits += hits.count;
        totals.distance += static_cast<double>(hits.distance);
    });
}

// Whether all widths agree.
bool run_kind(const Options& options, const std::string& scene, const Work& rays) {
    bool fine = true;
    const Totals singles = trace_frame(rays, 1);
    for (const int width : options.widths)
        for (const bool coherent : {false, true}) {
            if (width == 1 && coherent) continue;
            Work work = rays;
            work.coherent = coherent;
            Totals totals;
            trace_frame(work, width);  // once without a clock
            const Times times = measure(
                options.repeats, [] {}, [&] { totals = trace_frame(work, width); });
            const bool same = agree(totals, singles);
            const double millions = 1e-6 * static_cast<double>(totals.rays);
            std::printf(
                "{\"scene\": \"%s\", \"kind\": \"%s\", \"width\": %d, \"coherent\": %s, \"threads\": %d, \"rays\": "
                "%zu, "
                "\"hits\": %zu, \"mean_distance\": %.7g, \"ms\": %.2f, \"mrays_s\": %.2f, \"mrays_cpu_s\": %.2f%s}\n",
                scene.c_str(), name(work.kind), width, coherent ? "true" : "false", options.threads, totals.rays,
                totals.hits, totals.mean_distance(), 1e3 * times.wall, millions / times.wall,
                millions / times.processor, same ? "" : ", \"error\": \"differs from single rays\"");
            std::fflush(stdout);
            fine = fine && same;
        }
    return fine;
}

bool run_scene(const Options& options, const Device& device, const std::string& name_of_scene) {
    const Scene scene = make_scene(name_of_scene);
    const RTCScene traced =
        new_scene(device, scene, options.quality, options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcCommitScene(traced);
    device.check();
    Frame frame(scene, options.tile_side);
    find_points(traced, frame);
    bool fine = true;
    for (const Kind kind : kKinds)
        if (std::find(options.kinds.begin(), options.kinds.end(), name(kind)) != options.kinds.end())
            fine = run_kind(options, scene.name, {traced, frame, kind, false}) && fine;
    rtcReleaseScene(traced);
    return fine;
}

int run(int argc, char** argv) {
    Options options;
    const std::map<std::string, RTCBuildQuality> qualities{
        {"low", RTC_BUILD_QUALITY_LOW}, {"medium", RTC_BUILD_QUALITY_MEDIUM}, {"high", RTC_BUILD_QUALITY_HIGH}};
    CLI::App application("Times Embree's rays by kind and width of packets");
    application.add_option("--scene", options.scenes, "sphere100k, sphere1m, hf100k, hf1m");
    application.add_option("--kind", options.kinds)->check(CLI::IsMember({"primary", "shadow", "mirror", "diffuse"}));
    application.add_option("--width", options.widths)->check(CLI::IsMember({1, 4, 8, 16}));
    application.add_option("--threads", options.threads)->check(CLI::Range(1, 1024));
    application.add_option("--tile", options.tile_side, "side in pixels")->check(CLI::IsMember({4, 8, 16, 32}));
    application.add_option("--repeats", options.repeats)->check(CLI::Range(1, 1000));
    application.add_flag("--robust", options.robust, "Embree's watertight intersection");
    application.add_option("--quality", options.quality)->transform(CLI::CheckedTransformer(qualities));
    CLI11_PARSE(application, argc, argv);

    const Device device(options.threads);
    bool fine = true;
    for (const std::string& scene : options.scenes) fine = run_scene(options, device, scene) && fine;
    return fine ? 0 : 1;
}

}  // namespace
}  // namespace peers

int main(int argc, char** argv) {
    try {
        return peers::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tessera_embree_raw_bench: %s\n", error.what());
        return 1;
    }
}
