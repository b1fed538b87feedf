// BEY3: `tessera batch` from end to end: names, scenes that fail, shards, resuming, reports.
#include "cli/batch_support.h"

#include <tessera/image.h>

#include <set>

namespace {

TEST_F(CliBatch, BEY3_FoldersAreSearchedAndNamesFilledIn) {
    const Outcome run = batch({models(), "-o", in_folder("out/{folder}/{model}_{camera}_{aov}.{extension}.png")});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_NE(run.err.find("3 scenes: 3 pictures written"), std::string::npos) << run.err;
    EXPECT_EQ(names(tree(in_folder("out"))),
              (Strings{"a/two_default_color.gltf.png", "b/two_default_color.gltf.png", "one_default_color.gltf.png"}));
}

TEST_F(CliBatch, BEY3_PicturesAreThoseOfRender) {
    ASSERT_EQ(batch({scene("cornell-box.gltf"), scene("materials.gltf"), "-o", in_folder("{model}.png")}).code, 0);
    for (const char* name : {"cornell-box", "materials"}) {
        ASSERT_EQ(run_command({"render", scene(std::string(name) + ".gltf"), "-s", "48x32", "--samples", "1", "-o",
                               in_folder("single.png")})
                      .code,
                  0);
        EXPECT_TRUE(read_file(in_folder("single.png")) == read_file(in_folder(std::string(name) + ".png"))) << name;
    }
}

TEST_F(CliBatch, BEY3_TwoScenesForOneFileAreRefusedBeforeAnythingStarts) {
    const Outcome run = batch({models(), "-o", in_folder("out/{model}.png")});
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.err.find("models/a/two.gltf and from " + models() + "/b/two.gltf"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    // Parts of names that come together to one name.
    fs::create_directories(folder_ / "models/b/c");
    add_triangle("models/b/c/x.gltf"), add_triangle("models/b/cx.gltf");
    EXPECT_EQ(batch({in_folder("models/b"), "-o", in_folder("out/{folder}{model}.png")}).code, 0);
    EXPECT_EQ(batch({in_folder("models/b/c/x.gltf"), in_folder("models/b/c/x.gltf"), "-o", in_folder("x.png")}).code, 0)
        << "the same scene twice is one";
}

TEST_F(CliBatch, BEY3_UsageIsRefusedByName) {
    const std::string out = in_folder("{path}.png");
    const std::vector<std::pair<Strings, std::string>> cases{
        {{models()}, "--output"},
        {{"-o", out}, "scenes"},
        {{models(), "-o", "-"}, "--output"},
        {{models(), "-o", in_folder("{modell}.png")}, "{modell}"},
        {{models(), "-o", out, "--shard", "0/3"}, "--shard"},
        {{models(), "-o", out, "--shard", "4/3"}, "--shard"},
        {{models(), "-o", out, "--shard", "auto/3"}, "--shard"},
        {{models(), "-o", out, "--shard-by", "frame"}, "--shard-by"},
        {{models(), "-o", out, "--html", "x.html"}, "--html"},
        {{models(), "-o", out, "--camera", "all"}, "{camera}"},
        {{models(), "-o", out, "--frames", "0-3"}, "--output"},
        {{models(), "-o", out, "--in-flight", "0"}, "--in-flight"},
    };
    for (const auto& [arguments, named] : cases) {
        const Outcome run = batch(arguments);
        EXPECT_EQ(run.code, 2) << run.err;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_NE(run.err.find(named), std::string::npos) << named << " in " << run.err;
    }
    EXPECT_EQ(batch({in_folder("nowhere"), "-o", out}).code, 4);
    EXPECT_EQ(batch({models(), "-o", in_folder("models/notes.txt/{path}.png")}).code, 5);
}

TEST_F(CliBatch, BEY3_AFailedSceneIsReportedAndTheRestGoesOn) {
    std::ofstream(folder_ / "models/bad.gltf") << "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":5}]}";
    const Outcome run = batch({models(), "-o", in_folder("out/{path}.png"), "--report", in_folder("run.json")});
    EXPECT_EQ(run.code, 4) << run.err;
    EXPECT_NE(run.err.find("tessera: error: " + models() + "/bad.gltf: "), std::string::npos) << run.err;
    EXPECT_EQ(names(tree(in_folder("out"))), (Strings{"a/two.png", "b/two.png", "one.png"}));
    simdjson::dom::parser parser;
    const auto report = parsed(parser, read_file(in_folder("run.json")));
    EXPECT_EQ(std::uint64_t(report["totals"]["failed"]), 1u);
    EXPECT_EQ(std::uint64_t(report["totals"]["done"]), 3u);
    EXPECT_EQ(std::int64_t(report["totals"]["exit_code"]), 4);
    bool found = false;
    for (const auto entry : report["scenes"].get_array()) {
        const bool bad = std::string_view(entry["scene"]).ends_with("bad.gltf");
        found = found || bad;
        EXPECT_EQ(std::string_view(entry["status"]), bad ? "failed" : "done");
        if (bad) {
            EXPECT_NE(std::string_view(entry["error"]).find("/nodes/0/mesh"), std::string_view::npos);
        }
        for (const auto picture : entry["pictures"].get_array()) {
            char hash[17];
            std::snprintf(hash, sizeof hash, "%016llx",
                          static_cast<unsigned long long>(tessera::hash_pixels(
                              tessera::read_image(std::string(std::string_view(picture["file"]))))));
            EXPECT_EQ(std::string_view(picture["hash"]), hash);
        }
    }
    EXPECT_TRUE(found);
}

