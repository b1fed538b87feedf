// The triangles of points and lines: every vertex must snap to exactly the position that it is meant to have, whatever
// the camera, however large the picture.
#include "geometry/strokes.h"

#include "geometry/frame.h"
#include "geometry/support.h"
#include "shading/triangle_setup.h"

#include <tessera/error.h>
#include <tessera/transform.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

namespace tessera {
namespace {

using test::Random;

// One primitive of one mode at one node, after a triangle, whose instance tells where vertices snap to.
Scene scene_of(PrimitiveMode mode, std::vector<Vec3> positions) {
    Scene scene;
    Primitive triangle, p;
    triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.mode = mode;
    p.positions = std::move(positions);
    scene.meshes.push_back({"", {triangle, std::move(p)}, {}, ""});
    scene.nodes.emplace_back().mesh = 0;
    scene.scenes.push_back({"", {0}, ""});
    return scene;
}

View view_of(int kind) {
    View view;
    view.eye = Vec3{0.3f, -0.2f, 3};
    view.target = Vec3{0, 0, 0};
    if (kind == 0) return view;
    // A host's: off centre, and with a w of its own scale.
    const Mat4 camera = look_at(*view.eye, *view.target, {0, 1, 0});
    Mat4 clip;
    clip(0, 0) = 1.5f, clip(0, 2) = 0.2f, clip(1, 1) = 1.7f, clip(1, 2) = -0.1f;
    clip(2, 2) = -1.02f, clip(2, 3) = -0.202f, clip(3, 2) = -1, clip(3, 3) = 0;
    if (kind == 2) {
        for (float& f : clip.m) f *= 3;
    }
    if (kind == 3) clip = orthographic(-1.5f, 1.5f, -1, 1, 0.1f, 9);
    if (kind == 3)
        for (int c = 0; c < 4; ++c) clip(2, c) = clip(3, c) - 2 * clip(2, c);  // as OpenGL has it
    view.eye.reset(), view.target.reset();
    view.clip_from_world = clip * camera;
    view.camera_from_world = camera;
    return view;
}

SnappedVertex snapped(const Frame& frame, const InstanceView& i, const Vec3& p) {
    const PictureVertex<float> v =
        to_picture(to_clip(i.object_to_clip, p.x, p.y, p.z), frame.projection.width, frame.projection.height);
    return {v.snapped_x, v.snapped_y};
}

Vec3 vertex(const InstanceView& i, std::uint32_t n) {
    const float* p = i.mesh.positions + 3 * std::size_t{n};
    return {p[0], p[1], p[2]};
}

bool in_guard(const SnappedVertex& v, int width, int height) {
    return std::abs(v.x - 128 * width) < 2 * 128 * width && std::abs(v.y - 128 * height) < 2 * 128 * height;
}

// The four corners of a line's parallelogram: of its first end, then of its second one.
struct Quad {
    SnappedVertex v[4];

