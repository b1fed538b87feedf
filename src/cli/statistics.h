// The `--stats` report: what was rendered, how, with which bits and at what cost, as one JSON object.
// Times are milliseconds of wall clock, cpu_ms of processor time while rendering.
#pragma once

#include <tessera/render.h>

#include <string>

namespace tessera::cli {

struct CommandTimes {
    double load_ms = 0, encode_ms = 0, total_ms = 0;
};

std::string statistics_json(const std::string& scene, const RenderOptions& options, const RenderResult& result,
                            const CommandTimes& times);

// Largest resident memory of this process so far, in MiB.
double peak_memory_mb();

}  // namespace tessera::cli
