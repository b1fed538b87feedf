// A batch at work: scenes are taken from the list by as many threads as there may be scenes in flight. They share
// the memory: a scene that its share is too small for is done at the end, alone, with all of it. Threads that have no
// scene to do help those that do. What is written does not depend on any of that.
#pragma once

#include "cli/batch_arguments.h"
#include "cli/batch_report.h"
#include "cli/scene_list.h"

#include <functional>
#include <vector>

namespace tessera::cli {

// `done` is called for every scene as it ends, one call at a time; `left` of `all` scenes of the shard are to come. The
// report has everything but the options. Where the system has no more threads, those that there are do all of it.
using SceneDone = std::function<void(const SceneReport& scene, std::size_t left, std::size_t all)>;
BatchReport run_batch(const BatchJob& job, const std::vector<SceneFile>& scenes, const SceneDone& done);

}  // namespace tessera::cli
