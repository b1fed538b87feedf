#include "cli/picture_file.h"

namespace tessera::cli {

void finish_color(const RenderJob& job, RenderResult& result) { finish_color(job.planes, result); }

std::vector<std::byte> encode_color(const RenderJob& job, const RenderResult& result) {
    return encode_planes(job.planes, job.planes.files.front(), result);
}

}  // namespace tessera::cli
