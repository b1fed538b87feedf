// Where the files beside a scene lie: in a folder, in the same archive, or nowhere.
#pragma once

#include "load/context.h"
#include "load/file.h"

#include <cstdint>
#include <string>
#include <utility>

namespace tessera {

class SceneFiles {
  public:
    virtual ~SceneFiles() = default;
    // The first `most` bytes (fewer when it is shorter) of the file that a relative path names, charged to the
    // context. Throws kInput for paths that leave the scene's place, and for what is not there.
    virtual Bytes read(LoadContext& context, const std::string& path, std::uint64_t most,
                       const std::string& place) const = 0;
};

// A folder of the file system; "" for nowhere.
class FolderFiles : public SceneFiles {
  public:
    explicit FolderFiles(std::string folder) : folder_(std::move(folder)) {}
    Bytes read(LoadContext& context, const std::string& path, std::uint64_t most,
               const std::string& place) const override;

  private:
    std::string folder_;
};

// The whole file that a mesh format names, with forward slashes: where its name says or, as names often begin with
// folders of the machine that wrote them, beside the scene.
Bytes read_beside(LoadContext& context, const SceneFiles& files, const std::string& name, const std::string& place);

}  // namespace tessera
