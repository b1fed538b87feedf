// ANI11: videos through a pipe to ffmpeg: what it is told and given (by a stand-in that writes it down), what happens
// when it fails, is killed or is not there; and with the real one the frames that come out again.
#include "cli/run_command.h"

#include <tessera/image.h>

#include <cstring>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

Strings operator+(Strings a, const Strings& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

class CliVideo : public CliTest {
  protected:
    Strings turn(const std::string& out) const {
        return {"render", scene("hierarchy.gltf"), "-s", "64x48", "--samples",
                "1",      "--turntable",           "5",  "-o",    in_folder(out)};
    }
    // Puts a script in the place of ffmpeg; `$file` is what it is to write.
    Strings with_ffmpeg(const std::string& body) const {
        fs::create_directories(folder_ / "bin");
        std::ofstream(folder_ / "bin/ffmpeg") << "#!/bin/bash\nfile=\"${@: -1}\"\n[[ $file == file:* ]] || exit 9\n"
                                              << "file=\"${file#file:}\"\n"
                                              << body << "\n";
        fs::permissions(folder_ / "bin/ffmpeg", fs::perms::owner_all);
        const char* path = std::getenv("PATH");
        return {"PATH=" + in_folder("bin") + ":" + (path != nullptr ? path : "")};
    }
    Strings outputs() const {
        Strings names = folder_contents();
        std::erase_if(names, [](const std::string& name) { return name == "bin" || name.ends_with(".txt"); });
        return names;
    }
    static bool has_ffmpeg() { return std::system("ffmpeg -version >/dev/null 2>&1") == 0; }
};

TEST_F(CliVideo, ANI11_TheEncoderGetsTheFramesAsTheyAre) {
    const Strings environment =
        with_ffmpeg("printf '%s\\n' \"$@\" >" + in_folder("arguments.txt") + "; cat >\"$file\"");
    const Outcome run = run_command(turn("clip.mp4"), {}, environment);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(outputs(), Strings{"clip.mp4"});
    const std::string video = read_file(in_folder("clip.mp4"));
    ASSERT_EQ(video.size(), 5u * 64 * 48 * 4);
    ASSERT_EQ(run_command(turn("{frame}.png")).code, 0);
    for (std::size_t i = 0; i < 5; ++i) {
        const tessera::Image frame = tessera::read_image(in_folder(std::to_string(i) + ".png"));
        EXPECT_EQ(std::memcmp(frame.bytes().data(), video.data() + i * frame.bytes().size(), frame.bytes().size()), 0)
            << i;
    }
    const std::string arguments = read_file(in_folder("arguments.txt"));
    for (const char* said :
         {"-f\nrawvideo\n", "-pixel_format\nrgba\n", "-video_size\n64x48\n", "-framerate\n24\n", "-i\npipe:0\n"})
        EXPECT_NE(arguments.find(said), std::string::npos) << said << "in\n" << arguments;
    EXPECT_NE(arguments.find("-f\nmp4\nfile:" + in_folder("clip.mp4.tessera-")), std::string::npos) << arguments;
}

TEST_F(CliVideo, ANI11_NamesThatLookLikeAddressesOrOptionsAreFiles) {
    Strings environment = with_ffmpeg("cat >\"./$file\"");
    const Strings names{"-y.mp4", "a:b.mp4", "http:x.mp4", "pipe:1.mp4"};
    // With the real one, too, where there is one.
    for (const bool real : {false, true}) {
        if (real && !has_ffmpeg()) continue;
        if (real) environment.clear();
        for (const std::string& name : names) {
            Strings arguments = turn("");
            arguments.erase(arguments.end() - 2, arguments.end());
            const Outcome run =
                run_program("/bin/bash",
                            Strings{"-c", "cd " + folder_.string() + " && exec \"$0\" \"$@\"", kCommand} + arguments +
                                Strings{"--output=" + name},
                            {}, environment);
            EXPECT_EQ(run.code, 0) << name << ": " << run.err;
        }
        EXPECT_EQ(outputs(), names);
        for (const std::string& name : names) fs::remove(folder_ / name);
    }
}

TEST_F(CliVideo, ANI11_NamesGoToTheEncoderWithoutAShell) {
    const Strings environment = with_ffmpeg("cat >\"$file\"");
    const std::string name = "$(touch pwned) ;'\"&.mp4";
    ASSERT_EQ(run_command(turn(name), {}, environment).code, 0);
    EXPECT_EQ(outputs(), Strings{name});
    EXPECT_FALSE(fs::exists("pwned"));
}

TEST_F(CliVideo, ANI11_AFailingEncoderLeavesNothing) {
    struct Case {
        const char *body, *message;
    };
    const Case cases[] = {
        {"cat >/dev/null; echo 'no such codec' >&2; exit 3", "ffmpeg failed (exit code 3): no such codec"},
        {"head -c 100 >\"$file\"; echo 'that was enough' >&2; exit 1", "ffmpeg failed (exit code 1): that was enough"},
        {"head -c 100 >\"$file\"; exit 0", "ffmpeg ended before the last frame"},
        {"echo part >\"$file\"; kill -9 $$", "ffmpeg was ended by signal 9"},
    };
    for (const Case& c : cases) {
        Strings large = turn("clip.mp4");
        large[3] = "640x480";  // more than a pipe holds
        const Outcome run = run_command(large, {}, with_ffmpeg(c.body));
        EXPECT_EQ(run.code, 5) << run.err;
        EXPECT_NE(run.err.find(c.message), std::string::npos) << run.err;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_EQ(outputs(), Strings{}) << c.message;
    }
}

TEST_F(CliVideo, ANI11_AnEncoderThatHangsIsBoundByTheTimeout) {
    const Outcome run = run_command(turn("clip.mp4") + Strings{"--timeout", "2"}, {},
                                    with_ffmpeg("echo part >\"$file\"; exec sleep 100"));
    EXPECT_EQ(run.code, 6) << run.err;
    EXPECT_LT(run.seconds, 30);
    EXPECT_EQ(outputs(), Strings{});
}

TEST_F(CliVideo, ANI11_AKilledVideoIsMadeAgainAndItsRestGone) {
    const Strings slow = with_ffmpeg("echo part >\"$file\"; exec sleep 100");
    const Strings again = turn("clip.mp4") + Strings{"--skip-existing"};
    EXPECT_EQ(run_command(again, {}, slow, 2).signal, SIGKILL);
    ASSERT_EQ(outputs().size(), 1u) << "what was being written";
    EXPECT_EQ(outputs()[0].rfind("clip.mp4.tessera-", 0), 0u);
    ASSERT_EQ(run_command(again, {}, with_ffmpeg("cat >\"$file\"")).code, 0);
    EXPECT_EQ(outputs(), Strings{"clip.mp4"});
}

TEST_F(CliVideo, ANI11_WithoutFfmpegTheMessageSaysSo) {
    fs::create_directories(folder_ / "bin");
    const Outcome run = run_command(turn("clip.mp4"), {}, {"PATH=" + in_folder("bin")});
    EXPECT_EQ(run.code, 5);
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_NE(run.err.find("a video needs ffmpeg, which is not in PATH"), std::string::npos) << run.err;
}

TEST_F(CliVideo, ANI11_WhatAVideoCannotBeIsRefusedByName) {
    const Strings base{"render", scene("motion.gltf"), "-o"};
    const std::vector<std::pair<Strings, const char*>> cases{
        {{in_folder("a.mp4")}, "--output"},
        {{in_folder("a{frame}.mp4"), "--frames", "0-3"}, "{frame}"},
        {{in_folder("a.mp4"), "--frames", "0-3", "-s", "33x32"}, "--size"},
        {{in_folder("a.mp4"), "--frames", "0-3", "--background", "none"}, "--background"},
    };
    for (const auto& [more, named] : cases) {
        const Outcome run = run_command(base + more);
        EXPECT_EQ(run.code, 2);
        EXPECT_NE(run.err.find(named), std::string::npos) << run.err;
    }
}

TEST_F(CliVideo, ANI11_BatchMakesAVideoPerScene) {
    const Strings environment = with_ffmpeg("cat >\"$file\"");
    const Strings base{"batch",
                       scene("hierarchy.gltf"),
                       scene("materials.gltf"),
                       "-s",
                       "64x48",
                       "--samples",
                       "1",
                       "-q",
                       "--turntable",
                       "5",
                       "-o",
                       in_folder("{model}.mp4")};
    ASSERT_EQ(run_command(base, {}, environment).code, 0);
    EXPECT_EQ(outputs(), (Strings{"hierarchy.mp4", "materials.mp4"}));
    ASSERT_EQ(run_command(turn("one.mp4"), {}, environment).code, 0);
    EXPECT_TRUE(read_file(in_folder("one.mp4")) == read_file(in_folder("hierarchy.mp4")));
    // Resumed: what is there stays, what is missing comes.
    std::ofstream(folder_ / "hierarchy.mp4") << "mine";
    fs::remove(folder_ / "materials.mp4");
    ASSERT_EQ(run_command(base + Strings{"--skip-existing"}, {}, environment).code, 0);
    EXPECT_EQ(read_file(in_folder("hierarchy.mp4")), "mine");
    EXPECT_EQ(outputs().size(), 3u);
}

TEST_F(CliVideo, ANI11_TheFramesComeOutOfARealVideo) {
    if (!has_ffmpeg()) GTEST_SKIP() << "there is no ffmpeg in PATH";
    ASSERT_EQ(run_command(turn("{frame}.png")).code, 0);
    for (const char* ending : {"mp4", "mov", "mkv", "webm", "gif"}) {
        const std::string clip = in_folder(std::string("clip.") + ending);
        const Outcome run = run_command(turn(std::string("clip.") + ending));
        ASSERT_EQ(run.code, 0) << run.err;
        const std::string out = in_folder(std::string(ending) + "%d.png");
        ASSERT_EQ(std::system(("ffmpeg -v error -i " + clip + " -start_number 0 " + out).c_str()), 0);
        int frames = 0;
        for (; fs::exists(folder_ / (ending + std::to_string(frames) + ".png")); ++frames) {
            const tessera::Image a = tessera::read_image(in_folder(std::to_string(frames) + ".png")),
                                 b = tessera::read_image(in_folder(ending + std::to_string(frames) + ".png"));
            ASSERT_EQ(b.width(), 64);
            // Half the colour resolution and the encoder take something; a wrong matrix, range or order would take
            // more, and another frame is far from it.
            EXPECT_GT(tessera::compare_images(a, b).psnr, 26) << ending << " " << frames;
        }
        EXPECT_EQ(frames, 5) << ending;
    }
    const tessera::Image first = tessera::read_image(in_folder("0.png")),
                         other = tessera::read_image(in_folder("1.png"));
    EXPECT_LT(tessera::compare_images(first, other).psnr, 26);
}

}  // namespace
