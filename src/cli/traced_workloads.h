// Workloads of `tessera bench` for traced light: a primary ray a pixel, in the whitted_ ones with a hard shadow and one
// mirrored ray, again with its shadow, on the meshes that benchmarks of bare Embree use.
#pragma once

#include "cli/workloads.h"

#include <optional>
#include <string>
#include <vector>

namespace tessera::cli {

std::vector<std::string> traced_workload_names();
// Nothing for other names.
std::optional<Workload> make_traced_workload(const std::string& name, int width, int height);

}  // namespace tessera::cli
