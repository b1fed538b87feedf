// Transform and index_range of every instruction set against one lane.
#include "raster/kernel_world.h"

#include <cstring>

namespace tessera {
namespace {

using namespace test;

class VertexKernels : public KernelTest {};

TEST_P(VertexKernels, IndexRangeOfEveryLength) {
    Random random(1);
    for (std::uint32_t count = 1; count < 70; ++count)
        for (int round = 0; round < 20; ++round) {
            GuardedArray<std::uint32_t> indices(count);
            for (std::uint32_t i = 0; i < count; ++i)
                indices[i] = round % 3 == 0 ? random.below(10) : random.below(0x7fffffff);
            if (round % 4 == 0) indices[random.below(count)] = 0;
            if (round % 4 == 1) indices[random.below(count)] = 0x7fffffff;
            std::uint32_t low = 0, high = 0, want_low = 0, want_high = 0;
            kernels().index_range(indices.data(), count, low, high);
            scalar().index_range(indices.data(), count, want_low, want_high);
            ASSERT_EQ(low, want_low) << count;
            ASSERT_EQ(high, want_high) << count;
        }
}

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

INSTANTIATE_TEST_SUITE_P(Kernels, VertexKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
