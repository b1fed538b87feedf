// What tessera_raster_kernel_bench measures: jobs of the rasterizer's kernels as they occur in the frames of
// the built-in workloads, at 1920 x 1080 with tiles of 128 pixels. One thread, but for the stages.
#pragma once

#include "kernel_work.h"

#include "cli/workloads.h"
#include "core/parallel.h"
#include "raster/engine.h"
#include "render/options.h"
#include "render/shading_scene.h"
#include "tile/tile.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tessera::bench {

// A workload ready to draw, set up and binned by the scalar kernels. Made once, then kept.
class BenchFrame {
  public:
    // The name of a workload, or of one with "_shuffled" behind it: its triangles in random order.
    static BenchFrame& of(const std::string& name);
    explicit BenchFrame(const std::string& name);

    FrontEndInput input(const RasterKernels& kernels) const;
    TileTask task(const RasterSettings& settings, const PictureTargets& targets, const FrontEnd& front) const;
    // Settings of a picture drawn with this instruction set.
    RasterSettings settings(Isa isa) const;

    cli::Workload workload;
    Arena arena{1};
    std::unique_ptr<PreparedScene> prepared;
    std::unique_ptr<ShadingScene> shading;
    Frame frame;
    const TileGrid grid;
    FrontEnd front;

  private:
    Watchdog watchdog_;
    std::vector<SamplePosition> samples_;
    std::function<void()> checkpoint_ = [] {};
};

// All kernels that draw tiles.
struct Kernels : RasterKernels, TileKernels {
    explicit Kernels(Isa isa) : RasterKernels(raster_kernels(isa)), TileKernels(tile_kernels(isa)) {}
};

using KernelWork = WorkOf<Kernels>;
using KernelCase = CaseOf<Kernels>;

// A stage of a whole frame on a number of threads.
struct StageWork {
    std::uint64_t items;
    std::function<void()> run;
    std::function<Bytes()> output;
};
struct StageCase {
    std::string name;  // stage/workload
    std::function<StageWork(Isa, int threads)> make;
};

std::vector<KernelCase> front_end_cases();
std::vector<KernelCase> visibility_cases();
std::vector<KernelCase> surface_cases();
std::vector<StageCase> stage_cases();

}  // namespace tessera::bench
