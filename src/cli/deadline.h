// The end of the command's time (`--timeout`). Rendering asks expired() through its cancel callback
// and stops by itself; loading cannot be interrupted, so when the time ends there, or rendering does
// not stop within a grace period, the process ends at once with exit code 6. That is safe because
// nothing is being written then: the caller disarms before it writes.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace tessera::cli {

class Deadline {
  public:
    // Unset: no limit. `file` is named in the error.
    Deadline(std::optional<double> seconds, std::string file);
    ~Deadline() { disarm(); }
    Deadline(const Deadline&) = delete;
    Deadline& operator=(const Deadline&) = delete;

    bool expired() const { return expired_; }
    // From now on the work asks expired() and stops by itself.
    void allow_grace() { grace_ = true; }
    void disarm();
    // While something is written the process is not ended; the work is told of the end afterwards.
    void hold(bool writing);
    // The one line that is printed when the time is up.
    std::string message() const;

  private:
    void watch();

    double seconds_ = 0;
    std::string file_;
    std::atomic<bool> expired_{false}, grace_{false};
    bool done_ = false, writing_ = false;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::thread watcher_;
};

}  // namespace tessera::cli
