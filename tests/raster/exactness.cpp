#include "raster/exactness.h"

#include "simd/isa.h"

#include <algorithm>
#include <cstring>
#include <random>

namespace tessera::test {

std::vector<Isa> all_isas() {
    std::vector<Isa> isas;
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
        if (isa_supported(isa)) isas.push_back(isa);
    return isas;
}

std::uint64_t differing(const Image& a, const Image& b) {
    if (a.width() != b.width() || a.height() != b.height() || a.format() != b.format()) return ~0ull;
    if (std::memcmp(a.bytes().data(), b.bytes().data(), a.bytes().size()) == 0) return 0;
    std::uint64_t count = 0;
    const std::size_t size = bytes_per_pixel(a.format());
    for (std::size_t i = 0; i < a.bytes().size(); i += size)
        count += std::memcmp(a.bytes().data() + i, b.bytes().data() + i, size) != 0;
    return count;
}

void expect_equal_planes(const RenderResult& reference, const RenderResult& r, const std::string& what) {
    const auto compare = [&](const Image& a, const Image& b, const char* plane) {
        if (b.width() > 0) {
            EXPECT_EQ(differing(a, b), 0u) << what << ": " << plane;
        }
    };
    compare(reference.primitive, r.primitive, "triangle numbers");
    compare(reference.depth, r.depth, "depth");
    compare(reference.linear, r.linear, "radiance");
    compare(reference.color, r.color, "colour");
    compare(reference.alpha, r.alpha, "alpha");
    compare(reference.node, r.node, "nodes");
    compare(reference.material, r.material, "materials");
    compare(reference.normal, r.normal, "normals");
    compare(reference.shading_normal, r.shading_normal, "normals of shading");
    compare(reference.uv, r.uv, "texture coordinates");
    compare(reference.position, r.position, "positions");
    compare(reference.albedo, r.albedo, "albedo");
    compare(reference.motion, r.motion, "motion");
    compare(reference.motion_seen, r.motion_seen, "what is seen of motion");
}

void expect_equal(const RenderResult& reference, const RenderResult& r, const std::string& what) {
    expect_equal_planes(reference, r, what);
    const RenderStats &a = reference.stats, &b = r.stats;
    EXPECT_EQ(a.triangles, b.triangles) << what;
    EXPECT_EQ(a.culled_frustum, b.culled_frustum) << what;
    EXPECT_EQ(a.culled_backface, b.culled_backface) << what;
    EXPECT_EQ(a.culled_degenerate, b.culled_degenerate) << what;
    EXPECT_EQ(a.clipped, b.clipped) << what;
    EXPECT_EQ(a.exposure, b.exposure) << what;
    if (r.color.width() == 0 && r.linear.width() == 0) return;  // the counts are those of the labels
    EXPECT_EQ(a.pixels_covered, b.pixels_covered) << what;
    if (b.samples_tested > 0) {  // they were counted
        EXPECT_EQ(a.fragments_passed, b.fragments_passed) << what;
    }
}

void want_labels(RenderOptions& o, bool wanted) {
    o.want_depth = o.want_primitive = o.want_node = o.want_material = wanted;
    o.want_normal = o.want_shading_normal = o.want_uv = o.want_position = o.want_albedo = wanted;
}

RenderOptions all_planes(int width, int height, int samples) {
    RenderOptions o;
    o.width = width;
    o.height = height;
    o.samples = samples;
    o.want_linear = o.want_alpha = true;
    want_labels(o, true);
    return o;
}

void expect_exact(const Scene& scene, RenderOptions o, const std::string& what) {
    o.engine = Engine::kReferenceRaster;
    const RenderResult reference = render(scene, o);
    o.engine = Engine::kRaster;
    int turn = 0;
    for (const Isa isa : all_isas()) {
        o.isa = isa;
        o.threads = 1 + turn % 3;
        if (o.raster.tile_side != 64) o.raster.tile_side = 32 << turn % 3;
        o.raster.hierarchical_z = turn % 2 == 0;
        ++turn;
        expect_equal(reference, render(scene, o), what + ", " + name(isa));
    }
}

Scene reversed(Scene scene) {
    std::reverse(scene.scenes[0].nodes.begin(), scene.scenes[0].nodes.end());
    for (Mesh& mesh : scene.meshes)
        for (Primitive& p : mesh.primitives) {
            if (p.indices.empty())
                for (std::uint32_t i = 0; i < p.positions.size(); ++i) p.indices.push_back(i);
            std::reverse(p.indices.begin(), p.indices.end());
            // Each triangle keeps its own order.
            for (std::size_t i = 0; i < p.indices.size(); i += 3) std::swap(p.indices[i], p.indices[i + 2]);
        }
    return scene;
}

Scene triangles_around_the_camera(unsigned seed) {
    std::mt19937 random(seed);
    const auto value = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
    const auto box = [&](float x, float y, float z_low, float z_high) {
        const float a = value(-x, x), b = value(-y, y);
        return Vec3{a, b, value(z_low, z_high)};
    };
    Scene scene;
    for (int m = 0; m < 4; ++m) {
        const Vec3 tint = box(0.5f, 0.5f, 0, 1) + Vec3{0.5f, 0.5f, 0};
        Material material = m == 3 ? unlit({tint.x, tint.y, tint.z, value(0.2f, 0.9f)}) : lambert(tint);
        material.alpha_mode = m == 3 ? AlphaMode::kBlend : m == 2 ? AlphaMode::kMask : AlphaMode::kOpaque;
        material.double_sided = m != 0;
        scene.materials.push_back(material);
        Primitive p;
        Vec3 centre;
        for (int i = 0; i < 3 * 120; ++i) {
            const float scale = i % 9 < 3 ? 0.05f : i % 9 < 6 ? 1.0f : 60.0f;
            if (i % 3 == 0) centre = box(3, 3, -6, 3);
            p.positions.push_back(centre + box(scale, scale, -scale, scale));
            p.normals.push_back(normalize(box(1, 1, -1, 1)));
            centre = p.positions.back();
        }
        if (m == 2) {
            p.colors.emplace_back();
            for (std::size_t i = 0; i < p.positions.size(); ++i) p.colors[0].push_back({1, 1, 1, value(0, 1)});
        }
        p.material = m;
        add_mesh(scene, p);
        scene.nodes.back().scale = {m == 1 ? -1.0f : 1.0f, 1, 1};
    }
    return scene;
}

Primitive level_grid(int n, float side, float z, int material) {
    Primitive p;
    const float step = 2 * side / static_cast<float>(n);
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) {
            p.positions.push_back({-side + step * static_cast<float>(x), -side + step * static_cast<float>(y), z});
            p.normals.push_back({0, 0, 1});
        }
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const auto a = static_cast<std::uint32_t>(y * (n + 1) + x), c = a + static_cast<std::uint32_t>(n) + 1;
            p.indices.insert(p.indices.end(), {a, a + 1, c, a + 1, c + 1, c});
        }
    p.material = material;
    return p;
}

}  // namespace tessera::test
