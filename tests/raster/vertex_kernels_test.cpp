// Transform of every instruction set against one lane, and one lane against the definitions.
#include "raster/kernel_world.h"

#include <bit>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

using namespace test;

class VertexKernels : public KernelTest {};

// Runs both and compares the vertices; what follows them may be written as far as the padding goes.
void expect_same(const RasterKernels& got, const RasterKernels& want, VertexJob job, const std::string& what) {
    GuardedArray<TransformedVertex> a(job.count + kMaxLanes), b(job.count + kMaxLanes);
    job.out = a.data();
    got.transform(job);
    job.out = b.data();
    want.transform(job);
    ASSERT_FALSE(a.changed());
    for (std::uint32_t i = 0; i < job.count; ++i)
        ASSERT_EQ(std::memcmp(&a[i], &b[i], sizeof a[i]), 0) << what << ", vertex " << i << " of " << job.count;
}

TEST_P(VertexKernels, TransformInARow) {
    Random random(2);
    for (const Place place : kPlaces)
        for (std::uint32_t triangles = 1; triangles < 23; ++triangles) {
            const KernelMesh mesh(random, place, triangles);
            // The whole mesh, and a part that ends with it: its last triple lies where memory ends.
            for (const std::uint32_t first : {0u, random.below(3 * triangles)})
                expect_same(kernels(), scalar(),
                            {&mesh.instance(), KernelMesh::kWidth, KernelMesh::kHeight, nullptr, first,
                             3 * triangles - first, nullptr},
                            "place " + std::to_string(static_cast<int>(place)));
            expect_same(kernels(), scalar(),
                        {&mesh.instance(), KernelMesh::kWidth, KernelMesh::kHeight, nullptr, 0, 1, nullptr}, "one");
        }
}

TEST_P(VertexKernels, TransformScattered) {
    Random random(3);
    for (const Place place : kPlaces) {
        const KernelMesh mesh(random, place, 40);
        for (std::uint32_t count = 1; count < 50; ++count) {
            GuardedArray<std::uint32_t> indices(count);
            for (std::uint32_t i = 0; i < count; ++i) indices[i] = random.below(120);
            indices[random.below(count)] = 119;  // the last record of the array
            expect_same(kernels(), scalar(),
                        {&mesh.instance(), KernelMesh::kWidth, KernelMesh::kHeight, indices.data(), 0, count, nullptr},
                        "place " + std::to_string(static_cast<int>(place)));
        }
    }
}

// What one lane stores: the picture position, z / w and 1 / w, or the out-codes and nothing else.
TEST(VertexByDefinition, PlainVerticesAndOutCodes) {
    const FpEnvironment exact;
    Random random(4);
    int plain = 0, special = 0, unusable = 0;
    for (const Place place : kPlaces) {
        const KernelMesh mesh(random, place, 200);
        const InstanceView& instance = mesh.instance();
        std::vector<TransformedVertex> out(600 + kMaxLanes);
        raster_kernels(Isa::kScalar)
            .transform({&instance, KernelMesh::kWidth, KernelMesh::kHeight, nullptr, 0, 600, out.data()});
        for (std::size_t i = 0; i < 600; ++i) {
            const ClipVertex<float> c =
                to_clip(instance.object_to_clip, Vec3T<float>::load(instance.mesh.positions + 3 * i));
            const auto usable = [](float v) { return std::fabs(v) < kLargestCoordinate; };
            float want[4] = {0, 0, 0, 0};
            if (!usable(c.x) || !usable(c.y) || !usable(c.z) || !usable(c.w)) {
                want[2] = std::bit_cast<float>(kUnusable);
                ++unusable;
            } else if ((out_code(c) & kMustClip) != 0 || !(c.w > 0)) {
                want[2] = std::bit_cast<float>(out_code(c));
                ++special;
            } else {
                const PictureVertex<float> p = to_picture(c, KernelMesh::kWidth, KernelMesh::kHeight);
                want[0] = p.x, want[1] = p.y, want[2] = c.z / c.w, want[3] = 1.0f / c.w;
                ASSERT_NE(want[3], 0.0f);
                ++plain;
            }
            ASSERT_EQ(std::memcmp(want, out[i].numbers, sizeof want), 0) << "vertex " << i;
        }
    }
    EXPECT_GT(plain, 4000);
    EXPECT_GT(special, 100);
    EXPECT_GT(unusable, 100);
}

INSTANTIATE_TEST_SUITE_P(Kernels, VertexKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
