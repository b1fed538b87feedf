#include "cli/batch_scene.h"

#include "cli/files.h"
#include "cli/parse.h"
#include "cli/pattern.h"
#include "cli/planes.h"
#include "cli/scene_input.h"
#include "cli/scene_setup.h"
#include "cli/stopwatch.h"
#include "cli/video.h"

#include <tessera/error.h>

#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <new>
#include <set>
#include <string_view>
#include <utility>

namespace tessera::cli {
namespace {

std::string hash_text(std::uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

bool is_plain_file(const std::string& file) {
    struct stat info {};
    return ::stat(file.c_str(), &info) == 0 && S_ISREG(info.st_mode);
}

// Names of all cameras, by index; numbers where a name is missing, not the only one of its kind in names of files, or
// the number of any camera.
std::vector<std::string> cameras_of(const Scene& scene) {
    std::map<std::string, int> uses;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        ++uses[safe_name(scene.cameras[i].name)];
        ++uses[std::to_string(i)];
    }
    std::vector<std::string> names;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const std::string& name = scene.cameras[i].name;
        names.push_back(name.empty() || uses[safe_name(name)] > 1 ? std::to_string(i) : name);
    }
    return names;
}

void check_time(const RenderJob& job) {
    if (job.render.cancel && job.render.cancel()) throw Error(ErrorCode::kCancelled, "");
}

std::string timeout_text(double seconds) {
    char text[64];
    std::snprintf(text, sizeof text, "--timeout: not finished within %g s", seconds);
    return text;
}

}  // namespace

SceneReport SceneWorker::run(const SceneFile& file, std::uint64_t number, const SceneShare& share) {
    SceneReport report;
    report.file = file.file;
    report.number = number;
    const auto fail = [&](ErrorCode code, const std::string& line) {
        report.status = SceneStatus::kFailed;
        report.exit_code = exit_code(code);
        report.error = line;
        hit_limit_ = code == ErrorCode::kLimit;
    };
    hit_limit_ = false;
    try {
        run_outputs(file, share, report);
    } catch (const Error& error) {
        const bool late = error.code() == ErrorCode::kCancelled;
        const std::string reason = late ? timeout_text(*job_.render.timeout) : error.message();
        fail(error.code(), error.file().empty() || late
                               ? Error(error.code(), reason, file.file, error.location()).what()
                               : error.what());
    } catch (const std::bad_alloc&) {
        fail(ErrorCode::kLimit, file.file + ": out of memory");
    } catch (const std::exception& error) {
        fail(ErrorCode::kInternal, file.file + ": internal: " + error.what());
    }
    return report;
}

bool SceneWorker::Output::complete() const {
    return std::none_of(missing.begin(), missing.end(), [](bool m) { return m; });
}

void SceneWorker::run_outputs(const SceneFile& file, const SceneShare& share, SceneReport& report) {
    if (!file.error.empty()) throw Error(ErrorCode::kInput, file.error, file.file);
    std::vector<Output> outputs;
    if (!job_.every_camera) outputs = plan(file, job_.cameras, report.number);
    const auto nothing_to_do = [&] {
        return std::all_of(outputs.begin(), outputs.end(), [](const Output& o) { return o.complete(); });
    };
    if (!job_.every_camera && nothing_to_do()) {
        report.status = SceneStatus::kSkipped;
        for (const Output& output : outputs)
            for (std::size_t i = 0; i < output.files.size(); ++i) add_existing(output, i, report);
        return;
    }

    RenderJob job = job_.render;
    job.load.threads = job.render.threads = job.planes.encode.png.threads = share.threads;
    job.load.max_bytes = share.scene_bytes, job.render.max_bytes = share.frame_bytes;
    const Stopwatch watch;
    if (job.timeout) job.render.cancel = [watch, limit = 1000 * *job.timeout] { return watch.milliseconds() > limit; };
    Scene scene = load_input(file.file, job.load);
    report.load_ms = watch.milliseconds();
    check_time(job);
    set_up(job, scene);
    std::vector<std::string> cameras = job_.cameras;
    if (job_.every_camera) {
        cameras = cameras_of(scene);
        if (cameras.empty()) throw Error(ErrorCode::kUsage, "--camera: the scene has no cameras");
        outputs = plan(file, cameras, report.number);
        if (nothing_to_do()) report.status = SceneStatus::kSkipped;
    }
    // Poses are the file's, and turned already.
    if (job.poses.empty())
        for (std::size_t i = 0; i < cameras.size(); ++i) {
            job.poses.push_back({cameras[i], job.render.view});
            job.poses.back().view.camera = job_.every_camera ? static_cast<int>(i) : find_camera(scene, cameras[i]);
        }
    report.warnings = scene.warnings;
    draw(job, scene, outputs, report);
}

SceneWorker::Output SceneWorker::plan_one(const SceneFile& file, long shot, const std::string& camera,
                                          std::optional<long> frame) {
    Output output;
    output.shot = shot, output.camera = camera, output.frame = frame;
    output.files = output_names(job_, file, camera, frame);
    for (const std::string& name : output.files) {
        shared_.claims.claim(name, file.file);
        shared_.inputs.check("--output", name);
        shared_.stale.remove(name);
        output.missing.push_back(!job_.skip_existing || !is_plain_file(name));
    }
    return output;
}

