// `tessera render`: load, render, encode, write; then the statistics.
#include "cli/commands.h"
#include "cli/deadline.h"
#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/parse.h"
#include "cli/pattern.h"
#include "cli/planes.h"
#include "cli/render_arguments.h"
#include "cli/report.h"
#include "cli/scene_input.h"
#include "cli/scene_setup.h"
#include "cli/shots.h"
#include "cli/statistics.h"
#include "cli/stopwatch.h"
#include "cli/temporary_file.h"
#include "cli/video.h"

#include <tessera/tessera.h>

#include <unistd.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
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

std::string output_of(const std::string& pattern, const std::string& camera, std::optional<long> frame,
                      const std::string& aov) {
    if (pattern == "-") return pattern;
    PatternValues values{{"camera", safe_name(camera)}, {"aov", aov}};
    if (frame) values["frame"] = *frame;
    return fill_pattern("--output", pattern, values);
}

std::string camera_name(const RenderJob& job) { return job.camera.empty() ? "default" : job.camera; }

std::string video_file(const RenderJob& job, const RenderArguments& arguments) {
    if (job.poses.size() > 1 && has_place(arguments.output, "camera"))
        refuse("--output", "a video is one file of all cameras: it has no {camera}");
    return output_of(arguments.output, job.poses.empty() ? camera_name(job) : job.poses[0].name, std::nullopt, "color");
}

// Draws and writes one picture after the other, and remembers what happened for the statistics.
class Sequence {
  public:
    Sequence(RenderJob& job, const Scene& scene, const RenderArguments& arguments)
        : job_(job), scene_(scene), arguments_(arguments), shots_(job), bar_(!arguments.quiet) {
        if (bar_.active())
            job.render.progress = [this](double done) {
                const std::lock_guard lock(bar_mutex_);
                bar_.show((static_cast<double>(drawn_) + done) / static_cast<double>(shots_.count()));
            };
    }

    void run(Deadline& deadline, CommandTimes times, const Stopwatch& total) {
        if (job_.timeout) job_.render.cancel = [&] { return deadline.expired(); };
        std::optional<Renderer> renderer;
        RenderResult result;
        std::optional<Video> video;
        if (job_.codec == Codec::kVideo)
            video.emplace(video_file(job_, arguments_), VideoOptions{job_.fps, !job_.render.background},
                          job_.render.cancel);
        for (; drawn_ < shots_.count(); ++drawn_) {
            const PlannedShot shot = shots_.at(drawn_);
            const std::vector<std::string> files = video ? std::vector<std::string>{} : files_of(shot);
            if (job_.skip_existing)
                for (const std::string& file : files) stale_.remove(file);
            if (!files.empty() && job_.skip_existing && std::all_of(files.begin(), files.end(), exists)) continue;
            within(deadline, [&] { draw(shot, renderer, result); });
            const bool last = drawn_ + 1 == shots_.count();
            if (last && !video) deadline.disarm();
            bar_.clear();
            deadline.hold(true);
            report(result);
            const Stopwatch encoding;
            within(deadline, [&] {
                if (video) video->add(result.color);
                write(files, result);
            });
            times.encode_ms = encoding.milliseconds();
            times.total_ms = total.milliseconds();
            if (!arguments_.stats.empty())
                statistics_.push_back(statistics_json(input_name(arguments_.scene), job_.render, result, times));
            deadline.hold(false);
        }
        if (video) within(deadline, [&] { video->finish(); });
        deadline.disarm();
    }

    // One object, or of several pictures a list of them.
    std::string statistics() const {
        if (!job_.frames && job_.poses.empty()) return statistics_.empty() ? "{}" : statistics_.front();
        std::string list = "[";
        for (std::size_t i = 0; i < statistics_.size(); ++i) list += (i == 0 ? "\n" : ",\n") + statistics_[i];
        return list + "]\n";
    }

  private:
    static bool exists(const std::string& file) { return ::access(file.c_str(), F_OK) == 0; }

    // The files of a picture, in the order of the planes.
    std::vector<std::string> files_of(const PlannedShot& shot) const {
        std::vector<std::string> files;
        if (arguments_.output.empty()) return files;
        for (const PlaneFile& file : job_.planes.files)
            files.push_back(output_of(arguments_.output, shot.camera, shot.frame, file.aov));
        return files;
    }

