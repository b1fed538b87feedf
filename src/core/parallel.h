// Parallel loops and arenas: the one home of oneTBB in Tessera (or of std::thread, with
// TESSERA_THREADS=std, for the thread sanitizer). An Arena has its own threads, so a host's use of
// oneTBB is neither limited nor joined. Exceptions thrown by a body reach the caller of for_each().
#pragma once

#include <tessera/threads.h>

#include <cstddef>
#include <functional>
#include <memory>

namespace tessera {

class Arena {
  public:
    // 0: available_threads().
    explicit Arena(int threads = 0);
    ~Arena();
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;

    int threads() const { return threads_; }
    // Calls body(i) for every i in [0, count), each exactly once, in any order and on any thread of
    // the arena, under the exact floating-point environment (fp_environment.h). Returns when all are
    // done; the first exception stops the loop and is rethrown.
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    int threads_;
};

}  // namespace tessera
