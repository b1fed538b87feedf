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

void add_unusable(const std::string& file, const std::string& reason, std::vector<SceneFile>& scenes) {
    SceneFile scene;
    scene.file = file;
    scene.error = reason;
    scenes.push_back(std::move(scene));
}

// Links to folders are not followed.
void search(const fs::path& top, std::vector<SceneFile>& scenes) {
    std::vector<fs::path> folders{top};
    while (!folders.empty()) {
        const fs::path folder = std::move(folders.back());
        folders.pop_back();
        std::error_code error;
        for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
            const fs::path& path = entry->path();
            std::error_code unknown;
            if (path.filename().string().starts_with(".")) continue;
            if (entry->is_directory(unknown)) {
                if (!entry->is_symlink(unknown)) folders.push_back(path);
            } else if (is_scene_name(path) && entry->is_regular_file(unknown)) {
                scenes.push_back(make_scene(path, path.lexically_relative(top)));
            }
        }
        if (error) add_unusable(folder.string(), "cannot be searched: " + error.message(), scenes);
    }
}

void add(const fs::path& path, const fs::file_status& status, std::vector<SceneFile>& scenes) {
    if (fs::is_directory(status))
        search(path, scenes);
    else
        scenes.push_back(make_scene(path, path));
}

void add_argument(const std::string& argument, std::vector<SceneFile>& scenes) {
    std::error_code unknown;
    const fs::path path = fs::path(argument).lexically_normal();
    const fs::file_status status = fs::status(path, unknown);
    if (!fs::exists(status)) fail(argument, "does not exist");
    add(path, status, scenes);
}

void add_line(const std::string& line, std::vector<SceneFile>& scenes) {
    std::error_code unknown;
    const fs::path path = fs::path(line).lexically_normal();
    const fs::file_status status = fs::status(path, unknown);
    if (fs::exists(status))
        add(path, status, scenes);
    else
        add_unusable(path.string(), "does not exist", scenes);
}

std::vector<std::string> lines_of(const std::string& list) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
    std::string text;
    if (list == "-") {
        const std::vector<std::byte> bytes = read_stdin(kMostBytes);
        text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    } else {
        if (is_folder(list)) fail(list, "is a folder, not a list of scenes; name it without --list");
        std::ifstream file(list, std::ios::binary);
        if (!file) fail(list, "cannot be read");
        try {
            text.assign(std::istreambuf_iterator<char>(file), {});
        } catch (const std::ios_base::failure&) {
            fail(list, "cannot be read");
        }
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
    for (const std::string& argument : arguments) add_argument(argument, scenes);
    if (!list.empty())
        for (const std::string& line : lines_of(list)) add_line(line, scenes);
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
