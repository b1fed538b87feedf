// From the bytes of picture files to the pictures of a scene.
#pragma once

#include "load/context.h"
#include "load/file.h"

#include <tessera/scene.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace tessera {

struct PictureFile {
    std::size_t picture = 0;  // index into Scene::pictures
    std::string place, name;  // for errors; the name may be empty
    Bytes owned;              // the bytes, or where they are not part of another file's: nothing
    std::span<const std::byte> bytes;
};

// What becomes of a file that holds no picture: an error, or a warning and no pixels.
enum class PictureFaults { kFail, kWarn };

// Decodes the files on several threads, after checking and charging the size of each. Formats that
// Tessera does not read are left out with a warning. Of several faults the first in order is reported.
void decode_pictures(LoadContext& context, std::vector<PictureFile>&& files, Scene& scene, PictureFaults faults);

}  // namespace tessera
