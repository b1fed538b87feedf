#include "cli/deadline.h"

#include "cli/exit_code.h"
#include "cli/report.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <utility>

namespace tessera::cli {

Deadline::Deadline(std::optional<double> seconds, std::string file) : file_(std::move(file)) {
    if (!seconds) return;
    seconds_ = *seconds;
    watcher_ = std::thread([this] { watch(); });
}

void Deadline::disarm() {
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    changed_.notify_all();
    if (watcher_.joinable()) watcher_.join();
}

void Deadline::hold(bool writing) {
    {
        const std::lock_guard lock(mutex_);
        writing_ = writing;
    }
    changed_.notify_all();
}

std::string Deadline::message() const {
    char time[32];
    std::snprintf(time, sizeof time, "%g", seconds_);
    return file_ + ": --timeout: not finished within " + time + " s";
}

void Deadline::watch() {
    std::unique_lock lock(mutex_);
    const auto finished = [this] { return done_; };
    if (changed_.wait_for(lock, std::chrono::duration<double>(seconds_), finished)) return;
    expired_ = true;
    constexpr auto kGrace = std::chrono::seconds(2);
    if (grace_ && changed_.wait_for(lock, kGrace, finished)) return;
    changed_.wait(lock, [this] { return done_ || !writing_; });
    if (done_) return;
    report_error(message());
    ::_exit(kLimitReached);
}

}  // namespace tessera::cli
