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

// The files that a batch reads and must not write: its scenes and their list. Any thread may call.
class InputFiles {
  public:
    // `list` may be "", or "-".
    InputFiles(const std::vector<SceneFile>& scenes, const std::string& list);
    // Throws kUsage, naming the option, when `name` is one of them.
    void check(const std::string& option, const std::string& name) const;

  private:
    std::unordered_multimap<std::string, std::string> by_name_;  // without and with folders
};

// Throws kUsage, naming both scenes, where two of the list would write one file, or one would write an input.
// Cameras that only the scenes know are left to Claims.
void check_names(const BatchJob& job, const std::vector<SceneFile>& scenes, const InputFiles& inputs);

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
