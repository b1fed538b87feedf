// BEY3: what happens to a batch that is killed, that cannot write, whose scenes are too large or take too long.
#include "cli/batch_support.h"

#include <random>

namespace {

// Ends the command by a signal that it cannot see, after so many microseconds.
int kill_after(const Strings& arguments, unsigned microseconds) {
    std::vector<char*> argv{const_cast<char*>(kCommand)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        ::execv(kCommand, argv.data());
        ::_exit(127);
    }
    ::usleep(microseconds);
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
}

TEST_F(CliBatch, BEY3_KilledAtRandomAndResumedGivesTheSameBytes) {
    const Strings base{"batch", scene("motion.gltf"), scene("hierarchy.gltf"), models(), "-q", "-s", "160x120"};
    const Strings turn{"--turntable", "12"};
    const auto to = [&](const char* folder) {
        return base + turn + Strings{"-o", in_folder(folder) + "/{path}_{frame:02}.png", "--skip-existing"};
    };
    const Outcome whole = run_command(to("whole"));
    ASSERT_EQ(whole.code, 0) << whole.err;
    const Files expected = tree(in_folder("whole"));
    ASSERT_EQ(expected.size(), 60u);

    std::mt19937 random(20);
    const auto longest = static_cast<unsigned>(0.5e6 * whole.seconds);
    const auto moment = [&] { return 1 + static_cast<unsigned>(random()) % (longest + 1); };
    int killed = 0, partial = 0;
    for (int round = 0; round < 12; ++round) {
        const int status = kill_after(to("out"), moment());
        killed += WIFSIGNALED(status);
        const Files now = tree(in_folder("out"));
        for (const auto& [name, contents] : now) {
            if (name.ends_with(".png")) {
                EXPECT_TRUE(contents == expected.at(name)) << name << " is there, but is not whole";
            } else {
                EXPECT_NE(name.find(".png.tessera-"), std::string::npos) << name;
            }
        }
        partial += now.size() > 0 && now.size() < expected.size();
    }
    EXPECT_GT(killed, 0);
    EXPECT_GT(partial, 0) << "no kill came in the middle";
    const fs::path motion = fs::path(scene("motion")).relative_path();
    fs::create_directories(folder_ / "out" / motion.parent_path());
    std::ofstream(folder_ / "out" / (motion.string() + "_03.png.tessera-abc123")) << "left by one that was killed";
    ASSERT_EQ(run_command(to("out")).code, 0);
    // Leftovers of pictures that were missing are gone; so are those of pictures that were there.
    EXPECT_EQ(tree(in_folder("out")), expected);
}

TEST_F(CliBatch, BEY3_NothingIsLeftWhereNothingCanBeWritten) {
    // 2 KiB a file at most: the pictures do not fit, as on a full disk.
    const std::string line = "ulimit -f 2; exec \"$0\" \"$@\"";
    const Outcome run =
        run_program("/bin/bash", {"-c", line, kCommand, "batch", scene("materials.gltf"), models(), "-q", "-o",
                                  in_folder("out/{path}.png"), "-s", "256x256", "--png-level", "0"});
    EXPECT_EQ(run.code, 5) << run.err;
    EXPECT_EQ(run.signal, 0);
    EXPECT_EQ(names(tree(in_folder("out"))), Strings{});
    EXPECT_EQ(run.error_lines(), 4) << run.err;
}

TEST_F(CliBatch, BEY3_ASceneTooLargeForItsShareIsDoneAlone) {
    // As much as the scene needs alone, found by halving; with eight in flight its share is far too small.
    const auto fits = [&](std::uint64_t bytes, const char* flight) {
        return batch({scene("spheres.gltf"), models(), "-o", in_folder("m/{path}.png"), "--max-memory",
                      std::to_string(bytes), "--in-flight", flight, "--report", in_folder("m.json")})
                   .code == 0;
    };
    std::uint64_t low = 1, high = std::uint64_t{1} << 30;
    ASSERT_TRUE(fits(high, "1"));
    while (high - low > high / 16) (fits((low + high) / 2, "1") ? high : low) = (low + high) / 2;
    fs::remove_all(folder_ / "m");
    EXPECT_TRUE(fits(high, "4"));
    EXPECT_FALSE(fits(low / 2, "4"));
}

TEST_F(CliBatch, BEY3_TheTimeOfEncodingCounts) {
    const Strings base{
        "batch", scene("spheres.gltf"),        "-q",        "-s", "1500x1500", "--samples", "1", "--png-level", "9",
        "-o",    in_folder("out/{model}.png"), "--threads", "1"};
    ASSERT_EQ(run_command(base + Strings{"--report", in_folder("run.json")}).code, 0);
    fs::remove_all(folder_ / "out");
    simdjson::dom::parser parser;
    const auto first = parsed(parser, read_file(in_folder("run.json")))["scenes"].at(0);
    const double drawn = double(first["load_ms"]) + double(first["render_ms"]);
    if (double(first["encode_ms"]) < 4 * drawn) GTEST_SKIP() << "drawing takes most of the time here";
    const Outcome run = run_command(base + Strings{"--timeout", std::to_string(2 * drawn / 1000)});
    EXPECT_EQ(run.code, 6) << run.err;
    EXPECT_NE(run.err.find("--timeout: not finished"), std::string::npos) << run.err;
    EXPECT_EQ(tree(in_folder("out")).size(), 0u);
}

TEST_F(CliBatch, BEY3_TimeIsLimitedPerScene) {
    const Outcome run =
        run_command({"batch", scene("spheres.gltf"), models(), "-o", in_folder("out/{path}.png"), "--engine",
                     "reference-trace", "--samples", "64", "-s", "320x240", "--timeout", "3", "-q"});
    EXPECT_EQ(run.code, 6);
    EXPECT_NE(run.err.find("spheres.gltf: --timeout: not finished within 3 s"), std::string::npos) << run.err;
    EXPECT_LT(run.seconds, 30);
    for (const auto& [name, contents] : tree(in_folder("out"))) EXPECT_EQ(name.find("spheres"), std::string::npos);
}

}  // namespace
