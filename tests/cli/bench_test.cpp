// `tessera bench`: its workloads are those of the other rasterizers to the bit, and what it reports.
#include "bench/workloads.h"
#include "cli/run_command.h"
#include "cli/workload_meshes.h"
#include "cli/workloads.h"

#include <simdjson.h>

#include <cmath>
#include <set>

namespace tessera::cli {
namespace {

void expect_same_mesh(const Primitive& ours, const wl::Mesh& theirs) {
    ASSERT_EQ(ours.positions.size(), theirs.verts());
    ASSERT_EQ(ours.normals.size(), theirs.verts());
    EXPECT_EQ(ours.indices, theirs.idx);
    for (std::size_t i = 0; i < theirs.verts(); ++i) {
        const float* v = theirs.v.data() + 8 * i;
        ASSERT_EQ(ours.positions[i], (Vec3{v[0], v[1], v[2]})) << i;
        ASSERT_EQ(ours.normals[i], (Vec3{v[3], v[4], v[5]})) << i;
        if (!ours.texcoords.empty()) {
            ASSERT_EQ(ours.texcoords[0][i], (Vec2{v[6], v[7]})) << i;
        }
    }
}

TEST(Workloads, MeshesAreTheirs) {
    expect_same_mesh(sphere_mesh(50), wl::sphere(50));
    expect_same_mesh(terrain_mesh(71), wl::terrain(71));
    expect_same_mesh(soup_mesh(2000, 8, 1920, 1080), wl::soup(2000, 8, 1920, 1080));
}

TEST(Workloads, LayersAreTheirs) {
    for (const bool front_to_back : {true, false}) {
        const Primitive ours = layer_mesh(20, front_to_back);
        const wl::Mesh theirs = wl::quads(20, front_to_back ? 1 : -1, 1920, 1080);
        ASSERT_EQ(ours.positions.size(), theirs.verts());
        EXPECT_EQ(ours.indices, theirs.idx);
        for (std::size_t i = 0; i < theirs.verts(); ++i) {
            const float* v = theirs.v.data() + 8 * i;  // the colour in place of the normal
            EXPECT_EQ(ours.positions[i], (Vec3{v[0], v[1], v[2]}));
            EXPECT_EQ(ours.colors[0][i], (Vec4{v[3], v[4], v[5], 1}));
        }
    }
}

TEST(Workloads, TheTextureIsTheirs) {
    const std::vector<std::uint8_t> theirs = wl::texture();
    const Image plain = workload_texture(false), srgb = workload_texture(true);
    ASSERT_EQ(plain.bytes().size(), theirs.size());
    EXPECT_TRUE(std::equal(theirs.begin(), theirs.end(), plain.data<std::uint8_t>()));
    for (std::size_t i = 0; i < theirs.size(); i += 4 * 331) {  // decodes to nearly the same value
        const double e = srgb.data<std::uint8_t>()[i] / 255.0;
        const double linear = e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
        EXPECT_NEAR(linear, theirs[i] / 255.0, 0.005);
    }
}

void expect_same_camera(const View& ours, const wl::Camera& theirs) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) {
            EXPECT_EQ((*ours.camera_from_world)(r, c), theirs.view[c][r]) << r << " " << c;
            EXPECT_EQ((*ours.clip_from_world)(r, c), theirs.mvp[c][r]) << r << " " << c;
        }
}

// Every float of GLM's lookAt and perspective.
TEST(Workloads, CamerasAreTheirs) {
    for (const auto& [w, h] : {std::pair(1920, 1080), std::pair(640, 480), std::pair(333, 777)}) {
        expect_same_camera(make_workload("sphere10k", w, h).options.view, wl::sphere_camera(w, h));
        expect_same_camera(make_workload("terrain100k", w, h).options.view, wl::terrain_camera(w, h));
        expect_same_camera(make_workload("soup20k", w, h).options.view, wl::soup_camera(w, h));
    }
}

// The peers' fragment shader at a point of the sphere, against the pixel of the reference engine.
TEST(Workloads, ShadingIsThatOfTheirFragmentShader) {
    Workload w = make_workload("sphere10k", 160, 90);
    w.options.engine = Engine::kReferenceRaster;
    w.options.want_linear = w.options.want_depth = true;
    const RenderResult r = render(w.scene, w.options);
    const float tangent = std::tan(3.14159265f / 6);
    int checked = 0;
    for (int y = 10; y < 80; y += 7)
        for (int x = 40; x < 120; x += 7) {
            const std::size_t i = static_cast<std::size_t>(y) * 160 + static_cast<std::size_t>(x);
            const float d = r.depth.data<float>()[i];
            if (std::isinf(d)) continue;
            const Vec3 p{(static_cast<float>(x) + 0.5f - 80) / 45 * tangent * d,
                         (45 - static_cast<float>(y) - 0.5f) / 45 * tangent * d, 2.2f - d};
            const Vec3 n = normalize(p), l = normalize(Vec3{3, 4, 5} - p), v = normalize(Vec3{0, 0, 2.2f} - p);
            const float diffuse = dot(n, l);
            if (diffuse < 0.02f) continue;
            const float specular = std::pow(std::max(dot(n, normalize(l + v)), 0.0f), 32.0f);
            const float* pixel = r.linear.data<float>() + 4 * i;
            EXPECT_NEAR(pixel[0], 0.8f * (0.1f + 0.9f * diffuse) + 0.4f * specular, 0.02f) << x << " " << y;
            EXPECT_NEAR(pixel[1], 0.5f * (0.1f + 0.9f * diffuse) + 0.4f * specular, 0.02f);
            EXPECT_NEAR(pixel[2], 0.3f * (0.1f + 0.9f * diffuse) + 0.4f * specular, 0.02f);
            EXPECT_EQ(r.color.data<std::uint8_t>()[4 * i], static_cast<int>(std::min(pixel[0], 1.0f) * 255.0f + 0.5f));
            ++checked;
        }
    EXPECT_GT(checked, 40);
}

