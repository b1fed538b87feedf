// The folder tree is the architecture: the rules of rules.h hold for every source file, and the
// rules themselves notice planted violations.
#include "layering/rules.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

namespace {

using tessera::layering::check_file;
using tessera::layering::ends_with;
using tessera::layering::includes_of;
using tessera::layering::starts_with;

// Path from the root of the project to the text.
const std::map<std::string, std::string>& sources() {
    static const std::map<std::string, std::string> files = [] {
        std::map<std::string, std::string> found;
        const std::filesystem::path root(TESSERA_SOURCE_DIR);
        for (const char* folder : {"include", "simd", "src", "tests", "bench", "fuzz", "examples"}) {
            if (!std::filesystem::exists(root / folder)) continue;
            for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
                const std::string name = entry.path().lexically_relative(root).generic_string();
                if (!entry.is_regular_file() || !(ends_with(name, ".h") || ends_with(name, ".cpp"))) continue;
                std::ifstream file(entry.path(), std::ios::binary);
                found[name] = {std::istreambuf_iterator<char>(file), {}};
            }
        }
        return found;
    }();
    return files;
}

TEST(Layering, EveryFileKeepsTheRules) {
    ASSERT_GT(sources().size(), 50u);
    for (const auto& [file, text] : sources())
        for (const std::string& fault : check_file(file, text)) ADD_FAILURE() << file << ": " << fault;
}

// A kernel must not reach a container through a header of ours either.
TEST(Layering, KernelsReachNoContainers) {
    const auto locate = [](const std::string& include) {
        for (const char* folder : {"src/", "", "include/"})
            if (sources().count(folder + include) != 0) return folder + include;
        return std::string();
    };
    for (const auto& [file, text] : sources()) {
        if (!ends_with(file, ".simd.cpp")) continue;
        std::set<std::string> seen{file};
        std::vector<std::string> pending{file};
        while (!pending.empty()) {
            const std::string name = pending.back();
            pending.pop_back();
            for (const auto& include : includes_of(sources().at(name))) {
                const auto& banned = tessera::layering::kNotInKernels;
                const bool container = std::find(banned.begin(), banned.end(), include.path) != banned.end();
                EXPECT_FALSE(container || starts_with(include.path, "glm/"))
                    << file << " reaches <" << include.path << "> through " << name;
                const std::string next = locate(include.path);
                if (!next.empty() && seen.insert(next).second) pending.push_back(next);
            }
        }
    }
}

TEST(Layering, IncludeLinesAreFound) {
    const auto found =
        includes_of("// #include <no>\n#include <a/b.h>\n  #  include \"c/d.h\"  // why\nint include;\n");
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].path, "a/b.h");
    EXPECT_FALSE(found[0].quoted);
    EXPECT_EQ(found[1].path, "c/d.h");
    EXPECT_TRUE(found[1].quoted);
}

TEST(Layering, WhatIsAllowedPasses) {
    const auto fine = [](const char* file, const std::string& text) { return check_file(file, text).empty(); };
    EXPECT_TRUE(
        fine("src/raster/bin.cpp", "#include \"raster/bin.h\"\n#include \"core/parallel.h\"\n#include <vector>\n"));
    EXPECT_TRUE(fine("src/core/parallel.cpp", "#include <tbb/parallel_for.h>\n#include <unistd.h>\n"));
    EXPECT_TRUE(
        fine("src/cli/main.cpp", "#include \"cli/report.h\"\n#include <tessera/error.h>\n#include <CLI/App.hpp>\n"));
    EXPECT_TRUE(fine("include/tessera/glm.h", "// Converts.\n#pragma once\n#include <glm/vec3.hpp>\n"));
    EXPECT_TRUE(fine("src/raster/fill.simd.cpp", "#include \"simd/vec.h\"\n#include <cstdint>\n"));
    EXPECT_TRUE(fine("tests/load/gltf_test.cpp", "#include <simdjson.h>\n#include \"load/json.h\"\n"));
}

TEST(Layering, PlantedViolationsAreFound) {
    const auto faults = [](const char* file, const std::string& text) { return check_file(file, text).size(); };
    const std::string head = "// A header.\n#pragma once\n";
    EXPECT_EQ(faults("src/core/x.cpp", "#include \"render/renderer.h\"\n"), 1u) << "upwards";
    EXPECT_EQ(faults("src/raster/x.cpp", "#include \"trace/packet.h\"\n"), 1u);
    EXPECT_EQ(faults("src/trace/x.cpp", "#include \"raster/bin.h\"\n"), 1u) << "sideways";
    EXPECT_EQ(faults("simd/vec.h", head + "#include \"core/error.h\"\n"), 1u);
    EXPECT_EQ(faults("src/cli/x.cpp", "#include \"image/codecs.h\"\n"), 1u) << "past the public API";
    EXPECT_EQ(faults("src/load/x.cpp", "#include \"json.h\"\n"), 1u) << "without its folder";
    EXPECT_EQ(faults("src/shiny/x.cpp", ""), 1u) << "a folder nobody placed";
    EXPECT_EQ(faults("include/tessera/x.h", head + "#include \"core/parallel.h\"\n"), 1u);
    EXPECT_EQ(faults("include/tessera/x.h", head + "#include <glm/vec3.hpp>\n"), 1u);
    EXPECT_EQ(faults("src/scene/x.cpp", "#include <tbb/parallel_for.h>\n"), 1u);
    EXPECT_EQ(faults("src/scene/x.cpp", "#include <png.h>\n"), 1u);
    EXPECT_EQ(faults("src/render/x.cpp", "#include <embree3/rtcore.h>\n"), 1u);
    EXPECT_EQ(faults("src/raster/x.cpp", "#include <hwy/highway.h>\n"), 1u);
    EXPECT_EQ(faults("src/image/x.cpp", "#include <simdjson.h>\n"), 1u);
    EXPECT_EQ(faults("src/image/x.cpp", "#include <stb_image.h>\n"), 1u) << "a library nobody placed";
    EXPECT_EQ(faults("src/raster/fill.simd.cpp", "#include <vector>\n"), 1u);
    EXPECT_EQ(faults("src/shading/lobes.h", head + "#include <array>\n"), 1u);
    EXPECT_EQ(faults("src/shading/lobes.h", head + "#include <glm/vec3.hpp>\n"), 2u) << "no home, and in a kernel";
    EXPECT_EQ(faults("src/load/x.h", "#pragma once\n// late\n"), 1u);
    EXPECT_EQ(faults("src/load/x.h", "// no guard\n"), 1u);
    EXPECT_EQ(faults("src/load/x.cpp", std::string(451, '\n')), 1u);
    EXPECT_EQ(faults("src/load/x.cpp", std::string(450, '\n')), 0u);
    EXPECT_EQ(faults("include/tessera/x.h", head + std::string(199, '\n')), 1u);
}

}  // namespace
