// The command `tessera`: parses, runs one subcommand, and turns every failure into one line on
// stderr and an exit code (exit_code.h).
#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/report.h"
#include "cli/temporary_file.h"

#include <tessera/error.h>
#include <tessera/render.h>
#include <tessera/version.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

namespace tessera::cli {
namespace {

std::string version_text() {
    std::string text = "tessera " TESSERA_VERSION "\ninstruction sets:";
    for (const char* isa : {"scalar", "sse4", "avx2", "avx512"}) {
        try {
            parse_isa(isa);
            text += std::string(" ") + isa;
        } catch (const Error&) {
            // This processor, or this build, lacks it.
        }
    }
    try {
        text += std::string(" (chosen: ") + name(resolve_isa(Isa::kAuto)) + ")";
    } catch (const Error& error) {
        text += " (" + printable(error.what()) + ")";
    }
#if defined(__clang__)
    text += "\ncompiler: clang " __clang_version__;
#elif defined(__GNUC__)
    text += "\ncompiler: g++ " __VERSION__;
#endif
#if !defined(__x86_64__)
    text += "\nthis processor is not x86-64: the one-lane code is built";
#endif
    return text + "\n";
}

int print(const std::string& text) {
    const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    if (!written) report_error("<stdout>: cannot be written");
    return written ? kFine : kOutputError;
}

// Names the argument that nothing expects: an option rather than what may have been its value.
std::string unexpected(const CLI::App& application) {
    const std::vector<std::string> rest = application.remaining(true);
    for (const std::string& argument : rest)
        if (argument.size() > 1 && argument[0] == '-' && argument != "--")
            return argument + ": there is no such option";
    return (rest.empty() ? std::string("arguments") : "'" + rest.back() + "'") + ": not expected here";
}

int parse_and_run(int argc, char** argv) {
    CLI::App application("Tessera renders 3D scenes (glTF 2.0) to pictures, without a GPU or a display.", "tessera");
    bool version = false;
    application.add_flag("-V,--version", version, "say version, instruction sets and compiler");
    application.require_subcommand(0, 1);
    const Command commands[] = {add_render_command(application),       add_batch_command(application),
                                add_merge_report_command(application), add_info_command(application),
                                add_diff_command(application),         add_bench_command(application)};
    application.footer(
        "`tessera COMMAND --help` lists a command's options.\n\n"
        "Exit codes: 0 fine, 1 internal fault, 2 usage, 3 pictures or counts differ, 4 input, 5 output,\n"
        "            6 a limit, the memory or the time.");
    try {
        application.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        for (const Command& command : commands)
            if (command.app->parsed()) return print(command.app->help("tessera"));
        return print(application.help());
    } catch (const CLI::ExtrasError&) {
        throw Error(ErrorCode::kUsage, unexpected(application));
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorCode::kUsage, error.what());
    }
    if (version) return print(version_text());
    for (const Command& command : commands)
        if (command.app->parsed()) return command.run();
    throw Error(ErrorCode::kUsage,
                "which command? There are render, batch, merge-report, info, diff and bench; see tessera --help");
}

}  // namespace
}  // namespace tessera::cli

int main(int argc, char** argv) {
    using namespace tessera::cli;
    // A closed pipe and a file-size limit shall be errors with an exit code, not signals.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    remember_umask();
    try {
        return parse_and_run(argc, argv);
    } catch (const tessera::Error& error) {
        report_error(error.what());
        return exit_code(error.code());
    } catch (const std::bad_alloc&) {
        report_error("out of memory");
        return kLimitReached;
    } catch (const std::exception& error) {
        report_error(std::string("internal: ") + error.what());
    } catch (...) {
        report_error("internal: unknown exception");
    }
    return kInternalFault;
}
