// `tessera info`: what is in a scene file, as text for people or as JSON.
#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/scene_input.h"
#include "cli/scene_summary.h"

#include <tessera/load.h>

#include <memory>

namespace tessera::cli {
namespace {

struct InfoArguments {
    std::string scene;
    bool json = false;
};

int run(const InfoArguments& arguments) {
    const Scene scene = load_input(arguments.scene, {});
    const SceneSummary summary = summarize(scene);
    const std::string file = input_name(arguments.scene);
    write_output("-", arguments.json ? summary_json(file, scene, summary) : summary_text(file, scene, summary));
    return kFine;
}

}  // namespace

Command add_info_command(CLI::App& application) {
    CLI::App* app = application.add_subcommand("info", "Say what is in a scene file");
    auto arguments = std::make_shared<InfoArguments>();
    app->add_option("scene", arguments->scene, "scene file (.gltf, .glb, .obj, .ply, .stl, .zip), or - for stdin")
        ->required()
        ->option_text("");
    app->add_flag("--json", arguments->json, "report as JSON");
    return {app, [arguments] { return run(*arguments); }};
}

}  // namespace tessera::cli
