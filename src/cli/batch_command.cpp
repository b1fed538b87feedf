// `tessera batch`: many scenes, cameras and frames in one process; the report, the comparison with a reference.
#include "cli/batch_arguments.h"
#include "cli/batch_names.h"
#include "cli/batch_run.h"
#include "cli/commands.h"
#include "cli/comparison_page.h"
#include "cli/files.h"
#include "cli/parse.h"
#include "cli/report.h"
#include "cli/video.h"

#include <tessera/error.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

namespace tessera::cli {
namespace {

void check_report(const std::string& file) {
    if (file != "-") make_folders_of(file);
    check_writable(file);
}

// What can be known to be in vain before anything is drawn.
void check_outputs(const BatchJob& job, const std::vector<SceneFile>& scenes) {
    const InputFiles inputs(scenes, job.list);
    check_names(job, scenes, inputs);
    if (!job.report.empty()) inputs.check("--report", job.report);
    if (job.reference) inputs.check("--html", job.page);
    const std::string folder = fixed_folder(job.pattern);
    make_folders_of(folder);
    check_folder_writable(folder);
    if (job.render.codec == Codec::kVideo) find_ffmpeg(job.pattern);
    if (!job.report.empty()) check_report(job.report);
    if (!job.reference) return;
    if (!is_folder(job.reference->folder))
        throw Error(ErrorCode::kInput, "--reference: is not a folder", job.reference->folder);
    std::error_code unknown;
    if (std::filesystem::equivalent(folder.empty() ? "." : folder, job.reference->folder, unknown))
        refuse("--reference",
               "'" + job.reference->folder + "' is the folder of --output: its pictures would be written over");
    check_report(job.page);
}

int run(const CLI::App& app, const BatchArguments& arguments) {
    const BatchJob job = parse_batch_arguments(arguments);
    const std::vector<SceneFile> scenes = list_scenes(arguments.scenes, arguments.list);
    check_outputs(job, scenes);
    if (!job.quiet && !job.shard.whole())
        std::fprintf(stderr, "tessera: shard %ld of %ld (%s)\n", job.shard.index, job.shard.count,
                     job.shard.from.c_str());

    ProgressBar bar(!job.quiet);
    BatchReport report = run_batch(job, scenes, [&](const SceneReport& scene, std::size_t left, std::size_t all) {
        bar.clear();
        if (!job.quiet) report_warnings(scene.file, scene.warnings);
        if (scene.status == SceneStatus::kFailed) report_error(scene.error);
        bar.show(1 - static_cast<double>(left) / static_cast<double>(all));
    });
    bar.clear();
    report.options = given_options(app);
    if (!job.quiet) std::fprintf(stderr, "tessera: %s\n", printable(summary(report)).c_str());
    if (!job.report.empty()) write_output(job.report, report_json(report));
    if (job.reference) write_output(job.page, comparison_page(report, kPageBytes));
    return exit_code(report);
}

}  // namespace

Command add_batch_command(CLI::App& application) {
    CLI::App* app = application.add_subcommand("batch", "Render many scenes, cameras and frames");
    auto arguments = std::make_shared<BatchArguments>();
    add_batch_options(*app, *arguments);
    return {app, [app, arguments] { return run(*app, *arguments); }};
}

}  // namespace tessera::cli