TEST(Workloads, WrongCountsOfPixelsAreNamed) {
    const Workload w = make_workload("sphere10k", 1920, 1080);
    EXPECT_EQ(pixel_fault(w, 714916), "");
    EXPECT_EQ(pixel_fault(w, 714920), "");
    EXPECT_EQ(pixel_fault(w, 714921), "sphere10k: 714916 pixels wanted, 714921 covered");
    EXPECT_NE(pixel_fault(w, 714911), "");
    EXPECT_EQ(pixel_fault(make_workload("sphere10k", 320, 180), 1), "") << "not known at this size";
}

using Bench = CliTest;

simdjson::dom::element parse(simdjson::dom::parser& parser, const std::string& text) {
    simdjson::dom::element json;
    EXPECT_EQ(parser.parse(text).get(json), simdjson::SUCCESS) << text;
    return json;
}

TEST_F(Bench, ReportsAJsonListAndChecksThePixels) {
    const Outcome run = run_command({"bench", "--workload", "quads_f2b", "--workload", "sphere10k", "--workload",
                                     "quads_b2f", "--frames", "1", "--json"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    simdjson::dom::parser parser;
    const simdjson::dom::element json = parse(parser, run.out);
    ASSERT_EQ(simdjson::dom::array(json).size(), 3u);
    EXPECT_EQ(std::string_view(json.at(0)["workload"]), "quads_f2b");
    EXPECT_EQ(std::uint64_t(json.at(0)["pixels_covered"]), 2073600u);
    EXPECT_EQ(std::string_view(json.at(0)["color_hash"]), std::string_view(json.at(2)["color_hash"]))
        << "the nearest layer is seen, whatever the order";
    EXPECT_NEAR(static_cast<double>(std::uint64_t(json.at(1)["pixels_covered"])), 714916, 4);
    for (const simdjson::dom::element m : simdjson::dom::array(json)) {
        EXPECT_GT(double(m["ms_median"]), 0);
        EXPECT_LE(double(m["ms_min"]), double(m["ms_median"]));
        EXPECT_GT(double(m["cpu_ms"]), 0);
    }
}

TEST_F(Bench, EnginesAgreeAndDepthHasAHashOfItsOwn) {
    std::set<std::string> hashes;
    for (const char* engine : {"raster", "reference-raster"}) {
        const Outcome run = run_command({"bench", "--workload", "depth_terrain1m", "--workload", "soup20k", "--frames",
                                         "1", "-s", "320x180", "--engine", engine, "--json"});
        ASSERT_EQ(run.code, 0) << run.err;
        simdjson::dom::parser parser;
        const simdjson::dom::element json = parse(parser, run.out);
        EXPECT_EQ(json.at(0)["color_hash"].error(), simdjson::NO_SUCH_FIELD);
        hashes.insert(std::string(std::string_view(json.at(0)["depth_hash"])) +
                      std::string(std::string_view(json.at(1)["color_hash"])));
    }
    EXPECT_EQ(hashes.size(), 1u);
}

TEST_F(Bench, TheTableNamesWhatRan) {
    const Outcome run = run_command(
        {"bench", "--workload", "sphere10k", "--frames", "1", "-s", "320x180", "--isa", "scalar", "--threads", "1"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.out.find("320x180, engine raster, scalar, 1 thread\n"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("sphere10k"), std::string::npos);
    EXPECT_EQ(run.out.find("sphere1m"), std::string::npos);
}

TEST_F(Bench, WrongArgumentsAreRefusedByName) {
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
        {{"--workload", "cube"}, "--workload: 'cube' is none of sphere1m, "},
        {{"--frames", "0"}, "--frames"},
        {{"--threads", "0"}, "--threads"},
        {{"--engine", "fast"}, "--engine"},
        {{"--isa", "mmx"}, "mmx"},
        {{"--size", "big"}, "--size"},
        {{"extra"}, "extra"},
    };
    for (const auto& [arguments, named] : cases) {
        std::vector<std::string> all{"bench"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const Outcome run = run_command(all);
        EXPECT_EQ(run.code, 2) << named;
        EXPECT_EQ(run.out, "") << named;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_NE(run.err.find(named), std::string::npos) << run.err;
    }
}

}  // namespace
}  // namespace tessera::cli
