// The command as a whole, `tessera info` and `tessera diff` from end to end.
#include "cli/json_writer.h"
#include "cli/run_command.h"

#include <tessera/image_files.h>
#include <tessera/planes.h>
#include <tessera/version.h>

#include <simdjson.h>

#include <limits>

namespace {

using Cli = CliTest;

TEST_F(Cli, VersionAndHelpGoToStdout) {
    const Outcome version = run_command({"--version"});
    EXPECT_EQ(version.code, 0);
    EXPECT_EQ(version.err, "");
    EXPECT_EQ(version.out.rfind("tessera " TESSERA_VERSION "\n", 0), 0u) << version.out;
    EXPECT_NE(version.out.find("scalar"), std::string::npos);
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{"--help"}, {"render", "--help"}, {"info", "-h"}, {"diff", "--help"}}) {
        const Outcome help = run_command(arguments);
        EXPECT_EQ(help.code, 0);
        EXPECT_EQ(help.err, "");
        EXPECT_NE(help.out.find("tessera"), std::string::npos) << help.out;
    }
}

TEST_F(Cli, UnknownCommandsAreRefused) {
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{}, {"paint"}, {"--verbose"}, {"info"}, {"diff", "a.png"}}) {
        const Outcome run = run_command(arguments);
        EXPECT_EQ(run.code, 2);
        EXPECT_EQ(run.out, "");
        EXPECT_EQ(run.error_lines(), 1) << run.err;
    }
}