// In the order of the ShotList.
std::vector<SceneWorker::Output> SceneWorker::plan(const SceneFile& file, const std::vector<std::string>& cameras,
                                                   std::uint64_t number) {
    const std::vector<std::string> names = cameras.empty() ? std::vector<std::string>{"default"} : cameras;
    const std::optional<Frames>& frames = job_.render.frames;
    const bool video = job_.render.codec == Codec::kVideo;
    const long numbered = frames && !video ? frames->count() : 1;
    const auto columns = static_cast<long>(names.size());
    std::vector<Output> outputs;
    for (long i = 0; i < numbered; ++i) {
        if (job_.shard_frames && !job_.shard.has(number + static_cast<std::uint64_t>(i))) continue;
        for (long c = 0; c < columns; ++c)
            outputs.push_back(plan_one(file, i * columns + c, names[static_cast<std::size_t>(c)],
                                       frames && !video ? std::optional(frames->first + i) : std::nullopt));
    }
    // Names of cameras may become one when they are made fit for files.
    std::set<std::string_view> different;
    for (const Output& output : outputs)
        for (const std::string& name : output.files)
            if (!different.insert(name).second) refuse("--output", "'" + name + "' would be written twice");
    return outputs;
}

void SceneWorker::draw(const RenderJob& job, const Scene& scene, const std::vector<Output>& outputs,
                       SceneReport& report) {
    const ShotList shots(job);
    std::optional<Renderer> renderer;
    for (const Output& output : outputs) {
        for (std::size_t i = 0; i < output.files.size(); ++i)
            if (!output.missing[i]) {
                add_existing(output, i, report);
                check_time(job);
            }
        if (output.complete()) continue;
        const Stopwatch watch;
        const bool first = !renderer;
        if (first) renderer.emplace(scene, job.render);
        if (job.codec == Codec::kVideo) {
            write_video(job, shots, *renderer, output, report);
        } else {
            const PlannedShot shot = shots.at(output.shot);
            renderer->draw(shot.now, shot.before, shot.after, planes_);
            report.render_ms += watch.milliseconds();
            write_picture(job, output, report);
        }
        if (first) report.warnings.insert(report.warnings.end(), planes_.warnings.begin(), planes_.warnings.end());
    }
}

void SceneWorker::write_picture(const RenderJob& job, const Output& output, SceneReport& report) {
    const Stopwatch watch;
    finish_color(job.planes, planes_);
    for (std::size_t i = 0; i < output.files.size(); ++i) {
        if (!output.missing[i]) continue;
        const PlaneFile& planes = job.planes.files[i];
        const Image& plane = plane_of(planes.planes.front(), planes_);
        PictureReport picture;
        picture.file = output.files[i], picture.aov = planes.aov;
        picture.camera = output.camera, picture.frame = output.frame;
        picture.width = plane.width(), picture.height = plane.height();
        if (planes.planes.size() == 1)
            picture.hash = hash_text(&plane == &planes_.color ? planes_.stats.color_hash : hash_pixels(plane));
        const std::vector<std::byte> file = encode_planes(job.planes, planes, planes_);
        check_time(job);
        make_folders_of(picture.file);
        write_output(picture.file, file);
        compare(picture, file);
        report.pictures.push_back(std::move(picture));
        check_time(job);
    }
    report.encode_ms += watch.milliseconds();
}

void SceneWorker::write_video(const RenderJob& job, const ShotList& shots, Renderer& renderer, const Output& output,
                              SceneReport& report) {
    const Stopwatch watch;
    PictureReport picture;
    picture.file = output.files.front(), picture.camera = output.camera, picture.aov = "color";
    make_folders_of(picture.file);
    Video video(picture.file, {job.fps, !job.render.background}, job.render.cancel);
    double encoding = 0;
    const auto cameras = static_cast<long>(std::max<std::size_t>(job.poses.size(), 1));
    for (long i = output.shot; i < shots.count(); i += cameras) {
        const PlannedShot shot = shots.at(i);
        renderer.draw(shot.now, shot.before, shot.after, planes_);
        const Stopwatch encoder;
        finish_color(job.planes, planes_);
        video.add(planes_.color);
        encoding += encoder.milliseconds();
    }
    const Stopwatch encoder;
    picture.width = planes_.color.width(), picture.height = planes_.color.height();
    video.finish();
    encoding += encoder.milliseconds();
    report.encode_ms += encoding;
    report.render_ms += watch.milliseconds() - encoding;
    report.pictures.push_back(std::move(picture));
}

// What is there already is compared, too.
void SceneWorker::add_existing(const Output& output, std::size_t file, SceneReport& report) {
    PictureReport picture;
    picture.file = output.files[file], picture.camera = output.camera, picture.frame = output.frame;
    picture.aov = job_.render.planes.files[file].aov;
    picture.skipped = true;
    if (job_.reference) compare(picture, read_file(picture.file));
    report.pictures.push_back(std::move(picture));
}

void SceneWorker::compare(PictureReport& picture, std::span<const std::byte> written) const {
    if (!job_.reference) return;
    const std::string below = picture.file.substr(fixed_folder(job_.pattern).size());
    picture.comparison = compare_with_reference(*job_.reference, below, written);
}

}  // namespace tessera::cli
