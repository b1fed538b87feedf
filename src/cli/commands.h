// The subcommands of `tessera`. Each adds itself to the application and returns what runs when it
// was chosen: a function that gives the exit code and throws tessera::Error.
#pragma once

#include <CLI/App.hpp>

#include <functional>

namespace tessera::cli {

struct Command {
    CLI::App* app = nullptr;
    std::function<int()> run;
};

Command add_render_command(CLI::App& application);
Command add_batch_command(CLI::App& application);
Command add_merge_report_command(CLI::App& application);
Command add_info_command(CLI::App& application);
Command add_diff_command(CLI::App& application);
Command add_bench_command(CLI::App& application);

}  // namespace tessera::cli
