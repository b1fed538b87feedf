// Coverage against figures that are not ours: three independent rasterizers (llvmpipe,
// MaskedOcclusionCulling and a scalar one) agree on the pixels that these meshes cover at 1920x1080.
#include <gtest/gtest.h>

#include "reference/rasterizer.h"
#include "reference/workload_scene.h"

namespace tessera {
namespace {

using test::look;
using test::Prepared;

struct Counts {
    std::uint64_t covered, passed;
};

// With `camera`, x, y and w come from its matrix, in the very floats that the others were given.
Counts count(Scene scene, const View& view, const wl::Camera* camera = nullptr) {
    Prepared p(std::move(scene), view, 1920, 1080);
    if (camera)
        for (const int row : {0, 1, 3})
            for (int column = 0; column < 4; ++column)
                p.frame.instances[0].object_to_clip[4 * row + column] = camera->mvp[column][row];
    const Visibility v = rasterize(p.frame, p.context(), {128, 128}, test::no_control());
    Counts c{0, v.counters.fragments_passed};
    for (const std::uint32_t t : v.triangle) c.covered += t != 0;
    return c;
}

Counts count_sphere(int n) {
    const wl::Camera camera = wl::sphere_camera(1920, 1080);
    return count(test::make_scene(wl::sphere(n)), look({0, 0, 2.2f}, {0, 0, 0}), &camera);
}
Counts count_terrain(int n) {
    const wl::Camera camera = wl::terrain_camera(1920, 1080);
    return count(test::make_scene(wl::terrain(n)), look({0, 0.9f, 1.3f}, {0, -0.15f, 0}), &camera);
}

TEST(Coverage, RAS4_Sphere1mCoversThePublishedPixels) {
    const Counts c = count_sphere(500);
    EXPECT_EQ(c.covered, 715620u);
    EXPECT_EQ(c.passed, 715620u);
}
TEST(Coverage, RAS4_Sphere100kCoversThePublishedPixels) { EXPECT_EQ(count_sphere(158).covered, 715564u); }
TEST(Coverage, RAS4_Sphere10kCoversThePublishedPixels) {
    EXPECT_NEAR(static_cast<double>(count_sphere(50).covered), 714916.0, 4.0);
}
TEST(Coverage, RAS4_Terrain1mCoversThePublishedPixels) {
    const Counts c = count_terrain(707);
    EXPECT_EQ(c.covered, 1242631u);
    EXPECT_EQ(c.passed, 1263053u);
}
TEST(Coverage, RAS4_Terrain100kCoversThePublishedPixels) {
    const Counts c = count_terrain(224);
    EXPECT_EQ(c.covered, 1242622u);
    EXPECT_EQ(c.passed, 1263008u);
}
TEST(Coverage, RAS4_Soup20kCoversThePublishedPixels) {
    const wl::Camera camera = wl::soup_camera(1920, 1080);
    const Counts c = count(test::make_scene(wl::soup(20000, 8, 1920, 1080)), look({0, 0, 0}, {0, 0, -1}), &camera);
    EXPECT_EQ(c.covered, 2072594u);
    // Depth rounding differs between the libraries; they are 17 apart from each other.
    EXPECT_NEAR(static_cast<double>(c.passed), 5443886.0, 40.0);
}

// Twenty full-screen layers: front to back only the first passes, back to front all of them.
TEST(Coverage, RAS4_FullScreenLayersPassAsTheirOrderSays) {
    for (const int order : {1, -1}) {
        wl::Mesh mesh = wl::quads(20, order, 1920, 1080);
        const float aspect = 1920.0f / 1080.0f;
        for (std::size_t i = 0; i < mesh.verts(); ++i) {
            float* v = mesh.v.data() + 8 * i;
            v[0] *= aspect;
            v[2] = -(v[2] + 1.0f);  // 0.1 .. 2 in front of the camera
        }
        Scene scene = test::make_scene(mesh);
        Camera camera;
        camera.type = Camera::Type::kOrthographic;
        camera.xmag = aspect;
        camera.ymag = 1;
        camera.znear = 0.01f;
        camera.zfar = 3;
        scene.cameras.push_back(camera);
        scene.nodes[0].camera = 0;
        const Counts c = count(std::move(scene), View{});
        EXPECT_EQ(c.covered, 2073600u);
        EXPECT_EQ(c.passed, order > 0 ? 2073600u : 41472000u);
    }
}

}  // namespace
}  // namespace tessera
