// Runs the built command as a user would and keeps what it said: exit code or signal, stdout,
// stderr, time and largest resident memory. Standard input is `input`. A run that takes longer than
// its limit is killed and shows as signal 9.
#pragma once

#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#if !defined(TESSERA_COMMAND)
#define TESSERA_COMMAND ""
#endif
// The command of this build, or one that is built with sanitizers, so that those builds need no copy of these tests:
// TESSERA_INSTRUMENTED_COMMAND names it.
inline const char* const kInstrumentedCommand = std::getenv("TESSERA_INSTRUMENTED_COMMAND");
inline const char* const kCommand = kInstrumentedCommand != nullptr ? kInstrumentedCommand : TESSERA_COMMAND;

struct Outcome {
    int code = -1, signal = 0;
    std::string out, err;
    double seconds = 0;
    double resident_mb = 0;

    int error_lines() const {
        int lines = 0;
        for (const char c : err) lines += c == '\n';
        return lines;
    }
};

// `program` is a path.
inline Outcome run_program(const std::string& program, const std::vector<std::string>& arguments,
                           const std::string& input = {}, const std::vector<std::string>& environment = {},
                           double limit_seconds = 60) {
    std::array<int, 2> out{}, err{};
    const std::filesystem::path input_file =
        std::filesystem::temp_directory_path() / ("tessera-input-" + std::to_string(::getpid()));
    std::ofstream(input_file, std::ios::binary) << input;
    if (::pipe(out.data()) != 0 || ::pipe(err.data()) != 0) throw std::runtime_error("pipe");
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);

    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(::open(input_file.c_str(), O_RDONLY), STDIN_FILENO);
        ::dup2(out[1], STDOUT_FILENO);
        ::dup2(err[1], STDERR_FILENO);
        for (const int descriptor : {out[0], out[1], err[0], err[1]}) ::close(descriptor);
        for (const std::string& setting : environment) ::putenv(const_cast<char*>(setting.c_str()));
        ::execv(program.c_str(), argv.data());
        ::_exit(127);
    }
    ::close(out[1]);
    ::close(err[1]);

    Outcome run;
    std::array<pollfd, 2> open{pollfd{out[0], POLLIN, 0}, pollfd{err[0], POLLIN, 0}};
    for (int left = 2; left > 0;) {
        ::poll(open.data(), 2, 100);
        if (elapsed() > limit_seconds) ::kill(child, SIGKILL);
        for (std::size_t i = 0; i < 2; ++i) {
            if (open[i].fd < 0 || open[i].revents == 0) continue;
            std::array<char, 65536> buffer;
            const ssize_t got = ::read(open[i].fd, buffer.data(), buffer.size());
            if (got > 0) {
                (i == 0 ? run.out : run.err).append(buffer.data(), static_cast<std::size_t>(got));
            } else {
                ::close(open[i].fd);
                open[i].fd = -1;
                --left;
            }
        }
    }
    int status = 0;
    struct rusage usage {};
    ::wait4(child, &status, 0, &usage);
    run.seconds = elapsed();
    run.resident_mb = static_cast<double>(usage.ru_maxrss) / 1024;
    if (WIFEXITED(status)) run.code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) run.signal = WTERMSIG(status);
    std::filesystem::remove(input_file);
    return run;
}

inline Outcome run_command(const std::vector<std::string>& arguments, const std::string& input = {},
                           const std::vector<std::string>& environment = {}, double limit_seconds = 60) {
    return run_program(kCommand, arguments, input, environment, limit_seconds);
}

inline std::string read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// A test with a folder of its own; skipped when the command was not built.
class CliTest : public ::testing::Test {
  protected:
    void SetUp() override {
        if (*kCommand == '\0') GTEST_SKIP() << "the command is not part of this build";
        std::string name = (std::filesystem::temp_directory_path() / "tessera-cli-XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override {
        if (!folder_.empty()) std::filesystem::remove_all(folder_);
    }

    std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }
    std::vector<std::string> folder_contents() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }
    // All files below a folder by their path in it, with their contents.
    static std::map<std::string, std::string> tree(const std::filesystem::path& folder) {
        std::map<std::string, std::string> files;
        if (!std::filesystem::exists(folder)) return files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
            if (entry.is_regular_file())
                files[entry.path().lexically_relative(folder).string()] = read_file(entry.path());
        return files;
    }
    static std::string scene(const std::string& name) { return std::string(TESSERA_SOURCE_DIR "/scenes/") + name; }

    std::filesystem::path folder_;
};
