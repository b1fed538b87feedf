// The scenes of a batch: files, folders with all that is in and below them, and lists of paths; sorted, each once.
#pragma once

#include <string>
#include <vector>

namespace tessera::cli {

struct SceneFile {
    std::string file;       // as it is opened and named in messages
    std::string path;       // below the folder that was given, or as it was given: without its ending
    std::string folder;     // of `path`; "." without one
    std::string model;      // the name alone, without its ending
    std::string extension;  // without the dot
    std::string error;      // why it cannot be read, known already; "" for none
};

// `arguments` are files and folders, which are searched for names that end like scenes; `list` is a file with a path
// per line ("-": stdin), or "". Throws kInput for arguments that are not there, kUsage when there is nothing at all. A
// line whose path is not there, and a folder that cannot be read, is in the result with its error.
std::vector<SceneFile> list_scenes(const std::vector<std::string>& arguments, const std::string& list);

}  // namespace tessera::cli
