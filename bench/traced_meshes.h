// The meshes of bench/peers as a frame of the ray tracer: in camera space, which is theirs.
#pragma once

#include "bench/peers/embree_scenes.h"
#include "trace/embree_scene.h"

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <vector>

namespace tessera::bench {

inline constexpr std::uint64_t kPlenty = std::uint64_t{1} << 36;  // bytes for hierarchies

inline Vec3 as_vec3(const glm::vec3& v) { return {v.x, v.y, v.z}; }

// `flat`: three vertices a triangle.
inline Primitive primitive_of(const peers::Mesh& mesh, bool flat) {
    Primitive p;
    if (flat) {
        for (const std::uint32_t i : mesh.indices) p.positions.push_back(as_vec3(mesh.positions[i]));
    } else {
        for (const glm::vec3& v : mesh.positions) p.positions.push_back(as_vec3(v));
        p.indices = mesh.indices;
    }
    p.normals.assign(p.positions.size(), {0, 1, 0});
    return p;
}

// A mesh as the renderer prepares it; not to be moved.
struct TracedMesh {
    TracedMesh(const peers::Mesh& of, bool flat, bool deformed)
        : primitive(primitive_of(of, flat)), mesh({}, primitive) {
        mesh.deformed = deformed;
    }

    Primitive primitive;
    PreparedMesh mesh;
};

// Opaque, two-sided instances of those that have triangles. `deformed`: their vertices may be written over.
struct TracedMeshes {
    TracedMeshes(std::initializer_list<const peers::Mesh*> sources, bool flat, bool deformed) {
        for (const peers::Mesh* source : sources) {
            if (source->triangles() == 0) continue;
            meshes.push_back(std::make_unique<TracedMesh>(*source, flat, deformed));
            InstanceView instance{};
            instance.mesh = meshes.back()->mesh.view;
            for (int i = 0; i < 3; ++i) instance.object_to_camera[5 * i] = 1;
            instance.handedness = 1;
            instance.first_triangle = frame.triangle_count;
            frame.triangle_count += instance.mesh.triangle_count;
            frame.instances.push_back(instance);
            frame.prepared.push_back(&meshes.back()->mesh);
            classes.emplace_back();
        }
    }

    std::vector<std::unique_ptr<TracedMesh>> meshes;
    Frame frame;
    std::vector<TraceClass> classes;
};

}  // namespace tessera::bench
