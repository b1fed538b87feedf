// The scripts of examples/farm do what they say: each is run as its farm would run it, part by part, and gives the
// pictures of one undivided batch.
#include "cli/run_command.h"

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

class CliFarm : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        if (IsSkipped()) return;
        fs::create_directories(folder_ / "models/more");
        for (int i = 0; i < 10; ++i) {
            std::string name(i % 2 == 0 ? "models/m" : "models/more/m");
            name.append(std::to_string(i)).append(".obj");
            std::ofstream(folder_ / name) << "v 0 0 0\nv 1 0 0\nv 0 1 " << i << "\nf 1 2 3\n";
        }
        ASSERT_EQ(run_command({"batch", in_folder("models"), "-q", "-o", in_folder("whole/{path}.{extension}.png"),
                               "-s", "512x512", "--background", "none"})
                      .code,
                  0);
        pictures_ = tree(in_folder("whole"));
        ASSERT_EQ(pictures_.size(), 10u);
    }
    static std::string script(const char* name) { return std::string(TESSERA_SOURCE_DIR "/examples/farm/") + name; }
    Outcome bash(const Strings& arguments, Strings environment = {}) const {
        environment.push_back(std::string("TESSERA=") + kCommand);
        return run_program("/bin/bash", arguments, {}, environment, 120);
    }
    std::map<std::string, std::string> pictures() const {
        auto files = tree(in_folder("out"));
        std::erase_if(files, [](const auto& file) { return file.first.ends_with(".json"); });
        return files;
    }
    Outcome merge(int parts) const {
        Strings arguments{"merge-report", "-q", "-o", in_folder("merged.json")};
        for (int i = 0; i < parts; ++i) arguments.push_back(in_folder("out/reports/" + std::to_string(i) + ".json"));
        return run_command(arguments);
    }

    std::map<std::string, std::string> pictures_;
};

TEST_F(CliFarm, BEY3_SlurmArray) {
    for (int i = 0; i < 3; ++i) {
        const Outcome run = bash({script("slurm.sh"), in_folder("models"), in_folder("out")},
                                 {"SLURM_ARRAY_TASK_ID=" + std::to_string(i), "SLURM_ARRAY_TASK_MIN=0",
                                  "SLURM_ARRAY_TASK_MAX=2", "SLURM_ARRAY_TASK_STEP=1", "SLURM_ARRAY_TASK_COUNT=3"});
        ASSERT_EQ(run.code, 0) << run.err;
        EXPECT_NE(run.err.find("shard " + std::to_string(i + 1) + " of 3 (SLURM_ARRAY_TASK_ID)"), std::string::npos)
            << run.err;
    }
    EXPECT_EQ(pictures(), pictures_);
    EXPECT_EQ(merge(3).code, 0);
    EXPECT_NE(bash({script("slurm.sh"), in_folder("models"), in_folder("out")}).code, 0) << "not in an array";
}

TEST_F(CliFarm, BEY3_GnuParallel) {
    if (std::system("parallel --version 2>/dev/null | grep -q 'GNU parallel'") != 0)
        GTEST_SKIP() << "there is no GNU parallel in PATH";
    Outcome run = bash({script("parallel.sh"), in_folder("models"), in_folder("out"), "3", "--jobs", "2"},
                       {"HOME=" + folder_.string()});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(pictures(), pictures_);
    EXPECT_TRUE(fs::exists(folder_ / "out/report.json"));
    // A bad model: the other parts go on, and the exit code says so.
    std::ofstream(folder_ / "models/bad.glb") << "no";
    run = bash({script("parallel.sh"), in_folder("models"), in_folder("out"), "3"}, {"HOME=" + folder_.string()});
    EXPECT_EQ(run.code, 4) << run.err;
    EXPECT_NE(run.err.find("bad.glb"), std::string::npos);
}

TEST_F(CliFarm, BEY3_KubernetesIndexedJob) {
    // Reads the job, checks what makes it an indexed one, and gives the command of a container line by line.
    const std::string reader = R"(
import sys, yaml
job = yaml.safe_load(open(sys.argv[1]))
spec = job['spec']
assert (job['apiVersion'], job['kind']) == ('batch/v1', 'Job'), job
assert spec['completionMode'] == 'Indexed' and spec['parallelism'] <= spec['completions']
pod = spec['template']['spec']
assert pod['restartPolicy'] == 'Never'
(container,) = pod['containers']
mounts = {m['name']: m['mountPath'] for m in container['volumeMounts']}
assert set(mounts) == {v['name'] for v in pod['volumes']} and set(mounts.values()) == {'/models', '/out'}
assert container['command'] == ['tessera']
print(spec['completions'])
print(*container['args'], sep='\n')
)";
    if (std::system("python3 -c 'import yaml' 2>/dev/null") != 0) GTEST_SKIP() << "there is no Python with yaml";
    std::ofstream(folder_ / "reader.py") << reader;
    const Outcome read = run_program("/usr/bin/env", {"python3", in_folder("reader.py"), script("kubernetes.yaml")});
    ASSERT_EQ(read.code, 0) << read.err;
    std::stringstream lines(read.out);
    std::string line;
    std::getline(lines, line);
    const int completions = std::stoi(line);
    Strings command;
    while (std::getline(lines, line)) command.push_back(line);
    const auto replace = [](const std::string& text, const std::string& from, const std::string& to) {
        const std::size_t at = text.find(from);
        if (at == std::string::npos) return text;
        std::string changed(text, 0, at);
        changed.append(to).append(text, at + from.size());
        return changed;
    };
    for (int i = 0; i < completions; ++i) {
        Strings here;
        for (const std::string& word : command) {
            const std::string named = replace(word, "$(JOB_COMPLETION_INDEX)", std::to_string(i));
            here.push_back(word[0] != '/'
                               ? named
                               : replace(replace(named, "/models", in_folder("models")), "/out/", in_folder("out/")));
        }
        const Outcome run = run_command(here, {}, {"JOB_COMPLETION_INDEX=" + std::to_string(i)});
        ASSERT_EQ(run.code, 0) << run.err;
    }
    EXPECT_EQ(pictures(), pictures_);
    EXPECT_EQ(merge(completions).code, 0) << "the count of --shard is that of the job";
}

}  // namespace
