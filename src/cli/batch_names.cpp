#include "cli/batch_names.h"

#include "cli/batch_arguments.h"
#include "cli/parse.h"
#include "cli/pattern.h"

#include <tessera/error.h>

#include <filesystem>
#include <system_error>

namespace tessera::cli {
namespace {

[[noreturn]] void refuse_clash(const std::string& name, const std::string& first, const std::string& second) {
    refuse("--output", first == second ? "'" + name + "' would be written twice, from " + first
                                       : "'" + name + "' would be written from " + first + " and from " + second +
                                             "; names can have {path}, {folder} and {extension} too");
}

std::string name_in_folder(const std::string& path) { return path.substr(path.rfind('/') + 1); }

}  // namespace

std::string fixed_folder(const std::string& pattern) {
    std::size_t place = 0;
    while ((place = pattern.find('{', place)) != std::string::npos && pattern.compare(place, 2, "{{") == 0) place += 2;
    const std::string front = pattern.substr(0, place);
    return fill_pattern("--output", front.substr(0, front.find_last_of('/') + 1), {});
}

std::vector<std::string> output_names(const BatchJob& job, const SceneFile& scene, const std::string& camera,
                                      std::optional<long> frame) {
    const std::string above = "../";
    if ((scene.path + "/").find(above) == 0 && (has_place(job.pattern, "path") || has_place(job.pattern, "folder")))
        refuse("--output",
               "{path} and {folder} of " + scene.file + " lead out of the folder; name the folder it is in instead");
    PatternValues values{{"model", scene.model},
                         {"path", scene.path},
                         {"folder", scene.folder},
                         {"extension", scene.extension},
                         {"camera", safe_name(camera)}};
    if (frame) values["frame"] = *frame;
    std::vector<std::string> names;
    for (const PlaneFile& file : job.render.planes.files) {
        values["aov"] = file.aov;
        names.push_back(fill_pattern("--output", job.pattern, values));
    }
    return names;
}

InputFiles::InputFiles(const std::vector<SceneFile>& scenes, const std::string& list) {
    for (const SceneFile& scene : scenes) by_name_.emplace(name_in_folder(scene.file), scene.file);
    if (!list.empty() && list != "-") by_name_.emplace(name_in_folder(list), list);
}

void InputFiles::check(const std::string& option, const std::string& name) const {
    // A file that is renamed to an input's place has its last name; whether the folder is the same, the system knows.
    const auto [first, last] = by_name_.equal_range(name_in_folder(name));
    for (auto input = first; input != last; ++input) {
        std::error_code unknown;
        if (input->second == name || std::filesystem::equivalent(input->second, name, unknown))
            refuse(option, "'" + name + "' would be written over " + input->second + ", which is read");
    }
}

void check_names(const BatchJob& job, const std::vector<SceneFile>& scenes, const InputFiles& inputs) {
    // A camera that is not known yet is a name that no file has.
    std::vector<std::string> cameras = job.cameras;
    if (job.every_camera) cameras = {"\x01"};
    if (cameras.empty()) cameras = {"default"};
    const std::optional<Frames>& frames = job.render.frames;
    const bool numbered = frames && job.render.codec != Codec::kVideo;
    const auto pictures = static_cast<std::uint64_t>(numbered ? frames->count() : 1);
    // Of very many pictures the first of each scene tell.
    constexpr std::uint64_t kMany = std::uint64_t{1} << 20;
    const bool all = pictures * cameras.size() * scenes.size() <= kMany;
    std::unordered_map<std::string, std::size_t> owners;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        if (!scenes[s].error.empty()) continue;
        for (const std::string& camera : cameras)
            for (std::uint64_t i = 0; i < (all ? pictures : 1); ++i) {
                const auto frame = numbered ? std::optional(frames->first + static_cast<long>(i)) : std::nullopt;
                for (const std::string& name : output_names(job, scenes[s], camera, frame)) {
                    const auto [owner, is_new] = owners.try_emplace(name, s);
                    if (!is_new) refuse_clash(name, scenes[owner->second].file, scenes[s].file);
                    inputs.check("--output", name);
                }
            }
    }
}

void Claims::claim(const std::string& name, const std::string& scene) {
    const std::lock_guard lock(mutex_);
    const auto [owner, is_new] = owners_.try_emplace(name, scene);
    if (!is_new && owner->second != scene) refuse_clash(name, owner->second, scene);
}

}  // namespace tessera::cli
