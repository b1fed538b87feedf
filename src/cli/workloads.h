// The built-in workloads of `tessera bench`: scenes whose pixel counts other rasterizers agree on, lit and
// developed as the benchmarks of those do it (Blinn-Phong under one light without falloff, no tone map,
// linear 8-bit values), and one with Tessera's own defaults.
#pragma once

#include <tessera/render.h>
#include <tessera/scene.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tessera::cli {

struct Workload {
    std::string name;
    Scene scene;
    RenderOptions options;  // engine, instruction set and threads are left to the caller
    // Pixels that a rasterizer must cover at this size, where that is known, give or take `tolerance`.
    std::optional<std::uint64_t> pixels;
    std::uint64_t tolerance = 0;
};

std::vector<std::string> workload_names();
// Throws kUsage, listing the names, for one that is none of them.
Workload make_workload(const std::string& name, int width, int height);

// What is wrong with a count of covered pixels; empty when nothing is, or nothing is known.
std::string pixel_fault(const Workload& workload, std::uint64_t covered);

// The cameras of the workloads: lookAt and perspective of GLM in float, operation by operation, so that the
// matrices are those that the other rasterizers were given. OpenGL conventions, 60 degrees, 0.1 to 20.
View workload_view(Vec3 eye, Vec3 target, int width, int height);

}  // namespace tessera::cli
