// BEY2, FB2: `--aov` and what goes with it, from the command line to the files: their numbers are those of the library.
#include "cli/run_command.h"

#include <tessera/image_files.h>
#include <tessera/load.h>
#include <tessera/planes.h>
#include <tessera/render.h>

#include <simdjson.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>

namespace {

using Strings = std::vector<std::string>;
using tessera::Image;

Strings operator+(Strings a, const Strings& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

class CliPlanes : public CliTest {
  protected:
    Outcome render(const std::string& name, const Strings& more) const {
        return run_command(Strings{"render", scene(name), "-s", "64x48", "--samples", "1"} + more);
    }
    // What the library says of the same picture.
    static tessera::RenderResult truth(const std::string& name) {
        tessera::RenderOptions o;
        o.width = 64, o.height = 48, o.samples = 1;
        o.want_linear = o.want_alpha = o.want_depth = o.want_primitive = o.want_node = o.want_material = true;
        o.want_normal = o.want_shading_normal = o.want_uv = o.want_position = o.want_albedo = o.want_motion = true;
        return tessera::render(tessera::load_scene(scene(name)), o);
    }
    void refused(const Strings& more, const std::string& part) const {
        const Outcome run = render("spheres.gltf", more);
        EXPECT_EQ(run.code, 2) << part;
        EXPECT_EQ(run.error_lines(), 1);
        EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
        EXPECT_TRUE(folder_contents().empty());
    }
    void expect_plane(const std::string& file, const Image& plane) const {
        const tessera::NpyArray array = tessera::read_npy(in_folder(file));
        EXPECT_EQ(array.width, 64);
        EXPECT_EQ(array.height, 48);
        ASSERT_EQ(array.values.size(), plane.bytes().size()) << file;
        EXPECT_EQ(std::memcmp(array.values.data(), plane.bytes().data(), array.values.size()), 0) << file;
    }
};

TEST_F(CliPlanes, BEY2_ArraysHoldEveryPlane) {
    const std::string all =
        "color,alpha,depth,normal,shading-normal,uv,position,albedo,node,material,primitive,motion,motion-seen";
    const Outcome run = render("materials.gltf", {"-o", in_folder("m_{aov}.npy"), "--aov", all});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(folder_contents().size(), 13u);
    const tessera::RenderResult r = truth("materials.gltf");
    expect_plane("m_color.npy", r.color);
    expect_plane("m_alpha.npy", r.alpha);
    expect_plane("m_depth.npy", r.depth);
    expect_plane("m_normal.npy", r.normal);
    expect_plane("m_shading-normal.npy", r.shading_normal);
    expect_plane("m_uv.npy", r.uv);
    expect_plane("m_position.npy", r.position);
    expect_plane("m_albedo.npy", r.albedo);
    expect_plane("m_node.npy", r.node);
    expect_plane("m_material.npy", r.material);
    expect_plane("m_primitive.npy", r.primitive);
    expect_plane("m_motion.npy", r.motion);
    expect_plane("m_motion-seen.npy", r.motion_seen);
}

TEST_F(CliPlanes, BEY2_OneExrHasAllChannelsByName) {
    if (!tessera::has_image_module()) GTEST_SKIP() << "built without the OpenImageIO module";
    const Outcome run = render("materials.gltf", {"-o", in_folder("m.exr"), "--aov", "color,depth,normal,node,motion"});
    ASSERT_EQ(run.code, 0) << run.err;
    const tessera::RenderResult r = truth("materials.gltf");
    std::map<std::string, Image> channels;
    for (tessera::ImagePlane& plane : tessera::read_exr_channels(in_folder("m.exr")))
        channels[plane.name] = std::move(plane.pixels);
    EXPECT_EQ(channels.size(), 4u + 1 + 3 + 1 + 4);
    for (std::size_t i = 0; i < 64 * 48; ++i) {
        EXPECT_EQ(channels.at("depth.Z").data<float>()[i], r.depth.data<float>()[i]);
        EXPECT_EQ(channels.at("normal.Y").data<float>()[i], r.normal.data<float>()[3 * i + 1]);
        EXPECT_EQ(channels.at("node.ID").data<std::uint32_t>()[i], r.node.data<std::uint32_t>()[i]);
        EXPECT_EQ(channels.at("backward.X").data<float>()[i], 0.0f);
        const float g = r.linear.data<float>()[4 * i + 1];
        EXPECT_NEAR(channels.at("G").data<float>()[i], g, std::fabs(g) / 2048 + 1e-7f);  // halves
    }
}

TEST_F(CliPlanes, BEY2_PngHoldsIdsExactlyAndDepthInSteps) {
    ASSERT_EQ(render("materials.gltf", {"-o", in_folder("{aov}.png"), "--aov",
                                        "depth,node,primitive,normal,albedo,uv,alpha", "--depth-scale", "500"})
                  .code,
              0);
    const tessera::RenderResult r = truth("materials.gltf");
    const auto bytes = [&](const char* name) { return read_file(in_folder(name)); };
    const auto ids = [&](const char* name) {
        const std::string file = bytes(name);
        return tessera::decode_id_png(std::as_bytes(std::span(file)));
    };
    const Image node = ids("node.png"), primitive = ids("primitive.png");
    EXPECT_EQ(std::memcmp(node.bytes().data(), r.node.bytes().data(), node.bytes().size()), 0);
    EXPECT_EQ(std::memcmp(primitive.bytes().data(), r.primitive.bytes().data(), primitive.bytes().size()), 0);
    const Image depth = tessera::read_image(in_folder("depth.png"), 1 << 20, true),
                normal = tessera::read_image(in_folder("normal.png"), 1 << 20, true);
    ASSERT_EQ(depth.format(), tessera::PixelFormat::kRgba16);
    for (std::size_t i = 0; i < 64 * 48; ++i) {
        const float d = r.depth.data<float>()[i];
        const std::uint16_t code = depth.data<std::uint16_t>()[4 * i];
        if (std::isinf(d)) {
            EXPECT_EQ(code, 0);
            EXPECT_EQ(normal.data<std::uint16_t>()[4 * i], 0);
            continue;
        }
        EXPECT_NEAR(code, d * 500, 0.51);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(normal.data<std::uint16_t>()[4 * i + c], (r.normal.data<float>()[3 * i + c] + 1) * 32767.5, 1);
    }
}

TEST_F(CliPlanes, FB2_ColormapsAndPalettesArePalettePictures) {
    ASSERT_EQ(
        render("spheres.gltf", {"-o", in_folder("d.png"), "--aov", "depth", "--colormap", "viridis", "--range", "2,12"})
            .code,
        0);
    ASSERT_EQ(render("spheres.gltf", {"-o", in_folder("n.png"), "--aov", "node", "--colormap", "ids"}).code, 0);
    ASSERT_EQ(render("spheres.gltf", {"-o", in_folder("p.png"), "--palette", "16", "--dither"}).code, 0);
    const auto color_type = [&](const char* name) { return static_cast<int>(read_file(in_folder(name)).at(25)); };
    EXPECT_EQ(color_type("d.png"), 3);
    EXPECT_EQ(color_type("p.png"), 3);
    std::set<std::uint32_t> colors;
    const Image p = tessera::read_image(in_folder("p.png"));
    for (std::size_t i = 0; i < 64 * 48; ++i) colors.insert(p.data<std::uint32_t>()[i]);
    EXPECT_LE(colors.size(), 16u);
    EXPECT_GE(colors.size(), 8u);
    tessera::RenderOptions o;
    o.width = 64, o.height = 48, o.samples = 1, o.want_color = false, o.want_depth = true;
    const Image expected = tessera::apply_colormap(tessera::render(tessera::load_scene(scene("spheres.gltf")), o).depth,
                                                   tessera::Colormap::kViridis, tessera::ValueRange{2, 12});
    const Image d = tessera::read_image(in_folder("d.png"));
    std::size_t different = 0;
    for (std::size_t i = 0; i < 64 * 48; ++i) {
        if (expected.data<std::uint8_t>()[4 * i + 3] == 0)
            EXPECT_EQ(d.data<std::uint8_t>()[4 * i + 3], 0);
        else  // an entry is spent on what is infinite
            for (std::size_t c = 0; c < 3; ++c)
                different += std::abs(d.data<std::uint8_t>()[4 * i + c] - expected.data<std::uint8_t>()[4 * i + c]) > 6;
    }
    EXPECT_EQ(different, 0u);
}

// A colormap is for the planes of one number; the others are written as ever. Alpha is filtered as the picture is.
TEST_F(CliPlanes, FB2_ColormapsLeaveOtherPlanesAlone) {
    const Outcome run =
        render("spheres.gltf", {"-o", in_folder("{aov}.png"), "--aov", "depth,normal", "--colormap", "magma"});
    ASSERT_EQ(run.code, 0) << run.err;
    ASSERT_EQ(render("spheres.gltf", {"-o", in_folder("n.png"), "--aov", "normal"}).code, 0);
    EXPECT_EQ(read_file(in_folder("normal.png")), read_file(in_folder("n.png")));
    ASSERT_EQ(render("spheres.gltf", {"-o", in_folder("alone.npy"), "--aov", "alpha", "--filter", "gaussian"}).code, 0);
    ASSERT_EQ(
        render("spheres.gltf", {"-o", in_folder("both_{aov}.npy"), "--aov", "alpha,color", "--filter", "gaussian"})
            .code,
        0);
    EXPECT_EQ(read_file(in_folder("alone.npy")), read_file(in_folder("both_alpha.npy")));
}

// What would be two files of one name, and what has no place in a video.
TEST_F(CliPlanes, NamesAreCheckedBeforeAnythingIsDrawn) {
    std::string cameras = R"({"cameras": [)";
    for (int i = 0; i < 12; ++i)
        cameras.append(i == 0 ? "" : ",").append(R"({"camera_to_world": [[1,0,0,0],[0,-1,0,1],[0,0,-1,6]]})");
    std::ofstream(in_folder("c.json")) << cameras << "]}";
    const Outcome run =
        run_command({"render", scene("motion.gltf"), "-s", "8x8", "-o", in_folder("{camera}{frame}.png"), "--poses",
                     in_folder("c.json"), "--frames", "0-11"});
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.err.find("would be written twice"), std::string::npos) << run.err;
    const Outcome video = render("spheres.gltf", {"-o", in_folder("{camera}.mp4"), "--poses", in_folder("c.json")});
    EXPECT_EQ(video.code, 2) << video.err;
    EXPECT_EQ(folder_contents(), Strings{"c.json"});
}

TEST_F(CliPlanes, BEY2_MotionOfWhatStandsIsSaidSo) {
    const Outcome run = render("spheres.gltf", {"-o", in_folder("m.npy"), "--aov", "motion"});
    EXPECT_EQ(run.code, 0);
    EXPECT_NE(run.err.find("nothing moves"), std::string::npos) << run.err;
}

TEST_F(CliPlanes, OtherEndings) {
    for (const char* name : {"a.webp", "a.hdr", "a.tif", "a.exr"}) {
        const bool module = std::strcmp(name, "a.tif") == 0 || std::strcmp(name, "a.exr") == 0;
        if (module && !tessera::has_image_module()) continue;
        const Outcome run = render("spheres.gltf", {"-o", in_folder(name)});
        EXPECT_EQ(run.code, 0) << run.err;
        tessera::DecodeOptions options;
        options.keep_float = true;
        const Image image = tessera::read_image(in_folder(name), options);
        EXPECT_EQ(image.width(), 64) << name;
        const bool linear = std::strcmp(name, "a.hdr") == 0 || std::strcmp(name, "a.exr") == 0;
        EXPECT_EQ(image.format(), linear ? tessera::PixelFormat::kRgba32f : tessera::PixelFormat::kRgba8) << name;
    }
}

TEST_F(CliPlanes, WhatCannotBeWrittenIsRefusedByName) {
    refused({"-o", in_folder("a.png"), "--aov", "depth,normal"}, "--output: several planes need {aov}");
    refused({"-o", in_folder("a.png"), "--aov", "dept"}, "--aov: 'dept' is none of color, alpha");
    refused({"-o", in_folder("a.npy"), "--aov", "depth,depth"}, "depth is there twice");
    refused({"-o", in_folder("a.png"), "--aov", "position"}, "position cannot be written as .png");
    refused({"-o", in_folder("a.png"), "--aov", "motion"}, "motion cannot be written as .png");
    refused({"-o", in_folder("a.jpg"), "--aov", "node"}, "node cannot be written as .jpg");
    refused({"-o", in_folder("a.hdr"), "--aov", "normal"}, "normal cannot be written as .hdr");
    refused({"-o", in_folder("a.foo")}, "--output: ");
    refused({"-o", in_folder("a.png"), "--colormap", "magma"}, "--colormap: needs a plane of numbers");
    refused({"-o", in_folder("a.png"), "--aov", "depth", "--colormap", "jet"}, "--colormap: 'jet' is none of");
    refused({"-o", in_folder("a.png"), "--aov", "depth", "--colormap", "ids"}, "--colormap: ids is for whole numbers");
    refused({"-o", in_folder("a.npy"), "--aov", "depth", "--colormap", "magma"}, "--colormap: makes pictures");
    refused({"-o", in_folder("a.png"), "--aov", "depth", "--colormap", "magma", "--range", "3,1"},
            "--range: must rise");
    refused({"-o", in_folder("a.png"), "--range", "0,1"}, "--range: needs a --colormap");
    refused({"-o", in_folder("a.png"), "--dither"}, "--dither: needs --palette");
    refused({"-o", in_folder("a.jpg"), "--palette", "8"}, "--palette: is for .png");
    refused({"-o", in_folder("a.png"), "--intrinsics", "1,2,3"}, "--intrinsics: '1,2,3' is not FX,FY,CX,CY");
    refused({"-o", in_folder("a.png"), "--intrinsics", "0,2,3,4"}, "--intrinsics: 0 is outside");
    refused({"-o", in_folder("a.png"), "--intrinsics", "9,9,3,4", "--fov", "20"}, "--intrinsics: excludes --fov");
    refused({"-o", in_folder("a.png"), "--space", "sky"}, "--space: 'sky' is none of");
    refused({"-o", in_folder("a.png"), "--depth", "long"}, "--depth: 'long' is none of");
    refused({"-o", in_folder("a_{b}.png")}, "{b} is no place to fill in");
    refused({"-o", in_folder("a.mp4"), "--turntable", "3", "--aov", "depth"}, "--aov: a video shows color");
    refused({"-o", in_folder("a.exr"), "--color-bits", "3-3-2"}, "--color-bits: is for pictures of 8 bits");
    refused({"-o", in_folder("a.exr"), "--background", "red"}, "--background: is for pictures of 8 bits");
    refused({"-o", in_folder("a.hdr"), "--tone-map", "aces"}, "--tone-map: is for pictures of 8 bits");
    refused({"-o", in_folder("a.png"), "--depth", "euclidean"}, "--depth: needs --aov depth");
    refused({"-o", in_folder("a.png"), "--space", "camera"}, "--space: needs --aov normal");
    refused({"-o", in_folder("a.npy"), "--aov", "depth", "--depth-scale", "10"}, "--depth-scale: is for");
    refused({"-o", in_folder("a.png"), "--intrinsics", "1e9,9,3,4"}, "intrinsics must be");
}

// Cameras of a file: one picture each, and each that of its matrix.
TEST_F(CliPlanes, BEY2_PosesGiveAPictureEach) {
    std::ofstream(in_folder("cameras.json")) << R"({"intrinsics": [60, 60, 31.5, 23.5], "cameras": [
            {"name": "front", "camera_to_world": [[1,0,0,0],[0,-1,0,1],[0,0,-1,6],[0,0,0,1]]},
            {"name": "a/b", "camera_to_world": [[0,0,-1,6],[0,-1,0,1],[-1,0,0,0],[0,0,0,1]]}]})";
    const Strings poses{"--poses", in_folder("cameras.json")};
    const Outcome run =
        render("spheres.gltf", Strings{"-o", in_folder("{camera}_{aov}.npy"), "--aov", "depth,motion"} + poses);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(folder_contents(),
              (Strings{"a_b_depth.npy", "a_b_motion.npy", "cameras.json", "front_depth.npy", "front_motion.npy"}));
    tessera::RenderOptions o;
    o.width = 64, o.height = 48, o.samples = 1, o.want_color = false, o.want_depth = o.want_motion = true;
    o.view.intrinsics = tessera::Intrinsics{60, 60, 31.5, 23.5};
    o.view.camera_to_world = tessera::Mat4{{0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 6, 1, 0, 1}};
    tessera::View front = o.view;
    front.camera_to_world = tessera::Mat4{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 6, 1}};
    o.motion_before = tessera::Shot{front, {}};  // the one before it in the list
    const tessera::RenderResult r = tessera::render(tessera::load_scene(scene("spheres.gltf")), o);
    expect_plane("a_b_depth.npy", r.depth);
    expect_plane("a_b_motion.npy", r.motion);
    // Resumed: what is there stays.
    std::filesystem::remove(in_folder("a_b_depth.npy"));
    std::ofstream(in_folder("front_depth.npy")) << "kept";
    ASSERT_EQ(render("spheres.gltf",
                     Strings{"-o", in_folder("{camera}_{aov}.npy"), "--aov", "depth,motion", "--skip-existing"} + poses)
                  .code,
              0);
    expect_plane("a_b_depth.npy", r.depth);
    EXPECT_EQ(read_file(in_folder("front_depth.npy")), "kept");
    EXPECT_EQ(render("spheres.gltf", Strings{"-o", in_folder("x.npy"), "--aov", "depth"} + poses).code, 2);
    EXPECT_EQ(render("spheres.gltf", Strings{"-o", in_folder("{camera}.png"), "--eye", "1,2,3"} + poses).code, 2);
    std::ofstream(in_folder("cameras.json")) << "{";
    EXPECT_EQ(render("spheres.gltf", Strings{"-o", in_folder("{camera}.png")} + poses).code, 4);
}

