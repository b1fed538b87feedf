#include "cli/scene_list.h"

#include "cli/files.h"
#include "cli/parse.h"

#include <tessera/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

namespace tessera::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 6> kEndings{".gltf", ".glb", ".obj", ".ply", ".stl", ".zip"};

bool is_scene_name(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

SceneFile make_scene(const fs::path& file, const fs::path& relative) {
    SceneFile scene;
    scene.file = file.string();
    scene.model = relative.stem().string();
    scene.extension = relative.extension().string();
    if (!scene.extension.empty()) scene.extension.erase(0, 1);
    const std::string folder = relative.parent_path().relative_path().lexically_normal().string();
    scene.folder = folder.empty() ? "." : folder;
    scene.path = folder.empty() || folder == "." ? scene.model : folder + "/" + scene.model;
    return scene;
}

[[noreturn]] void fail(const std::string& file, const std::string& reason) {
    throw Error(ErrorCode::kInput, reason, file);
}

void search(const fs::path& folder, std::vector<SceneFile>& scenes) {
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        const fs::path& path = entry->path();
        std::error_code unknown;
        const bool hidden = path.filename().string().starts_with(".");
        if (hidden && entry->is_directory(unknown)) entry.disable_recursion_pending();
        if (!hidden && is_scene_name(path) && entry->is_regular_file(unknown))
            scenes.push_back(make_scene(path, path.lexically_relative(folder)));
    }
    if (error) fail(folder.string(), "cannot be searched: " + error.message());
}

void add(const std::string& argument, std::vector<SceneFile>& scenes) {
    std::error_code error;
    const fs::path path = fs::path(argument).lexically_normal();
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) fail(argument, "does not exist");
    if (fs::is_directory(status))
        search(path, scenes);
    else
        scenes.push_back(make_scene(path, path));
}

std::vector<std::string> lines_of(const std::string& list) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
    std::string text;
    if (list == "-") {
        const std::vector<std::byte> bytes = read_stdin(kMostBytes);
        text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    } else {
        std::ifstream file(list, std::ios::binary);
        if (!file) fail(list, "cannot be read");
        text.assign(std::istreambuf_iterator<char>(file), {});
        if (file.bad()) fail(list, "cannot be read");
    }
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        std::string line = text.substr(at, end - at);
        if (line.ends_with('\r')) line.pop_back();
        if (!line.empty()) lines.push_back(std::move(line));
        at = end + 1;
    }
    return lines;
}

}  // namespace

std::vector<SceneFile> list_scenes(const std::vector<std::string>& arguments, const std::string& list) {
    std::vector<SceneFile> scenes;
    for (const std::string& argument : arguments) add(argument, scenes);
    if (!list.empty())
        for (const std::string& line : lines_of(list)) add(line, scenes);
    if (arguments.empty() && list.empty()) refuse("scenes", "say which: files, folders, or --list FILE");
    if (scenes.empty())
        throw Error(ErrorCode::kInput, "no scenes there: no file ends in .gltf, .glb, .obj, .ply, .stl or .zip");
    // Of a file that was named twice, in a folder and alone, the shorter path stays.
    std::sort(scenes.begin(), scenes.end(), [](const SceneFile& a, const SceneFile& b) {
        return std::pair(std::string_view(a.file), a.path.size()) < std::pair(std::string_view(b.file), b.path.size());
    });
    scenes.erase(std::unique(scenes.begin(), scenes.end(),
                             [](const SceneFile& a, const SceneFile& b) { return a.file == b.file; }),
                 scenes.end());
    return scenes;
}

}  // namespace tessera::cli
