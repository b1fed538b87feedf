// Wall time by phase, and processor time of the process, for the statistics.
#pragma once

#include <tessera/render.h>

#include <chrono>
#include <ctime>
#include <string>

namespace tessera {

class Stopwatch {
  public:
    explicit Stopwatch(RenderStats& stats) : stats_(stats) {}

    // Ends a phase: the time since the last one is its own. The same name again adds up.
    void phase(const std::string& name) {
        const auto now = Clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
        last_ = now;
        for (auto& [known, total] : stats_.phases_ms)
            if (known == name) {
                total += ms;
                return;
            }
        stats_.phases_ms.emplace_back(name, ms);
    }

    // The frame is done.
    void finish() {
        stats_.frame_ms = std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
        stats_.cpu_ms = cpu_ms() - cpu_start_;
    }

  private:
    using Clock = std::chrono::steady_clock;
    static double cpu_ms() {
        timespec t{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
    }

    RenderStats& stats_;
    Clock::time_point start_ = Clock::now(), last_ = start_;
    double cpu_start_ = cpu_ms();
};

}  // namespace tessera