TEST_F(CliBatch, BEY3_ScenesFromAList) {
    const std::string list = models() + "/one.gltf\r\n\n" + models() + "/a\n";
    EXPECT_EQ(run_command({"batch", "--list", "-", "-s", "16x16", "-o", in_folder("out/{model}.png")}, list).code, 0);
    EXPECT_EQ(names(tree(in_folder("out"))), (Strings{"one.png", "two.png"}));
}

TEST_F(CliBatch, BEY3_CamerasByNameAndAll) {
    const std::string cameras =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],"cameras":[
        {"name":"front/left","type":"perspective","perspective":{"yfov":0.7,"znear":0.1}},
        {"type":"perspective","perspective":{"yfov":0.9,"znear":0.1}}],
        "nodes":[{"mesh":0},{"camera":0,"translation":[0,0,3]},{"camera":1,"translation":[0,0,5]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,
        "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
    std::ofstream(folder_ / "c.gltf") << cameras;
    const Strings base{in_folder("c.gltf"), "-o", in_folder("out/{model}_{camera}.png"), "--camera"};
    ASSERT_EQ(batch(base + Strings{"all"}).code, 0);
    EXPECT_EQ(names(tree(in_folder("out"))), (Strings{"c_1.png", "c_front_left.png"}));
    const Files all = tree(in_folder("out"));
    EXPECT_NE(all.at("c_1.png"), all.at("c_front_left.png"));
    fs::remove_all(folder_ / "out");
    ASSERT_EQ(batch(base + Strings{"1,front/left"}).code, 0);
    EXPECT_EQ(tree(in_folder("out")), all);
    EXPECT_EQ(batch(base + Strings{"1,back"}).code, 2);
    // Two names that become one in a file's name.
    std::string alike = cameras;
    alike.insert(alike.find("{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.9") + 1, "\"name\":\"front_left\",");
    std::ofstream(folder_ / "c.gltf") << alike;
    const Outcome run = batch(base + Strings{"front/left,front_left"});
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.err.find("c_front_left.png' would be written twice"), std::string::npos) << run.err;
    fs::remove_all(folder_ / "out");
    ASSERT_EQ(batch(base + Strings{"all"}).code, 0);
    EXPECT_EQ(names(tree(in_folder("out"))), (Strings{"c_0.png", "c_1.png"}));
    EXPECT_EQ(tree(in_folder("out")).at("c_0.png"), all.at("c_front_left.png"));
    EXPECT_EQ(tree(in_folder("out")).at("c_1.png"), all.at("c_1.png"));
    // Nodes whose names are the numbers of other cameras.
    std::string numbers = cameras;
    numbers.erase(numbers.find("\"name\":\"front/left\","), 20);
    numbers.insert(numbers.find("\"camera\":0"), "\"name\":\"1\",");
    numbers.insert(numbers.find("\"camera\":1"), "\"name\":\"0\",");
    std::ofstream(folder_ / "c.gltf") << numbers;
    fs::remove_all(folder_ / "out");
    ASSERT_EQ(batch(base + Strings{"all"}).code, 0);
    EXPECT_EQ(tree(in_folder("out")).at("c_0.png"), all.at("c_front_left.png"));
    EXPECT_EQ(tree(in_folder("out")).at("c_1.png"), all.at("c_1.png"));
}

