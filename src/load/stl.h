// STL (3D Systems, 1988): binary and ASCII. Triangles with flat shading and no unit of length; the file's
// numbers are taken as metres. Normals in the file are not trusted: the triangles have their own.
#pragma once

#include "load/context.h"

#include <tessera/scene.h>

#include <cstddef>
#include <span>

namespace tessera {

// Binary STL has no mark of its own: its size has to fit the number of triangles in it. ASCII begins
// with "solid", in any case and after comments, which headers of binary ones do, too: these have bytes that are no
// text.
bool is_binary_stl(std::span<const std::byte> file);
bool is_ascii_stl(std::span<const std::byte> file);

// Either kind. Every solid becomes a mesh. Throws kInput for a damaged file.
Scene read_stl(LoadContext& context, std::span<const std::byte> file);

}  // namespace tessera
