// `tessera bench`: draws the built-in workloads with a warm renderer, reports times and checks the pixels.
#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/json_writer.h"
#include "cli/parse.h"
#include "cli/render_arguments.h"
#include "cli/report.h"
#include "cli/workloads.h"

#include <tessera/renderer.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>

namespace tessera::cli {
namespace {

struct BenchArguments {
    std::vector<std::string> workloads;
    std::string engine = "raster", isa = "auto", threads, frames = "11", size = "1920x1080";
    bool json = false;
};

struct Measurement {
    std::string workload;
    RenderStats stats;
    Size size{};
    double ms_median = 0, ms_min = 0;
    double cpu_ms = 0, cpu_per_wall = 0;  // of a frame, of all threads
    bool depth_only = false;
    std::string hash;
    std::string fault;  // what the check has to say
};

double now_ms(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

std::string hexadecimal(std::uint64_t value) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
    return text;
}

// One frame to warm up, then `frames` of which only the drawing is timed.
Measurement measure(const Workload& w, int frames) {
    Renderer renderer(w.scene, w.options);
    RenderResult result;
    renderer.draw(result);
    std::vector<double> times;
    double cpu = 0, wall = 0;
    for (int i = 0; i < frames; ++i) {
        const double cpu_start = now_ms(CLOCK_PROCESS_CPUTIME_ID), start = now_ms(CLOCK_MONOTONIC);
        renderer.draw(result);
        times.push_back(now_ms(CLOCK_MONOTONIC) - start);
        cpu += now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_start;
        wall += times.back();
    }
    std::sort(times.begin(), times.end());

    Measurement m;
    m.workload = w.name;
    m.stats = result.stats;
    m.size = {w.options.width, w.options.height};
    m.ms_median = times[times.size() / 2];
    m.ms_min = times.front();
    m.cpu_ms = cpu / frames;
    m.cpu_per_wall = cpu / wall;
    m.depth_only = !w.options.want_color;
    m.hash = hexadecimal(hash_pixels(m.depth_only ? result.depth : result.color));
    // Rays do not snap to the grid of 1/256 pixel, so their counts differ at edges.
    if (w.options.engine != Engine::kTrace && w.options.engine != Engine::kReferenceTrace)
        m.fault = pixel_fault(w, result.stats.pixels_covered);
    return m;
}

std::uint64_t rays(const RenderStats& s) {
    return s.primary_rays + s.shadow_rays + s.mirrored_rays + s.refracted_rays + s.straight_rays;
}
double megarays(const Measurement& m) { return static_cast<double>(rays(m.stats)) / m.ms_median * 1e-3; }

void write(JsonWriter& json, const Measurement& m) {
    json.begin_object();
    json.member("workload", m.workload);
    json.member("engine", name(m.stats.engine)).member("isa", name(m.stats.isa)).member("threads", m.stats.threads);
    json.member("width", m.size.width).member("height", m.size.height).member("triangles", m.stats.triangles);
    json.member("ms_median", m.ms_median).member("ms_min", m.ms_min);
    json.member("cpu_ms", m.cpu_ms).member("cpu_per_wall", m.cpu_per_wall);
    json.member("pixels_covered", m.stats.pixels_covered);
    json.member("rays", rays(m.stats)).member("mrays_per_s", megarays(m));
    json.member(m.depth_only ? "depth_hash" : "color_hash", std::string_view(m.hash));
    json.end_object();
}

std::string table_head(const Measurement& first) {
    return std::to_string(first.size.width) + "x" + std::to_string(first.size.height) + ", engine " +
           name(first.stats.engine) + ", " + name(first.stats.isa) + ", " + std::to_string(first.stats.threads) +
           (first.stats.threads == 1 ? " thread" : " threads") +
           "\nworkload                  ms median     ms min     cpu ms  cpu/wall      pixels  hash\n";
}

std::string table_row(const Measurement& m) {
    char line[160];
    std::snprintf(line, sizeof line, "%-24s %10.3f %10.3f %10.3f %9.2f %11llu  %s%s", m.workload.c_str(), m.ms_median,
                  m.ms_min, m.cpu_ms, m.cpu_per_wall, static_cast<unsigned long long>(m.stats.pixels_covered),
                  m.hash.c_str(), m.depth_only ? " (depth)" : "");
    std::string row = line;
    if (rays(m.stats) > 0) {
        std::snprintf(line, sizeof line, "  %llu rays, %.2f Mrays/s", static_cast<unsigned long long>(rays(m.stats)),
                      megarays(m));
        row += line;
    }
    return row + "\n";
}

int run(const BenchArguments& a) {
    const Size size = parse_size("--size", a.size);
    const int frames = static_cast<int>(parse_integer("--frames", a.frames, 1, 100000));
    const int threads = a.threads.empty() ? 0 : static_cast<int>(parse_integer("--threads", a.threads, 1, 1024));
    const Engine engine = parse_engine(a.engine);
    const Isa isa = parse_isa(a.isa);
    const std::vector<std::string> all = workload_names();
    const std::vector<std::string>& names = a.workloads.empty() ? all : a.workloads;
    for (const std::string& name : names)
        if (std::find(all.begin(), all.end(), name) == all.end()) make_workload(name, 1, 1);  // says what there is

    JsonWriter json;
    json.begin_array();
    std::vector<std::string> faults;
    for (const std::string& name : names) {
        Workload w = make_workload(name, size.width, size.height);
        w.options.engine = engine;
        w.options.isa = isa;
        w.options.threads = threads;
        const Measurement m = measure(w, frames);
        if (!m.fault.empty()) faults.push_back(m.fault);
        if (a.json)
            write(json, m);
        else
            write_output("-", (&name == &names.front() ? table_head(m) : std::string()) + table_row(m));
    }
    if (a.json) write_output("-", json.end_array().text());
    for (const std::string& fault : faults) report_error(fault);
    return faults.empty() ? kFine : kComparisonFailed;
}

}  // namespace

Command add_bench_command(CLI::App& application) {
    CLI::App* app = application.add_subcommand("bench", "Time the built-in workloads and check their pixels");
    auto a = std::make_shared<BenchArguments>();
    const auto option = [&](const char* names, std::string& value, const char* type, const char* help) {
        app->add_option(names, value, help)->option_text(type)->multi_option_policy(CLI::MultiOptionPolicy::Throw);
    };
    std::string names;
    for (const std::string& name : workload_names()) names += " " + name;
    app->add_option("--workload", a->workloads, "one of those below; may be repeated (default: all)")
        ->option_text("NAME")
        ->take_all()
        ->expected(1)
        ->allow_extra_args(false);
    option("--engine", a->engine, "NAME", "raster (the default), trace, hybrid, reference-raster or reference-trace");
    option("--isa", a->isa, "NAME", "auto (default), scalar, sse4, avx2 or avx512");
    option("--threads", a->threads, "N", "threads to use (default: all this process may)");
    option("--frames", a->frames, "K", "frames to time, after one to warm up (default 11)");
    option("-s,--size", a->size, "WxH", "size in pixels (default 1920x1080, for which the pixels covered are known)");
    app->add_flag("--json", a->json, "report as a JSON list");
    app->footer("Workloads:" + names +
                "\n\nOnly the drawing is timed. cpu_ms is processor time of all threads for a frame. The depth_ "
                "workloads draw\n"
                "no colour: they have a depth_hash, of the depth plane, in place of the color_hash. A count of pixels\n"
                "that is not the known one is reported at the end, with exit code 3.");
    return {app, [a] { return run(*a); }};
}

}  // namespace tessera::cli
