// `tessera render`: load, render, encode, write; then the statistics.
#include "cli/commands.h"
#include "cli/deadline.h"
#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/render_arguments.h"
#include "cli/report.h"
#include "cli/scene_input.h"
#include "cli/statistics.h"

#include <tessera/tessera.h>

#include <chrono>
#include <memory>
#include <mutex>

namespace tessera::cli {
namespace {

class Stopwatch {
  public:
    double milliseconds() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Applies what the options say about the scene itself.
void place_view(RenderJob& job, Scene& scene) {
    View& view = job.render.view;
    if (!job.camera.empty()) view.camera = find_camera(scene, job.camera);
    if (job.z_is_up) {
        turn_z_up(scene);
        if (view.eye) view.eye = turn_z_up(*view.eye);
        if (view.target) view.target = turn_z_up(*view.target);
    }
    if (view.eye && !view.target) {
        const Bounds3 bounds = visible_bounds(scene);
        view.target = bounds.empty() ? Vec3{} : (bounds.min + bounds.max) * 0.5f;
        if (*view.target == *view.eye)
            throw Error(ErrorCode::kUsage, "--eye: is the middle of the scene; give --target");
    }
}

RenderResult render_scene(RenderJob& job, const Scene& scene, Deadline& deadline, bool quiet) {
    ProgressBar bar(!quiet);
    std::mutex bar_mutex;
    if (bar.active())
        job.render.progress = [&](double done) {
            const std::lock_guard lock(bar_mutex);
            bar.show(done);
        };
    if (job.timeout) job.render.cancel = [&] { return deadline.expired(); };
    deadline.allow_grace();
    try {
        return render(scene, job.render);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::kCancelled) throw;
        throw Error(ErrorCode::kCancelled, deadline.message());
    }
}

int run(const RenderArguments& arguments) {
    const Stopwatch total;
    RenderJob job = parse_render_arguments(arguments);
    if (static_cast<std::uint64_t>(job.render.width) * static_cast<std::uint64_t>(job.render.height) > job.max_picture)
        throw Error(ErrorCode::kLimit, "--size: more pixels than --max-pixels allows");
    if (!arguments.output.empty()) check_writable(arguments.output);
    if (!arguments.stats.empty()) check_writable(arguments.stats);

    const std::string file = input_name(arguments.scene);
    Deadline deadline(job.timeout, file);
    CommandTimes times;

    const Stopwatch loading;
    Scene scene = load_input(arguments.scene, job.load);
    times.load_ms = loading.milliseconds();
    place_view(job, scene);

    RenderResult result = render_scene(job, scene, deadline, arguments.quiet);
    deadline.disarm();
    if (job.color_bits) {
        const auto [red, green, blue] = *job.color_bits;
        result.color = quantize_true_color(result.color, red, green, blue);
        result.stats.color_hash = hash_pixels(result.color);
    }
    result.warnings.insert(result.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
    if (!arguments.quiet) report_warnings(file, result.warnings);
    if (!arguments.quiet && job.render.show != Stage::kPicture) report_stage(job.render, result);

    if (!arguments.output.empty()) {
        const Stopwatch encoding;
        PngOptions png;
        png.level = job.png_level;
        write_output(arguments.output, job.codec == Codec::kJpeg ? encode_jpeg(result.color, job.quality)
                                                                 : encode_png(result.color, png));
        times.encode_ms = encoding.milliseconds();
    }
    times.total_ms = total.milliseconds();
    if (!arguments.stats.empty()) write_output(arguments.stats, statistics_json(file, job.render, result, times));
    return kFine;
}

}  // namespace

Command add_render_command(CLI::App& application) {
    CLI::App* app = application.add_subcommand("render", "Render a scene to a picture");
    auto arguments = std::make_shared<RenderArguments>();
    add_render_options(*app, *arguments);
    return {app, [arguments] { return run(*arguments); }};
}

}  // namespace tessera::cli
