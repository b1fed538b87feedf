// What the mesh formats (OBJ, PLY, STL) need to become scenes: memory that is charged as arrays grow, the
// material of what has none, nodes for meshes.
#pragma once

#include "load/context.h"

#include <tessera/scene.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace tessera {

// push_back() for arrays whose length the file does not say: memory is charged before it is taken.
template <class T>
void append(LoadContext& context, std::vector<T>& values, const T& value) {
    if (values.size() == values.capacity()) {
        const std::size_t more = std::max<std::size_t>(values.size(), 64);
        context.charge(std::uint64_t{more} * sizeof(T));
        values.reserve(values.size() + more);
    }
    values.push_back(value);
}

// resize() for a length that the file says.
template <class T>
void resize(LoadContext& context, std::vector<T>& values, std::size_t count) {
    context.charge(std::uint64_t{count} * sizeof(T));
    values.resize(count);
}

// Light grey, neither metallic nor glossy. Both sides are drawn, as these formats know no culling.
Material plain_material();

// Charges the scratch memory of a polygon of `corners`, so far as it exceeds that of `largest` before.
void charge_polygon(LoadContext& context, std::size_t corners, std::size_t& largest);

// At unit length, or (0, 0, 1) for what has no direction.
Vec3 unit_normal(const Vec3& n);

// Whether the file's normals say that the front of a triangle is at its other side: some writers care for
// normals only.
bool is_turned(const Vec3 (&positions)[3], const Vec3 (&normals)[3]);

// Appends the mesh and a root node of the active scene that carries it. Charged, and counted by max_nodes.
void add_mesh(LoadContext& context, Scene& scene, Mesh&& mesh);

// Throws kLimit for more than the options allow.
void count_triangles(const LoadContext& context, std::uint64_t triangles, const std::string& place);

// The last step: checks what was read and takes over the warnings.
void finish_scene(const LoadContext& context, Scene& scene);

}  // namespace tessera
