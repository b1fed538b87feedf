// The vertices of a frame: every corner of every instance in view finds what transforming that vertex alone
// gives, whether its mesh names vertices in a row or few among many.
#include "raster/frame_vertices.h"

#include "raster/exactness.h"
#include "raster/kernel_world.h"

#include <cstring>

namespace tessera {
namespace {

using namespace test;

Primitive points_ahead(Random& random, std::uint32_t count) {
    Primitive p;
    for (std::uint32_t i = 0; i < count; ++i) {
        p.positions.push_back({random.in(-3, 3), random.in(-3, 3), random.in(-9, 1)});
        p.normals.push_back({0, 0, 1});  // or flat ones would be made, and vertices with them
    }
    return p;
}

TEST(FrameVertices, EveryCornerFindsItsVertex) {
    const FpEnvironment exact;
    Random random(61);
    Scene scene;
    add_material(scene, lambert({0.5f, 0.5f, 0.5f}));
    // In a row, over several parts, the first and last vertices unused.
    Primitive row = points_ahead(random, 21000);
    for (std::uint32_t i = 100; i + 300 < 21000; ++i) row.indices.insert(row.indices.end(), {i, i + 1, i + 200});
    // Few among many; and so many corners of them that they fall into parts.
    Primitive few = points_ahead(random, 30000), scattered = points_ahead(random, 40000);
    few.indices = {29999, 5, 777, 12000, 29999, 3};
    for (int i = 0; i < 12000; ++i) scattered.indices.push_back(random.below(40000));
    scattered.indices[0] = 0;
    scattered.indices[1] = 39999;
    Primitive one = points_ahead(random, 3);
    one.indices = {2, 0, 1};
    for (Primitive* p : {&one, &row, &few, &one, &scattered, &few}) {
        Primitive copy = *p;
        copy.material = 0;
        add_mesh(scene, std::move(copy));
    }
    View view = look_from({0, 0, 2}, {0, 0, -1});
    const Frame frame = make_frame(scene, view, 320, 200);
    ASSERT_EQ(frame.instances.size(), 6u);
    const std::vector<std::uint32_t> in_view{0, 1, 2, 4, 5};
    for (const int threads : {1, 2})
        for (const Isa isa : all_isas()) {
            Arena arena(threads);
            FrameVertices vertices;
            int checkpoints = 0;
            for (int frames = 0; frames < 2; ++frames)
                vertices.transform(frame, in_view, raster_kernels(isa), arena, [] {});
            vertices.transform(frame, in_view, raster_kernels(isa), arena, [&] { checkpoints += threads == 1; });
            EXPECT_TRUE(threads > 1 || checkpoints > 3);
            EXPECT_EQ(vertices.by_instance()[3].vertices, nullptr);
            for (const std::uint32_t i : in_view) {
                const InstanceView& instance = frame.instances[i];
                const InstanceVertices& placed = vertices.by_instance()[i];
                EXPECT_EQ(placed.corners != instance.mesh.triangles, i != 0 && i != 1);
                for (std::size_t c = 0; c < 3 * std::size_t{instance.mesh.triangle_count}; ++c) {
                    TransformedVertex want[kMaxLanes];
                    raster_kernels(Isa::kScalar)
                        .transform({&instance, 320, 200, nullptr, instance.mesh.triangles[c], 1, want});
                    ASSERT_EQ(std::memcmp(&placed.vertices[placed.corners[c]], want, sizeof *want), 0)
                        << "instance " << i << ", corner " << c;
                }
            }
        }
}

}  // namespace
}  // namespace tessera
