// `tessera render`: load, render, encode, write; then the statistics.
#include "cli/commands.h"
#include "cli/deadline.h"
#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/parse.h"
#include "cli/pattern.h"
#include "cli/picture_file.h"
#include "cli/render_arguments.h"
#include "cli/report.h"
#include "cli/scene_input.h"
#include "cli/scene_setup.h"
#include "cli/statistics.h"
#include "cli/stopwatch.h"
#include "cli/video.h"

#include <tessera/tessera.h>

#include <unistd.h>

#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace tessera::cli {
namespace {

// Calls `work`, whose rendering asks for the time; what it throws when it was cancelled becomes the option's error.
template <class Work>
void within(Deadline& deadline, Work&& work) {
    deadline.allow_grace();
    try {
        work();
    } catch (const Error& error) {
        if (error.code() != ErrorCode::kCancelled) throw;
        throw Error(ErrorCode::kCancelled, deadline.message());
    }
}

// Reduces, encodes and writes a picture. Returns the milliseconds that took.
double write_picture(const RenderJob& job, RenderResult& result, const std::string& output,
                     std::optional<Video>& video) {
    finish_color(job, result);
    const Stopwatch encoding;
    if (output.empty()) return 0;
    if (video) {
        video->add(result.color);
        return encoding.milliseconds();
    }
    write_output(output, encode_color(job, result));
    return encoding.milliseconds();
}

std::string output_of(const std::string& pattern, long frame) {
    return fill_pattern("--output", pattern, {{"frame", frame}});
}

// Draws and writes one picture after the other, and remembers what happened for the statistics.
class Sequence {
  public:
    Sequence(RenderJob& job, const Scene& scene, const RenderArguments& arguments)
        : job_(job), scene_(scene), arguments_(arguments), bar_(!arguments.quiet) {
        if (bar_.active())
            job.render.progress = [this](double done) {
                const std::lock_guard lock(bar_mutex_);
                bar_.show((static_cast<double>(drawn_) + done) / static_cast<double>(pictures()));
            };
    }

    // Without --frames there is one.
    long pictures() const { return job_.frames ? job_.frames->count() : 1; }

    void run(Deadline& deadline, CommandTimes times, const Stopwatch& total) {
        if (job_.timeout) job_.render.cancel = [&] { return deadline.expired(); };
        std::optional<Renderer> renderer;
        RenderResult result;
        std::optional<Video> video;
        if (job_.codec == Codec::kVideo)
            video.emplace(output_of(arguments_.output, job_.frames->first),
                          VideoOptions{job_.frames->fps, !job_.render.background}, job_.render.cancel);
        for (; drawn_ < pictures(); ++drawn_) {
            std::string output = arguments_.output;
            Moment moment = job_.render.moment;
            View view = job_.render.view;
            if (job_.frames) {
                const long frame = job_.frames->first + drawn_;
                output = output_of(arguments_.output, frame);
                moment = job_.frames->moment(moment, frame);
                view = job_.frames->view(view, frame);
                if (!video && job_.skip_existing && ::access(output.c_str(), F_OK) == 0) continue;
            }
            within(deadline, [&] {
                if (!job_.frames) {
                    result = render(scene_, job_.render);
                    return;
                }
                if (!renderer) renderer.emplace(scene_, job_.render);
                renderer->draw(view, moment, result);
            });
            if (drawn_ + 1 == pictures() && !video) deadline.disarm();
            bar_.clear();
            deadline.hold(true);
            result.warnings.insert(result.warnings.begin(), scene_.warnings.begin(), scene_.warnings.end());
            if (!arguments_.quiet && !reported_) report_warnings(input_name(arguments_.scene), result.warnings);
            reported_ = true;
            if (!arguments_.quiet && job_.render.show != Stage::kPicture) report_stage(job_.render, result);
            within(deadline, [&] { times.encode_ms = write_picture(job_, result, output, video); });
            times.total_ms = total.milliseconds();
            if (!arguments_.stats.empty())
                statistics_.push_back(statistics_json(input_name(arguments_.scene), job_.render, result, times));
            deadline.hold(false);
        }
        if (video) within(deadline, [&] { video->finish(); });
        deadline.disarm();
    }

    // One object, or with --frames a list of them.
    std::string statistics() const {
        if (!job_.frames) return statistics_.empty() ? "{}" : statistics_.front();
        std::string list = "[";
        for (std::size_t i = 0; i < statistics_.size(); ++i) list += (i == 0 ? "\n" : ",\n") + statistics_[i];
        return list + "]\n";
    }

  private:
    RenderJob& job_;
    const Scene& scene_;
    const RenderArguments& arguments_;
    ProgressBar bar_;
    std::mutex bar_mutex_;
    long drawn_ = 0;
    bool reported_ = false;
    std::vector<std::string> statistics_;
};

int run(const RenderArguments& arguments) {
    const Stopwatch total;
    RenderJob job = parse_render_arguments(arguments);
    if (static_cast<std::uint64_t>(job.render.width) * static_cast<std::uint64_t>(job.render.height) > job.max_picture)
        throw Error(ErrorCode::kLimit, "--size: more pixels than --max-pixels allows");
    if (!arguments.output.empty())
        check_writable(job.frames ? output_of(arguments.output, job.frames->first) : arguments.output);
    if (!arguments.stats.empty()) check_writable(arguments.stats);

    if (job.codec == Codec::kVideo) {
        const std::string output = output_of(arguments.output, job.frames->first);
        if (job.skip_existing && ::access(output.c_str(), F_OK) == 0) return kFine;
        find_ffmpeg(output);
    }

    Deadline deadline(job.timeout, input_name(arguments.scene));
    CommandTimes times;
    const Stopwatch loading;
    Scene scene = load_input(arguments.scene, job.load);
    times.load_ms = loading.milliseconds();
    set_up(job, scene);

    Sequence sequence(job, scene, arguments);
    sequence.run(deadline, times, total);
    if (!arguments.stats.empty()) write_output(arguments.stats, sequence.statistics());
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
