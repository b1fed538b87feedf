// The benchmark meshes (bench/workloads.h) as scenes, and a frame of one ready for a reference engine.
#pragma once

#include <tessera/tessera.h>

#include "bench/workloads.h"
#include "core/parallel.h"
#include "geometry/frame.h"
#include "reference/visibility.h"
#include "render/shading_scene.h"

#include <memory>

namespace tessera::test {

inline Scene make_scene(const wl::Mesh& mesh) {
    Scene scene;
    Primitive p;
    for (std::size_t i = 0; i < mesh.verts(); ++i) {
        const float* v = mesh.v.data() + 8 * i;
        p.positions.push_back({v[0], v[1], v[2]});
        p.normals.push_back({v[3], v[4], v[5]});
    }
    p.indices.assign(mesh.idx.begin(), mesh.idx.end());
    scene.meshes.push_back({"mesh", {std::move(p)}, {}, {}});
    scene.nodes.emplace_back().mesh = 0;
    scene.scenes.push_back({"scene", {0}, {}});
    return scene;
}

// A scene with everything that rendering it once needs.
struct Prepared {
    Prepared(Scene s, const View& view, int width, int height, const StrokeStyle& style = {})
        : scene(std::move(s)), frame(make_frame(scene, view, width, height, style)) {
        options.samples = 1;
        options.width = width;
        options.height = height;
        Arena arena(1);
        shading = std::make_unique<ShadingScene>(scene, frame, options, arena, warnings);
    }
    const ShadingContext& context() const { return shading->context(); }

    Scene scene;
    RenderOptions options;
    Frame frame;
    std::vector<std::string> warnings;
    std::unique_ptr<ShadingScene> shading;
};

inline View look(Vec3 eye, Vec3 target) {
    View view;
    view.eye = eye;
    view.target = target;
    view.yfov = 60.0f * 3.14159265358979f / 180.0f;
    return view;
}

inline RunControl no_control() {
    return {[](double) {}, std::size_t{1} << 24};
}

}  // namespace tessera::test
