// One scene of a batch: load it, draw what is missing of its pictures, write and compare them. A SceneWorker belongs to
// one thread; it keeps its planes from scene to scene.
#pragma once

#include "cli/batch_arguments.h"
#include "cli/batch_names.h"
#include "cli/batch_report.h"
#include "cli/scene_list.h"
#include "cli/temporary_file.h"

#include <tessera/renderer.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace tessera::cli {

// What the workers of a batch share.
struct BatchShared {
    const BatchJob& job;
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

  private:
    // A file to write: a picture, or a video of all frames.
    struct Output {
        std::string file, camera;
        std::optional<long> frame;
        View view;
        bool exists = false;
    };

    void run_outputs(const SceneFile& file, const SceneShare& share, SceneReport& report);
    std::vector<Output> plan(const SceneFile& file, const std::vector<std::string>& cameras, std::uint64_t number);
    void draw(RenderJob& job, const Scene& scene, const std::vector<Output>& outputs, SceneReport& report);
    void write_picture(const RenderJob& job, const Output& output, PictureReport& picture, SceneReport& report);
    void write_video(const RenderJob& job, Renderer& renderer, const Output& output, PictureReport& picture,
                     SceneReport& report);
    void add_existing(const Output& output, SceneReport& report);
    void compare(PictureReport& picture, std::span<const std::byte> written) const;

    BatchShared& shared_;
    const BatchJob& job_;
    RenderResult planes_;
};

}  // namespace tessera::cli
