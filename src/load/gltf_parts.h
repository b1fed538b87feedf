// The parts of a glTF document, one function per topic, in the order in which gltf.cpp calls them.
// Each fills its vectors of the scene, whose sizes are those of the document's arrays.
#pragma once

#include "load/gltf_document.h"

#include <tessera/scene.h>

#include <vector>

namespace tessera {

// asset, extensionsUsed, extensionsRequired; refuses what is required and not known.
void read_header(GltfDocument& document, Scene& scene);

void read_cameras(GltfDocument& document, Scene& scene);
// KHR_lights_punctual. Returns, for each light of the file, its number in the scene or kNone for a type
// that is not known.
std::vector<int> read_lights(GltfDocument& document, Scene& scene);

// Nodes and scenes, with references checked but not the forest.
void read_nodes(GltfDocument& document, Scene& scene, const std::vector<int>& lights);
void read_skins(GltfDocument& document, Scene& scene);

// Throws kLimit when a scene draws more than LoadOptions::max_triangles. Needs the nodes, which must
// form a forest; reads no vertex data.
void check_triangle_limit(GltfDocument& document, const Scene& scene);
void read_meshes(GltfDocument& document, Scene& scene);
void read_materials(GltfDocument& document, Scene& scene);
// Textures, samplers and pictures; decodes the pictures that a material uses, in parallel.
void read_textures(GltfDocument& document, Scene& scene);
void read_pictures(GltfDocument& document, Scene& scene);
void read_animations(GltfDocument& document, Scene& scene);

// Makes room for the things of one array, charged to the context.
template <class T>
void make_room(GltfDocument& document, GltfArray array, std::vector<T>& things) {
    document.context().charge(std::uint64_t{document.size(array)} * sizeof(T));
    things.resize(document.size(array));
}

}  // namespace tessera
