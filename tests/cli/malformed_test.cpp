// Hostile files through the command: each scene and picture of the corpus gives what its manifest
// says (formats that are not read are errors), within 5 s and 1 GiB, without a signal, with one line that names the
// file, and leaves nothing behind.
#include "cli/run_command.h"

#include <sstream>

namespace {

std::filesystem::path corpus() {
    const char* models = std::getenv("TESSERA_MODELS");
    return std::filesystem::path(models != nullptr ? models : TESSERA_SOURCE_DIR "/../shared") / "malformed";
}

struct Case {
    std::string file, expected;
};

std::vector<Case> cases() {
    std::vector<Case> list;
    std::ifstream manifest(corpus() / "MANIFEST.csv");
    std::string line;
    std::getline(manifest, line);
    while (std::getline(manifest, line)) {
        // file, bytes, sha256, expected; the free text behind them may hold commas.
        std::istringstream fields(line);
        Case one;
        std::string skipped;
        std::getline(fields, one.file, ',');
        std::getline(fields, skipped, ',');
        std::getline(fields, skipped, ',');
        std::getline(fields, one.expected, ',');
        if (one.expected == "error" || one.expected == "clean" || one.expected == "error-or-clean") list.push_back(one);
    }
    return list;
}

class CliMalformed : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        if (!IsSkipped() && !std::filesystem::exists(corpus() / "MANIFEST.csv"))
            GTEST_SKIP() << "no hostile files at " << corpus();
    }

    void check(const Case& one, const Outcome& run) {
        SCOPED_TRACE(one.file + ": " + run.err);
        EXPECT_EQ(run.signal, 0);
        EXPECT_LT(run.seconds, kSeconds);
        EXPECT_LT(run.resident_mb, kMegabytes);
        if (one.expected == "error") {
            EXPECT_TRUE(run.code == 4 || run.code == 6) << run.code;
        } else if (one.expected == "clean") {
            EXPECT_EQ(run.code, 0);
        } else {
            EXPECT_TRUE(run.code == 0 || run.code == 4 || run.code == 6) << run.code;
        }
        if (run.code == 0) return;
        EXPECT_EQ(run.error_lines(), 1);
        EXPECT_EQ(run.err.rfind("tessera: error: ", 0), 0u);
        EXPECT_NE(run.err.find(std::filesystem::path(one.file).filename().string()), std::string::npos);
        EXPECT_TRUE(folder_contents().empty()) << folder_contents().front();
    }

    // The corpus's own bounds; an instrumented build is slower and larger.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    static constexpr bool kInstrumented = true;
#else
    const bool kInstrumented = kInstrumentedCommand != nullptr;
#endif
    const double kSeconds = kInstrumented ? 60 : 5, kMegabytes = kInstrumented ? 4096 : 1024;
};

TEST_F(CliMalformed, Scenes) {
    int count = 0;
    for (const Case& one : cases()) {
        if (one.file.rfind("image/", 0) == 0) continue;
        ++count;
        const Outcome run = run_command(
            {"render", (corpus() / one.file).string(), "-o", in_folder("a.png"), "-s", "64x64"}, "", {}, 2 * kSeconds);
        check(one, run);
        std::filesystem::remove(in_folder("a.png"));
    }
    EXPECT_GT(count, 250);
}

TEST_F(CliMalformed, Pictures) {
    int count = 0;
    for (const Case& one : cases()) {
        if (one.file.rfind("image/", 0) != 0) continue;
        ++count;
        const std::string file = (corpus() / one.file).string();
        check(one, run_command({"diff", file, file}, "", {}, 2 * kSeconds));
    }
    EXPECT_GT(count, 0);
}

// A picture is no scene.
TEST_F(CliMalformed, PicturesAreNoScenes) {
    for (const Case& one : cases()) {
        if (one.file.rfind("image/", 0) != 0) continue;
        const Outcome run =
            run_command({"render", (corpus() / one.file).string(), "-o", in_folder("a.png")}, "", {}, 2 * kSeconds);
        check({one.file, "error"}, run);
    }
}

}  // namespace
