// Shared by the tests of `tessera batch`: a folder with small scenes, one of whose names is there twice.
#pragma once

#include "cli/run_command.h"

#include <simdjson.h>

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;
using Files = std::map<std::string, std::string>;

inline Strings operator+(Strings a, const Strings& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

inline Strings names(const Files& files) {
    Strings list;
    for (const auto& [name, unused] : files) list.push_back(name);
    return list;
}

class CliBatch : public CliTest {
  protected:
    // Small scenes under other names, in folders.
    void SetUp() override {
        CliTest::SetUp();
        if (IsSkipped()) return;
        for (const char* folder : {"models/a", "models/b", "models/.hidden"}) fs::create_directories(folder_ / folder);
        add_triangle("models/one.gltf");
        add_triangle("models/a/two.gltf");
        add_triangle("models/b/two.gltf");
        add_triangle("models/.hidden/three.gltf");
        std::ofstream(folder_ / "models/notes.txt") << "no scene";
    }
    void add_triangle(const std::string& name) const { std::ofstream(folder_ / name) << kTriangle; }
    Outcome batch(const Strings& more, const Strings& environment = {}) const {
        return run_command(Strings{"batch", "-s", "48x32", "--samples", "1"} + more, {}, environment);
    }
    std::string models() const { return in_folder("models"); }

    static constexpr const char* kTriangle =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,
        "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
};

inline simdjson::dom::element parsed(simdjson::dom::parser& parser, const std::string& text) {
    simdjson::dom::element root;
    EXPECT_EQ(parser.parse(text).get(root), simdjson::SUCCESS) << text;
    return root;
}
