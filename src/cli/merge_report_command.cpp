// `tessera merge-report`: the reports of a batch's shards as one, with the exit code that the whole batch would have
// had.
#include "cli/batch_report.h"
#include "cli/commands.h"
#include "cli/comparison_page.h"
#include "cli/files.h"
#include "cli/parse.h"
#include "cli/report.h"

#include <tessera/error.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

namespace tessera::cli {
namespace {

struct MergeArguments {
    std::vector<std::string> reports;
    std::string output, page;
    bool partial = false, quiet = false;
};

// Options that shards may differ in: they change neither pictures nor verdicts.
bool is_of_the_shard(const std::string& option) {
    constexpr std::array<std::string_view, 12> kOwn{"--shard",   "--report",    "--html", "--diff-dir",
                                                    "--threads", "--in-flight", "--isa",  "--max-memory",
                                                    "--timeout", "--quiet",     "--list", "--skip-existing"};
    return std::find(kOwn.begin(), kOwn.end(), option) != kOwn.end();
}

[[noreturn]] void fail(const std::string& file, const std::string& reason) {
    throw Error(ErrorCode::kInput, reason, file);
}

std::map<std::string, std::string> shared_options(const BatchReport& report) {
    std::map<std::string, std::string> options = report.options;
    std::erase_if(options, [](const auto& option) { return is_of_the_shard(option.first); });
    return options;
}

// Throws unless both are of one batch.
void check_same_batch(const BatchReport& first, const std::string& first_file, const BatchReport& next,
                      const std::string& file) {
    const std::string other = " than in " + first_file;
    if (next.list_scenes != first.list_scenes || next.list_hash != first.list_hash)
        fail(file, "its list of scenes is another" + other);
    if (next.shard_count != first.shard_count || next.shard_by != first.shard_by)
        fail(file, "it is split in another way" + other);
    const auto a = shared_options(first), b = shared_options(next);
    if (a == b) return;
    std::set<std::string> names;
    for (const auto* options : {&a, &b})
        for (const auto& [name, value] : *options) names.insert(name);
    for (const std::string& name : names) {
        const auto x = a.find(name), y = b.find(name);
        const bool in_both = x != a.end() && y != b.end();
        if (!in_both || x->second != y->second) fail(file, name + " is another" + other);
    }
}

// The pictures of a scene whose frames were shared out come together.
void join(BatchReport& whole, BatchReport part) {
    whole.shards.insert(whole.shards.end(), part.shards.begin(), part.shards.end());
    whole.threads += part.threads, whole.in_flight += part.in_flight;
    whole.wall_ms = std::max(whole.wall_ms, part.wall_ms);
    whole.peak_rss_mb = std::max(whole.peak_rss_mb, part.peak_rss_mb);
    std::move(part.scenes.begin(), part.scenes.end(), std::back_inserter(whole.scenes));
}

void join_scenes(BatchReport& whole) {
    std::stable_sort(whole.scenes.begin(), whole.scenes.end(),
                     [](const SceneReport& a, const SceneReport& b) { return a.number < b.number; });
    std::vector<SceneReport> joined;
    for (SceneReport& scene : whole.scenes) {
        if (joined.empty() || joined.back().number != scene.number) {
            joined.push_back(std::move(scene));
            continue;
        }
        SceneReport& s = joined.back();
        s.load_ms += scene.load_ms, s.render_ms += scene.render_ms, s.encode_ms += scene.encode_ms;
        std::move(scene.pictures.begin(), scene.pictures.end(), std::back_inserter(s.pictures));
        // All cameras of a frame are in one shard, in the order of the undivided batch.
        std::stable_sort(s.pictures.begin(), s.pictures.end(),
                         [](const PictureReport& a, const PictureReport& b) { return a.frame < b.frame; });
        if (s.warnings.empty()) s.warnings = std::move(scene.warnings);
        if (scene.status == SceneStatus::kFailed && s.status != SceneStatus::kFailed)
            s.status = scene.status, s.exit_code = scene.exit_code, s.error = scene.error;
        else if (s.status == SceneStatus::kSkipped)
            s.status = scene.status;
    }
    whole.scenes = std::move(joined);
}

std::string listed(const std::vector<long>& numbers) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(numbers.size(), 20); ++i)
        text += (i == 0 ? "" : ", ") + std::to_string(numbers[i]);
    return numbers.size() > 20 ? text + ", ... (" + std::to_string(numbers.size()) + ")" : text;
}

BatchReport merge(const std::vector<std::string>& files, bool partial) {
    BatchReport whole = read_report(files.front());
    std::map<long, std::string> owners;
    const auto own = [&](const std::vector<long>& shards, const std::string& file) {
        for (const long shard : shards)
            if (const auto [owner, is_new] = owners.try_emplace(shard, file); !is_new)
                fail(file, "shard " + std::to_string(shard) + " is in " + owner->second + ", too");
    };
    own(whole.shards, files.front());
    for (std::size_t i = 1; i < files.size(); ++i) {
        BatchReport part = read_report(files[i]);
        check_same_batch(whole, files.front(), part, files[i]);
        own(part.shards, files[i]);
        join(whole, std::move(part));
    }
    std::vector<long> missing;
    for (long shard = 1; shard <= whole.shard_count; ++shard)
        if (!owners.contains(shard)) missing.push_back(shard);
    if (!missing.empty() && !partial)
        fail(files.front(),
             "of " + std::to_string(whole.shard_count) + " shards these are missing: " + listed(missing));
    std::sort(whole.shards.begin(), whole.shards.end());
    std::erase_if(whole.options, [](const auto& option) { return is_of_the_shard(option.first); });
    join_scenes(whole);
    if (missing.empty() && whole.scenes.size() != whole.list_scenes)
        fail(files.front(), "its list has " + std::to_string(whole.list_scenes) + " scenes, the reports have " +
                                std::to_string(whole.scenes.size()));
    return whole;
}

int run(const MergeArguments& arguments) {
    if (arguments.output.empty() && arguments.page.empty())
        refuse("--output", "say where the report goes: -o FILE, or -o -");
    for (const std::string& file : {arguments.output, arguments.page}) {
        if (file.empty()) continue;
        if (file != "-") make_folders_of(file);
        check_writable(file);
    }
    const BatchReport whole = merge(arguments.reports, arguments.partial);
    if (!arguments.output.empty()) write_output(arguments.output, report_json(whole));
    if (!arguments.page.empty()) write_output(arguments.page, comparison_page(whole, kPageBytes));
    if (!arguments.quiet) std::fprintf(stderr, "tessera: %s\n", printable(summary(whole)).c_str());
    return exit_code(whole);
}

}  // namespace

Command add_merge_report_command(CLI::App& application) {
    CLI::App* app = application.add_subcommand("merge-report", "Join the reports of a batch's shards");
    auto arguments = std::make_shared<MergeArguments>();
    app->add_option("reports", arguments->reports, "what tessera batch --report wrote, of every shard")
        ->required()
        ->option_text("");
    app->add_option("-o,--output", arguments->output, "the report of the whole, as JSON (- for stdout)")
        ->option_text("FILE");
    app->add_option("--html", arguments->page, "page of the whole comparison")->option_text("FILE");
    app->add_flag("--partial", arguments->partial, "shards may be missing");
    app->add_flag("-q,--quiet", arguments->quiet, "nothing on stderr but errors");
    app->footer(
        "Exit code: that of the first scene that failed, else 3 where pictures differ from the reference, else 0.\n"
        "4 when a shard is missing or there twice, or when the reports are not of one batch.");
    return {app, [arguments] { return run(*arguments); }};
}

}  // namespace tessera::cli
