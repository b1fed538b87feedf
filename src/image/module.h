// The OpenImageIO module (oiio/module_api.h), found and opened the first time that it is needed. It is
// looked for where TESSERA_OIIO_MODULE says or, without that, beside the library or the executable that
// holds this code, and in tessera/ beside the library. It stays open until the process ends. Any thread
// may call; all see the same outcome.
#pragma once

#include "image/oiio/module_api.h"

#include <string>

namespace tessera {

// Null where there is none that fits.
const ImageModule* find_image_module() noexcept;
// `what` such as "reading WebP". Throws kInput, or kOutput for `writing`, when there is none; the message says
// how to get one.
const ImageModule& require_image_module(const std::string& what, bool writing);

}  // namespace tessera
