#include "cli/batch_run.h"

#include "cli/batch_scene.h"
#include "cli/statistics.h"
#include "cli/stopwatch.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace tessera::cli {
namespace {

// FNV-1a (64 bit) over the names, each ended by a zero.
std::string list_hash(const std::vector<SceneFile>& scenes) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const SceneFile& scene : scenes)
        for (std::size_t i = 0; i <= scene.file.size(); ++i)
            hash = (hash ^ static_cast<unsigned char>(scene.file.c_str()[i])) * 0x100000001b3u;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

class Run {
  public:
    Run(const BatchJob& job, const std::vector<SceneFile>& scenes, const SceneDone& done)
        : job_(job), scenes_(scenes), done_(done), shared_{job, InputFiles(scenes, job.list), {}, {}} {
        for (std::size_t i = 0; i < scenes.size(); ++i)
            if (job.shard_frames || job.shard.has(i)) mine_.push_back(i);
        left_ = mine_.size();
        workers_ = static_cast<int>(std::clamp<std::size_t>(mine_.size(), 1, static_cast<std::size_t>(job.in_flight)));
    }

    BatchReport run() {
        const Stopwatch watch;
        const int workers = start_and_work();
        if (failure_) std::rethrow_exception(failure_);
        do_large_ones();

        std::sort(report_.scenes.begin(), report_.scenes.end(),
                  [](const SceneReport& a, const SceneReport& b) { return a.number < b.number; });
        report_.list_scenes = scenes_.size();
        report_.list_hash = list_hash(scenes_);
        report_.shards = {job_.shard.index}, report_.shard_count = job_.shard.count;
        report_.shard_by = job_.shard_frames ? "frame" : "scene";
        report_.threads = job_.threads, report_.in_flight = workers;
        report_.wall_ms = watch.milliseconds();
        report_.peak_rss_mb = peak_memory_mb();
        return std::move(report_);
    }

  private:
    // Returns how many threads there were.
    int start_and_work() {
        const int wanted = workers_;
        std::vector<std::thread> helpers;
        helpers.reserve(static_cast<std::size_t>(wanted));
        try {
            for (int i = 1; i < wanted; ++i) helpers.emplace_back([this] { work(); });
        } catch (const std::exception&) {
            // No thread, or no memory for one.
            const std::lock_guard lock(mutex_);
            workers_ = 1 + static_cast<int>(helpers.size());
        }
        work();
        for (std::thread& helper : helpers) helper.join();
        return 1 + static_cast<int>(helpers.size());
    }

    // Nothing is thrown out of a thread; the first failure ends the batch.
    void work() noexcept {
        try {
            SceneWorker worker(shared_);
            SceneShare share;
            bool alone = false;
            for (std::size_t number; take(number, share, alone);) {
                SceneReport report = worker.run(scenes_[number], number, share);
                finish(std::move(report), worker.hit_limit() && !alone);
            }
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            next_ = mine_.size();
        }
    }

    // The next scene, and what it may take: a fair part of the threads among the scenes that are left, and of the
    // memory among the scenes in flight.
    bool take(std::size_t& number, SceneShare& share, bool& alone) {
        const std::lock_guard lock(mutex_);
        if (next_ == mine_.size()) return false;
        const auto rivals = static_cast<int>(std::min(left_, static_cast<std::size_t>(workers_)));
        const auto parts = static_cast<std::uint64_t>(workers_);
        share.threads = std::max(1, job_.threads / rivals);
        share.scene_bytes = std::max<std::uint64_t>(1, job_.render.load.max_bytes / parts);
        share.frame_bytes = std::max<std::uint64_t>(1, job_.render.render.max_bytes / parts);
        alone = workers_ == 1;
        number = mine_[next_++];
        return true;
    }

    void finish(SceneReport report, bool too_large) {
        const std::lock_guard lock(mutex_);
        if (too_large) {
            large_.push_back(static_cast<std::size_t>(report.number));
            return;
        }
        --left_;
        done_(report, left_, mine_.size());
        report_.scenes.push_back(std::move(report));
    }

    void do_large_ones() {
        std::sort(large_.begin(), large_.end());
        const SceneShare all{job_.threads, job_.render.load.max_bytes, job_.render.render.max_bytes};
        for (const std::size_t number : std::exchange(large_, {})) {
            SceneWorker worker(shared_);
            finish(worker.run(scenes_[number], number, all), false);
        }
    }

    const BatchJob& job_;
    const std::vector<SceneFile>& scenes_;
    const SceneDone& done_;
    BatchShared shared_;
    std::vector<std::size_t> mine_;  // of this shard, by number in the list

    std::mutex mutex_;  // of all that follows
    int workers_ = 1;
    std::exception_ptr failure_;
    std::size_t next_ = 0, left_ = 0;
    std::vector<std::size_t> large_;
    BatchReport report_;
};

}  // namespace

BatchReport run_batch(const BatchJob& job, const std::vector<SceneFile>& scenes, const SceneDone& done) {
    return Run(job, scenes, done).run();
}

}  // namespace tessera::cli
