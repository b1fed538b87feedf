// The tile rasterizer against the reference rasterizer: the same bytes in every plane, for every
// instruction set and thread count.
#include <tessera/tessera.h>

#include "bench/workloads.h"
#include "load/test_files.h"
#include "reference/workload_scene.h"
#include "render/scenes.h"

#include <gtest/gtest.h>

#include <random>

namespace tessera {
namespace {

using namespace test;

std::vector<Isa> all_isas() {
    std::vector<Isa> isas;
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
        if (isa_supported(isa)) isas.push_back(isa);
    return isas;
}

std::uint64_t differing(const Image& a, const Image& b) {
    if (a.width() != b.width() || a.height() != b.height() || a.format() != b.format()) return ~0ull;
    std::uint64_t count = 0;
    const std::size_t size = bytes_per_pixel(a.format());
    for (std::size_t i = 0; i < a.bytes().size(); i += size)
        count += !std::equal(a.bytes().begin() + static_cast<std::ptrdiff_t>(i),
                             a.bytes().begin() + static_cast<std::ptrdiff_t>(i + size),
                             b.bytes().begin() + static_cast<std::ptrdiff_t>(i));
    return count;
}

void expect_equal(const RenderResult& reference, const RenderResult& r, const std::string& what) {
    EXPECT_EQ(differing(reference.primitive, r.primitive), 0u) << what << ": triangle numbers";
    EXPECT_EQ(differing(reference.depth, r.depth), 0u) << what << ": depth";
    EXPECT_EQ(differing(reference.linear, r.linear), 0u) << what << ": radiance";
    EXPECT_EQ(differing(reference.color, r.color), 0u) << what << ": colour";
    EXPECT_EQ(reference.stats.pixels_covered, r.stats.pixels_covered) << what;
    EXPECT_EQ(reference.stats.fragments_passed, r.stats.fragments_passed) << what;
    EXPECT_EQ(reference.stats.triangles, r.stats.triangles) << what;
    EXPECT_EQ(reference.stats.culled_frustum, r.stats.culled_frustum) << what;
    EXPECT_EQ(reference.stats.culled_backface, r.stats.culled_backface) << what;
    EXPECT_EQ(reference.stats.culled_degenerate, r.stats.culled_degenerate) << what;
    EXPECT_EQ(reference.stats.clipped, r.stats.clipped) << what;
}

RenderOptions all_planes(int width, int height, int samples) {
    RenderOptions o;
    o.width = width;
    o.height = height;
    o.samples = samples;
    o.want_linear = o.want_depth = o.want_primitive = true;
    return o;
}

void expect_exact(const Scene& scene, RenderOptions o, const std::string& name) {
    o.engine = Engine::kReferenceRaster;
    const RenderResult reference = render(scene, o);
    o.engine = Engine::kRaster;
    for (const Isa isa : all_isas()) {
        o.isa = isa;
        o.threads = 1 + static_cast<int>(isa) % 3;
        expect_equal(reference, render(scene, o), name + " " + tessera::name(isa));
    }
}

TEST(RasterExactness, BEY1_EveryModelIsTheReferencesPictureToTheBit) {
    if (all_gltf_models().empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    for (const std::string& file : all_gltf_models()) {
        Scene scene;
        try {
            scene = load_scene(gltf_model(file).string());
        } catch (const Error&) {
            continue;  // needs an extension; the loader's tests say which
        }
        expect_exact(scene, all_planes(256, 192, 1), file);
    }
}

TEST(RasterExactness, BEY1_EverySceneOfOursWithSamplesAndOddSizes) {
    for (const char* name : {"cornell-box", "spheres", "lights", "materials", "hierarchy", "transparency"}) {
        const Scene scene = load_scene(std::string(TESSERA_SOURCE_DIR) + "/scenes/" + name + ".gltf");
        expect_exact(scene, all_planes(201, 131, 1), name);
        expect_exact(scene, all_planes(130, 67, 3), std::string(name) + ", 3 samples");
    }
}

TEST(RasterExactness, BEY1_MeshesOfSmallTriangles) {
    RenderOptions o = all_planes(320, 180, 1);
    o.view = look({0, 0, 2.2f}, {0, 0, 0});
    expect_exact(make_scene(wl::sphere(158)), o, "sphere");
    o.view = look({0, 0.9f, 1.3f}, {0, -0.15f, 0});
    expect_exact(make_scene(wl::terrain(120)), o, "terrain");
    o.view = look({0, 0, 0}, {0, 0, -1});
    expect_exact(make_scene(wl::soup(3000, 8, 320, 180)), o, "soup");
    o.samples = 4;
    expect_exact(make_scene(wl::soup(500, 8, 320, 180)), o, "soup, 4 samples");
}

// Triangles of every size and place around the camera: behind it, through the near plane, beyond the
// guard band, thin ones, and all three alpha modes.
TEST(RasterExactness, RAS2_RandomTrianglesAroundTheCamera) {
    std::mt19937 random(11);
    for (int round = 0; round < 12; ++round) {
        const auto value = [&](float low, float high) {
            return std::uniform_real_distribution<float>(low, high)(random);
        };
        Scene scene;
        for (int m = 0; m < 4; ++m) {
            Material material = m == 3 ? unlit({value(0, 1), value(0, 1), value(0, 1), value(0.2f, 0.9f)})
                                       : lambert({value(0, 1), value(0, 1), value(0, 1)});
            material.alpha_mode = m == 3 ? AlphaMode::kBlend : m == 2 ? AlphaMode::kMask : AlphaMode::kOpaque;
            material.double_sided = m != 0;
            scene.materials.push_back(material);
            Primitive p;
            for (int i = 0; i < 3 * 120; ++i) {
                const float scale = i % 9 < 3 ? 0.05f : i % 9 < 6 ? 1.0f : 60.0f;
                const Vec3 centre =
                    i % 3 == 0 ? Vec3{value(-3, 3), value(-3, 3), value(-6, 3)} : cartesian(point(p.positions.back()));
                p.positions.push_back(centre + Vec3{value(-scale, scale), value(-scale, scale), value(-scale, scale)});
                p.normals.push_back(normalize(Vec3{value(-1, 1), value(-1, 1), value(-1, 1)}));
            }
            if (m == 2) {
                p.colors.emplace_back();
                for (std::size_t i = 0; i < p.positions.size(); ++i) p.colors[0].push_back({1, 1, 1, value(0, 1)});
            }
            p.material = m;
            add_mesh(scene, p);
            scene.nodes.back().scale = {m == 1 ? -1.0f : 1.0f, 1, 1};  // one mirrored instance
        }
        RenderOptions o = all_planes(150 + round, 100 + 7 * round, 1 + round % 3);
        o.view = look({0, 0, 1}, {0, 0, -1});
        expect_exact(scene, o, "round " + std::to_string(round));
    }
}

TEST(RasterExactness, CARD3_ThreadsAndRepetitionChangeNothing) {
    const Scene scene = load_scene(std::string(TESSERA_SOURCE_DIR) + "/scenes/transparency.gltf");
    RenderOptions o = all_planes(192, 144, 2);
    o.engine = Engine::kRaster;
    const RenderResult first = render(scene, o);
    for (int i = 0; i < 25; ++i) {
        o.threads = 1 + i % 8;
        expect_equal(first, render(scene, o), "run " + std::to_string(i));
    }
}

TEST(RasterExactness, CancellingAndTheFragmentLimitReachTheCaller) {
    Scene scene;
    Material glass = unlit({1, 1, 1, 0.5f});
    glass.alpha_mode = AlphaMode::kBlend;
    const int m = add_material(scene, glass);
    for (int i = 0; i < 40; ++i) add_mesh(scene, rectangle(1, 1, static_cast<float>(i) * 0.1f, m));
    add_orthographic(scene);
    RenderOptions o = small(128, 128);
    o.engine = Engine::kRaster;
    o.max_bytes = 128 * 128 * 30;
    EXPECT_THROW(render(scene, o), Error);
    o.max_bytes = std::uint64_t{1} << 30;
    EXPECT_NO_THROW(render(scene, o));
    o.cancel = [] { return true; };
    EXPECT_THROW(render(scene, o), Error);
}

}  // namespace
}  // namespace tessera