TEST_F(CliBatch, BEY3_PlanesAndPosesAreThoseOfRender) {
    std::ofstream(folder_ / "poses.json")
        << R"({"convention":"opengl","cameras":[{"name":"a","camera_to_world":[[1,0,0,0],[0,1,0,1],[0,0,1,6],[0,0,0,1]]},
        {"name":"b","camera_to_world":[[1,0,0,1],[0,1,0,1],[0,0,1,5],[0,0,0,1]]}]})";
    const Strings planes{"--aov", "depth,node,motion", "--poses", in_folder("poses.json"), "--frames", "3-4"};
    ASSERT_EQ(batch(Strings{scene("motion.gltf"), "-o", in_folder("out/{camera}_{frame}_{aov}.npy")} + planes).code, 0);
    const Files files = tree(in_folder("out"));
    EXPECT_EQ(files.size(), 2u * 2 * 3);
    fs::create_directories(folder_ / "single");
    ASSERT_EQ(run_command(Strings{"render", scene("motion.gltf"), "-s", "48x32", "--samples", "1", "-o",
                                  in_folder("single/{camera}_{frame}_{aov}.npy")} +
                          planes)
                  .code,
              0);
    EXPECT_EQ(tree(in_folder("single")), files);
    // One of the planes is missing: it alone is written again.
    std::ofstream(folder_ / "out/a_3_node.npy") << "mine";
    fs::remove(folder_ / "out/a_3_depth.npy");
    ASSERT_EQ(
        batch(Strings{scene("motion.gltf"), "--skip-existing", "-o", in_folder("out/{camera}_{frame}_{aov}.npy")} +
              planes)
            .code,
        0);
    EXPECT_EQ(read_file(in_folder("out/a_3_node.npy")), "mine");
    EXPECT_EQ(read_file(in_folder("out/a_3_depth.npy")), files.at("a_3_depth.npy"));
    EXPECT_EQ(batch(Strings{scene("motion.gltf"), "-o", in_folder("out/{frame}_{aov}.npy")} + planes).code, 2);
}

TEST_F(CliBatch, BEY3_NothingDependsOnThreadsOrScenesInFlight) {
    const Strings base{in_folder("models"), scene("materials.gltf"), scene("transparency.gltf"), scene("motion.gltf")};
    ASSERT_EQ(batch(base + Strings{"-o", in_folder("one/{path}.png"), "--threads", "1"}).code, 0);
    const Files expected = tree(in_folder("one"));
    for (const char* flight : {"1", "2", "7"}) {
        const std::string out = in_folder(std::string("out") + flight);
        ASSERT_EQ(batch(base + Strings{"-o", out + "/{path}.png", "--threads", "4", "--in-flight", flight}).code, 0);
        EXPECT_EQ(tree(out), expected);
    }
}

