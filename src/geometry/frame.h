// A frame: a prepared scene seen from one camera. Instances with their matrices, placed lights, the
// projection, and the triangles that points and lines are in it. Points into the prepared scene and the scene, which
// must outlive it. Read-only once made.
#pragma once

#include "geometry/prepared_scene.h"
#include "geometry/projection.h"
#include "geometry/strokes.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tessera {

struct PlacedLight {
    int light;  // index into Scene::lights
    glm::dmat4 light_to_camera;
};

struct Frame {
    ProjectionView projection{};
    glm::dmat4 world_to_camera{1.0};
    std::vector<InstanceView> instances;     // in order of submission
    std::vector<const DrawnMesh*> prepared;  // per instance
    std::vector<PlacedLight> lights;         // in order of the nodes
    std::uint32_t triangle_count = 0;        // those of points and lines included, as far as these are in view
    std::uint64_t points = 0, lines = 0;     // in view or not
    std::vector<std::unique_ptr<StrokeMesh>> strokes;  // kept from frame to frame
    std::vector<std::string> warnings;
    std::shared_ptr<PreparedScene> owned;  // of a frame that was made from a scene alone

    // Spheres and discs are drawn by their formula, where their place lets them be.
    bool exact_shapes = false;
    bool has_exact_shapes = false;  // there are some

    // For motion: per instance the place of its node in PreparedScene::nodes(), and by that place the matrices to clip
    // space. Made where they are asked for.
    bool keep_nodes = false;
    std::vector<std::uint32_t> node_of_instance;
    std::vector<glm::dmat4> node_to_clip;

    // The instance that triangle `number` (0-based) belongs to.
    const InstanceView& instance_of(std::uint32_t number) const;
};

// Evaluates the active scene for a picture of width x height pixels into `frame`, whose memory is used again.
// Throws kUsage for views that make no sense and kLimit for more than 2^32 - 2 triangles, or points and lines beyond
// the memory limit.
void make_frame(PreparedScene& scene, const View& view, int width, int height, const StrokeStyle& style, Frame& frame);
// The same for one picture of a scene.
Frame make_frame(const Scene& scene, const View& view, int width, int height, const StrokeStyle& style = {});

// Whether the whole box lies outside one plane of the view volume (per-object frustum culling). Never
// true for a box of which any rounding could show a pixel.
bool outside_view(const InstanceView& instance, const Bounds3& object_bounds);

// A bound of the terms that coordinates of the instance in camera space are sums of: what their rounding goes by.
float largest_coordinate(const InstanceView& instance, const DrawnMesh& mesh);

}  // namespace tessera
