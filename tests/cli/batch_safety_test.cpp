// BEY3: what a batch must not do: write over its inputs, give its files other rights than usual, end with the first
// path that is not there, or fall when the system has no thread for it.
#include "cli/batch_support.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include <cstddef>

namespace {

// A process that is ended when it calls umask(), or 77 where the system has no such filters.
int run_without_umask(const Strings& arguments) {
    std::vector<char*> argv{const_cast<char*>(kCommand)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        ::umask(022);
        sock_filter filter[] = {
            BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_umask, 0, 1),
            BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
            BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
        };
        const sock_fprog program{static_cast<unsigned short>(std::size(filter)), filter};
        if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
            ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
            ::_exit(77);
        ::execv(kCommand, argv.data());
        ::_exit(127);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST_F(CliBatch, BEY3_ThreadsLeaveTheUmaskAlone) {
    if (read_file("/proc/self/status").find("\nUmask:") == std::string::npos)
        GTEST_SKIP() << "this system says the umask only to those who set it";
    for (int i = 0; i < 64; ++i) {
        std::string name("models/m");
        add_triangle(name.append(std::to_string(i)).append(".gltf"));
    }
    const int code = run_without_umask({"batch", models(), "-q", "-s", "16x16", "--samples", "1", "--threads", "8",
                                        "--in-flight", "8", "-o", in_folder("out/{path}.png")});
    if (code == 77) GTEST_SKIP() << "there are no filters of system calls here";
    ASSERT_EQ(code, 0);
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out")) {
        if (!entry.is_regular_file()) continue;
        ++files;
        EXPECT_EQ(entry.status().permissions(), static_cast<fs::perms>(0644)) << entry.path();
    }
    EXPECT_EQ(files, 67);
}

TEST_F(CliBatch, BEY3_FewerThreadsThanWantedDoAllOfIt) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers need more addresses than are left here";
#endif
    for (int i = 0; i < 8; ++i) {
        std::string name("models/m");
        add_triangle(name.append(std::to_string(i)).append(".gltf"));
    }
    // Stacks of a gigabyte, and addresses for three of them.
    const std::string line = "ulimit -s 1000000 && ulimit -v 4000000 || exit 77; exec \"$0\" \"$@\"";
    const Outcome run = run_program(
        "/bin/bash", {"-c", line, kCommand, "batch", models(), "-q", "-s", "16x16", "--samples", "1", "--threads", "1",
                      "--in-flight", "8", "-o", in_folder("out/{path}.png"), "--report", in_folder("run.json")});
    if (run.code == 77) GTEST_SKIP() << "this system does not let stacks be so large";
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(tree(in_folder("out")).size(), 11u);
    simdjson::dom::parser parser;
    EXPECT_LT(std::int64_t(parsed(parser, read_file(in_folder("run.json")))["in_flight"]), 8);
}

TEST_F(CliBatch, BEY3_WhatIsReadIsNotWrittenOver) {
    // Scenes are told by what is in them, whatever their names.
    add_triangle("models/c.png");
    fs::create_directory_symlink(folder_ / "models", folder_ / "link");
    std::ofstream(folder_ / "list.png") << in_folder("models/one.gltf") << "\n";
    const Files before = tree(folder_);
    struct Case {
        Strings arguments;
        const char* option;
    };
    const std::string one = in_folder("models/one.gltf"), out = in_folder("out/{path}.png");
    const std::vector<Case> cases{
        {{in_folder("models/c.png"), "-o", in_folder("models/{model}.png")}, "--output"},
        {{in_folder("models/c.png"), "-o", in_folder("link/{model}.png")}, "--output"},
        {{"--list", in_folder("list.png"), "-o", in_folder("list.png")}, "--output"},
        {{one, "-o", out, "--report", one}, "--report"},
        {{one, "-o", out, "--report", in_folder("link/one.gltf")}, "--report"},
        {{one, "-o", out, "--reference", models(), "--html", one}, "--html"},
    };
    for (const auto& [arguments, option] : cases) {
        const Outcome run = batch(arguments);
        EXPECT_EQ(run.code, 2) << run.err;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_NE(run.err.find(option), std::string::npos) << run.err;
        EXPECT_NE(run.err.find("would be written over"), std::string::npos) << run.err;
    }
    EXPECT_EQ(tree(folder_), before);
}