TEST_F(CliBatch, BEY3_ShardsMakeTheWholeAndTheirReportsMerge) {
    const Strings base{models(), scene("materials.gltf"), scene("hierarchy.gltf")};
    ASSERT_EQ(batch(base + Strings{"-o", in_folder("whole/{path}.png")}).code, 0);
    std::set<std::string> seen;
    Strings reports;
    for (const char* shard : {"1/3", "2/3", "3/3"}) {
        const std::size_t before = tree(in_folder("out")).size();
        reports.push_back(in_folder(std::string("r") + shard[0] + ".json"));
        const Outcome run =
            batch(base + Strings{"-o", in_folder("out/{path}.png"), "--shard", shard, "--report", reports.back()});
        ASSERT_EQ(run.code, 0) << run.err;
        EXPECT_GT(tree(in_folder("out")).size(), before) << "each does its part";
    }
    EXPECT_EQ(tree(in_folder("out")), tree(in_folder("whole")));

    const Outcome merged = run_command(Strings{"merge-report"} + reports + Strings{"-o", "-"});
    ASSERT_EQ(merged.code, 0) << merged.err;
    simdjson::dom::parser parser;
    const auto report = parsed(parser, merged.out);
    EXPECT_EQ(std::uint64_t(report["totals"]["scenes"]), 5u);
    EXPECT_EQ(std::uint64_t(report["totals"]["pictures_written"]), 5u);
    std::uint64_t number = 0;
    for (const auto entry : report["scenes"].get_array()) EXPECT_EQ(std::uint64_t(entry["number"]), number++);

    // Missing, doubled, foreign and broken ones are named.
    Outcome run = run_command({"merge-report", reports[0], reports[2], "-o", "-"});
    EXPECT_EQ(run.code, 4);
    EXPECT_NE(run.err.find("missing: 2"), std::string::npos) << run.err;
    EXPECT_EQ(run_command({"merge-report", reports[0], reports[2], "-o", "-", "--partial"}).code, 0);
    run = run_command({"merge-report", reports[0], reports[1], reports[0], "-o", "-"});
    EXPECT_EQ(run.code, 4);
    EXPECT_NE(run.err.find("shard 1 is in"), std::string::npos) << run.err;
    ASSERT_EQ(batch(base + Strings{"-o", in_folder("out/{path}.png"), "--shard", "2/3", "--report",
                                   in_folder("other.json"), "--ambient", "1"})
                  .code,
              0);
    run = run_command({"merge-report", reports[0], in_folder("other.json"), reports[2], "-o", "-"});
    EXPECT_EQ(run.code, 4);
    EXPECT_NE(run.err.find("--ambient"), std::string::npos) << run.err;
    for (const char* text :
         {"", "[]", "{}", "{\"tessera_batch\": 1}", "{\"tessera_batch\": 2}", "{\"tessera_batch\":"}) {
        std::ofstream(folder_ / "broken.json") << text;
        run = run_command({"merge-report", in_folder("broken.json"), "-o", "-"});
        EXPECT_EQ(run.code, 4) << text;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
    }
}

TEST_F(CliBatch, BEY3_AMergedReportIsThatOfTheWhole) {
    std::ofstream(folder_ / "models/bad.gltf") << "{}";
    const Strings base{models(), "-o", in_folder("out/{path}.png"), "--report"};
    EXPECT_EQ(batch(base + Strings{in_folder("whole.json")}).code, 4);
    EXPECT_EQ(batch(base + Strings{in_folder("1.json"), "--shard", "1/2"}).code, 4) << "bad.gltf is the third";
    EXPECT_EQ(batch(base + Strings{in_folder("2.json"), "--shard", "2/2"}).code, 0);
    EXPECT_EQ(run_command({"merge-report", in_folder("2.json"), in_folder("1.json"), "-o", in_folder("m.json")}).code,
              4);
    simdjson::dom::parser first, second;
    const auto whole = parsed(first, read_file(in_folder("whole.json")));
    const auto merged = parsed(second, read_file(in_folder("m.json")));
    EXPECT_EQ(simdjson::to_string(whole["totals"]), simdjson::to_string(merged["totals"]));
    auto b = merged["scenes"].get_array().begin();
    for (const auto a : whole["scenes"].get_array()) {
        for (const char* key : {"number", "scene", "status", "pictures", "warnings"})
            EXPECT_EQ(simdjson::to_string(a[key]), simdjson::to_string((*b)[key]));
        ++b;
    }
}

TEST_F(CliBatch, BEY3_FramesCanBeSharedOut) {
    const Strings base{scene("motion.gltf"), "--frames", "0-6"};
    ASSERT_EQ(batch(base + Strings{"-o", in_folder("whole/{frame:02}.png")}).code, 0);
    Strings reports;
    for (const char* shard : {"1/3", "2/3", "3/3"}) {
        reports.push_back(in_folder(std::string("r") + shard[0] + ".json"));
        ASSERT_EQ(batch(base + Strings{"-o", in_folder("out/{frame:02}.png"), "--shard", shard, "--shard-by", "frame",
                                       "--report", reports.back()})
                      .code,
                  0);
    }
    EXPECT_EQ(tree(in_folder("out")), tree(in_folder("whole")));
    const Outcome merged = run_command(Strings{"merge-report", "-o", "-"} + reports);
    ASSERT_EQ(merged.code, 0) << merged.err;
    simdjson::dom::parser parser;
    const auto report = parsed(parser, merged.out);
    EXPECT_EQ(std::uint64_t(report["totals"]["scenes"]), 1u);
    std::int64_t frame = 0;
    for (const auto picture : report["scenes"].at(0)["pictures"].get_array())
        EXPECT_EQ(std::int64_t(picture["frame"]), frame++);
    EXPECT_EQ(frame, 7);
}

