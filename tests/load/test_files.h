// The models and the malformed files that tests read: below the folder that the environment variable
// TESSERA_MODELS names, or beside the source tree.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera {

inline std::filesystem::path test_folder() {
    const char* named = std::getenv("TESSERA_MODELS");
    return named ? std::filesystem::path(named) : std::filesystem::path(TESSERA_SOURCE_DIR) / ".." / "shared";
}

inline std::filesystem::path gltf_model(const std::string& name) { return test_folder() / "models" / "gltf" / name; }

// Every .gltf and .glb below models/gltf, sorted, relative to it.
inline std::vector<std::string> all_gltf_models() {
    std::vector<std::string> names;
    const std::filesystem::path folder = test_folder() / "models" / "gltf";
    std::error_code none;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, none))
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
            names.push_back(std::filesystem::relative(entry.path(), folder).string());
    std::sort(names.begin(), names.end());
    return names;
}

// Every file with one of the extensions below models/FOLDER, sorted, with its path.
inline std::vector<std::string> models_in(const std::string& sub_folder,
                                          std::initializer_list<const char*> extensions) {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(test_folder() / "models" / sub_folder, none))
        for (const char* extension : extensions)
            if (entry.path().extension() == extension) names.push_back(entry.path().string());
    std::sort(names.begin(), names.end());
    return names;
}

// The OBJ, PLY and STL files.
inline std::vector<std::string> all_mesh_models() {
    std::vector<std::string> names = models_in("obj", {".obj"});
    for (const char* format : {"ply", "stl"})
        for (std::string& name : models_in(format, {std::string(format) == "ply" ? ".ply" : ".stl"}))
            names.push_back(std::move(name));
    return names;
}

struct MalformedCase {
    std::string file, expected;
};

// The cases of malformed/MANIFEST.csv that are scene files: path and expectation (error, clean,
// error-or-clean) are its first and fourth column, which are never quoted.
inline std::vector<MalformedCase> malformed_cases() {
    std::vector<MalformedCase> cases;
    std::ifstream manifest(test_folder() / "malformed" / "MANIFEST.csv");
    std::string line;
    while (std::getline(manifest, line)) {
        std::istringstream columns(line);
        std::string file, bytes, sha, expected;
        std::getline(columns, file, ',');
        std::getline(columns, bytes, ',');
        std::getline(columns, sha, ',');
        std::getline(columns, expected, ',');
        bool is_scene = false;
        for (const char* extension : {".gltf", ".glb", ".obj", ".ply", ".stl", ".off"})
            is_scene = is_scene || file.ends_with(extension);
        if (is_scene && !expected.starts_with("(")) cases.push_back({file, expected});
    }
    return cases;
}

}  // namespace tessera
