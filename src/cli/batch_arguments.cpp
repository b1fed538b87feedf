#include "cli/batch_arguments.h"

#include "cli/batch_names.h"
#include "cli/option_adder.h"
#include "cli/parse.h"
#include "cli/pattern.h"

#include <tessera/error.h>
#include <tessera/threads.h>

#include <algorithm>

namespace tessera::cli {
namespace {

// "front,top", or "all".
void parse_cameras(const std::string& text, BatchJob& job) {
    job.every_camera = text == "all";
    if (text.empty() || job.every_camera) return;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        if (end == at) refuse("--camera", "'" + text + "' has a name of no letters");
        job.cameras.push_back(text.substr(at, end - at));
        at = end + 1;
    }
}

void parse_pattern(const std::string& pattern, BatchJob& job) {
    if (pattern.empty()) refuse("--output", "say where the pictures go, as in out/{model}.png");
    if (pattern == "-") refuse("--output", "a batch writes files, not to stdout");
    for (const Pose& pose : job.render.poses) job.cameras.push_back(pose.name);
    if ((job.cameras.size() > 1 || job.every_camera) && !has_place(pattern, "camera"))
        refuse("--output", "several cameras need {camera} in the names");
    if (job.render.codec == Codec::kVideo && !job.render.frames)
        refuse("--output", "a video needs --frames or --turntable");
    job.pattern = pattern;
}

void parse_reference(const BatchArguments& a, BatchJob& job) {
    if (a.reference.empty()) {
        for (const auto& [option, text] : {std::pair{"--html", &a.page}, {"--diff-dir", &a.differences}})
            if (!text->empty()) refuse(option, "needs --reference");
        return;
    }
    if (job.render.codec == Codec::kVideo) refuse("--reference", "videos cannot be compared; write pictures");
    ReferenceOptions reference;
    reference.folder = a.reference;
    reference.tolerance = parse_number("--tolerance", a.tolerance, 0, 255);
    reference.max_differing =
        static_cast<std::uint64_t>(parse_integer("--max-differing", a.max_differing, 0, INT64_MAX));
    reference.max_pixels = job.render.max_picture;
    const std::string part =
        job.shard.whole() ? "" : "-" + std::to_string(job.shard.index) + "-of-" + std::to_string(job.shard.count);
    job.page = a.page.empty() ? fixed_folder(job.pattern) + "comparison" + part + ".html" : a.page;
    reference.differences = a.differences;
    if (reference.differences.empty())
        reference.differences = job.page.substr(0, job.page.find_last_of('/') + 1) + "differences";
    job.reference = reference;
}

}  // namespace

void add_batch_options(CLI::App& app, BatchArguments& a) {
    const OptionAdder option(app);
    app.add_option("scenes", a.scenes, "scene files, and folders with scene files anywhere in them")
        ->group("Input and output")
        ->option_text("");
    option("Input and output", "--list", a.list, "FILE", "more of them: a file with a path per line, or - for stdin");
    option(
        "Input and output", "-o,--output", a.render.output, "PATTERN",
        "names of the pictures: {model} (name of the scene's file), {path} (with its folders), {folder}, {extension}, "
        "{camera}, {frame:04}, {aov}; files and videos as render writes them");
    app.add_flag("--skip-existing", a.skip_existing, "leave out pictures that are there already")
        ->group("Input and output");
    option("Input and output", "--report", a.report, "FILE", "say what happened, as JSON (- for stdout)");
    add_picture_options(app, a.render);
    app.get_option("--camera")
        ->description("the scenes' cameras: names or indices with commas, or all (default: the first)");
    app.get_option("--timeout")
        ->description("give up a scene after so many seconds (exit code 6); loading is not interrupted");

    option("Farm", "--shard", a.shard, "I/N",
           "do part I (from 1) of N only; auto/N takes I, and without --shard both are taken, from the environment of "
           "Slurm's arrays, Kubernetes' indexed jobs and Open MPI");
    option("Farm", "--shard-by", a.shard_by, "scene|frame", "share out scenes (default), or the frames of each scene");
    option("Farm", "--in-flight", a.in_flight, "N",
           "scenes at a time at most, sharing threads and memory (default: threads)");

    option("Comparison", "--reference", a.reference, "DIR",
           "compare with the pictures of the same names in DIR; exit code 3 where one differs or is missing");
    option("Comparison", "--tolerance", a.tolerance, "N",
           "a pixel differs when a channel is off by more, in 1/255 (default 0)");
    option("Comparison", "--max-differing", a.max_differing, "N", "so many pixels of a picture may differ (default 0)");
    option("Comparison", "--html", a.page, "FILE",
           "page of the comparison (default: comparison.html beside the pictures)");
    option("Comparison", "--diff-dir", a.differences, "DIR",
           "for pictures of the differences (default: differences, beside the page)");

    app.footer(
        "Examples:\n"
        "  tessera batch models -o thumbs/{path}.png -s 256x256 --background none\n"
        "  tessera batch robot.glb -o out/{model}_{camera}_{frame:04}.png --camera all --frames 0-47 --skip-existing\n"
        "  tessera batch models -o turns/{path}.mp4 --turntable 72 -s 640x480\n"
        "  tessera batch models -o new/{path}.png --reference approved --tolerance 2 --html report.html\n"
        "  tessera batch --list scenes.txt -o out/{path}.png --shard 3/8 --report run-3.json\n"
        "\nA scene that fails is reported, and the rest goes on; the exit code is then that of the first one in the "
        "list.");
}

BatchJob parse_batch_arguments(const BatchArguments& a) {
    BatchJob job;
    RenderArguments render = a.render;
    job.render = parse_render_arguments(render);
    if (job.render.max_picture <
        static_cast<std::uint64_t>(job.render.render.width) * static_cast<std::uint64_t>(job.render.render.height))
        throw Error(ErrorCode::kLimit, "--size: more pixels than --max-pixels allows");
    job.skip_existing = a.skip_existing, job.quiet = a.render.quiet;
    parse_cameras(a.render.camera, job);
    job.render.camera.clear();
    parse_pattern(a.render.output, job);

    job.shard = parse_shard(a.shard);
    if (a.shard_by != "scene" && a.shard_by != "frame")
        refuse("--shard-by", "'" + a.shard_by + "' is none of scene, frame");
    job.shard_frames = a.shard_by == "frame";
    if (job.shard_frames && !job.render.frames) refuse("--shard-by", "frame needs --frames or --turntable");
    if (job.shard_frames && job.render.codec == Codec::kVideo)
        refuse("--shard-by", "frame: a video is made in one piece");

    job.threads = job.render.render.threads > 0 ? job.render.render.threads : available_threads();
    job.in_flight =
        a.in_flight.empty() ? job.threads : static_cast<int>(parse_integer("--in-flight", a.in_flight, 1, 1024));
    job.report = a.report;
    job.list = a.list;
    parse_reference(a, job);
    return job;
}

std::map<std::string, std::string> given_options(const CLI::App& app) {
    std::map<std::string, std::string> options;
    for (const CLI::Option* option : app.get_options()) {
        if (option->count() == 0 || option->get_lnames().empty()) continue;
        const auto& results = option->results();
        options["--" + option->get_lnames().front()] = results.empty() ? "" : results.front();
    }
    return options;
}

}  // namespace tessera::cli
