// TESSERA_shape: primitives that are spheres, discs and planes.
#pragma once

#include "load/gltf_document.h"

#include <tessera/scene.h>

#include <optional>

namespace tessera {

// The shape that a primitive of the file has. Throws kInput for one that cannot be.
std::optional<Shape> find_shape(const Json& primitive);

// What stands for it, charged before it is made; its own attributes in the file are for other programs.
Primitive read_shape_primitive(GltfDocument& document, const Json& primitive, const Shape& shape);

}  // namespace tessera
