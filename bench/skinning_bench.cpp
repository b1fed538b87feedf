// Skinning with four influences, vertices per second on one thread, by instruction set: positions and normals of
// 100,000 vertices, 60 joints that neighbouring vertices share, as in a figure.
#include "core/fp_environment.h"
#include "geometry/skin_kernels.h"

#include <tessera/isa.h>

#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

namespace {

using namespace tessera;

struct Figure {
    static constexpr std::uint32_t kVertices = 100000, kJoints = 60;
    std::vector<float> matrices, weights, positions, normals, out_positions, out_normals;
    std::vector<std::uint32_t> joints;

    Figure()
        : matrices(12 * kJoints),
          weights(4 * kVertices),
          positions(3 * kVertices),
          normals(3 * kVertices),
          out_positions(3 * kVertices),
          out_normals(3 * kVertices),
          joints(4 * kVertices) {
        std::mt19937 random(1);
        const auto number = [&] { return static_cast<float>(random() >> 8) / 16777216.0f; };
        for (std::vector<float>* values : {&matrices, &positions, &normals})
            for (float& v : *values) v = number();
        for (std::uint32_t v = 0; v < kVertices; ++v) {
            const std::uint32_t first = v / (kVertices / (kJoints - 4));
            for (std::uint32_t k = 0; k < 4; ++k) {
                joints[4 * v + k] = (first + k) % kJoints;
                weights[4 * v + k] = 0.25f;
            }
        }
    }
    SkinJob job() {
        SkinJob job{};
        job.matrices = matrices.data();
        job.joints = joints.data();
        job.weights = weights.data();
        job.sets = 1;
        job.count = kVertices;
        job.positions = positions.data();
        job.normals = normals.data();
        job.out_positions = out_positions.data();
        job.out_normals = out_normals.data();
        job.end = kVertices;
        return job;
    }
};

void skin(benchmark::State& state, Isa isa) {
    if (!isa_supported(isa)) return state.SkipWithError("this processor lacks it");
    const FpEnvironment exact;
    Figure figure;
    const SkinJob job = figure.job();
    for (auto unused : state) {
        skin_kernels(isa).skin(job);
        benchmark::DoNotOptimize(figure.out_positions.data());
    }
    state.SetItemsProcessed(state.iterations() * Figure::kVertices);
}

}  // namespace

int main(int argc, char** argv) {
    for (const tessera::Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
        benchmark::RegisterBenchmark((std::string("skin/4_influences/") + tessera::name(isa)).c_str(), skin, isa);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
