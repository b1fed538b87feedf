// Loading gives back what it takes: a hundred loads in a row keep memory flat, of every format, whether they go
// well or not.
#include "mesh_files.h"
#include "test_files.h"

#include <gtest/gtest.h>

#include <malloc.h>

#include <fstream>
#include <iterator>

namespace tessera {
namespace {

std::size_t bytes_in_use() {
    const struct mallinfo2 info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
}

// What a hundred runs leave behind after three that warm up caches.
template <class F>
std::ptrdiff_t left_behind(F&& load) {
    for (int i = 0; i < 3; ++i) load();
    const auto before = static_cast<std::ptrdiff_t>(bytes_in_use());
    for (int i = 0; i < 100; ++i) load();
    return static_cast<std::ptrdiff_t>(bytes_in_use()) - before;
}

// A hundred times anything would be more than this.
constexpr std::ptrdiff_t kNoise = 16384;

class FlatMemory : public testing::Test {
  protected:
    void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
        GTEST_SKIP() << "the sanitizer has an allocator of its own";
#endif
    }
};

TEST_F(FlatMemory, SAFE_AHundredLoadsOfEachFormat) {
    if (all_gltf_models().empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    std::vector<std::string> files;
    for (const char* name : {"Box/glTF/Box.gltf", "Box/glTF-Binary/Box.glb", "BoxDraco/BoxDraco.gltf", "BoxMeshopt.glb",
                             "Box/glTF-pbrSpecularGlossiness/Box.gltf", "simple-instancing.glb"})
        files.push_back(gltf_model(name).string());
    // The smallest of the mesh formats.
    for (const auto& [folder, extension] : {std::pair("obj", ".obj"), {"ply", ".ply"}, {"stl", ".stl"}}) {
        std::string smallest;
        for (const std::string& name : models_in(folder, {extension}))
            if (smallest.empty() || std::filesystem::file_size(name) < std::filesystem::file_size(smallest))
                smallest = name;
        if (!smallest.empty()) files.push_back(smallest);
    }
    EXPECT_EQ(files.size(), 9u);
    for (const std::string& file : files)
        EXPECT_LT(left_behind([&] { EXPECT_GT(load_scene(file).meshes.size(), 0u); }), kNoise) << file;
}

TEST_F(FlatMemory, SAFE_AHundredFailures) {
    std::size_t failures = 0;
    for (const MalformedCase& one : malformed_cases()) {
        const std::filesystem::path path = test_folder() / "malformed" / one.file;
        // Small ones, of every kind.
        if (one.expected != "error" || std::filesystem::file_size(path) > 4096) continue;
        ++failures;
        EXPECT_LT(left_behind([&] { EXPECT_THROW(load_scene(path.string()), Error); }), kNoise) << one.file;
    }
    if (failures == 0) GTEST_SKIP() << "no malformed files: set TESSERA_MODELS";
    EXPECT_GT(failures, 30u);
}

// The measure itself: a leak of some bytes a load is seen.
TEST_F(FlatMemory, SAFE_ALeakIsSeen) {
    std::vector<std::unique_ptr<std::vector<char>>> kept;
    kept.reserve(128);
    EXPECT_GT(left_behind([&] { kept.push_back(std::make_unique<std::vector<char>>(200)); }), kNoise);
}

}  // namespace
}  // namespace tessera
