// A frame: a prepared scene seen from one camera. Instances with their matrices, placed lights, the
// projection. Points into the prepared scene and the scene, which must outlive it. Read-only once made.
#pragma once

#include "geometry/prepared_scene.h"
#include "geometry/projection.h"

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
    std::vector<InstanceView> instances;        // in order of submission
    std::vector<const PreparedMesh*> prepared;  // per instance
    std::vector<PlacedLight> lights;            // in order of the nodes
    std::uint32_t triangle_count = 0;
    std::vector<std::string> warnings;
    std::shared_ptr<PreparedScene> owned;  // of a frame that was made from a scene alone

    // For motion: per instance the place of its node in PreparedScene::nodes(), and by that place the matrices to clip
    // space. Made where they are asked for.
    bool keep_nodes = false;
    std::vector<std::uint32_t> node_of_instance;
    std::vector<glm::dmat4> node_to_clip;

    // The instance that triangle `number` (0-based) belongs to.
    const InstanceView& instance_of(std::uint32_t number) const;
};

// Evaluates the active scene for a picture of width x height pixels into `frame`, whose memory is used again.
// Throws kUsage for views that make no sense and kLimit for more than 2^32 - 2 triangles.
void make_frame(PreparedScene& scene, const View& view, int width, int height, Frame& frame);
// The same for one picture of a scene.
Frame make_frame(const Scene& scene, const View& view, int width, int height);

// Whether the whole box lies outside one plane of the view volume (per-object frustum culling). Never
// true for a box of which any rounding could show a pixel.
bool outside_view(const InstanceView& instance, const Bounds3& object_bounds);

}  // namespace tessera
