// The rules of a valid scene, in pieces, so that the loader can apply each as soon as it can (the
// node forest before anything walks it) and skip the scans that it has done while reading. Each
// throws Error kUsage whose location is the place in the scene: "nodes/3/mesh". All are iterative.
#pragma once

#include <tessera/scene.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// A place in a scene as a chain on the stack; it becomes text only when a rule fails.
struct Place {
    static constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);
    const Place* parent = nullptr;
    std::string_view name;
    std::size_t index = kNoIndex;

    Place child(std::string_view child_name, std::size_t child_index = kNoIndex) const {
        return {this, child_name, child_index};
    }
    std::string text() const;
    [[noreturn]] void fail(const std::string& message) const;
    // `reference` is kNone or names one of `size` things.
    void reference(int reference, std::size_t size, std::string_view name_of_it) const;
    void finite(const float* values, std::size_t count) const;
};

// References of nodes, skins and scenes; the nodes form a forest; the roots of a scene are roots.
void check_hierarchy(const Scene& scene);
// Cameras, lights, materials, textures, pictures.
void check_appearance(const Scene& scene);
// Attribute lengths and morph targets; references of primitives; skins fit their meshes. With `values`
// also every index and number.
void check_meshes(const Scene& scene, bool values);
// A primitive with a shape, at `place`, is what shape_primitive() makes in kind; with `values` its vertices lie on the
// shape.
void check_shape(const Primitive& primitive, const Place& place, bool values);
// Key counts, increasing times, references. With `values` also every number of the keys.
void check_animations(const Scene& scene, bool values);

}  // namespace tessera
