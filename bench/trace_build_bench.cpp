// What the ray tracer's hierarchies take to build and to refit, beside bare Embree with the same triangles, quality and
// flags (bench/peers), in turn.
//     tessera_trace_build_bench [--scene NAME...] [--threads N] [--repeats N]
// A line of JSON each: medians in milliseconds, the median of the ratios of pairs by wall and by processor time, and of
// ours the search for duplicate triangles. `build` and `refit` have the arrays that bare Embree has; `build_flat` has
// three vertices a triangle, as meshes without normals are drawn. Exit code 3 when a hierarchy was not made as asked.
#include "traced_meshes.h"

#include "bench/peers/embree_builds.h"
#include "trace/duplicates.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <cstdio>

namespace {

using namespace tessera;
using namespace tessera::bench;
using peers::Mesh;

struct Options {
    std::vector<std::string> scenes{"sphere100k", "hf100k", "hf1m"};
    int threads = 1, repeats = 7;
};

template <class Run>
peers::Times time_of(const Run& run) {
    return peers::measure(
        1, [] {}, run);
}

// Seen from both sides.
TriangleSet triangles_of(const TracedMesh& m) {
    const MeshView& v = m.mesh.view;
    return {v.positions, v.triangles, v.vertex_count, v.triangle_count, 3, 3};
}

class Pairs {
  public:
    Pairs(const Options& options, const peers::Device& device)
        : options_(options), device_(device), arena_(options.threads), ours_(best_isa(), kPlenty), bare_(device) {}

    bool build(const peers::Scene& scene, bool flat) {
        const TracedMeshes traced({&scene.mesh, &scene.ground}, flat, false);
        const auto clear = [&] {
            ours_.update(Frame{}, {}, arena_);
            bare_.release();
        };
        const auto ours = [&] { ours_.update(traced.frame, traced.classes, arena_); };
        const auto bare = [&] { bare_.build({&scene.mesh, &scene.ground}, false); };
        compare(clear, ours, bare);
        const BuildStatistics& s = ours_.statistics();
        const bool fine = s.groups == 1 && s.built == 1 && s.duplicates == 0;
        print(scene, flat ? "build_flat" : "build", traced, fine);
        clear();
        return fine;
    }

    bool refit(const peers::Scene& scene) {
        TracedMeshes traced({&scene.mesh}, false, true);
        Mesh moved = scene.mesh;
        peers::pad_vertices(moved);
        std::vector<Vec3>& positions = traced.meshes[0]->primitive.positions;
        ours_.update(traced.frame, traced.classes, arena_);
        bare_.build({&moved}, true);
        int phase = 0;
        std::uint32_t refitted = 0;
        const auto move = [&] {
            peers::wave_through(scene.mesh.positions, phase++, moved.positions.data());
            std::transform(moved.positions.begin(), moved.positions.end(), positions.begin(), as_vec3);
        };
        const auto ours = [&] {
            ours_.update(traced.frame, traced.classes, arena_);
            refitted += ours_.statistics().refitted;
        };
        compare(move, ours, [&] { bare_.refit(); });
        const bool fine = refitted == static_cast<std::uint32_t>(options_.repeats) + 1;
        print(scene, "refit", traced, fine);
        ours_.update(Frame{}, {}, arena_);
        bare_.release();
        return fine;
    }

  private:
    // In turn, each the first of a pair every other time.
    template <class Prepare, class Ours, class Bare>
    void compare(const Prepare& prepare, const Ours& ours, const Bare& bare) {
        for (std::vector<double>* v : {&ours_ms_, &bare_ms_, &ratios_, &cpu_ratios_}) v->clear();
        for (int pair = 0; pair <= options_.repeats; ++pair) {
            prepare();
            peers::Times a, b;
            if (pair % 2 == 0) a = time_of(ours);
            b = time_of(bare);
            if (pair % 2 != 0) a = time_of(ours);
            device_.check();
            if (pair == 0) continue;  // cold
            ours_ms_.push_back(1e3 * a.wall);
            bare_ms_.push_back(1e3 * b.wall);
            ratios_.push_back(a.wall / b.wall);
            cpu_ratios_.push_back(a.processor / b.processor);
        }
    }

    void print(const peers::Scene& scene, const char* what, const TracedMeshes& traced, bool fine) {
        std::vector<TriangleSet> sets;
        for (const auto& mesh : traced.meshes) sets.push_back(triangles_of(*mesh));
        const peers::Times duplicates = peers::measure(
            options_.repeats, [] {}, [&] { find_duplicates(sets, arena_); });
        const double ms = peers::median(ours_ms_), bare_ms = peers::median(bare_ms_);
        std::printf(
            "{\"scene\": \"%s\", \"what\": \"%s\", \"threads\": %d, \"triangles\": %u, \"ms\": %.2f, \"bare_ms\": "
            "%.2f, \"ratio\": %.3f, \"cpu_ratio\": %.3f, \"duplicates_ms\": %.2f%s}\n",
            scene.name.c_str(), what, options_.threads, traced.frame.triangle_count, ms, bare_ms,
            peers::median(ratios_), peers::median(cpu_ratios_), 1e3 * duplicates.wall,
            fine ? "" : ", \"error\": \"not what was asked for\"");
        std::fflush(stdout);
    }

    const Options& options_;
    const peers::Device& device_;
    Arena arena_;
    EmbreeScene ours_;
    peers::BareHierarchy bare_;
    std::vector<double> ours_ms_, bare_ms_, ratios_, cpu_ratios_;
};

int run(int argc, char** argv) {
    Options options;
    CLI::App application("Times the ray tracer's hierarchies beside bare Embree's");
    application.add_option("--scene", options.scenes, "sphere100k, sphere1m, hf100k, hf1m");
    application.add_option("--threads", options.threads)->check(CLI::Range(1, 1024));
    application.add_option("--repeats", options.repeats, "pairs")->check(CLI::Range(1, 1000));
    CLI11_PARSE(application, argc, argv);

    const peers::Device device(options.threads);
    Pairs pairs(options, device);
    bool fine = true;
    for (const std::string& name : options.scenes) {
        peers::Scene scene = peers::make_scene(name);
        peers::pad_vertices(scene.mesh);
        peers::pad_vertices(scene.ground);
        fine = pairs.build(scene, false) && fine;
        fine = pairs.build(scene, true) && fine;
        fine = pairs.refit(scene) && fine;
    }
    return fine ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tessera_trace_build_bench: %s\n", error.what());
        return 1;
    }
}
