#include "raster_kernel_cases.h"

#include <algorithm>
#include <map>
#include <random>

namespace tessera::bench {
namespace {

constexpr int kTileSide = 128;
constexpr char kShuffled[] = "_shuffled";

cli::Workload make(std::string name) {
    const std::size_t suffix = name.find(kShuffled);
    const bool shuffled = suffix != std::string::npos;
    if (shuffled) name.resize(suffix);
    cli::Workload w = cli::make_workload(name, 1920, 1080);
    if (!shuffled) return w;
    auto& indices = w.scene.meshes[0].primitives[0].indices;
    std::mt19937 random(1);
    for (std::size_t t = indices.size() / 3 - 1; t > 0; --t) {
        const std::size_t other = random() % (t + 1);
        std::swap_ranges(indices.data() + 3 * t, indices.data() + 3 * t + 3, indices.data() + 3 * other);
    }
    return w;
}

}  // namespace

BenchFrame& BenchFrame::of(const std::string& name) {
    static std::map<std::string, std::unique_ptr<BenchFrame>> kept;
    std::unique_ptr<BenchFrame>& frame = kept[name];
    if (!frame) frame = std::make_unique<BenchFrame>(name);
    return *frame;
}

BenchFrame::BenchFrame(const std::string& name)
    : workload(make(name)),
      prepared(std::make_unique<PreparedScene>(workload.scene)),
      grid(workload.options.width, workload.options.height, kTileSide),
      watchdog_(workload.options),
      samples_(sample_positions(workload.options)) {
    std::vector<std::string> warnings;
    shading = std::make_unique<ShadingScene>(workload.scene, prepared->used_materials(), arena, warnings);
    make_frame(*prepared, workload.options.view, workload.options.width, workload.options.height, {}, frame);
    shading->light(workload.scene, frame, workload.options);
    front.run(input(raster_kernels(Isa::kScalar)), arena);
}

FrontEndInput BenchFrame::input(const RasterKernels& kernels) const {
    return {frame, shading->context(), kernels, grid, samples_, checkpoint_};
}

TileTask BenchFrame::task(const RasterSettings& settings, const PictureTargets& targets, const FrontEnd& binned) const {
    return {frame, shading->context(), settings, targets, grid, binned.vertices()};
}

RasterSettings BenchFrame::settings(Isa isa) const {
    RasterSettings s = raster_settings(workload.options, shading->film(workload.options), watchdog_.control(0, 1));
    s.isa = isa;
    return s;
}

}  // namespace tessera::bench
