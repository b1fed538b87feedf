#include "cli/batch_scene.h"

#include "cli/files.h"
#include "cli/picture_file.h"
#include "cli/scene_input.h"
#include "cli/scene_setup.h"
#include "cli/stopwatch.h"
#include "cli/video.h"

#include <tessera/error.h>

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <utility>

namespace tessera::cli {
namespace {

std::string hash_text(std::uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

bool exists(const std::string& file) { return ::access(file.c_str(), F_OK) == 0; }

// The names of all cameras that the active scene can be seen from; numbers where a name is missing or not unique.
std::vector<std::string> cameras_of(const Scene& scene) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const std::string& name = scene.cameras[i].name;
        const auto same =
            std::count_if(scene.cameras.begin(), scene.cameras.end(), [&](const Camera& c) { return c.name == name; });
        names.push_back(name.empty() || same > 1 ? std::to_string(i) : name);
    }
    return names;
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
    };
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

void SceneWorker::run_outputs(const SceneFile& file, const SceneShare& share, SceneReport& report) {
    std::vector<Output> outputs;
    if (!job_.every_camera) outputs = plan(file, job_.cameras, report.number);
    const auto nothing_to_do = [&] {
        return std::all_of(outputs.begin(), outputs.end(), [](const Output& o) { return o.exists; });
    };
    if (!job_.every_camera && nothing_to_do()) {
        report.status = SceneStatus::kSkipped;
        for (const Output& output : outputs) add_existing(output, report);
        return;
    }

    RenderJob job = job_.render;
    job.load.threads = job.render.threads = share.threads;
    job.load.max_bytes = share.scene_bytes, job.render.max_bytes = share.frame_bytes;
    const Stopwatch watch;
    if (job.timeout) job.render.cancel = [watch, limit = 1000 * *job.timeout] { return watch.milliseconds() > limit; };
    Scene scene = load_input(file.file, job.load);
    report.load_ms = watch.milliseconds();
    if (job.render.cancel && job.render.cancel()) throw Error(ErrorCode::kCancelled, "");
    set_up(job, scene);
    if (job_.every_camera) {
        const std::vector<std::string> cameras = cameras_of(scene);
        if (cameras.empty()) throw Error(ErrorCode::kUsage, "--camera: the scene has no cameras");
        outputs = plan(file, cameras, report.number);
        if (nothing_to_do()) report.status = SceneStatus::kSkipped;
    }
    for (Output& output : outputs) {
        output.view = job.render.view;
        if (!output.camera.empty()) output.view.camera = find_camera(scene, output.camera);
        if (output.frame) output.view = job.frames->view(output.view, *output.frame);
    }
    report.warnings = scene.warnings;
    draw(job, scene, outputs, report);
}

std::vector<SceneWorker::Output> SceneWorker::plan(const SceneFile& file, const std::vector<std::string>& cameras,
                                                   std::uint64_t number) {
    const std::optional<Frames>& frames = job_.render.frames;
    const bool numbered = frames && job_.render.codec != Codec::kVideo;
    std::vector<Output> outputs;
    const auto add = [&](const std::string& camera, std::optional<long> frame) {
        Output output;
        output.file = output_name(job_, file, camera.empty() ? "default" : camera, frame);
        output.camera = camera, output.frame = frame;
        shared_.claims.claim(output.file, file.file);
        shared_.stale.remove(output.file);
        output.exists = job_.skip_existing && exists(output.file);
        outputs.push_back(std::move(output));
    };
    for (const std::string& camera : cameras.empty() ? std::vector<std::string>{""} : cameras) {
        if (!numbered) {
            add(camera, std::nullopt);
            continue;
        }
        for (long frame = frames->first; frame <= frames->last; ++frame)
            if (!job_.shard_frames || job_.shard.has(number + static_cast<std::uint64_t>(frame - frames->first)))
                add(camera, frame);
    }
    return outputs;
}

void SceneWorker::draw(RenderJob& job, const Scene& scene, const std::vector<Output>& outputs, SceneReport& report) {
    std::optional<Renderer> renderer;
    for (const Output& output : outputs) {
        if (output.exists) {
            add_existing(output, report);
            continue;
        }
        const Stopwatch watch;
        const bool first = !renderer;
        if (first) renderer.emplace(scene, job.render);
        PictureReport picture;
        picture.file = output.file, picture.camera = output.camera, picture.frame = output.frame, picture.aov = "color";
        make_folders_of(output.file);
        if (job.codec == Codec::kVideo) {
            write_video(job, *renderer, output, picture, report);
        } else {
            const Moment moment =
                output.frame ? job.frames->moment(job.render.moment, *output.frame) : job.render.moment;
            renderer->draw(output.view, moment, planes_);
            report.render_ms += watch.milliseconds();
            write_picture(job, output, picture, report);
        }
        if (first) report.warnings.insert(report.warnings.end(), planes_.warnings.begin(), planes_.warnings.end());
        report.pictures.push_back(std::move(picture));
    }
}

void SceneWorker::write_picture(const RenderJob& job, const Output& output, PictureReport& picture,
                                SceneReport& report) {
    const Stopwatch watch;
    finish_color(job, planes_);
    picture.hash = hash_text(planes_.stats.color_hash);
    picture.width = planes_.color.width(), picture.height = planes_.color.height();
    const std::vector<std::byte> file = encode_color(job, planes_);
    write_output(output.file, file);
    compare(picture, file);
    report.encode_ms += watch.milliseconds();
}

void SceneWorker::write_video(const RenderJob& job, Renderer& renderer, const Output& output, PictureReport& picture,
                              SceneReport& report) {
    const Stopwatch watch;
    Video video(output.file, {job.frames->fps, !job.render.background}, job.render.cancel);
    double encoding = 0;
    for (long frame = job.frames->first; frame <= job.frames->last; ++frame) {
        renderer.draw(job.frames->view(output.view, frame), job.frames->moment(job.render.moment, frame), planes_);
        const Stopwatch encoder;
        finish_color(job, planes_);
        video.add(planes_.color);
        encoding += encoder.milliseconds();
    }
    const Stopwatch encoder;
    picture.width = planes_.color.width(), picture.height = planes_.color.height();
    video.finish();
    encoding += encoder.milliseconds();
    report.encode_ms += encoding;
    report.render_ms += watch.milliseconds() - encoding;
}

// What is there already is compared, too.
void SceneWorker::add_existing(const Output& output, SceneReport& report) {
    PictureReport picture;
    picture.file = output.file, picture.camera = output.camera, picture.frame = output.frame, picture.aov = "color";
    picture.skipped = true;
    if (job_.reference) compare(picture, read_file(output.file));
    report.pictures.push_back(std::move(picture));
}

void SceneWorker::compare(PictureReport& picture, std::span<const std::byte> written) const {
    if (!job_.reference) return;
    const std::string below = picture.file.substr(fixed_folder(job_.pattern).size());
    picture.comparison = compare_with_reference(*job_.reference, below, written);
}

}  // namespace tessera::cli
