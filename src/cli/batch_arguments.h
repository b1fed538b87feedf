// The options of `tessera batch` and what they mean. Those about picture and machine are those of `tessera render`.
#pragma once

#include "cli/reference.h"
#include "cli/render_arguments.h"
#include "cli/shard.h"

#include <CLI/App.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tessera::cli {

struct BatchArguments {
    RenderArguments render;  // its output is the pattern of names
    std::vector<std::string> scenes;
    std::string list, shard, shard_by = "scene", in_flight, report;
    std::string reference, tolerance = "0", max_differing = "0", differences, page;
    bool skip_existing = false;
};

struct BatchJob {
    RenderJob render;
    std::string list;                  // file that scenes were taken from, or ""
    std::string pattern;               // of the outputs' names
    std::vector<std::string> cameras;  // that were asked for; empty: each scene's default view
    bool every_camera = false;         // all that a scene has, in place of those
    Shard shard;
    bool shard_frames = false;  // shards share out the pictures of a scene, not the scenes
    int threads = 1;            // of the process
    int in_flight = 1;          // scenes at a time, at most
    bool skip_existing = false, quiet = false;
    std::string report;                         // file to write; "" for none
    std::optional<ReferenceOptions> reference;  // its tolerance and more
    std::string page;                           // HTML file of the comparison
};

void add_batch_options(CLI::App& app, BatchArguments& arguments);
// Throws kUsage, naming the option, unless all of it makes sense.
BatchJob parse_batch_arguments(const BatchArguments& arguments);
// The options that were given, by their names, for the report.
std::map<std::string, std::string> given_options(const CLI::App& app);

}  // namespace tessera::cli
