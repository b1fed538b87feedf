// A frame: the scene evaluated at one moment from one camera. Meshes prepared for drawing (triangles,
// normals, tangents), instances with their matrices, placed lights. Owns everything that its views
// point to except what the scene owns: the scene must outlive it unchanged. Read-only once made.
#pragma once

#include "geometry/camera.h"
#include "geometry/draw_data.h"
#include "geometry/triangles.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tessera {

// One primitive of a mesh, prepared once for all of its instances.
struct PreparedMesh {
    PreparedMesh(Primitive&& made, const Primitive& source);

    const Primitive& primitive() const { return made.positions.empty() ? *source : made; }

    Primitive made;           // with normals and tangents, where the source lacked them; else empty
    const Primitive* source;  // the scene's
    TriangleList triangles;   // of primitive()
    Bounds3 bounds;           // object space
};

struct PlacedLight {
    int light;  // index into Scene::lights
    glm::dmat4 light_to_camera;
};

struct Frame {
    glm::dmat4 camera_to_world{1.0};
    Camera lens;
    ProjectionView projection{};
    std::vector<std::unique_ptr<PreparedMesh>> meshes;
    std::vector<InstanceView> instances;        // in order of submission
    std::vector<const PreparedMesh*> prepared;  // per instance
    std::vector<PlacedLight> lights;            // in order of the nodes
    std::uint32_t triangle_count = 0;
    std::vector<std::string> warnings;

    // The instance that triangle `number` (0-based) belongs to.
    const InstanceView& instance_of(std::uint32_t number) const;
};

// Evaluates the active scene, without exact duplicates of opaque instances, for a picture of width x height pixels.
// Throws kUsage for views that make no sense and kLimit for more than 2^32 - 2 triangles.
Frame make_frame(const Scene& scene, const View& view, int width, int height);

// Whether the whole box lies outside one plane of the view volume (per-object frustum culling). Never
// true for a box of which any rounding could show a pixel.
bool outside_view(const InstanceView& instance, const Bounds3& object_bounds);

}  // namespace tessera
