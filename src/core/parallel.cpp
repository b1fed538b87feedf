#include "core/parallel.h"

#include "core/fp_environment.h"

#include <sched.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

#if defined(TESSERA_STD_THREADS)
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace tessera {
namespace {

// The cgroup's CPU quota in whole processors (rounded up), or 0 when there is none. Version 2 keeps
// "quota period" in cpu.max; version 1 keeps two files.
int cgroup_quota() {
    std::string quota;
    long long period = 0;
    if (std::ifstream v2("/sys/fs/cgroup/cpu.max"); v2 >> quota >> period) {
        if (quota == "max" || period <= 0) return 0;
        return static_cast<int>((std::stoll(quota) + period - 1) / period);
    }
    long long us = 0;
    std::ifstream q("/sys/fs/cgroup/cpu/cpu.cfs_quota_us"), p("/sys/fs/cgroup/cpu/cpu.cfs_period_us");
    if (q >> us && p >> period && us > 0 && period > 0) return static_cast<int>((us + period - 1) / period);
    return 0;
}

}  // namespace

int available_threads() {
    cpu_set_t set;
    CPU_ZERO(&set);
    int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    if (const int quota = cgroup_quota(); quota > 0) count = std::min(count, quota);
    return std::max(count, 1);
}

#if defined(TESSERA_STD_THREADS)

struct Arena::Impl {};

void Arena::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    auto work = [&] {
        const FpEnvironment exact;
        for (std::size_t i; (i = next.fetch_add(1)) < count;) {
            try {
                body(i);
            } catch (...) {
                const std::lock_guard lock(failure_mutex);
                if (!failure) failure = std::current_exception();
                next = count;
            }
        }
    };
    std::vector<std::thread> helpers;
    const std::size_t wanted = std::min<std::size_t>(static_cast<std::size_t>(threads_), count);
    for (std::size_t i = 1; i < wanted; ++i) helpers.emplace_back(work);
    work();
    for (std::thread& t : helpers) t.join();
    if (failure) std::rethrow_exception(failure);
}

#else

struct Arena::Impl {
    explicit Impl(int threads) : arena(threads) {}
    tbb::task_arena arena;
};

void Arena::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
    impl_->arena.execute([&] {
        tbb::parallel_for(
            std::size_t{0}, count,
            [&](std::size_t i) {
                const FpEnvironment exact;
                body(i);
            },
            tbb::simple_partitioner{});
    });
}

#endif

Arena::Arena(int threads) : threads_(threads > 0 ? threads : available_threads()) {
#if !defined(TESSERA_STD_THREADS)
    // More than oneTBB may use here (processors, or a limit that the host has set) would make it print
    // a warning and change nothing.
    const std::size_t most = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    threads_ = std::min(threads_, static_cast<int>(std::min<std::size_t>(most, 4096)));
    impl_ = std::make_unique<Impl>(threads_);
#endif
}

Arena::~Arena() = default;

}  // namespace tessera