    Quad(const Frame& frame, const InstanceView& i, std::uint32_t triangle) {
        const std::uint32_t first = i.mesh.triangles[3 * triangle] / 4 * 4;
        for (std::uint32_t k = 0; k < 4; ++k) v[k] = snapped(frame, i, vertex(i, first + k));
    }
};

void check_lines(const std::vector<Vec3>& ends, const View& view, int width, int height, float pixels) {
    const Frame frame = make_frame(scene_of(PrimitiveMode::kLines, ends), view, width, height, {2, pixels});
    const auto units = static_cast<std::int32_t>(256 * pixels + 0.5f);
    std::size_t checked = 0;
    TriangleSetup t;
    for (std::size_t n = 1; n < frame.instances.size(); ++n) {
        const InstanceView& i = frame.instances[n];
        ASSERT_TRUE(i.mesh.is_stroke());
        for (std::uint32_t triangle = 0; triangle < i.mesh.triangle_count; ++triangle) {
            setup_triangle(i, triangle, frame.projection, t);
            if (t.kind == TriangleSetup::Kind::kOutside) continue;
            ASSERT_EQ(t.kind, TriangleSetup::Kind::kPlain);
            ASSERT_TRUE(t.front(i));
            const Quad q(frame, i, triangle);
            const bool steep = std::abs(q.v[3].y - q.v[0].y) > std::abs(q.v[3].x - q.v[0].x);
            for (std::uint32_t end = 0; end < 2; ++end) {
                const SnappedVertex low = q.v[end ? 3 : 0], high = q.v[end ? 2 : 1];
                ASSERT_EQ(high.x - low.x, steep ? units : 0);
                ASSERT_EQ(high.y - low.y, steep ? 0 : units);
                const SnappedVertex middle =
                    snapped(frame, frame.instances[0], ends[2 * i.mesh.element_of(triangle) + end]);
                if (!in_guard(middle, width, height)) continue;  // it may have been cut
                ASSERT_EQ(low.x, middle.x - (steep ? units / 2 : 0));
                ASSERT_EQ(low.y, middle.y - (steep ? 0 : units / 2));
                ++checked;
            }
        }
    }
    EXPECT_GT(checked, ends.size() / 2);
}

TEST(Strokes, RAS3_SidesOfLinesAreTheirWidthApartExactly) {
    Random random(21);
    std::vector<Vec3> ends;
    for (int i = 0; i < 40000; ++i) ends.push_back(random.vec3(1.3f));  // several tasks
    for (const auto& [width, height] : {std::pair(64, 48), std::pair(1921, 1080), std::pair(16384, 16384)})
        for (int kind = 0; kind < 4; ++kind)
            for (const float pixels : {1.0f, 2.5f, 0.1f}) {
                SCOPED_TRACE(std::to_string(width) + " pixels, camera " + std::to_string(kind));
                check_lines(ends, view_of(kind), width, height, pixels);
            }
}

// Corners lie where the size says, and the polygon within 1/8 pixel of the circle.
TEST(Strokes, PointsAreRoundAndStandWhereTheyAre) {
    Random random(22);
    std::vector<Vec3> centres;
    for (int i = 0; i < 3000; ++i) centres.push_back(random.vec3(0.9f));
    for (const float size : {0.1f, 1.0f, 2.0f, 2.1f, 3.0f, 7.5f, 40.0f, 256.0f})
        for (int kind = 0; kind < 4; ++kind) {
            const int width = 2048, height = 1536;
            const Frame frame =
                make_frame(scene_of(PrimitiveMode::kPoints, centres), view_of(kind), width, height, {size, 1});
            const std::uint32_t corners = frame.instances[1].mesh.triangles_per_element + 2;
            EXPECT_EQ(corners == 4, size <= 2);
            std::size_t checked = 0;
            for (std::size_t n = 1; n < frame.instances.size(); ++n) {
                const InstanceView& i = frame.instances[n];
                for (std::uint32_t first = 0; first < i.mesh.vertex_count; first += corners) {
                    const std::uint32_t triangle = first / corners * (corners - 2);
                    const SnappedVertex at = snapped(frame, frame.instances[0], centres[i.mesh.element_of(triangle)]);
                    for (std::uint32_t k = 0; k < corners; ++k) {
                        const SnappedVertex a = snapped(frame, i, vertex(i, first + k)),
                                            b = snapped(frame, i, vertex(i, first + (k + 1) % corners));
                        const double ax = (a.x - at.x) / 256.0, ay = (a.y - at.y) / 256.0, radius = size / 2.0;
                        const double bx = (b.x - at.x) / 256.0, by = (b.y - at.y) / 256.0;
                        if (corners == 4) {
                            ASSERT_NEAR(std::abs(ax), radius, 1.0 / 256);
                            ASSERT_NEAR(std::abs(ay), radius, 1.0 / 256);
                        } else {
                            ASSERT_NEAR(std::hypot(ax, ay), radius, 0.125);
                            ASSERT_NEAR(std::hypot(ax + bx, ay + by) / 2, radius, 0.125);
                        }
                        ASSERT_GT(ay * bx - ax * by, 0);  // counter-clockwise, y down
                        ++checked;
                    }
                }
            }
            EXPECT_GT(checked, 3000u);
        }
}

// In any number of tasks, on any number of threads.
TEST(Strokes, CARD3_ThreadsAreNoMatter) {
    Random random(23);
    std::vector<Vec3> ends;
    for (int i = 0; i < 100000; ++i) ends.push_back(random.vec3(1.3f));
    const Scene scene = scene_of(PrimitiveMode::kLineLoop, ends);
    Frame frames[2];
    for (const int threads : {1, 3}) {
        Arena arena(threads);
        PreparedScene prepared(scene, &arena);
        Frame& frame = frames[threads / 2];
        for (int again = 0; again < 2; ++again) make_frame(prepared, view_of(again), 640, 480, {}, frame);
        EXPECT_EQ(frame.lines, 100000u);
        EXPECT_LT(frame.triangle_count, 200000u);
        EXPECT_EQ(frame.instances.size(), 1 + (100000 + 16383) / 16384u);
    }
    for (std::size_t i = 1; i < frames[0].instances.size(); ++i) {  // strokes belong to the frame
        const MeshView &a = frames[0].instances[i].mesh, &b = frames[1].instances[i].mesh;
        ASSERT_EQ(a.vertex_count, b.vertex_count);
        EXPECT_EQ(std::memcmp(a.positions, b.positions, 12 * std::size_t{a.vertex_count}), 0);
        EXPECT_EQ(frames[0].instances[i].first_triangle, frames[1].instances[i].first_triangle);
    }
}

TEST(Strokes, MemoryHasALimit) {
    const Scene scene = scene_of(PrimitiveMode::kPoints, std::vector<Vec3>(20000, Vec3{0.1f, 0.2f, 0.3f}));
    const View view = view_of(0);
    const std::uint64_t bytes = 20000 * (4 * 12 + 6 * 4 + 4);
    EXPECT_EQ(make_frame(scene, view, 64, 64, {2, 1, bytes}).triangle_count, 40001u);
    try {
        make_frame(scene, view, 64, 64, {2, 1, bytes - 1});
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::kLimit);
    }
    // What is out of view takes none.
    Scene aside = scene;
    aside.nodes[0].translation = {100, 0, 0};
    EXPECT_EQ(make_frame(aside, view, 64, 64, {2, 1, 0}).triangle_count, 1u);
}

}  // namespace
}  // namespace tessera
