// One scene of a batch: load it, draw what is missing of its pictures, write and compare them. A SceneWorker belongs to
// one thread; it keeps its planes from scene to scene.
#pragma once

#include "cli/batch_arguments.h"
#include "cli/batch_names.h"
#include "cli/batch_report.h"
#include "cli/scene_list.h"
#include "cli/shots.h"
#include "cli/temporary_file.h"

#include <tessera/renderer.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera::cli {

// What the workers of a batch share.
struct BatchShared {
    const BatchJob& job;
    InputFiles inputs;
    Claims claims;
    StaleFiles stale;
};

// What one scene may take.
struct SceneShare {
    int threads = 1;
    std::uint64_t scene_bytes = 0, frame_bytes = 0;
};

class SceneWorker {
  public:
    explicit SceneWorker(BatchShared& shared) : shared_(shared), job_(shared.job) {}

    // Never throws for what is wrong with the scene or its pictures: the report says it. `number` is its place in the
    // list of all shards.
    SceneReport run(const SceneFile& scene, std::uint64_t number, const SceneShare& share);
    // Whether the latest one failed at a limit, which may have been that of its share.
    bool hit_limit() const { return hit_limit_; }

  private:
    // A picture with its files, one for each plane; or a video, with its one file.
    struct Output {
        long shot = 0;       // in the ShotList; of a video the first one
        std::string camera;  // as in the list
        std::optional<long> frame;
        std::vector<std::string> files;
        std::vector<bool> missing;

        bool complete() const;
    };

    void run_outputs(const SceneFile& file, const SceneShare& share, SceneReport& report);
    std::vector<Output> plan(const SceneFile& file, const std::vector<std::string>& cameras, std::uint64_t number);
    Output plan_one(const SceneFile& file, long shot, const std::string& camera, std::optional<long> frame);
    void draw(const RenderJob& job, const Scene& scene, const std::vector<Output>& outputs, SceneReport& report);
    void write_picture(const RenderJob& job, const Output& output, SceneReport& report);
    void write_video(const RenderJob& job, const ShotList& shots, Renderer& renderer, const Output& output,
                     SceneReport& report);
    void add_existing(const Output& output, std::size_t file, SceneReport& report);
    void compare(PictureReport& picture, std::span<const std::byte> written) const;

    BatchShared& shared_;
    const BatchJob& job_;
    RenderResult planes_;
    bool hit_limit_ = false;
};

}  // namespace tessera::cli
