// The layering of Tessera as rules over include lines: which folder may include which, where each
// external library is at home, what kernels may not include, and the shape of files. check_file()
// is pure, so that the rules are tested on text, too.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::layering {

// In the order of the data: a folder includes itself and those before it.
inline constexpr std::array<std::string_view, 13> kOrder{"simd",      "core",    "image", "scene",  "load",
                                                         "geometry",  "shading", "tile",  "raster", "trace",
                                                         "reference", "render",  "cli"};
inline constexpr std::size_t kLongestFile = 450, kLongestPublicHeader = 200;

struct Home {
    std::string_view header;  // the header, or the folder when it ends with a slash
    std::vector<std::string_view> folders;
};

// Every library outside the standard's, with the folders that may include it.
inline const std::vector<Home>& homes() {
    static const std::vector<Home> list{
        {"tbb/", {"core"}},
        {"oneapi/", {"core"}},
        {"png.h", {"image"}},
        {"zlib.h", {"image"}},
        {"jpeglib.h", {"image"}},
        {"jerror.h", {"image"}},
        {"libdeflate.h", {"image"}},
        {"OpenImageIO/", {"image"}},
        {"webp/", {"image"}},
        {"simdjson.h", {"load", "cli"}},
        {"minizip/", {"load"}},
        {"draco/", {"load"}},
        {"meshoptimizer.h", {"load"}},
        {"embree3/", {"trace"}},
        {"embree4/", {"trace"}},
        {"hwy/", {"simd"}},
        {"glm/", {"core", "geometry"}},
        {"CLI/", {"cli"}},
    };
    return list;
}

// Headers of the operating system and the processor that the sources may use anywhere.
inline constexpr std::array<std::string_view, 17> kSystem{
    "unistd.h",    "fcntl.h",     "sched.h",     "poll.h",      "pthread.h",   "dlfcn.h",
    "cpuid.h",     "sys/",        "linux/",      "dirent.h",    "xmmintrin.h", "emmintrin.h",
    "immintrin.h", "pmmintrin.h", "smmintrin.h", "x86intrin.h", "endian.h"};

// What instantiates shared inline code, which must not come from an object built for one ISA.
inline constexpr std::array<std::string_view, 18> kNotInKernels{
    "vector",     "string", "map",       "set",      "unordered_map", "unordered_set",
    "deque",      "list",   "memory",    "array",    "optional",      "variant",
    "functional", "span",   "algorithm", "iostream", "sstream",       "string_view"};

struct Include {
    bool quoted = false;
    std::string path;
};

inline std::vector<Include> includes_of(const std::string& text) {
    std::vector<Include> found;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::size_t at = line.find_first_not_of(" \t");
        if (at == std::string::npos || line[at] != '#') continue;
        at = line.find_first_not_of(" \t", at + 1);
        if (at == std::string::npos || line.compare(at, 7, "include") != 0) continue;
        const std::size_t open = line.find_first_of("<\"", at);
        if (open == std::string::npos) continue;
        const bool quoted = line[open] == '"';
        const std::size_t close = line.find(quoted ? '"' : '>', open + 1);
        if (close != std::string::npos) found.push_back({quoted, line.substr(open + 1, close - open - 1)});
    }
    return found;
}

inline bool ends_with(std::string_view text, std::string_view tail) {
    return text.size() >= tail.size() && text.substr(text.size() - tail.size()) == tail;
}

inline bool starts_with(std::string_view text, std::string_view head) { return text.substr(0, head.size()) == head; }

// `path` matches a header's name, or lies in the folder that `header` names.
inline bool matches(std::string_view path, std::string_view header) {
    return header.back() == '/' ? starts_with(path, header) : path == header;
}

// "core" for src/core/x.cpp, "simd" for simd/x.h, "include" for public headers; "" for the rest.
inline std::string folder_of(std::string_view file) {
    if (starts_with(file, "include/tessera/")) return "include";
    if (starts_with(file, "simd/")) return "simd";
    if (!starts_with(file, "src/")) return "";
    file.remove_prefix(4);
    const std::size_t slash = file.find('/');
    return slash == std::string_view::npos ? "" : std::string(file.substr(0, slash));
}

inline std::size_t rank_of(std::string_view folder) {
    return static_cast<std::size_t>(std::find(kOrder.begin(), kOrder.end(), folder) - kOrder.begin());
}

inline void check_quoted(const std::string& folder, const std::string& path, std::vector<std::string>& faults) {
    const std::string target = path.substr(0, path.find('/'));
    const std::size_t own = rank_of(folder), other = rank_of(target);
    if (folder == "include") {
        faults.push_back("a public header includes \"" + path + "\"");
    } else if (path.find('/') == std::string::npos || other == kOrder.size()) {
        faults.push_back("\"" + path + "\" does not begin with a folder of Tessera");
    } else if (other > own) {
        faults.push_back(folder + " includes \"" + path + "\", which comes later in the order");
    } else if (folder == "trace" && target == "raster") {
        faults.push_back("trace includes \"" + path + "\": raster and trace stand side by side");
    } else if (folder == "cli" && target != "cli") {
        faults.push_back("cli includes \"" + path + "\": it may see the public headers only");
    }
}

inline void check_angled(const std::string& file, const std::string& folder, const std::string& path,
                         std::vector<std::string>& faults) {
    if (starts_with(path, "tessera/")) return;
    for (const Home& home : homes()) {
        if (!matches(path, home.header)) continue;
        const bool at_home = std::find(home.folders.begin(), home.folders.end(), folder) != home.folders.end();
        const bool converter = file == "include/tessera/glm.h" && home.header == "glm/";
        if (!at_home && !converter) faults.push_back("<" + path + "> is not at home in " + folder);
        return;
    }
    const bool standard = path.find_first_of("./") == std::string::npos;
    const bool system = std::any_of(kSystem.begin(), kSystem.end(), [&](auto h) { return matches(path, h); });
    if (!standard && !system) faults.push_back("<" + path + ">: a library without a home");
    if (system && folder == "include") faults.push_back("a public header includes <" + path + ">");
}

// All that is wrong with one file; `file` is its path from the root of the project.
inline std::vector<std::string> check_file(const std::string& file, const std::string& text) {
    std::vector<std::string> faults;
    const std::string folder = folder_of(file);
    const bool header = ends_with(file, ".h");
    const bool kernel = ends_with(file, ".simd.cpp") || (folder == "shading" && header);
    if (!folder.empty()) {
        if (folder != "include" && rank_of(folder) == kOrder.size())
            faults.push_back("folder without a place in the order");
        for (const Include& include : includes_of(text)) {
            if (include.quoted)
                check_quoted(folder, include.path, faults);
            else
                check_angled(file, folder, include.path, faults);
            const bool banned =
                std::find(kNotInKernels.begin(), kNotInKernels.end(), include.path) != kNotInKernels.end();
            if (kernel && (banned || starts_with(include.path, "glm/") || starts_with(include.path, "tbb/")))
                faults.push_back("kernel code includes <" + include.path + ">");
        }
    }
    if (header && !starts_with(text, "//")) faults.push_back("a header opens with a comment that says what it is");
    if (header && text.find("#pragma once") == std::string::npos) faults.push_back("a header without #pragma once");
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    const std::size_t limit = folder == "include" ? kLongestPublicHeader : kLongestFile;
    if (lines > limit) faults.push_back(std::to_string(lines) + " lines, more than " + std::to_string(limit));
    return faults;
}

}  // namespace tessera::layering
