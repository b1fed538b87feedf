// Frames of labels alone by a warm renderer: 640x480 pixels of a sphere of 69,696 triangles, for each set of planes and
// on one thread and two; motion is measured to a shot from another place, both ways.
#include <tessera/tessera.h>

#include "cli/workload_meshes.h"

#include <benchmark/benchmark.h>

#include <string>

namespace {

using namespace tessera;

Scene sphere() {
    Scene scene;
    scene.meshes.push_back({"", {cli::sphere_mesh(132)}, {}, {}});
    Node node;
    node.mesh = 0;
    scene.nodes.push_back(node);
    scene.scenes.push_back({"", {0}, {}});
    return scene;
}

RenderOptions depth_and_ids() {
    RenderOptions o;
    o.width = 640, o.height = 480;
    o.want_color = false;
    o.want_depth = o.want_primitive = o.want_node = true;
    o.view.eye = Vec3{0.4f, 0.9f, 2.2f};
    o.view.target = Vec3{0, 0, 0};
    o.view.yfov = 0.9f;
    return o;
}

void draw(benchmark::State& state, const RenderOptions& wanted) {
    const Scene scene = sphere();
    RenderOptions o = wanted;
    o.threads = static_cast<int>(state.range(0));
    Renderer renderer(scene, o);
    RenderResult result;
    const Shot now{o.view, {}};
    Shot other = now;
    other.view.eye = Vec3{0.45f, 0.9f, 2.2f};
    renderer.draw(now, other, other, result);
    for (auto unused : state) renderer.draw(now, other, other, result);
}

void add(const char* name, const RenderOptions& options) {
    benchmark::RegisterBenchmark((std::string("labels/") + name + "/threads").c_str(), draw, options)
        ->Arg(1)
        ->Arg(2)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
    RenderOptions o = depth_and_ids();
    add("depth_ids", o);
    o.want_normal = true;
    add("depth_normal_ids", o);
    o.want_position = o.want_uv = o.want_albedo = o.want_material = true;
    add("all_but_motion", o);
    o = depth_and_ids();
    o.want_motion = true;
    add("depth_ids_motion", o);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