TEST_F(Cli, InfoCountsPointsAndLines) {
    std::ofstream(folder_ / "p.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nl 1 2 3 4\np 1 2 3 4\nf 1 2 3\n";
    const Outcome run = run_command({"info", in_folder("p.obj"), "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    const simdjson::dom::element counts = parser.parse(run.out)["counts"];
    EXPECT_EQ(std::uint64_t(counts["drawn_triangles"]), 1u);
    EXPECT_EQ(std::uint64_t(counts["drawn_lines"]), 3u);
    EXPECT_EQ(std::uint64_t(counts["drawn_points"]), 4u);
    EXPECT_NE(run_command({"info", in_folder("p.obj")}).out.find("lines         3 drawn\npoints        4 drawn\n"),
              std::string::npos);
}

TEST_F(Cli, InfoCountsShapes) {
    const auto write = [&](const std::string& more) {
        std::ofstream(folder_ / "s.gltf")
            << R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"meshes":[{"primitives":[)" +
                   more + R"({"attributes":{},"extensions":{"TESSERA_shape":{"type":"plane"}}}]}]})";
    };
    write(R"({"attributes":{},"extensions":{"TESSERA_shape":{"type":"plane","size":[4,2]}}},)");
    const Outcome run = run_command({"info", in_folder("s.gltf"), "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    const simdjson::dom::element json = parser.parse(run.out);
    EXPECT_EQ(std::uint64_t(json["counts"]["primitives"]), 2u);
    EXPECT_EQ(std::uint64_t(json["counts"]["shapes"]), 2u);
    EXPECT_EQ(double(json["bounds"]["max"].at(0)), 2);  // not those of the plane without end
    EXPECT_NE(run_command({"info", in_folder("s.gltf")}).out.find("1 with 2 primitives, 2 of them shapes\n"),
              std::string::npos);
    write("");
    const Outcome endless = run_command({"info", in_folder("s.gltf"), "--json"});
    EXPECT_NE(endless.out.find("\"bounds\": null"), std::string::npos) << endless.out;
    EXPECT_NE(run_command({"info", in_folder("s.gltf")}).out.find("bounds        none\n"), std::string::npos);
}

TEST_F(Cli, InfoCountsTheHierarchyScene) {
    const Outcome run = run_command({"info", scene("hierarchy.gltf"), "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    simdjson::dom::element json;
    ASSERT_EQ(parser.parse(run.out).get(json), simdjson::SUCCESS) << run.out;
    EXPECT_EQ(std::uint64_t(json["counts"]["cameras"]), 2u);
    EXPECT_EQ(std::uint64_t(json["counts"]["lights"]), 2u);
    EXPECT_EQ(std::string_view(json["cameras"].at(0)["name"]), "main");
    EXPECT_EQ(std::string_view(json["lights"].at(0)["type"]), "directional");
    EXPECT_GT(std::uint64_t(json["counts"]["drawn_triangles"]), std::uint64_t(json["counts"]["triangles"]))
        << "bolts, crates and fingers are instances";
    // The floor spans 28 m and nothing is below it.
    EXPECT_DOUBLE_EQ(double(json["bounds"]["min"].at(0)), -14);
    EXPECT_DOUBLE_EQ(double(json["bounds"]["max"].at(2)), 14);
    EXPECT_DOUBLE_EQ(double(json["bounds"]["min"].at(1)), 0);
    EXPECT_GT(std::uint64_t(json["memory_bytes"]), 10000u);

    const Outcome text = run_command({"info", scene("hierarchy.gltf")});
    EXPECT_EQ(text.code, 0);
    EXPECT_NE(text.out.find("main (perspective)"), std::string::npos) << text.out;
}

TEST_F(Cli, InfoShowsPicturesAndExtensions) {
    const Outcome run = run_command({"info", scene("materials.gltf"), "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    const simdjson::dom::element json = parser.parse(run.out);
    EXPECT_EQ(std::uint64_t(json["pictures"].at(0)["width"]), 128u);
    EXPECT_EQ(std::uint64_t(json["pictures"].at(1)["height"]), 64u);
    EXPECT_EQ(simdjson::dom::array(json["extensions_ignored"]).size(), 0u) << run.out;
    EXPECT_EQ(simdjson::dom::array(json["extensions_used"]).size(), 4u);
    std::vector<std::string_view> models;
    for (const auto material : simdjson::dom::array(json["materials"])) models.push_back(material["model"]);
    for (const char* model : {"metallic-roughness", "unlit", "lambert", "phong", "blinn-phong"})
        EXPECT_NE(std::find(models.begin(), models.end(), model), models.end()) << model;
}

TEST_F(Cli, InfoShowsTheLayersOfMaterials) {
    std::filesystem::copy_file(scene("checker.png"), in_folder("checker.png"));
    std::ofstream(in_folder("m.gltf"))
        << R"({"asset":{"version":"2.0"},"images":[{"uri":"checker.png"}],"textures":[{"source":0}],"materials":[{)"
        << R"("extensions":{)"
        << R"("KHR_materials_transmission":{"transmissionFactor":0.75,"transmissionTexture":{"index":0}},)"
        << R"("KHR_materials_volume":{"thicknessFactor":0.25,"attenuationDistance":2,"attenuationColor":[1,0.5,0]},)"
        << R"("KHR_materials_ior":{"ior":1.25},"KHR_materials_clearcoat":{"clearcoatFactor":1},)"
        << R"("KHR_materials_sheen":{"sheenRoughnessFactor":0.5},"KHR_materials_anisotropy":{"anisotropyRotation":1},)"
        << R"("KHR_materials_iridescence":{"iridescenceFactor":0.5},"KHR_materials_dispersion":{"dispersion":0.5}}},{}]})";
    const Outcome run = run_command({"info", in_folder("m.gltf"), "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    const simdjson::dom::element json = parser.parse(run.out), m = json["materials"].at(0);
    EXPECT_EQ(double(m["ior"]), 1.25);
    EXPECT_EQ(double(m["transmission"]["strength"]), 0.75);
    EXPECT_EQ(std::uint64_t(m["transmission"]["texture"]), 0u);
    EXPECT_EQ(double(m["volume"]["thickness_m"]), 0.25);
    EXPECT_EQ(double(m["volume"]["attenuation_distance_m"]), 2);
    EXPECT_EQ(double(m["volume"]["attenuation_color"].at(1)), 0.5);
    EXPECT_EQ(double(m["clearcoat"]["strength"]), 1);
    EXPECT_EQ(double(m["sheen"]["roughness"]), 0.5);
    EXPECT_EQ(double(m["anisotropy"]["rotation_rad"]), 1);
    EXPECT_EQ(double(m["iridescence"]["thickness_at_white_nm"]), 400);
    EXPECT_EQ(double(m["dispersion"]), 0.5);
    int undrawn = 0;
    for (const auto warning : simdjson::dom::array(json["warnings"]))
        undrawn += std::string_view(warning).find("not drawn yet") != std::string_view::npos;
    EXPECT_EQ(undrawn, 4) << run.out;
    // What a material does not have is not there.
    for (const char* key : {"clearcoat", "sheen", "transmission", "volume", "anisotropy", "iridescence", "dispersion"})
        EXPECT_NE(json["materials"].at(1)[key].error(), simdjson::SUCCESS) << key;
    const Outcome text = run_command({"info", in_folder("m.gltf")});
    EXPECT_NE(
        text.out.find("ior 1.25, clearcoat 1, sheen roughness 0.5, transmission 0.75, volume 0.25 m, anisotropy 0, "
                      "iridescence 0.5, dispersion 0.5"),
        std::string::npos)
        << text.out;
}

class CliDiff : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        if (IsSkipped()) return;
        tessera::Image image(8, 4, tessera::PixelFormat::kRgba8);
        for (std::size_t i = 0; i < image.bytes().size(); ++i) image.data<unsigned char>()[i] = i % 4 == 3 ? 255 : 100;
        tessera::write_image(in_folder("a.png"), image);
        image.data<unsigned char>()[0] = 110;   // one pixel by 10 ...
        image.data<unsigned char>()[21] = 103;  // ... and another by 3
        tessera::write_image(in_folder("b.png"), image);
        tessera::write_image(in_folder("small.png"), tessera::Image(4, 4, tessera::PixelFormat::kRgba8));
    }
    Outcome diff(std::vector<std::string> more) const {
        std::vector<std::string> arguments{"diff", in_folder("a.png"), in_folder("b.png")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_command(arguments);
    }
};

TEST_F(CliDiff, MeasuresAgainstHandCalculatedValues) {
    const Outcome run = diff({"--json"});
    EXPECT_EQ(run.code, 3);
    simdjson::dom::parser parser;
    simdjson::dom::element json;
    ASSERT_EQ(parser.parse(run.out).get(json), simdjson::SUCCESS) << run.out;
    EXPECT_EQ(std::uint64_t(json["differing_pixels"]), 2u);
    EXPECT_EQ(std::uint64_t(json["pixels"]), 32u);
    EXPECT_DOUBLE_EQ(double(json["max_error"]), 10);
    EXPECT_EQ(bool(json["equal"]), false);
}

TEST_F(CliDiff, ToleranceAndCountDecide) {
    EXPECT_EQ(diff({}).code, 3);
    EXPECT_EQ(diff({"--tolerance", "9"}).code, 3);
    EXPECT_EQ(diff({"--tolerance", "10"}).code, 0);
    EXPECT_EQ(diff({"--max-differing", "1"}).code, 3);
    EXPECT_EQ(diff({"--max-differing", "2"}).code, 0);
    EXPECT_EQ(diff({"--max-differing", "1", "--tolerance", "3"}).code, 0);
}

TEST_F(CliDiff, EqualPicturesExitWith0) {
    const Outcome run = run_command({"diff", in_folder("a.png"), in_folder("a.png")});
    EXPECT_EQ(run.code, 0);
    EXPECT_NE(run.out.find("infinite"), std::string::npos) << run.out;
}

TEST_F(CliDiff, DifferentSizesAreDifferentPictures) {
    const Outcome run = run_command({"diff", in_folder("a.png"), in_folder("small.png"), "-o", in_folder("d.png")});
    EXPECT_EQ(run.code, 3);
    EXPECT_NE(run.out.find("8x4 and 4x4"), std::string::npos) << run.out;
}

TEST_F(CliDiff, ThePictureMarksTheDifferencesRed) {
    ASSERT_EQ(diff({"-o", in_folder("d.png")}).code, 3);
    const tessera::Image picture = tessera::read_image(in_folder("d.png"));
    const auto* first = picture.data<unsigned char>();
    EXPECT_GT(first[0], first[1] + 50) << "the pixel that differs";
    const auto* equal = first + 4;
    EXPECT_EQ(equal[0], equal[1]);
    EXPECT_EQ(equal[1], equal[2]);
}

TEST_F(CliDiff, Fb1ArraysAreComparedInTheirUnit) {
    const auto write = [&](const char* name, int width, int components, const std::vector<float>& values) {
        const std::vector<std::byte> file =
            tessera::encode_npy(width, static_cast<int>(values.size()) / width / components, components,
                                tessera::NpyType::kF4, values.data());
        std::ofstream(in_folder(name), std::ios::binary)
            .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
    };
    write("a.npy", 2, 1, {1, 2, 3, std::numeric_limits<float>::infinity()});
    write("b.npy", 2, 1, {1, 2.5, 3, std::numeric_limits<float>::infinity()});
    write("c.npy", 2, 2, {1, 2, 3, 4});
    const auto compare = [&](const char* first, const char* second, std::vector<std::string> more) {
        more.insert(more.begin(), {"diff", in_folder(first), in_folder(second)});
        return run_command(more);
    };
    EXPECT_EQ(compare("a.npy", "a.npy", {}).code, 0);
    EXPECT_EQ(compare("a.npy", "b.npy", {"--tolerance", "0.5"}).code, 0);
    EXPECT_EQ(compare("a.npy", "b.npy", {"--max-differing", "1"}).code, 0);
    const Outcome run = compare("a.npy", "b.npy", {"--json", "--tolerance", "0.49"});
    EXPECT_EQ(run.code, 3);
    simdjson::dom::parser parser;
    simdjson::dom::element json;
    ASSERT_EQ(parser.parse(run.out).get(json), simdjson::SUCCESS) << run.out;
    EXPECT_EQ(std::uint64_t(json["differing_pixels"]), 1u);
    EXPECT_EQ(double(json["max_error"]), 0.5);
    EXPECT_EQ(double(json["mean_error"]), 0.125);
    const Outcome shapes = compare("a.npy", "c.npy", {});
    EXPECT_EQ(shapes.code, 3);
    EXPECT_EQ(shapes.out, "arrays differ: <f4 of 2x2 and <f4 of 2x1x2\n");
    EXPECT_EQ(compare("a.npy", "a.png", {}).code, 2);
    EXPECT_EQ(compare("a.npy", "b.npy", {"-o", in_folder("d.png")}).code, 2);
    EXPECT_EQ(compare("a.npy", "no.npy", {}).code, 4);
    EXPECT_EQ(compare("a.npy", "a.npy", {"--max-pixels", "3"}).code, 6);
    std::ofstream(in_folder("bad.npy")) << "not an array";
    const Outcome bad = compare("a.npy", "bad.npy", {});
    EXPECT_EQ(bad.code, 4);
    EXPECT_NE(bad.err.find("bad.npy"), std::string::npos) << bad.err;
    EXPECT_EQ(bad.error_lines(), 1);
}

// Floating-point pictures are compared in their own unit, whatever their format, and with the like only.
TEST_F(CliDiff, FloatingPointInItsOwnUnit) {
    tessera::Image image(8, 4, tessera::PixelFormat::kRgba32f);
    for (std::size_t i = 0; i < 128; ++i) image.data<float>()[i] = i % 4 == 3 ? 1.0f : 2.0f;
    tessera::write_image(in_folder("a.hdr"), image);
    image.data<float>()[4] = 2.5f;
    tessera::write_image(in_folder("b.hdr"), image);
    const std::string a = in_folder("a.hdr"), b = in_folder("b.hdr");
    const Outcome run = run_command({"diff", a, b, "-o", in_folder("d.png")});
    EXPECT_EQ(run.code, 3);
    EXPECT_NE(run.out.find("differing pixels: 1 of 32\nmax error:        0.5\n"), std::string::npos) << run.out;
    const tessera::Image picture = tessera::read_image(in_folder("d.png"));
    const auto* marked = picture.data<unsigned char>() + 4;
    EXPECT_GT(marked[0], marked[1] + 50);
    EXPECT_EQ(run_command({"diff", a, b, "--tolerance", "0.49"}).code, 3);
    EXPECT_EQ(run_command({"diff", a, b, "--tolerance", "0.5"}).code, 0);
    const Outcome mixed = run_command({"diff", a, in_folder("a.png")});
    EXPECT_EQ(mixed.code, 4);
    EXPECT_NE(mixed.err.find("no unit in common"), std::string::npos) << mixed.err;
    EXPECT_EQ(run_command({"diff", in_folder("a.png"), a}).code, 4);
    if (!tessera::has_image_module()) return;
    // Another format, the same values; the colour of the HDR file is opaque.
    tessera::write_image(in_folder("b.exr"), image);
    EXPECT_EQ(run_command({"diff", b, in_folder("b.exr")}).code, 0);
    EXPECT_EQ(run_command({"diff", in_folder("b.exr"), b}).code, 0);
    EXPECT_EQ(run_command({"diff", in_folder("b.exr"), a}).code, 3);
}

// Two EXR files are the same when all their channels are.
TEST_F(CliDiff, EveryChannelOfExr) {
    if (!tessera::has_image_module()) GTEST_SKIP() << "built without the OpenImageIO module";
    std::vector<float> depth(32, 1000);
    std::vector<std::uint32_t> ids(32, 7);
    const auto write = [&](const char* name, const char* channel) {
        const tessera::ImageChannel channels[] = {{channel, tessera::ChannelType::kFloat, depth.data(), 4},
                                                  {"id", tessera::ChannelType::kUint, ids.data(), 4}};
        const std::vector<std::byte> file = tessera::encode_exr(8, 4, channels);
        std::ofstream(in_folder(name), std::ios::binary)
            .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
    };
    write("a.exr", "depth.Z");
    write("other.exr", "depth.W");
    depth[3] = 1002, ids[3] = 8, ids[9] = 9;
    write("b.exr", "depth.Z");
    const std::string a = in_folder("a.exr"), b = in_folder("b.exr");
    const Outcome run = run_command({"diff", a, b});
    EXPECT_EQ(run.code, 3);
    EXPECT_NE(run.out.find("differing pixels: 2 of 32\nmax error:        2\n"), std::string::npos) << run.out;
    EXPECT_EQ(run_command({"diff", a, b, "--tolerance", "2"}).code, 0);
    EXPECT_EQ(run_command({"diff", a, a}).code, 0);
    const Outcome names = run_command({"diff", a, in_folder("other.exr")});
    EXPECT_EQ(names.code, 4);
    EXPECT_NE(names.err.find("channels depth.W, id"), std::string::npos) << names.err;
    // Without the module: one line that says what is missing.
    const Outcome without = run_command({"diff", a, b}, {}, {"TESSERA_OIIO_MODULE=/no/such/module.so"});
    EXPECT_EQ(without.code, 4);
    EXPECT_EQ(without.error_lines(), 1);
    EXPECT_NE(without.err.find("libopenimageio-dev"), std::string::npos) << without.err;
}

TEST_F(CliDiff, FailuresHaveTheirCodes) {
    const Outcome missing = run_command({"diff", in_folder("a.png"), in_folder("no.png")});
    EXPECT_EQ(missing.code, 4);
    EXPECT_EQ(missing.error_lines(), 1);
    EXPECT_NE(missing.err.find("no.png"), std::string::npos) << missing.err;
    EXPECT_EQ(diff({"--tolerance", "much"}).code, 2);
    EXPECT_EQ(diff({"-o", in_folder("nowhere/d.png")}).code, 5);
}

TEST_F(CliDiff, ThePictureIsAPngAndStdoutCarriesTheReport) {
    for (const char* name : {"d.jpg", "d"}) EXPECT_EQ(diff({"-o", in_folder(name)}).code, 2) << name;
    EXPECT_EQ(diff({"-o", "-"}).code, 2);
    EXPECT_FALSE(std::filesystem::exists(in_folder("d.jpg")));
}

TEST_F(Cli, ALongNameInAFileGivesAShortLine) {
    const std::string name(100000, 'B');
    const Outcome run =
        run_command({"info", "-"}, R"({"asset":{"version":"2.0"},"extensionsRequired":[")" + name + "\"]}");
    EXPECT_EQ(run.code, 4);
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_LT(run.err.size(), 1200u);
    EXPECT_NE(run.err.find("/extensionsRequired/0"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("not supported"), std::string::npos) << run.err;
}

TEST_F(Cli, WhatFollowsTwoDashesIsNoOption) {
    const Outcome run = run_command({"render", "--", scene("hierarchy.gltf"), "-o", in_folder("a.png")});
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.err.find("--: there is no such option"), std::string::npos) << run.err;
}

TEST(JsonWriter, EscapesWhatJsonForbids) {
    const std::string hostile =
        std::string("a\"b\\c\n\x01\x7f") + "\xff\xc3\xa9\xed\xa0\x80" + "\xf0\x9f\x98\x80\xe2\x82";
    tessera::cli::JsonWriter json;
    json.begin_object().member(hostile, hostile).member("inf", std::numeric_limits<double>::infinity());
    json.member("third", 1.0 / 3).key("list").begin_array().value(true).begin_object().end_object().end_array();
    simdjson::dom::parser parser;
    simdjson::dom::element parsed;
    const std::string text = json.end_object().text();
    ASSERT_EQ(parser.parse(text).get(parsed), simdjson::SUCCESS) << text;
    const std::string replaced = std::string("a\"b\\c\n\x01\x7f") + "\xef\xbf\xbd\xc3\xa9" +
                                 "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd" + "\xf0\x9f\x98\x80\xef\xbf\xbd\xef\xbf\xbd";
    EXPECT_EQ(std::string_view(parsed[replaced]), replaced);
    EXPECT_TRUE(parsed["inf"].is_null());
    EXPECT_EQ(double(parsed["third"]), 1.0 / 3) << "numbers read back exactly";
    EXPECT_EQ(simdjson::dom::array(parsed["list"]).size(), 2u);
}

}  // namespace
