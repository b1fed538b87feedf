// `tessera render` from end to end: exit codes, what goes to stdout and to stderr, the picture, the
// statistics.
#include "cli/run_command.h"

#include <tessera/image.h>
#include <tessera/load.h>
#include <tessera/render.h>

#include <simdjson.h>

#include <algorithm>
#include <tuple>

namespace {

using Strings = std::vector<std::string>;

Strings operator+(Strings a, const Strings& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::string color_hash(const std::string& statistics) {
    simdjson::dom::parser parser;
    return std::string(std::string_view(parser.parse(statistics)["color_hash"]));
}

class CliRender : public CliTest {
  protected:
    Strings small(const std::string& name) const { return {"render", scene(name), "-s", "64x48", "--samples", "1"}; }
    std::string contents(const std::string& name) const {
        std::ifstream file(in_folder(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    Outcome render(const Strings& more) const { return run_command(small("cornell-box.gltf") + more); }
};

TEST_F(CliRender, WritesAPngAndSaysNothing) {
    const Outcome run = render({"-o", in_folder("a.png")});
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err, "");
    const tessera::Image image = tessera::read_image(in_folder("a.png"));
    EXPECT_EQ(image.width(), 64);
    EXPECT_EQ(image.height(), 48);
    EXPECT_EQ(folder_contents(), Strings{"a.png"});
}

TEST_F(CliRender, WritesAJpeg) {
    ASSERT_EQ(render({"-o", in_folder("a.JPG"), "--quality", "80"}).code, 0);
    const std::string file = read_file(in_folder("a.JPG"));
    EXPECT_EQ(tessera::read_image_info(std::as_bytes(std::span(file))).codec, "jpeg");
}

TEST_F(CliRender, LinearEncodingIsDarkerAndKeepsTheBackground) {
    ASSERT_EQ(render({"-o", in_folder("s.png"), "--background", "#203040", "--eye", "0,1,9"}).code, 0);
    ASSERT_EQ(
        render({"-o", in_folder("l.png"), "--background", "#203040", "--eye", "0,1,9", "--encoding", "linear"}).code,
        0);
    const tessera::Image srgb = tessera::read_image(in_folder("s.png")),
                         linear = tessera::read_image(in_folder("l.png"));
    const auto *s = srgb.data<std::uint8_t>(), *l = linear.data<std::uint8_t>();
    EXPECT_EQ(std::vector<int>(s, s + 3), (std::vector<int>{0x20, 0x30, 0x40}));
    EXPECT_EQ(std::vector<int>(l, l + 3), (std::vector<int>{0x20, 0x30, 0x40}));
    std::uint64_t sum_srgb = 0, sum_linear = 0;
    for (std::size_t i = 0; i < srgb.bytes().size(); ++i) sum_srgb += s[i], sum_linear += l[i];
    EXPECT_LT(sum_linear, sum_srgb);
}

TEST_F(CliRender, StreamsTheSamePngToStdout) {
    ASSERT_EQ(render({"-o", in_folder("a.png")}).code, 0);
    const Outcome run = render({"-o", "-"});
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_TRUE(run.out == read_file(in_folder("a.png"))) << run.out.size() << " bytes";
}

TEST_F(CliRender, StatisticsAreJsonWithAllMembers) {
    const Outcome run = render({"-o", in_folder("a.png"), "--stats", "-", "--engine", "reference-trace"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    simdjson::dom::object json;
    ASSERT_EQ(parser.parse(run.out).get(json), simdjson::SUCCESS) << run.out;
    for (const char* key : {"triangles", "pixels_covered", "fragments_passed", "phases_ms", "frame_ms", "cpu_ms",
                            "load_ms", "peak_rss_mb", "threads", "isa", "engine", "color_hash", "culls", "exposure",
                            "width", "height", "samples", "version"})
        EXPECT_EQ(json[key].error(), simdjson::SUCCESS) << key;
    EXPECT_EQ(std::string_view(json["engine"]), "reference-trace");
    EXPECT_EQ(std::uint64_t(json["width"]), 64u);
    EXPECT_EQ(std::uint64_t(json["samples"]), 1u);
    // Five walls, the lamp and two blocks of twelve.
    EXPECT_EQ(std::uint64_t(json["triangles"]), 2u * 6 + 2 * 12);
    EXPECT_GT(std::uint64_t(json["pixels_covered"]), 1000u);
    EXPECT_GT(double(json["peak_rss_mb"]), 1.0);

    char hash[17];
    const tessera::Image image = tessera::read_image(in_folder("a.png"));
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(tessera::hash_pixels(image)));
    EXPECT_EQ(std::string_view(json["color_hash"]), hash);
}

TEST_F(CliRender, TheSceneMayComeFromStdin) {
    const std::string triangle = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,
        "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
    const Outcome run = run_command({"render", "-", "-o", in_folder("a.png"), "--stats", "-", "-s", "32x32"}, triangle);
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    EXPECT_EQ(std::uint64_t(parser.parse(run.out)["triangles"]), 1u);

    const Outcome outside =
        run_command({"render", "-", "-o", in_folder("b.png")}, read_file(scene("cornell-box.gltf")));
    EXPECT_EQ(outside.code, 4) << "a scene from stdin may not open files";
    EXPECT_EQ(outside.err.rfind("tessera: error: <stdin>: ", 0), 0u) << outside.err;
}

TEST_F(CliRender, ThreadsAndIsaDoNotChangeThePixels) {
    const std::string expected = color_hash(render({"--stats", "-"}).out);
    EXPECT_EQ(expected.size(), 16u);
    EXPECT_EQ(color_hash(render({"--stats", "-", "--threads", "1"}).out), expected);
    EXPECT_EQ(color_hash(render({"--stats", "-", "--threads", "3", "--isa", "scalar"}).out), expected);
    EXPECT_NE(color_hash(render({"--stats", "-", "--camera", "corner"}).out), expected);
}

TEST_F(CliRender, CamerasByNameIndexAndPosition) {
    const std::string corner = color_hash(render({"--stats", "-", "--camera", "corner"}).out);
    EXPECT_EQ(color_hash(render({"--stats", "-", "--camera", "1"}).out), corner);
    EXPECT_EQ(render({"--stats", "-", "--eye", "0,1,4", "--target", "0,1,0", "--fov", "40"}).code, 0);
    EXPECT_EQ(render({"--stats", "-", "--eye", "0,1,4", "--up", "z"}).code, 0);

    const Outcome unknown = render({"--stats", "-", "--camera", "attic"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_NE(unknown.err.find("'front'"), std::string::npos) << "names the cameras that there are: " << unknown.err;
}

TEST_F(CliRender, TransparentBackgroundHasAlpha) {
    ASSERT_EQ(run_command({"render", scene("spheres.gltf"), "-o", in_folder("a.png"), "-s", "32x32", "--samples", "1",
                           "--background", "none", "--eye", "0,1,8", "--target", "0,6,0", "--fov", "30"})
                  .code,
              0);
    const tessera::Image image = tessera::read_image(in_folder("a.png"));
    EXPECT_EQ(image.data<unsigned char>()[3], 0) << "the top left corner shows the sky";
}

TEST_F(CliRender, RAS7_FiltersGiveTheLibrarysPictures) {
    using tessera::PixelFilter;
    const std::pair<const char*, PixelFilter> filters[] = {{"box", PixelFilter::kBox},
                                                           {"tent", PixelFilter::kTent},
                                                           {"gaussian", PixelFilter::kGaussian},
                                                           {"mitchell", PixelFilter::kMitchell}};
    const tessera::Scene spheres = tessera::load_scene(scene("spheres.gltf"));
    std::vector<std::uint64_t> hashes;
    for (const auto& [name, filter] : filters) {
        const Outcome run = run_command({"render", scene("spheres.gltf"), "-o", in_folder("a.png"), "-s", "40x30",
                                         "--samples", "2", "--filter", name});
        ASSERT_EQ(run.code, 0) << run.err;
        tessera::RenderOptions options;
        options.width = 40, options.height = 30, options.samples = 2, options.filter = filter;
        hashes.push_back(tessera::hash_pixels(tessera::read_image(in_folder("a.png"))));
        EXPECT_EQ(hashes.back(), tessera::render(spheres, options).stats.color_hash) << name;
    }
    std::sort(hashes.begin(), hashes.end());
    EXPECT_EQ(std::adjacent_find(hashes.begin(), hashes.end()), hashes.end()) << "two filters, one picture";
}

TEST_F(CliRender, ShowsTheStagesAndSaysTheirMost) {
    using tessera::Stage;
    const tessera::Scene box = tessera::load_scene(scene("cornell-box.gltf"));
    const std::tuple<const char*, Stage, std::string> stages[] = {
        {"bins", Stage::kBins, " triangles in a tile of 64x64\n"},
        {"hiz", Stage::kHiZ, " (0 is far)\n"},
        {"overdraw", Stage::kOverdraw, " samples tested in a pixel of 1\n"},
        {"cost", Stage::kCost, " cycles, estimated, in a tile of 64x64\n"}};
    for (const auto& [name, stage, line] : stages) {
        const Outcome run = render({"-o", in_folder("a.png"), "--show", name});
        ASSERT_EQ(run.code, 0) << run.err;
        tessera::RenderOptions options;
        options.width = 64, options.height = 48, options.samples = 1, options.show = stage;
        const tessera::RenderResult result = tessera::render(box, options);
        EXPECT_EQ(tessera::hash_pixels(tessera::read_image(in_folder("a.png"))), result.stats.color_hash) << name;
        EXPECT_EQ(run.err.rfind("tessera: " + std::string(name) + ": ", 0), 0u) << run.err;
        EXPECT_NE(run.err.find(line), std::string::npos) << run.err;
        if (stage != Stage::kHiZ) {
            const std::uint32_t* n = result.stage.data<std::uint32_t>();
            const std::string most = "at most " + std::to_string(*std::max_element(n, n + 64 * 48)) + " ";
            EXPECT_NE(run.err.find(most), std::string::npos) << run.err;
        }
        EXPECT_EQ(render({"-o", in_folder("a.png"), "--show", name, "--quiet"}).err, "");
    }
}

TEST_F(CliRender, FB1_ColorBitsLimitTheLevels) {
    ASSERT_EQ(render({"-o", in_folder("a.png"), "--color-bits", "3-3-2"}).code, 0);
    const tessera::Image image = tessera::read_image(in_folder("a.png"));
    std::array<std::vector<bool>, 3> seen{std::vector<bool>(256), std::vector<bool>(256), std::vector<bool>(256)};
    for (std::size_t i = 0; i < image.bytes().size(); ++i)
        if (i % 4 < 3) seen[i % 4][image.data<unsigned char>()[i]] = true;
    const auto levels = [&](std::size_t c) { return std::count(seen[c].begin(), seen[c].end(), true); };
    EXPECT_LE(levels(0), 8);
    EXPECT_LE(levels(1), 8);
    EXPECT_LE(levels(2), 4);
    EXPECT_GT(levels(0), 2);
}

// Numbered pictures are those of --time, and what is there already can stay.
TEST_F(CliRender, ANI11_FramesAreNumbered) {
    const std::string motion = std::string(TESSERA_SOURCE_DIR) + "/scenes/motion.gltf";
    const auto run = [&](Strings arguments) {
        arguments.insert(arguments.begin(), {"render", motion, "-s", "64x48", "--samples", "1"});
        return run_command(arguments);
    };
    const Outcome all =
        run({"-o", in_folder("f_{frame:03}.png"), "--frames", "2-4", "--fps", "4", "--stats", in_folder("stats.json")});
    EXPECT_EQ(all.code, 0) << all.err;
    EXPECT_EQ(folder_contents(), (Strings{"f_002.png", "f_003.png", "f_004.png", "stats.json"}));
    EXPECT_EQ(run({"-o", in_folder("single.png"), "--time", "0.75", "--animation", "everything"}).code, 0);
    EXPECT_EQ(contents("f_003.png"), contents("single.png"));
    EXPECT_NE(contents("f_002.png"), contents("f_003.png"));
    const std::string statistics = contents("stats.json");
    EXPECT_EQ(statistics.front(), '[');
    std::size_t objects = 0;
    for (std::size_t at = 0; (at = statistics.find("\"color_hash\"", at)) != std::string::npos; ++at) ++objects;
    EXPECT_EQ(objects, 3u);

    std::ofstream(in_folder("f_003.png")) << "kept";
    std::filesystem::remove(in_folder("f_004.png"));
    EXPECT_EQ(run({"-o", in_folder("f_{frame:03}.png"), "--frames", "3-4", "--fps", "4", "--skip-existing"}).code, 0);
    EXPECT_EQ(contents("f_003.png"), "kept");
    EXPECT_TRUE(std::filesystem::exists(in_folder("f_004.png")));

    const Outcome wrong = run({"-o", in_folder("x.png"), "--animation", "nothing"});
    EXPECT_EQ(wrong.code, 2);
    EXPECT_NE(wrong.err.find("there are: 0 'everything'"), std::string::npos) << wrong.err;
}

TEST_F(CliRender, UsageErrorsExitWith2AndNameTheOption) {
    const std::string out = in_folder("a.png");
    const std::vector<std::pair<Strings, std::string>> cases{
        {{}, "--output"},
        {{"-o", in_folder("a.bmp")}, "--output"},
        {{"-o", out, "--bogus"}, "--bogus"},
        {{"-o", out, "--frobnicate", "3"}, "--frobnicate"},
        {{"-o", out, "--engine", "fast"}, "--engine"},
        {{"-o", out, "--shadows", "soft"}, "--shadows"},
        {{"-o", out, "--shadows", "traced", "--no-shadows"}, "--no-shadows"},
        {{"-o", out, "--shadows", "traced", "--engine", "reference-raster"}, "reference-raster"},
        {{"-o", out, "--max-depth", "65"}, "--max-depth"},
        {{"-o", out, "--min-contribution", "-1"}, "--min-contribution"},
        {{"-o", out, "--size", "64"}, "--size"},
        {{"-o", out, "--samples", "0"}, "--samples"},
        {{"-o", out, "--samples", "4x"}, "--samples"},
        {{"-o", out, "--point-size", "0"}, "--point-size"},
        {{"-o", out, "--line-width", "257"}, "--line-width"},
        {{"-o", out, "--filter", "lanczos"}, "--filter"},
        {{"-o", out, "--show", "triangles"}, "--show"},
        {{"-o", out, "--show", "bins", "--engine", "reference-raster"}, "--show: needs --engine raster"},
        {{"-o", out, "--show", "cost", "--filter", "tent"}, "--show: needs --filter box"},
        {{"-o", out, "--eye", "1,2"}, "--eye"},
        {{"-o", out, "--target", "1,2,3"}, "--target"},
        {{"-o", out, "--camera", "0", "--eye", "1,2,3"}, "--camera"},
        {{"-o", out, "--fov", "200"}, "--fov"},
        {{"-o", out, "--time", "1.5"}, "--time: the scene has no animations"},
        {{"-o", out, "--time", "soon"}, "--time"},
        {{"-o", out, "--animation", "all"}, "--animation: the scene has no animations"},
        {{"-o", out, "--frames", "0-9"}, "--output: with --frames or --turntable it must say"},
        {{"-o", in_folder("{frame}.png")}, "--output: {frame} needs --frames"},
        {{"-o", in_folder("{{frame}}.png"), "--frames", "0-1"}, "--output: with --frames or --turntable it must say"},
        {{"-o", in_folder("{frame}_{take}.png"), "--frames", "0-9"}, "{take} is no place"},
        {{"-o", in_folder("{frame:x}.png"), "--frames", "0-9"}, "is no width"},
        {{"-o", in_folder("{frame}}.png"), "--frames", "0-9"}, "--output: a }"},
        {{"-o", in_folder("{frame}.png"), "--frames", "9-0"}, "--frames: ends before"},
        {{"-o", in_folder("{frame}.png"), "--frames", "a-b"}, "--frames"},
        {{"-o", in_folder("{frame}.png"), "--frames", "0-1", "--fps", "0"}, "--fps"},
        {{"-o", in_folder("{frame}.png"), "--frames", "0-1", "--time", "1"}, "--time: excludes"},
        {{"-o", out, "--skip-existing"}, "--skip-existing: needs --frames"},
        {{"-o", out, "--background", "#12345"}, "--background"},
        {{"-o", out, "--exposure", "nan"}, "--exposure"},
        {{"-o", out, "--tone-map", "film"}, "--tone-map"},
        {{"-o", out, "--encoding", "gamma"}, "--encoding"},
        {{"-o", out, "--lighting", "dark"}, "--lighting"},
        {{"-o", out, "--isa", "mmx"}, "mmx"},
        {{"-o", out, "--threads", "0"}, "--threads"},
        {{"-o", out, "--aov", "depths"}, "--aov"},
        {{"-o", out, "--color-bits", "9-3-2"}, "--color-bits"},
        {{"-o", out, "--timeout", "-1"}, "--timeout"},
        {{"-o", "-", "--stats", "-"}, "--stats"},
    };
    for (const auto& [arguments, named] : cases) {
        const Outcome run = render(arguments);
        EXPECT_EQ(run.code, 2) << named;
        EXPECT_EQ(run.out, "") << named;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_EQ(run.err.rfind("tessera: error: ", 0), 0u) << run.err;
        EXPECT_NE(run.err.find(named), std::string::npos) << run.err;
    }
    EXPECT_TRUE(folder_contents().empty());
}

TEST_F(CliRender, InputErrorsExitWith4AndNameTheFile) {
    const Outcome missing = run_command({"render", in_folder("no.gltf"), "-o", in_folder("a.png")});
    EXPECT_EQ(missing.code, 4);
    EXPECT_EQ(missing.error_lines(), 1);
    EXPECT_NE(missing.err.find("no.gltf"), std::string::npos) << missing.err;

    std::ofstream(in_folder("bad.gltf")) << "{\"asset\":";
    const Outcome bad = run_command({"render", in_folder("bad.gltf"), "-o", in_folder("a.png")});
    EXPECT_EQ(bad.code, 4);
    EXPECT_EQ(bad.error_lines(), 1);
    EXPECT_EQ(folder_contents(), Strings{"bad.gltf"});
}

TEST_F(CliRender, OutputErrorsExitWith5) {
    const Outcome no_folder = render({"-o", in_folder("nowhere/a.png")});
    EXPECT_EQ(no_folder.code, 5);
    EXPECT_NE(no_folder.err.find("nowhere/a.png"), std::string::npos) << no_folder.err;
    std::filesystem::create_directory(in_folder("dir.png"));
    EXPECT_EQ(render({"-o", in_folder("dir.png")}).code, 5);
    EXPECT_EQ(render({"-o", "/dev/full"}).code, 5);
    EXPECT_EQ(render({"-o", in_folder("a.png"), "--stats", in_folder("nowhere/s.json")}).code, 5);
    EXPECT_EQ(folder_contents(), Strings{"dir.png"});
}

TEST_F(CliRender, AnExistingPictureSurvivesAFailure) {
    ASSERT_EQ(render({"-o", in_folder("a.png")}).code, 0);
    const std::string before = read_file(in_folder("a.png"));
    EXPECT_EQ(run_command({"render", in_folder("no.gltf"), "-o", in_folder("a.png")}).code, 4);
    EXPECT_EQ(read_file(in_folder("a.png")), before);
}

TEST_F(CliRender, LimitsExitWith6) {
    EXPECT_EQ(render({"-o", in_folder("a.png"), "--max-triangles", "10"}).code, 6);
    EXPECT_EQ(render({"-o", in_folder("a.png"), "--max-pixels", "3000"}).code, 6);
    EXPECT_EQ(render({"-o", in_folder("a.png"), "--max-memory", "1K"}).code, 6);
    const Outcome late = run_command({"render", scene("spheres.gltf"), "-o", in_folder("a.png"), "-s", "4096x4096",
                                      "--engine", "reference-trace", "--samples", "64", "--timeout", "0.2"});
    EXPECT_EQ(late.code, 6);
    EXPECT_EQ(late.error_lines(), 1) << late.err;
    EXPECT_NE(late.err.find("--timeout"), std::string::npos) << late.err;
    EXPECT_TRUE(folder_contents().empty());
}

TEST_F(CliRender, AClosedPipeIsAnOutputErrorNotASignal) {
    const std::string line = std::string("'") + kCommand + "' render '" + scene("cornell-box.gltf") +
                             "' -s 64x48 --samples 1 -o - 2>'" + in_folder("err") + "'; echo $? >'" +
                             in_folder("code") + "'";
    // The reader ends at once, before anything is written to it.
    ASSERT_EQ(std::system(("( sleep 0.3; " + line + " ) | true").c_str()), 0);
    for (int i = 0; i < 200 && read_file(in_folder("code")).empty(); ++i) ::usleep(50'000);
    EXPECT_EQ(read_file(in_folder("code")), "5\n") << read_file(in_folder("err"));
}

TEST_F(CliRender, AWrongIsaInTheEnvironmentIsRefusedByName) {
    const Outcome run =
        run_command(small("cornell-box.gltf") + Strings{"-o", in_folder("a.png")}, "", {"TESSERA_ISA=mmx"});
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.err.find("mmx"), std::string::npos) << run.err;
}

TEST_F(CliRender, NothingToDrawIsABackgroundAWarningAndNoError) {
    const std::string empty = R"({"asset":{"version":"2.0"}})";
    const Outcome run =
        run_command({"render", "-", "-o", in_folder("a.png"), "-s", "8x8", "--background", "#ff8000"}, empty);
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.err.rfind("tessera: warning: ", 0), 0u) << run.err;
    const tessera::Image image = tessera::read_image(in_folder("a.png"));
    EXPECT_EQ(image.data<unsigned char>()[0], 255);
    EXPECT_EQ(image.data<unsigned char>()[1], 128);
    EXPECT_EQ(image.data<unsigned char>()[2], 0);
    EXPECT_EQ(run_command({"render", "-", "-o", in_folder("b.png"), "-s", "8x8", "--quiet"}, empty).err, "");
}

}  // namespace
