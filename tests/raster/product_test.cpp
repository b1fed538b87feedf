// BEY1: the exactness product: scenes x instruction sets x threads x tiles x hierarchical Z x samples, every
// plane of the tile rasterizer by memcmp against the reference's. All pairs of two factors by default; the
// full product where the environment says TESSERA_FULL_EXACTNESS=1.
#include "raster/all_pairs.h"
#include "raster/exactness.h"

#include "cli/workload_meshes.h"
#include "load/test_files.h"

#include <cstdlib>
#include <map>

namespace tessera {
namespace {

using namespace test;

constexpr int kThreads[] = {1, 2, 3, 8};
constexpr int kTiles[] = {32, 64, 128};
constexpr int kSamples[] = {1, 3};
// Not all planes take the same way through a tile.
enum Planes { kAll, kColorOnly, kLabelsOnly };
enum Factor : std::size_t { kScene, kIsa, kThread, kTile, kHierarchicalZ, kSample, kPlanes, kCounting };

struct Subject {
    std::string name;
    Scene scene;
    RenderOptions options;
};

void run_product(const std::vector<Subject>& subjects) {
    const char* const full = std::getenv("TESSERA_FULL_EXACTNESS");
    const std::vector<Isa> isas = all_isas();
    const std::vector<int> sizes{static_cast<int>(subjects.size()), static_cast<int>(isas.size()), 4, 3, 2, 2, 3, 2};
    // By scene and number of samples, so that each reference is made once.
    std::map<std::pair<int, int>, std::vector<std::vector<int>>> rows;
    for (const std::vector<int>& row : full&& std::string(full) == "1" ? full_product(sizes) : all_pairs(sizes))
        rows[{row[kScene], row[kSample]}].push_back(row);
    for (const auto& [key, combinations] : rows) {
        const Subject& s = subjects[static_cast<std::size_t>(key.first)];
        RenderOptions o = s.options;
        o.samples = kSamples[key.second];
        o.engine = Engine::kReferenceRaster;
        const RenderResult reference = render(s.scene, o);
        o.engine = Engine::kRaster;
        for (const std::vector<int>& c : combinations) {
            const auto value = [&](Factor f) { return static_cast<std::size_t>(c[f]); };
            o.isa = isas[value(kIsa)];
            o.threads = kThreads[value(kThread)];
            o.raster.tile_side = kTiles[value(kTile)];
            o.raster.hierarchical_z = value(kHierarchicalZ) == 0;
            const auto planes = static_cast<Planes>(c[kPlanes]);
            o.raster.count_samples = value(kCounting) == 0;  // the code without it is another
            o.want_linear = o.want_alpha = planes == kAll;
            o.want_color = planes != kLabelsOnly;
            want_labels(o, planes != kColorOnly);
            std::string what = s.name;
            what += std::string(", ") + name(o.isa);
            for (const int v : {o.samples, o.threads, o.raster.tile_side, int{o.raster.hierarchical_z}, int{planes},
                                int{o.raster.count_samples}})
                what += ", " + std::to_string(v);
            const RenderResult r = render(s.scene, o);
            EXPECT_EQ(r.linear.width() > 0, o.want_linear) << what;
            EXPECT_EQ(r.color.width() > 0, o.want_color) << what;
            EXPECT_EQ(r.depth.width() > 0 && r.primitive.width() > 0, o.want_depth) << what;
            expect_equal(reference, r, what);
            if (planes != kLabelsOnly && reference.stats.fragments_passed > 0) {
                EXPECT_EQ(r.stats.samples_tested > 0, o.raster.count_samples) << what;
            }
        }
    }
}

TEST(ExactnessProduct, BEY1_EveryModel) {
    if (all_gltf_models().empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    std::vector<Subject> subjects;
    for (const std::string& file : all_gltf_models()) {
        try {
            subjects.push_back({file, load_scene(gltf_model(file).string()), all_planes(256, 192, 1)});
        } catch (const Error&) {
            // It needs an extension; the loader's tests say which.
        }
    }
    ASSERT_GT(subjects.size(), 30u);
    run_product(subjects);
}

TEST(ExactnessProduct, BEY1_EverySceneOfOursAtOddSizes) {
    std::vector<Subject> subjects;
    int odd = 0;
    for (const char* name : {"cornell-box", "spheres", "lights", "materials", "hierarchy", "transparency"}) {
        std::string file = TESSERA_SOURCE_DIR;
        file.append("/scenes/").append(name).append(".gltf");
        subjects.push_back({name, load_scene(file), all_planes(201 + 17 * odd, 131 - 9 * odd, 1)});
        ++odd;
    }
    run_product(subjects);
}

Subject mesh_subject(const char* name, Primitive mesh, const View& view) {
    Subject s{name, {}, all_planes(256, 144, 1)};
    add_mesh(s.scene, std::move(mesh));
    s.options.view = view;
    return s;
}

// Small triangles, many to a pixel and a few pixels each; and clipped ones of every kind.
TEST(ExactnessProduct, BEY1_RAS2_MeshesAndTrianglesAroundTheCamera) {
    std::vector<Subject> subjects;
    subjects.push_back(mesh_subject("sphere", cli::sphere_mesh(110), look_from({0, 0, 2.2f}, {0, 0, 0})));
    subjects.push_back(mesh_subject("terrain", cli::terrain_mesh(90), look_from({0, 0.9f, 1.3f}, {0, -0.15f, 0})));
    subjects.push_back(mesh_subject("soup", cli::soup_mesh(3000, 8, 256, 144), look_from({0, 0, 0}, {0, 0, -1})));
    for (unsigned seed = 1; seed < 4; ++seed) {
        subjects.push_back({"round " + std::to_string(seed), triangles_around_the_camera(seed),
                            all_planes(150 + static_cast<int>(seed), 100 + 7 * static_cast<int>(seed), 1)});
        subjects.back().options.view = look_from({0, 0, 1}, {0, 0, -1});
    }
    run_product(subjects);
}

// Textures of what is mirrored, by every model that has them, with one and with two sets of texture coordinates.
TEST(ExactnessProduct, BEY1_LIT4_TexturesOfWhatIsMirrored) {
    Image noise(32, 32, PixelFormat::kRgba8);
    std::uint32_t random = 7;
    for (std::size_t i = 0; i < noise.bytes().size(); ++i) {
        random = random * 1664525u + 1013904223u;
        noise.data<std::uint8_t>()[i] = static_cast<std::uint8_t>(random >> 24);
    }
    std::vector<Subject> subjects;
    for (const ShadingModel model : {ShadingModel::kMetallicRoughness, ShadingModel::kSpecularGlossiness,
                                     ShadingModel::kPhong, ShadingModel::kBlinnPhong})
        for (int textures = 1; textures < 4; ++textures) {
            Subject s{"mirrors " + std::to_string(static_cast<int>(model)), {}, all_planes(160, 96, 1)};
            s.scene.pictures.push_back({"noise", "", std::make_shared<const Image>(noise), ""});
            s.scene.textures.push_back({"", 0, kNone, ""});
            Material m;
            m.model = model;
            m.base_color = {0.7f, 0.4f, 0.3f, 1};
            m.metallic = 0.25f, m.roughness = 0.3f;
            m.specular_color = {0.9f, 0.8f, 0.7f};
            m.specular = {0.6f, 0.5f, 0.4f};
            m.shininess = 40;
            if (textures & 1) m.texture(TextureSlot::kSpecularColor).texture = 0;
            if (textures & 2)
                m.texture(TextureSlot::kSpecular) = {0, textures == 3 ? 1 : 0, {0.1f, 0.2f}, {3, 2}, 0.4f};
            Primitive ball = cli::sphere_mesh(24);
            ball.material = add_material(s.scene, m);
            ball.texcoords = {{}, {}};
            for (const Vec3& p : ball.positions) {
                ball.texcoords[0].push_back({2 * p.x, 2 * p.y});
                ball.texcoords[1].push_back({p.y + p.z, p.x});
            }
            add_mesh(s.scene, std::move(ball));
            s.options.view = look_from({0, 0, 2.2f}, {0, 0, 0});
            subjects.push_back(std::move(s));
        }
    run_product(subjects);
}

}  // namespace
}  // namespace tessera
