// The options of `tessera render` as text, as they stand on the command line, and what they mean to
// the library. Values are checked by hand (parse.h) so that every refusal names its option.
#pragma once

#include <tessera/load.h>
#include <tessera/poses.h>
#include <tessera/render.h>

#include "cli/frames.h"
#include "cli/planes.h"

#include <CLI/App.hpp>

#include <optional>
#include <string>
#include <vector>

namespace tessera::cli {

struct RenderArguments {
    std::string scene, output, stats;
    std::string size = "1024x768", engine = "raster", samples = "4", filter = "box";
    PlaneTexts planes;
    std::string depth = "planar", space = "world";
    std::string point_size = "2", line_width = "1";
    std::string time, animation, frames, fps = "24", turntable, variant;
    std::string camera, eye, target, up = "y", fov, intrinsics, poses;
    std::string show, background = "white", exposure = "auto", tone_map = "neutral", encoding = "srgb";
    std::string lighting = "auto", ambient, shadows, max_depth = "8", min_contribution = "0.002";
    std::string threads, isa = "auto", quality = "92", png_level = "1";
    std::string max_triangles, max_pixels, max_memory, timeout;
    bool no_shadows = false, quiet = false, skip_existing = false;
};

// The engine that --engine names.
Engine parse_engine(const std::string& text);

void add_render_options(CLI::App& app, RenderArguments& arguments);
// Those about picture and machine, which other commands have, too.
void add_picture_options(CLI::App& app, RenderArguments& arguments);

enum class Codec { kPicture, kVideo };

// The arguments with their meaning. `camera` and `animation` stay text: they name parts of the scene.
struct RenderJob {
    LoadOptions load;
    RenderOptions render;
    std::string camera, animation, variant;
    std::optional<double> time;    // seconds
    std::optional<Frames> frames;  // a sequence
    bool skip_existing = false;
    bool z_is_up = false;
    double fps = 24;
    std::vector<Pose> poses;  // a picture from each, in place of the view
    Codec codec = Codec::kPicture;
    PlaneOptions planes;                                                       // what is written
    std::optional<double> timeout;                                             // seconds
    std::uint64_t max_picture = std::uint64_t{kMaxImageSide} * kMaxImageSide;  // pixels
};

// Throws kUsage, naming the option, unless all of it makes sense.
RenderJob parse_render_arguments(const RenderArguments& arguments);

}  // namespace tessera::cli