// Positions are told in the file's own axes, whichever way it is up.
TEST_F(CliPlanes, BEY2_LabelsSpeakOfTheFilesAxes) {
    std::ofstream(in_folder("t.stl")) << "solid t\nfacet normal 0 0 1\nouter loop\nvertex -1 -1 2\nvertex 1 -1 2\n"
                                         "vertex 0 1 2\nendloop\nendfacet\nendsolid t\n";
    const Outcome run = run_command({"render", in_folder("t.stl"), "--up", "z", "--eye", "0,0,9", "--target", "0,0,0",
                                     "-s", "32x32", "-o", in_folder("{aov}.npy"), "--aov", "position,normal"});
    ASSERT_EQ(run.code, 0) << run.err;
    const tessera::NpyArray position = tessera::read_npy(in_folder("position.npy")),
                            normal = tessera::read_npy(in_folder("normal.npy"));
    const auto* p = reinterpret_cast<const float*>(position.values.data()) + 3 * (16 * 32 + 16);
    const auto* n = reinterpret_cast<const float*>(normal.values.data()) + 3 * (16 * 32 + 16);
    EXPECT_NEAR(p[2], 2, 1e-4);
    EXPECT_NEAR(n[2], 1, 1e-5);
}

TEST_F(CliPlanes, StatisticsHaveTheHashesOfThePlanes) {
    const Outcome run = render("spheres.gltf", {"--stats", "-", "--aov", "depth,node"});
    ASSERT_EQ(run.code, 0) << run.err;
    simdjson::dom::parser parser;
    const simdjson::dom::element json = parser.parse(run.out);
    const tessera::RenderResult r = truth("spheres.gltf");
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(tessera::hash_pixels(r.depth)));
    EXPECT_EQ(std::string_view(json["plane_hashes"]["depth"]), text);
    EXPECT_EQ(std::int64_t(json["width"]), 64);
    EXPECT_TRUE(json["plane_hashes"]["uv"].error() != simdjson::SUCCESS);
}

}  // namespace