TEST_F(CliBatch, BEY3_PathsThatAreNotThereAreFailedScenes) {
    const std::string list = models() + "/one.gltf\n" + in_folder("nowhere.glb") + "\n" + models() + "/a\n";
    const Outcome run = run_command({"batch", "--list", "-", "-q", "-s", "16x16", "-o", in_folder("out/{model}.png"),
                                     "--report", in_folder("run.json")},
                                    list);
    EXPECT_EQ(run.code, 4) << run.err;
    EXPECT_EQ(run.err, "tessera: error: " + in_folder("nowhere.glb") + ": does not exist\n");
    EXPECT_EQ(names(tree(in_folder("out"))), (Strings{"one.png", "two.png"}));
    simdjson::dom::parser parser;
    const auto report = parsed(parser, read_file(in_folder("run.json")));
    EXPECT_EQ(std::uint64_t(report["totals"]["failed"]), 1u);
    EXPECT_EQ(std::uint64_t(report["totals"]["done"]), 2u);
    // A list that is none.
    const Outcome folder = batch({"--list", models(), "-o", in_folder("out/{model}.png")});
    EXPECT_EQ(folder.code, 4) << folder.err;
    EXPECT_NE(folder.err.find(models() + ": is a folder"), std::string::npos) << folder.err;
}

TEST_F(CliBatch, BEY3_AFolderThatCannotBeSearchedIsAFailedScene) {
    // Deeper than paths may be long, which stops the superuser, too.
    const std::string name(250, 'd'),
        make = "cd " + models() + "/b && for i in {1..20}; do mkdir " + name + " && cd -P " + name + " || exit 1; done";
    ASSERT_EQ(run_program("/bin/bash", {"-c", make}).code, 0);
    const Outcome run = batch({models(), "-q", "-o", in_folder("out/{path}.png")});
    EXPECT_EQ(run_program("/bin/rm", {"-rf", models() + "/b/" + name}).code, 0);
    EXPECT_EQ(run.code, 4) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_NE(run.err.find("cannot be searched"), std::string::npos) << run.err;
    EXPECT_EQ(names(tree(in_folder("out"))), (Strings{"a/two.png", "b/two.png", "one.png"}));
}

TEST_F(CliBatch, BEY3_AFolderInAPicturesPlaceHindersThatPictureAlone) {
    fs::create_directories(folder_ / "out/x");
    fs::create_directories(folder_ / "out/one.png");
    EXPECT_EQ(batch({models(), "-o", in_folder("out/{path}.png"), "--skip-existing"}).code, 5);
    EXPECT_EQ(names(tree(in_folder("out"))), (Strings{"a/two.png", "b/two.png"}));
    fs::remove(folder_ / "out/one.png");
    EXPECT_EQ(batch({models(), "-o", in_folder("out/{path}.png")}).code, 0);
}

TEST_F(CliBatch, BEY3_ProcessesWithTheSamePicturesDoNotHinderEachOther) {
    for (int i = 0; i < 100; ++i) {
        std::string name("models/m");
        add_triangle(name.append(std::to_string(i)).append(".gltf"));
    }
    const std::string line = "\"$0\" \"$@\" & \"$0\" \"$@\"; code=$?; wait $! && exit $code";
    for (int round = 0; round < 5; ++round) {
        const Outcome run =
            run_program("/bin/bash", {"-c", line, kCommand, "batch", models(), "-q", "-s", "8x8", "--samples", "1",
                                      "--in-flight", "4", "-o", in_folder("out/{path}.png")});
        ASSERT_EQ(run.code, 0) << run.err;
        EXPECT_EQ(tree(in_folder("out")).size(), 103u);
    }
}

TEST_F(CliBatch, BEY3_MergedFramesAreInTheOrderOfTheWhole) {
    std::ofstream(folder_ / "poses.json")
        << R"({"convention":"opengl","cameras":[{"name":"z","camera_to_world":[[1,0,0,0],[0,1,0,1],[0,0,1,6],[0,0,0,1]]},
        {"name":"a","camera_to_world":[[1,0,0,1],[0,1,0,1],[0,0,1,5],[0,0,0,1]]}]})";
    const Strings base{scene("motion.gltf"),   "--frames", "0-4", "--poses", in_folder("poses.json"), "--report",
                       in_folder("whole.json")};
    const Strings out{"-o", in_folder("out/{camera}_{frame}.png")};
    ASSERT_EQ(batch(base + out).code, 0);
    Strings reports;
    for (const char* shard : {"1/3", "2/3", "3/3"}) {
        reports.push_back(in_folder(std::string("r") + shard[0] + ".json"));
        Strings part = base;
        part.back() = reports.back();
        ASSERT_EQ(batch(part + out + Strings{"--shard", shard, "--shard-by", "frame"}).code, 0);
    }
    ASSERT_EQ(run_command(Strings{"merge-report", "-q", "-o", in_folder("merged.json")} + reports).code, 0);
    simdjson::dom::parser first, second;
    const auto whole = parsed(first, read_file(in_folder("whole.json"))),
               merged = parsed(second, read_file(in_folder("merged.json")));
    EXPECT_EQ(simdjson::to_string(whole["scenes"].at(0)["pictures"]),
              simdjson::to_string(merged["scenes"].at(0)["pictures"]));
}

}  // namespace
