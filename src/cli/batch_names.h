// Which files a batch writes: the pattern filled in for scenes, cameras and frames, so that no two have one name.
#pragma once

#include "cli/scene_list.h"

#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace tessera::cli {

struct BatchJob;

// The folder in front of the first place of a pattern, with its slash: "out/" of "out/{model}.png"; "" without one.
std::string fixed_folder(const std::string& pattern);

// A file for each that a picture has. Throws kUsage for places that there are not.
std::vector<std::string> output_names(const BatchJob& job, const SceneFile& scene, const std::string& camera,
                                      std::optional<long> frame);

// Throws kUsage, naming both scenes, where two of the list would write one file. Cameras that only the scenes
// know are left to Claims.
void check_names(const BatchJob& job, const std::vector<SceneFile>& scenes);

// Names that are taken. Any thread may call.
class Claims {
  public:
    // Throws kUsage when another scene has the name.
    void claim(const std::string& name, const std::string& scene);

  private:
    std::mutex mutex_;
    std::unordered_map<std::string, std::string> owners_;
};

}  // namespace tessera::cli