TEST_F(CliBatch, BEY3_TheFarmSaysWhichShard) {
    const Strings base{models(), "-o", in_folder("out/{path}.png")};
    struct Case {
        Strings environment, more;
        const char* shard;  // "" is refused
    };
    const std::vector<Case> cases{
        {{"SLURM_ARRAY_TASK_ID=20", "SLURM_ARRAY_TASK_MIN=10", "SLURM_ARRAY_TASK_STEP=10", "SLURM_ARRAY_TASK_COUNT=3"},
         {},
         "shard 2 of 3 (SLURM_ARRAY_TASK_ID)"},
        {{"SLURM_ARRAY_TASK_ID=9", "SLURM_ARRAY_TASK_MIN=1", "SLURM_ARRAY_TASK_STEP=1", "SLURM_ARRAY_TASK_COUNT=3"},
         {},
         ""},
        {{"JOB_COMPLETION_INDEX=0"}, {"--shard", "auto/3"}, "shard 1 of 3 (JOB_COMPLETION_INDEX)"},
        {{"JOB_COMPLETION_INDEX=0"}, {}, ""},
        {{"OMPI_COMM_WORLD_RANK=2", "OMPI_COMM_WORLD_SIZE=3"}, {}, "shard 3 of 3 (OMPI_COMM_WORLD_RANK)"},
        {{"OMPI_COMM_WORLD_RANK=2", "OMPI_COMM_WORLD_SIZE=3"}, {"--shard", "1/2"}, "shard 1 of 2 (--shard)"},
        {{"JOB_COMPLETION_INDEX=x"}, {}, ""},
    };
    for (const Case& c : cases) {
        fs::remove_all(folder_ / "out");
        const Outcome run = batch(base + c.more, c.environment);
        EXPECT_EQ(run.code, *c.shard == '\0' ? 2 : 0) << run.err;
        EXPECT_NE(run.err.find(c.shard), std::string::npos) << run.err;
        if (*c.shard == '\0') continue;
        const bool half = !c.more.empty() && c.more[1] == "1/2";
        EXPECT_EQ(tree(in_folder("out")).size(), half ? 2u : 1u);
    }
}

TEST_F(CliBatch, BEY3_SkipExistingLeavesWhatIsThere) {
    const Strings base{models(), "-o", in_folder("out/{path}.png"), "--skip-existing", "--report", in_folder("r.json")};
    ASSERT_EQ(batch(base).code, 0);
    const Files all = tree(in_folder("out"));
    std::ofstream(folder_ / "out/one.png") << "mine";
    fs::remove(folder_ / "out/a/two.png");
    const Outcome run = batch(base);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(read_file(in_folder("out/one.png")), "mine");
    EXPECT_EQ(read_file(in_folder("out/a/two.png")), all.at("a/two.png"));
    simdjson::dom::parser parser;
    const auto report = parsed(parser, read_file(in_folder("r.json")));
    EXPECT_EQ(std::uint64_t(report["totals"]["pictures_written"]), 1u);
    EXPECT_EQ(std::uint64_t(report["totals"]["pictures_skipped"]), 2u);
    EXPECT_EQ(std::uint64_t(report["totals"]["skipped"]), 2u);
}

TEST_F(CliBatch, ANI11_ATurntableHasNViewsAndNumberZeroIsTheFirst) {
    ASSERT_EQ(batch({scene("hierarchy.gltf"), "-o", in_folder("out/{frame}.png"), "--turntable", "8"}).code, 0);
    const Files views = tree(in_folder("out"));
    EXPECT_EQ(names(views), (Strings{"0.png", "1.png", "2.png", "3.png", "4.png", "5.png", "6.png", "7.png"}));
    std::set<std::string> different;
    for (const auto& [name, contents] : views) different.insert(contents);
    EXPECT_EQ(different.size(), 8u);
    ASSERT_EQ(run_command({"render", scene("hierarchy.gltf"), "-o", in_folder("r{frame}.png"), "--turntable", "8", "-s",
                           "48x32", "--samples", "1"})
                  .code,
              0);
    for (int i = 0; i < 8; ++i) {
        const std::string number = std::to_string(i) + ".png";
        EXPECT_TRUE(read_file(in_folder("r" + number)) == views.at(number));
    }
    EXPECT_EQ(
        batch({scene("hierarchy.gltf"), "-o", in_folder("{frame}.png"), "--turntable", "8", "--camera", "0"}).code, 2);
}

}  // namespace
