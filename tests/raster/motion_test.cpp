// Scenes in motion: at every moment the tile rasterizer's planes are the reference's, whatever the instruction
// set and the threads that deform; and a warm renderer that goes from moment to moment draws what a new one does.
#include "load/test_files.h"
#include "raster/exactness.h"

#include <tessera/renderer.h>

namespace tessera {
namespace {

using namespace test;

std::vector<std::string> moving_models() {
    std::vector<std::string> names;
    for (const char* name :
         {"RiggedSimple/glTF-Binary/RiggedSimple.glb", "AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb",
          "BoxAnimated/glTF-Binary/BoxAnimated.glb", "SimpleMorph/glTF/SimpleMorph.gltf"})
        if (std::filesystem::exists(gltf_model(name))) names.push_back(gltf_model(name).string());
    return names;
}

TEST(RasterMotion, ANI5_EveryMomentIsExact) {
    const std::vector<std::string> names = moving_models();
    if (names.empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    for (const std::string& name : names) {
        const Scene scene = load_scene(name);
        const double end = duration(scene.animations.at(0));
        for (const double part : {0.0, 0.37, 1.0}) {
            RenderOptions o = all_planes(160, 120, 2);
            o.moment = {0, part * end};
            o.want_motion = true;
            o.motion_before = Shot{o.view, {0, (part - 0.1) * end}};
            o.motion_after = Shot{o.view, {0, (part + 0.1) * end}};
            expect_exact(scene, o, name);
        }
    }
}

TEST(RasterMotion, ANI5_WarmRenderersDrawTheSame) {
    const std::vector<std::string> names = moving_models();
    if (names.empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    for (const std::string& name : names) {
        const Scene scene = load_scene(name);
        const double end = duration(scene.animations.at(0));
        RenderOptions o = all_planes(160, 120, 1);
        o.moment = {0, 0};
        o.threads = 3;
        Renderer warm(scene, o);
        RenderResult result;
        for (const double part : {0.0, 0.9, 0.37, 0.37, 1.0, 0.0}) {
            warm.draw(o.view, {0, part * end}, result);
            RenderOptions cold = o;
            cold.moment.time = part * end;
            cold.threads = 1;
            cold.isa = Isa::kScalar;
            expect_equal_planes(render(scene, cold), result, name);
        }
    }
}

}  // namespace
}  // namespace tessera
