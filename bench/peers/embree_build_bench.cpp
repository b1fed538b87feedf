// What Embree 3 takes to build its hierarchies, by quality, and to refit one to moved vertices.
//     tessera_embree_build_bench [--scene NAME...] [--threads N] [--repeats N]
// A line of JSON each: time of the commit alone, triangles a second, and the memory of the hierarchy; at last what the
// renderer asks of Embree, from the mesh's arrays to the hierarchy.
#include "bench/peers/embree_builds.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <atomic>
#include <cstdio>

namespace peers {
namespace {

struct Options {
    std::vector<std::string> scenes{"sphere100k", "hf100k", "hf1m"};
    int threads = 1, repeats = 5;
};

struct Way {
    const char* name;
    RTCBuildQuality quality;
    RTCSceneFlags flags;
};
constexpr Way kWays[] = {
    {"low", RTC_BUILD_QUALITY_LOW, RTC_SCENE_FLAG_NONE},
    {"low, dynamic", RTC_BUILD_QUALITY_LOW, RTC_SCENE_FLAG_DYNAMIC},
    {"medium", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_NONE},
    {"medium, compact", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_COMPACT},
    {"medium, robust", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_ROBUST},
    {"high", RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_NONE},
};

// What the device holds, as its monitor says.
std::atomic<std::int64_t> held_bytes{0};
bool count_memory(void*, ssize_t bytes, bool) {
    held_bytes += bytes;
    return true;
}

void print(const Options& options, const Scene& scene, const std::string& way, std::size_t triangles, Times times,
           std::int64_t bytes) {
    const auto count = static_cast<double>(triangles);
    std::printf(
        "{\"scene\": \"%s\", \"way\": \"%s\", \"threads\": %d, \"triangles\": %zu, \"ms\": %.2f, \"cpu_ms\": %.2f, "
        "\"mtriangles_s\": %.2f, \"bytes_per_triangle\": %.1f}\n",
        scene.name.c_str(), way.c_str(), options.threads, triangles, 1e3 * times.wall, 1e3 * times.processor,
        1e-6 * count / times.wall, static_cast<double>(bytes) / count);
    std::fflush(stdout);
}

void time_builds(const Options& options, const Device& device, const Scene& scene) {
    for (const Way& way : kWays) {
        RTCScene built = nullptr;
        std::int64_t before = 0;
        const auto prepare = [&] {
            if (built != nullptr) rtcReleaseScene(built);
            built = new_scene(device, scene, way.quality, way.flags);
            before = held_bytes;
        };
        const auto commit = [&] { rtcCommitScene(built); };
        measure(1, prepare, commit);
        const Times times = measure(options.repeats, prepare, commit);
        device.check();
        print(options, scene, way.name, scene.mesh.triangles() + scene.ground.triangles(), times, held_bytes - before);
        rtcReleaseScene(built);
    }
}

// The hierarchy of a mesh that moves is built again or refitted.
void time_updates(const Options& options, const Device& device, const Scene& scene) {
    for (const bool refit : {false, true}) {
        const RTCScene traced = rtcNewScene(device);
        rtcSetSceneFlags(traced, RTC_SCENE_FLAG_DYNAMIC);
        rtcSetSceneBuildQuality(traced, RTC_BUILD_QUALITY_LOW);
        const RTCGeometry geometry =
            add_geometry(device, traced, scene.mesh, refit ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_LOW);
        const std::int64_t before = held_bytes;
        rtcCommitScene(traced);
        int phase = 0;
        const auto move = [&] {
            auto* positions = static_cast<vec3*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
            wave_through(scene.mesh.positions, phase++, positions);
            rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
            rtcCommitGeometry(geometry);
        };
        const auto commit = [&] { rtcCommitScene(traced); };
        measure(1, move, commit);
        const Times times = measure(options.repeats, move, commit);
        device.check();
        print(options, scene, refit ? "refit" : "built again", scene.mesh.triangles(), times, held_bytes - before);
        rtcReleaseGeometry(geometry);
        rtcReleaseScene(traced);
    }
}

// As the renderer has it.
void time_robust(const Options& options, const Device& device, Scene scene) {
    const std::vector<vec3> rest = scene.mesh.positions;
    pad_vertices(scene.mesh);
    pad_vertices(scene.ground);
    BareHierarchy bare(device);
    std::int64_t before = 0;
    const auto clear = [&] {
        bare.release();
        before = held_bytes;
    };
    const auto build = [&] { bare.build({&scene.mesh, &scene.ground}, false); };
    measure(1, clear, build);
    const Times built = measure(options.repeats, clear, build);
    device.check();
    print(options, scene, "robust, build", scene.mesh.triangles() + scene.ground.triangles(), built,
          held_bytes - before);

    clear();
    bare.build({&scene.mesh}, true);
    int phase = 0;
    const auto move = [&] { wave_through(rest, phase++, scene.mesh.positions.data()); };
    const auto refit = [&] { bare.refit(); };
    measure(1, move, refit);
    const Times refitted = measure(options.repeats, move, refit);
    device.check();
    print(options, scene, "robust, refit", scene.mesh.triangles(), refitted, held_bytes - before);
}

int run(int argc, char** argv) {
    Options options;
    CLI::App application("Times Embree's builds and refits");
    application.add_option("--scene", options.scenes, "sphere100k, sphere1m, hf100k, hf1m");
    application.add_option("--threads", options.threads)->check(CLI::Range(1, 1024));
    application.add_option("--repeats", options.repeats)->check(CLI::Range(1, 1000));
    CLI11_PARSE(application, argc, argv);

    const Device device(options.threads);
    rtcSetDeviceMemoryMonitorFunction(device, count_memory, nullptr);
    for (const std::string& name : options.scenes) {
        const Scene scene = make_scene(name);
        time_builds(options, device, scene);
        time_updates(options, device, scene);
        time_robust(options, device, scene);
    }
    return 0;
}

}  // namespace
}  // namespace peers

int main(int argc, char** argv) {
    try {
        return peers::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tessera_embree_build_bench: %s\n", error.what());
        return 1;
    }
}
