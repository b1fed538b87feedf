// ZIP archives with a scene in them, read in place: nothing is unpacked to disk. Every file in it is hostile:
// sizes are charged before memory is taken, what is encrypted or damaged is an error, and names are only
// compared, never opened.
#pragma once

#include "load/scene_files.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tessera {

bool is_zip(std::span<const std::byte> file);

// Paths are those inside the archive, relative to its scene's folder; ".." may not leave the archive. Names of the
// archive may have backslashes or begin with "./".
class ZipFiles : public SceneFiles {
  public:
    // `file` must outlive this. Throws kInput for what is no archive or holds no scene.
    ZipFiles(LoadContext& context, std::span<const std::byte> file);
    ~ZipFiles() override;

    // The scene: the file nearest to the root that has a scene's extension; of several the first by name.
    const std::string& scene() const { return scene_; }
    Bytes read_scene(LoadContext& context) const;
    Bytes read(LoadContext& context, const std::string& path, std::uint64_t most,
               const std::string& place) const override;

  private:
    struct Archive;
    void find_scene(LoadContext& context);
    Bytes read_entry(LoadContext& context, const std::string& name, std::uint64_t most, const std::string& place) const;

    std::unique_ptr<Archive> archive_;
    std::string scene_, folder_;  // the folder ends with a slash, or is empty
};

}  // namespace tessera