    void draw(const PlannedShot& shot, std::optional<Renderer>& renderer, RenderResult& result) {
        if (shots_.count() == 1) {
            RenderOptions options = job_.render;
            options.view = shot.now.view;
            options.moment = shot.now.moment;
            options.motion_before = shot.before;
            options.motion_after = shot.after;
            result = render(scene_, options);
        } else {
            if (!renderer) renderer.emplace(scene_, job_.render);
            renderer->draw(shot.now, shot.before, shot.after, result);
        }
        finish_color(job_.planes, result);
    }

    void report(RenderResult& result) {
        result.warnings.insert(result.warnings.begin(), scene_.warnings.begin(), scene_.warnings.end());
        if (!arguments_.quiet && !reported_) report_warnings(input_name(arguments_.scene), result.warnings);
        reported_ = true;
        if (!arguments_.quiet && job_.render.show != Stage::kPicture) report_stage(job_.render, result);
    }

    void write(const std::vector<std::string>& files, const RenderResult& result) const {
        for (std::size_t i = 0; i < files.size(); ++i) {
            if (job_.skip_existing && exists(files[i])) continue;
            write_output(files[i], encode_planes(job_.planes, job_.planes.files[i], result));
        }
    }

    RenderJob& job_;
    const Scene& scene_;
    const RenderArguments& arguments_;
    const ShotList shots_;
    ProgressBar bar_;
    std::mutex bar_mutex_;
    StaleFiles stale_;
    long drawn_ = 0;
    bool reported_ = false;
    std::vector<std::string> statistics_;
};

// Refuses now what could not be written later, and pictures that would have one file.
void check_outputs(const RenderJob& job, const RenderArguments& arguments) {
    if (!arguments.stats.empty()) check_writable(arguments.stats);
    if (arguments.output.empty()) return;
    if (job.codec == Codec::kVideo) return check_writable(video_file(job, arguments));
    std::set<std::string> files;
    std::vector<std::string> cameras;
    for (const Pose& pose : job.poses) cameras.push_back(pose.name);
    if (cameras.empty()) cameras.push_back(camera_name(job));
    const long frames = job.frames ? job.frames->count() : 1;
    // Of very many pictures the first ones tell.
    constexpr std::size_t kMany = std::size_t{1} << 18;
    for (const std::string& camera : cameras)
        for (long f = 0; f < frames && files.size() < kMany; ++f)
            for (const PlaneFile& plane : job.planes.files) {
                const std::optional<long> frame = job.frames ? std::optional(job.frames->first + f) : std::nullopt;
                const std::string file = output_of(arguments.output, camera, frame, plane.aov);
                if (!files.insert(file).second) refuse("--output", "'" + file + "' would be written twice");
                if (f == 0) check_writable(file);
            }
}

// A picture whose motion is measured to itself.
void warn_of_rest(const RenderJob& job, const RenderArguments& arguments) {
    const PlannedShot shot = ShotList(job).at(0);
    if (!job.render.want_motion || arguments.quiet || shot.before != shot.now || shot.after != shot.now) return;
    if (ShotList(job).count() == 1)
        report_warnings(input_name(arguments.scene),
                        {"nothing moves: give --time, --frames, --turntable or --poses for motion"});
}

int run(const RenderArguments& arguments) {
    const Stopwatch total;
    RenderJob job = parse_render_arguments(arguments);
    if (static_cast<std::uint64_t>(job.render.width) * static_cast<std::uint64_t>(job.render.height) > job.max_picture)
        throw Error(ErrorCode::kLimit, "--size: more pixels than --max-pixels allows");
    check_outputs(job, arguments);
    if (job.codec == Codec::kVideo) {
        const std::string file = video_file(job, arguments);
        if (job.skip_existing) StaleFiles().remove(file);
        if (job.skip_existing && ::access(file.c_str(), F_OK) == 0) return kFine;
        find_ffmpeg(file);
    }

    Deadline deadline(job.timeout, input_name(arguments.scene));
    CommandTimes times;
    const Stopwatch loading;
    Scene scene = load_input(arguments.scene, job.load);
    times.load_ms = loading.milliseconds();
    set_up(job, scene);

    warn_of_rest(job, arguments);
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
