// A Whitted frame straight on Embree 3: primary rays, hard shadows and one mirror bounce with its shadows, 1920x1080 at
// one sample, with no more shading than that. It is what a ray tracing engine is measured against.
//     tessera_embree_whitted_bench [--scene NAME...] [--width N...] [--threads N] [--robust] [-o PICTURE.ppm]
// Width 1 is the textbook's recursion per pixel; packets go in waves through 16x16 tiles, with the rays that live on
// moved together between the waves. A line of JSON each. Exit code 1 when packets do not do the work of single rays:
// the same number of rays and the same picture.
#include "bench/peers/embree_whitted.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <cstdio>
#include <fstream>

namespace peers {
namespace {

// Some rays that graze an edge are decided the other way: 1 in 5 million on these scenes.
constexpr double kRayTolerance = 2e-6;    // of the rays
constexpr double kPixelTolerance = 1e-3;  // of the mean of all bytes, 0 to 255

struct Options {
    std::vector<std::string> scenes{"sphere100k", "hf100k"};
    std::vector<int> widths{1, 4, 8, 16};
    int threads = 1, repeats = 7;
    bool incoherent = false, robust = false;
    std::string picture;
};

Totals draw_frame(const Work& work, int width) {
    const auto draw = width == 1   ? draw_tile_by_rays
                      : width == 4 ? draw_tile_by_waves<4>
                      : width == 8 ? draw_tile_by_waves<8>
                                   : draw_tile_by_waves<16>;
    return for_tiles(work.frame, [&](int tile, RayTile&, Totals& totals) { totals.rays += draw(work, tile); });
}

double mean(const std::vector<Pixel>& pixels) {
    double sum = 0;
    for (const Pixel& p : pixels) sum += p.r + p.g + p.b;
    return sum / static_cast<double>(3 * pixels.size());
}

void write_picture(const std::string& file, const std::vector<Pixel>& pixels) {
    std::ofstream out(file, std::ios::binary);
    out << "P6\n" << kWidth << ' ' << kHeight << "\n255\n";
    out.write(reinterpret_cast<const char*>(pixels.data()), static_cast<std::streamsize>(3 * pixels.size()));
    if (!out) throw std::runtime_error(file + " cannot be written");
}

// Whether all widths do the work of single rays.
bool run_scene(const Options& options, const Device& device, const std::string& name) {
    const Scene scene = make_scene(name);
    const RTCScene traced = new_scene(device, scene, RTC_BUILD_QUALITY_MEDIUM,
                                      options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcCommitScene(traced);
    device.check();
    const Frame frame(scene, kTileSide);
    std::vector<Pixel> pixels(static_cast<std::size_t>(kWidth) * kHeight);
    const Work work{traced, frame, !options.incoherent, pixels};
    const std::size_t rays_wanted = draw_frame(work, 1).rays;
    const double mean_wanted = mean(pixels);
    bool fine = true;
    for (const int width : options.widths) {
        Totals totals;
        draw_frame(work, width);  // once without a clock
        const Times times = measure(
            options.repeats, [] {}, [&] { totals = draw_frame(work, width); });
        const auto rays = static_cast<double>(totals.rays), wanted = static_cast<double>(rays_wanted);
        const bool same = std::abs(rays - wanted) <= kRayTolerance * wanted &&
                          std::abs(mean(pixels) - mean_wanted) <= kPixelTolerance;
        std::printf(
            "{\"scene\": \"%s\", \"width\": %d, \"coherent\": %s, \"threads\": %d, \"rays\": %zu, \"mean_pixel\": "
            "%.4f, "
            "\"ms\": %.2f, \"cpu_ms\": %.2f, \"mrays_s\": %.2f%s}\n",
            name.c_str(), width, width > 1 && work.coherent ? "true" : "false", options.threads, totals.rays,
            mean(pixels), 1e3 * times.wall, 1e3 * times.processor, 1e-6 * rays / times.wall,
            same ? "" : ", \"error\": \"differs from single rays\"");
        std::fflush(stdout);
        fine = fine && same;
    }
    if (!options.picture.empty()) write_picture(options.picture, pixels);
    rtcReleaseScene(traced);
    return fine;
}

int run(int argc, char** argv) {
    Options options;
    CLI::App application("Times a Whitted frame on Embree");
    application.add_option("--scene", options.scenes, "sphere100k, sphere1m, hf100k, hf1m");
    application.add_option("--width", options.widths)->check(CLI::IsMember({1, 4, 8, 16}));
    application.add_option("--threads", options.threads)->check(CLI::Range(1, 1024));
    application.add_option("--repeats", options.repeats)->check(CLI::Range(1, 1000));
    application.add_flag("--incoherent", options.incoherent, "without the flag for coherent packets");
    application.add_flag("--robust", options.robust, "Embree's watertight intersection");
    application.add_option("-o,--output", options.picture, "the last picture, as PPM");
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
        std::fprintf(stderr, "tessera_embree_whitted_bench: %s\n", error.what());
        return 1;
    }
}
